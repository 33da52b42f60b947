// The heading dial: drawn as the map is, 0° to the right and angles to the left. While it is seen, the arrow keys and the
// space bar are its own, not the clock's.
const SVG = "http://www.w3.org/2000/svg"
const RIM = 84, FAR_KM = 40, KEY_MS = 60, TAP_DEG = 5, HELD_DEG = 4, FINE_DEG = 1, AHEAD_DEG = 90

const whole = (degrees) => ((Math.round(degrees) % 360) + 360) % 360
const wrapped = (degrees) => ((degrees + 180) % 360 + 360) % 360 - 180
const at = (degrees, radius) => {
  const angle = degrees * Math.PI / 180
  return [radius * Math.cos(angle), -radius * Math.sin(angle)]
}

function draw(tag, attributes, parent) {
  const node = document.createElementNS(SVG, tag)
  for (const [key, value] of Object.entries(attributes)) { node.setAttribute(key, value) }
  parent.append(node)
  return node
}

function make(tag, name, parent, words = "") {
  const node = document.createElement(tag)
  node.className = name
  node.textContent = words
  parent.append(node)
  return node
}

function face(svg) {
  draw("circle", {class: "rim", r: RIM}, svg)
  for (const share of [0.25, 0.5]) { draw("circle", {class: "ring", r: RIM * share * 2 - 8}, svg) }
  for (let degrees = 0; degrees < 360; degrees += 30) {
    const [x1, y1] = at(degrees, RIM), [x2, y2] = at(degrees, RIM - 5)
    draw("line", {class: "tick", x1, y1, x2, y2}, svg)
    const [x, y] = at(degrees, RIM + 9)
    if (degrees % 90 === 0) { draw("text", {class: "scale", x, y}, svg).textContent = `${degrees}°` }
  }
}

export function render({model}) {
  const root = document.createElement("div")
  root.className = "stick"
  root.style.setProperty("--ink", model.colour)
  const svg = draw("svg", {viewBox: "-110 -110 220 220", tabindex: 0, role: "slider", "aria-valuemin": 0, "aria-valuemax": 359,
    "aria-label": "Heading to fly"}, root)
  face(svg)
  const sky = draw("g", {}, svg)
  const side = make("div", "side", root), numbers = make("dl", "numbers", side)
  const cells = ["asked for", "heading", "speed", "closest missile"].map((name) => {
    const cell = make("div", "", numbers)
    make("dt", "", cell, name)
    return make("dd", "", cell, "–")
  })
  const row = make("div", "row", side)
  const hold = make("button", "hold", row), speeds = make("div", "speeds", row)
  hold.type = "button"
  speeds.setAttribute("role", "group")
  speeds.setAttribute("aria-label", "Speed of the flight")
  const help = make("div", "help", side)
  help.innerHTML = "Time begins with your first turn. <kbd>←</kbd> <kbd>→</kbd> turn, with <kbd>Shift</kbd> finely, or drag the dial · <kbd>Space</kbd> pauses · " +
    "the aircraft turns as fast as it can"
  let asked = model.heading, side_held = 0, fine = false, timer = 0, dragging = false, begun = model.running

  function drawSky() {
    const seen = model.sight, flown = seen.heading ?? asked
    sky.replaceChildren()
    for (const beam of [-90, 90]) {
      const [x2, y2] = at(flown + beam, RIM - 6)
      draw("line", {class: "beam", x1: 0, y1: 0, x2, y2}, sky)
    }
    if (seen.exit !== undefined) {
      draw("path", {class: "exit", d: "M-6 -7 L6 0 L-6 7z", transform: `rotate(${-seen.exit}) translate(${RIM - 8})`}, sky)
        .append(document.createElementNS(SVG, "title"))
      sky.lastChild.lastChild.textContent = "Direction of the exit"
    }
    const [x2, y2] = at(asked, RIM)
    draw("line", {class: "ask", x1: 0, y1: 0, x2, y2}, sky)
    draw("path", {class: "bug", d: "M-9 0 L7 -9 L7 9z", transform: `rotate(${-asked}) translate(${RIM + 2})`}, sky)
    draw("path", {class: "plane", d: "M14 0 L-9 -9 L-4 0 L-9 9z", transform: `rotate(${-flown})`}, sky)
    for (const [number, direction, km, colour] of seen.missiles ?? []) {
      const [x, y] = at(direction, 16 + (RIM - 28) * Math.min(km / FAR_KM, 1))
      const dot = draw("g", {class: "missile", transform: `translate(${x} ${y})`}, sky)
      draw("circle", {r: 8, fill: colour}, dot)
      draw("text", {}, dot).textContent = number
      draw("title", {}, dot).textContent = `Missile ${number}, ${km} km`
    }
    tell(seen, flown)
  }

  function tell(seen, flown) {
    const near = [...(seen.missiles ?? [])].sort((one, other) => one[2] - other[2])[0]
    const words = [`${asked}°`, `${whole(flown)}°`, seen.speed === undefined ? "–" : `${seen.speed} m/s`,
      near ? `${near[0]} · ${near[2]} km` : "none"]
    cells.forEach((cell, index) => { cell.textContent = words[index] })
    cells[3].style.color = near ? near[3] : ""
    svg.setAttribute("aria-valuenow", asked)
    svg.setAttribute("aria-valuetext", `${asked} degrees`)
  }

  function drawControls() {
    hold.textContent = model.running ? "❚❚ Pause" : begun ? "▶ Go on" : "▶ Go"
    hold.setAttribute("aria-pressed", String(!model.running))
    speeds.replaceChildren(...model.speeds.map((speed) => {
      const button = document.createElement("button")
      button.type = "button"
      button.textContent = `${speed}×`
      button.title = `${speed} second${speed > 1 ? "s" : ""} of flight per second`
      button.classList.toggle("on", speed === model.speed)
      button.setAttribute("aria-pressed", String(speed === model.speed))
      button.onclick = () => { model.speed = speed; drawControls() }
      return button
    }))
  }

  // Time waits for the first turn, so that nobody has to look at everything at once.
  function begin() {
    if (!begun) { begun = true; model.running = true; drawControls() }
  }

  function ask(degrees) {
    asked = whole(degrees)
    if (model.heading !== asked) { model.heading = asked }
    drawSky()
  }

  // A heading further ahead than one action may turn would change nothing, and past the opposite it would turn back.
  function turn(step) {
    const ahead = wrapped(asked + step - (model.sight.heading ?? asked)) * Math.sign(step)
    if (ahead <= AHEAD_DEG) { ask(asked + step) }
    begin()
  }

  const release = () => { side_held = 0; clearInterval(timer) }
  const pause = () => { begun = true; model.running = !model.running; drawControls() }

  function onKey(event) {
    if (!root.isConnected || root.offsetParent === null || event.altKey || event.ctrlKey || event.metaKey) { return }
    const busy = event.composedPath()[0]
    if (busy instanceof Element && busy.closest("input:not([type=range]), textarea, select, [role=combobox], [role=listbox], [role=tab], [contenteditable]")) { return }
    const left = {ArrowLeft: 1, ArrowRight: -1}[event.key]
    if (left) {
      event.preventDefault()
      event.stopImmediatePropagation()
      fine = event.shiftKey
      if (side_held === left) { return }
      release()
      side_held = left
      turn(left * (fine ? FINE_DEG : TAP_DEG))
      timer = setInterval(() => turn(side_held * (fine ? FINE_DEG : HELD_DEG)), KEY_MS)
    } else if (event.code === "Space" && !(busy instanceof HTMLButtonElement)) {
      event.preventDefault()
      event.stopImmediatePropagation()
      pause()
    }
  }
  const onKeyUp = (event) => { if (event.key === "ArrowLeft" || event.key === "ArrowRight") { release() } }

  function drag(event) {
    const box = svg.getBoundingClientRect()
    const [x, y] = [event.clientX - box.left - box.width / 2, box.top + box.height / 2 - event.clientY]
    if (Math.hypot(x, y) > 8) { ask(Math.atan2(y, x) * 180 / Math.PI) }
    begin()
  }
  svg.onpointerdown = (event) => { dragging = true; svg.setPointerCapture(event.pointerId); drag(event) }
  svg.onpointermove = (event) => { if (dragging) { drag(event) } }
  svg.onpointerup = svg.onpointercancel = () => { dragging = false }

  hold.onclick = pause
  // Before the clock, which listens at the document.
  window.addEventListener("keydown", onKey, true)
  window.addEventListener("keyup", onKeyUp, true)
  window.addEventListener("blur", release)
  model.on("sight", drawSky)
  model.on("asked", () => { asked = model.asked[0]; begun = model.running; drawSky() })
  model.on(["running", "speed"], drawControls)
  model.on("remove", () => {
    release()
    window.removeEventListener("keydown", onKey, true)
    window.removeEventListener("keyup", onKeyUp, true)
    window.removeEventListener("blur", release)
  })
  drawControls()
  drawSky()
  return root
}
