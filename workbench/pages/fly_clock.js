// One clock for the page. It ticks here; Python hears of it as often as it can answer, everything else by browser events.
//   "flight-clock" (detail: seconds) asks to move the clock; "flight-time" (detail: {time, playing}) tells where it is.
const CURSOR = "clock-cursor"
const PLAY = "M8 5.5v13l11-6.5z", PAUSE = "M7 5h3.6v14H7zM13.4 5H17v14h-3.6z"
const SEND_MS = 66, PAINT_MS = 50, SETTLE_MS = 400

const text = (seconds) => {
  const whole = Math.floor(seconds + 1e-6)
  return `${Math.floor(whole / 60)}:${String(whole % 60).padStart(2, "0")}`
}

function make(tag, name, parent, attributes = {}) {
  const node = document.createElement(tag)
  node.className = name
  for (const [key, value] of Object.entries(attributes)) { node.setAttribute(key, value) }
  parent.append(node)
  return node
}

function cursors() {
  const found = []
  for (const doc of globalThis.Bokeh?.documents ?? []) {
    for (const model of doc._all_models?.values() ?? []) {
      if (model.tags?.includes?.(CURSOR)) { found.push(model) }
    }
  }
  return found
}

export function render({model}) {
  const root = make("div", "clock", document.createElement("div"))
  const play = make("button", "play", root, {type: "button", title: "Play or pause (space)", "aria-label": "Play or pause"})
  play.innerHTML = "<svg viewBox='0 0 24 24' width='26' height='26'><path fill='currentColor'/></svg>"
  const now = make("span", "now", root)
  const track = make("div", "track", root)
  const marks = make("div", "marks", track)
  const rail = make("input", "rail", track, {type: "range", min: 0, step: 0.05, "aria-label": "Time in seconds"})
  const end = make("span", "end", root)
  const speeds = make("div", "speeds", root, {role: "group", "aria-label": "Playback speed"})
  let time = model.time, playing = model.playing, spans = [], looked = 0
  let frame = 0, before = 0, painted = 0, sent = 0, waiting = false, timer = 0, settle = 0

  function draw() {
    const share = model.duration > 0 ? time / model.duration : 0
    rail.max = model.duration
    rail.value = time
    rail.style.setProperty("--share", `${100 * share}%`)
    rail.setAttribute("aria-valuetext", text(time))
    now.textContent = text(time)
    end.textContent = text(model.duration)
    play.querySelector("path").setAttribute("d", playing ? PAUSE : PLAY)
    play.classList.toggle("on", playing)
  }

  function drawMarks() {
    marks.replaceChildren()
    for (const mark of model.marks) {
      const tick = make("i", `mark ${mark.who === "B" ? "below" : "above"}`, marks)
      tick.style.left = `${100 * mark.time / Math.max(model.duration, 1e-6)}%`
      tick.style.background = mark.colour
    }
  }

  function drawSpeeds() {
    speeds.replaceChildren()
    for (const speed of model.speeds) {
      const button = make("button", speed === model.speed ? "on" : "", speeds, {type: "button", "aria-pressed": speed === model.speed})
      button.textContent = `${speed}×`
      button.onclick = () => { model.speed = speed; drawSpeeds() }
    }
  }

  function moveCursors() {
    const stamp = performance.now()
    if (stamp - looked > 700) { spans = cursors(); looked = stamp }
    for (const span of spans) { if (span.location !== time) { span.setv({location: time}, {sync: false}) } }
  }

  // Python answers each time with `shown`; the next one leaves only then, so a slow machine skips instances and never lags behind.
  function send() {
    clearTimeout(timer)
    const stamp = performance.now()
    if (waiting && stamp - sent < 1500) { return }
    if (stamp - sent < SEND_MS) { timer = setTimeout(send, SEND_MS - (stamp - sent)); return }
    if (model.time === time) { return }
    waiting = true
    sent = stamp
    model.time = time
  }

  function put(value, paint = true) {
    time = Math.min(Math.max(value, 0), model.duration)
    draw()
    if (paint) { moveCursors(); painted = performance.now() }
    window.dispatchEvent(new CustomEvent("flight-time", {detail: {time, playing}}))
    send()
    clearTimeout(settle)
    if (!playing) { settle = setTimeout(() => { model.settled = time }, SETTLE_MS) }
  }

  function tick(stamp) {
    if (!playing) { return }
    const passed = Math.min(stamp - before, 250) / 1000
    before = stamp
    put(time + passed * model.speed, stamp - painted > PAINT_MS)
    if (time >= model.duration) { setPlaying(false); return }
    frame = requestAnimationFrame(tick)
  }

  function setPlaying(on) {
    playing = on
    if (model.playing !== on) { model.playing = on }
    cancelAnimationFrame(frame)
    if (on) {
      if (time >= model.duration) { time = 0 }
      before = performance.now()
      frame = requestAnimationFrame(tick)
    }
    put(time)
  }

  function onKey(event) {
    const busy = event.composedPath()[0]
    if (busy instanceof Element && busy.closest("input:not([type=range]), textarea, select, [role=combobox], [contenteditable]")) { return }
    if (event.code === "Space" && !(busy instanceof HTMLButtonElement)) { event.preventDefault(); setPlaying(!playing) }
    if (event.altKey || event.ctrlKey || event.metaKey || busy instanceof HTMLInputElement) { return }
    const step = {ArrowLeft: -1, ArrowRight: 1}[event.key]
    if (step) { put(time + step * (event.shiftKey ? 10 : 1)) }
  }

  const onClock = (event) => { if (Number.isFinite(event.detail)) { put(event.detail) } }
  play.onclick = () => setPlaying(!playing)
  rail.oninput = () => put(Number(rail.value))
  window.addEventListener("flight-clock", onClock)
  document.addEventListener("keydown", onKey)
  model.on("shown", () => { waiting = false; send() })
  model.on("jump", () => { setPlaying(false); put(model.jump[0]) })
  model.on("playing", () => { if (model.playing !== playing) { setPlaying(model.playing) } })
  model.on(["duration", "marks"], () => { drawMarks(); looked = 0; put(Math.min(time, model.duration)) })
  model.on("remove", () => {
    playing = false
    cancelAnimationFrame(frame)
    clearTimeout(timer)
    clearTimeout(settle)
    window.removeEventListener("flight-clock", onClock)
    document.removeEventListener("keydown", onKey)
  })
  drawSpeeds()
  drawMarks()
  draw()
  if (playing) { setPlaying(true) }
  // Figures drawn later start at 0; this brings their cursors along.
  const keep = setInterval(() => { if (root.isConnected && !playing) { moveCursors() } }, 800)
  model.on("remove", () => clearInterval(keep))
  return root
}
