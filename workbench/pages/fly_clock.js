// One clock for the page. It ticks here; Python hears of it as often as it can answer, everything else by browser events.
//   "flight-clock" (detail: seconds) asks to move the clock; "flight-time" (detail: {time, playing}) tells where it is.
const PLAY = "M8 5.5v13l11-6.5z", PAUSE = "M7 5h3.6v14H7zM13.4 5H17v14h-3.6z"
const SHAPES = {
  event_back: "M6 5h2.2v14H6zM19 5v14L9.5 12z", step_back: "M15.5 5.5v13L7 12z",
  step_on: "M8.5 5.5v13L17 12z", event_on: "M15.8 5H18v14h-2.2zM5 5v14l9.5-7z",
}
const SEND_MS = 30, SETTLE_MS = 400, LOST_MS = 1500, ON_THEIR_WAY = 2
const STEP_S = 1, LEAP_S = 10, FINE_S = 0.1

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

export function render({model}) {
  const root = make("div", "clock", document.createElement("div"))
  const play = make("button", "play", root, {type: "button", title: "Play or pause (space)", "aria-label": "Play or pause"})
  play.innerHTML = "<svg viewBox='0 0 24 24' width='26' height='26'><path fill='currentColor'/></svg>"
  const steps = make("div", "steps", root, {role: "group", "aria-label": "Step"})
  for (const [shape, words, move] of [
    ["event_back", "Previous event ([)", () => leap(-1)], ["step_back", "One step back (left arrow)", () => stepBy(-STEP_S)],
    ["step_on", "One step on (right arrow)", () => stepBy(STEP_S)], ["event_on", "Next event (])", () => leap(1)]]) {
    const button = make("button", "step", steps, {type: "button", title: words, "aria-label": words.replace(/ \(.*/, "")})
    button.innerHTML = `<svg viewBox='0 0 24 24' width='20' height='20' aria-hidden='true'><path fill='currentColor' d='${SHAPES[shape]}'/></svg>`
    button.onclick = move
  }
  const now = make("span", "now", root)
  const track = make("div", "track", root)
  const marks = make("div", "marks", track)
  const rail = make("input", "rail", track, {type: "range", min: 0, step: 0.05, "aria-label": "Time in seconds"})
  const end = make("span", "end", root)
  const speeds = make("div", "speeds", root, {role: "group", "aria-label": "Playback speed"})
  let time = model.time, playing = model.playing
  let frame = 0, painting = 0, before = 0, sent = 0, unanswered = [], timer = 0, settle = 0

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

  function setSpeed(way) {
    const place = model.speeds.indexOf(model.speed) + way
    if (place >= 0 && place < model.speeds.length) { model.speed = model.speeds[place]; drawSpeeds() }
  }

  // A single step is for looking closely: it ends the play, and lands on whole steps.
  function stepBy(seconds) {
    if (playing) { setPlaying(false) }
    const whole = Math.abs(seconds), place = time / whole
    put((seconds > 0 ? Math.floor(place + 1e-6) + 1 : Math.ceil(place - 1e-6) - 1) * whole)
  }

  function leap(way) {
    const times = [...new Set(model.marks.map((mark) => mark.time))].sort((a, b) => a - b)
    const next = way > 0 ? times.find((one) => one > time + 0.02) : times.findLast((one) => one < time - 0.02)
    if (playing) { setPlaying(false) }
    put(next ?? (way > 0 ? model.duration : 0))
  }

  // Python answers each time with `shown`. Two may be on their way, so that neither side waits for the other; the next one
  // leaves only then: a slow machine skips instants and never lags behind.
  function send() {
    clearTimeout(timer)
    const stamp = performance.now()
    if (unanswered.length >= ON_THEIR_WAY && stamp - sent < LOST_MS) { return }
    if (stamp - sent < SEND_MS) { timer = setTimeout(send, SEND_MS - (stamp - sent)); return }
    if (model.time === time) { return }
    if (stamp - sent >= LOST_MS) { unanswered = [] }
    unanswered.push(time)
    sent = stamp
    model.time = time
  }

  function paint() {
    cancelAnimationFrame(painting)
    painting = 0
    draw()
    window.dispatchEvent(new CustomEvent("flight-time", {detail: {time, playing}}))
  }

  // A slow machine is moved more often than it draws: the page follows once a frame.
  function put(value) {
    time = Math.min(Math.max(value, 0), model.duration)
    painting ||= requestAnimationFrame(paint)
    send()
    clearTimeout(settle)
    if (!playing) { settle = setTimeout(() => { model.settled = time }, SETTLE_MS) }
  }

  function tick(stamp) {
    if (!playing) { return }
    const passed = Math.min(stamp - before, 250) / 1000
    before = stamp
    put(time + passed * model.speed)
    paint()
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

  const KEYS = {
    ArrowLeft: (event) => stepBy(event.shiftKey ? -LEAP_S : -STEP_S), ArrowRight: (event) => stepBy(event.shiftKey ? LEAP_S : STEP_S),
    ",": () => stepBy(-FINE_S), ".": () => stepBy(FINE_S), "[": () => leap(-1), "]": () => leap(1),
    Home: () => put(0), End: () => put(model.duration), "+": () => setSpeed(1), "=": () => setSpeed(1), "-": () => setSpeed(-1),
  }

  function onKey(event) {
    const busy = event.composedPath()[0]
    if (event.defaultPrevented || event.altKey || event.ctrlKey || event.metaKey) { return }
    if (busy instanceof Element && busy.closest("input:not([type=range]), textarea, select, dialog, [role=combobox], [role=tab], [role=listbox], [contenteditable]")) { return }
    const space = event.code === "Space" && !(busy instanceof HTMLButtonElement)
    if (!space && !KEYS[event.key]) { return }
    event.preventDefault()
    if (space) { setPlaying(!playing) } else { KEYS[event.key](event) }
  }

  const onClock = (event) => { if (Number.isFinite(event.detail)) { put(event.detail) } }
  play.onclick = () => setPlaying(!playing)
  rail.oninput = () => put(Number(rail.value))
  window.addEventListener("flight-clock", onClock)
  document.addEventListener("keydown", onKey)
  model.on("shown", () => { unanswered.splice(0, unanswered.lastIndexOf(model.shown) + 1); send() })
  model.on("jump", () => { setPlaying(false); put(model.jump[0]) })
  model.on("playing", () => { if (model.playing !== playing) { setPlaying(model.playing) } })
  model.on(["duration", "marks"], () => { drawMarks(); put(Math.min(time, model.duration)) })
  model.on("remove", () => {
    playing = false
    cancelAnimationFrame(frame)
    cancelAnimationFrame(painting)
    clearTimeout(timer)
    clearTimeout(settle)
    window.removeEventListener("flight-clock", onClock)
    document.removeEventListener("keydown", onKey)
  })
  drawSpeeds()
  drawMarks()
  draw()
  if (playing) { setPlaying(true) }
  return root
}
