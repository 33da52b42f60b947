// Buttons, slider, keys and mouse, and the words of the page; then the first picture.
function writeCards() {
  for (const flight of data.flights) {
    const card = make("div", find("cards"), "", {class: "card"})
    card.style.borderLeftColor = flight.evader.ink
    make("h1", card, `${flight.letter ? `${flight.letter} · ` : ""}${flight.name}`, {title: flight.facts.policy})
    const line = make("p", card)
    make("b", line, flight.outcome, {class: flight.success ? "won" : "lost"})
    const rest = [`return ${flight.facts.return.toFixed(1).replace("-", "−")}`, `${Math.round(flight.facts.length_s)} s`, flight.closest && `closest ${flight.closest}`]
    line.append(["", ...rest.filter(Boolean), `${flight.facts.task}, seed ${flight.facts.seed}`].join("  ·  "))
    line.title = line.textContent
  }
}

function writeEvents() {
  const shape = {launch: "▼", closest: "◆", evaded: "○", shot_down: "✕", exit: "⚑", branch: "↱"}
  // What happened to a branch before its moment is told of the flight it left.
  const own = (flight) => flight.events.filter((event) => flight.branch_of === null || event.time_s > flight.branch_s || event.kind === "branch")
  const all = data.flights.flatMap((flight) => own(flight).map((event) => [flight, event])).sort((a, b) => a[1].time_s - b[1].time_s)
  for (const [flight, event] of all) {
    const item = make("li", find("events"), "", {"data-time": event.time_s}), button = make("button", item, "", {type: "button"})
    make("time", button, clock(event.time_s))
    make("i", button, shape[event.kind] ?? "■").style.color = event.ink
    const words = make("span", button)
    if (flight.letter) { make("b", words, `${flight.letter} `).style.color = flight.evader.ink }
    words.append(event.text)
    button.onclick = () => seek(event.time_s)
    const tick = make("i", find("ticks"), "", {class: (flight.branch_of ?? data.flights.indexOf(flight)) === 0 ? "above" : "below"})
    tick.style.left = `${100 * event.time_s / Math.max(data.duration_s, 1e-6)}%`
    tick.style.background = event.ink
  }
  if (!all.length) { make("li", find("events"), "Nothing happened.", {"data-time": "0"}) }
}

function writeFacts() {
  const table = (title, rows) => {
    const one = make("table", find("facts"))
    make("caption", one, title)
    for (const [name, value] of rows) { const row = one.insertRow(); make("th", row, name, {scope: "row"}); row.insertCell().textContent = value }
  }
  for (const flight of data.flights) {
    const facts = Object.entries(flight.facts).filter(([name]) => name !== "events")
    const words = (value) => Array.isArray(value) ? value.join(", ") || "none" : value !== null && typeof value === "object" ? Object.entries(value).map(([key, one]) => `${key}: ${one}`).join(", ") || "none" : String(value)
    table(`${flight.letter ? `${flight.letter} · ` : ""}${flight.facts.policy}`, facts.map(([name, value]) => [name.replaceAll("_", " "), words(value)]))
  }
  table("Made with", Object.entries(data.made_with))
  const keys = make("p", find("facts"))
  for (const [key, words] of [["space", "play or pause"], ["← →", "one second, with shift ten"], [CAMERAS.map((_camera, i) => i + 1).join(" "), "camera"], ["l t b", "labels, trails, beam"], ["?", "this"]]) {
    make("kbd", keys, key)
    keys.append(` ${words}   `)
  }
  make("p", find("facts"), `Drag to turn the view, with shift or the right button to move it, wheel to come closer, double click to start over. Altitudes are drawn ${data.exaggeration} times as high, aircraft and missiles larger than they are. This file asks nobody for anything.`)
}

function save(name, content) {
  const link = make("a", document.body, "", {download: name, href: URL.createObjectURL(content)})
  link.click()
  link.remove()
  setTimeout(() => URL.revokeObjectURL(link.href), 1000)
}

function photograph() {
  draw()
  const parts = [find("scene"), ...[...find("plots").children].map((plot) => plot.firstChild)]
  const sheet = document.createElement("canvas"), [scene, ...rest] = parts, pen = sheet.getContext("2d")
  const below = Math.max(...rest.map((plot) => plot.height))
  sheet.width = scene.width
  sheet.height = scene.height + below
  pen.fillStyle = getComputedStyle(root).getPropertyValue("--panel")
  pen.fillRect(0, 0, sheet.width, sheet.height)
  pen.drawImage(scene, 0, 0)
  rest.forEach((plot, i) => pen.drawImage(plot, sheet.width * i / rest.length, scene.height))
  sheet.toBlob((picture) => save("flight.png", picture), "image/png")
}

function onDrag(canvas, move) {
  canvas.onpointerdown = (event) => { canvas.setPointerCapture(event.pointerId); move(event, true) }
  canvas.onpointermove = (event) => { if (canvas.hasPointerCapture(event.pointerId)) { move(event, false) } }
}

function moveCamera(event, first) {
  if (first) { return }
  if (!["follow", "branch", "free"].includes(state.camera)) { aim("free"); markers.cameras() }
  const across = event.movementX, down = event.movementY
  if (event.shiftKey || event.buttons === 2) {
    const view = viewOf(0, boxes()[0]), scale = Math.hypot(...view.eye) / view.focal, north = unit([view.ahead[0], view.ahead[1], 0])
    orbit.shift = plus(plus(orbit.shift, view.right, -across * scale), north, down * scale)
  } else { orbit.yaw -= across * 0.006; orbit.tilt += down * 0.005 }
  redraw()
}

function listen() {
  const scene = find("scene")
  onDrag(scene, moveCamera)
  scene.oncontextmenu = (event) => event.preventDefault()
  scene.addEventListener("wheel", (event) => { event.preventDefault(); orbit.zoom = clamp(orbit.zoom * Math.exp(event.deltaY * 0.001), 0.05, 6); redraw() }, {passive: false})
  scene.ondblclick = () => { orbit = still(); redraw() }
  data.flights.forEach((_flight, i) => {
    const canvas = make("canvas", make("div", find("plots")), "", {role: "img", "aria-label": "Curves over time; press to set the clock"})
    onDrag(canvas, (event) => seek(plots[i].time(event.offsetX)))
    const body = make("table", make("div", find("readouts")))
    body.createTBody()
  })
  find("rail").max = data.duration_s
  find("rail").oninput = () => seek(Number(find("rail").value))
  find("play").onclick = () => play(!state.playing)
  find("theme").onclick = () => paint(state.mode === "dark" ? "light" : "dark")
  find("photo").onclick = photograph
  find("keep").onclick = () => save("flight.json", new Blob([find("flight-data").textContent], {type: "application/json"}))
  find("tell").onclick = () => find("about").showModal()
  find("close").onclick = () => find("about").close()
  document.addEventListener("keydown", onKey)
  new ResizeObserver(() => { fitted.clear(); redraw() }).observe(find("stage"))
}

function onKey(event) {
  if (event.altKey || event.ctrlKey || event.metaKey || find("about").open) { return }
  const step = {ArrowLeft: -1, ArrowRight: 1}[event.key]
  const camera = CAMERAS[Number(event.key) - 1], layer = LAYERS.find(([name]) => name[0] === event.key)
  if (event.code === "Space" && event.target.tagName !== "BUTTON") { event.preventDefault(); play(!state.playing) }
  if (step) { event.preventDefault(); seek(state.time + step * (event.shiftKey ? 10 : 1)) }
  if (camera) { aim(camera[0]); markers.cameras() }
  if (layer) { show[layer[0]] = !show[layer[0]]; markers.layers() }
  if (event.key === "?") { find("about").showModal() }
  redraw()
}

function paint(mode) {
  state.mode = mode
  root.classList.toggle("light", mode === "light")
  find("theme").textContent = mode === "light" ? "Dark" : "Light"
  redraw()
}

writeCards()
writeEvents()
writeFacts()
listen()
find("end").textContent = clock(data.duration_s)
const markers = {
  cameras: choices("cameras", CAMERAS, (name) => state.camera === name, aim),
  layers: choices("layers", LAYERS, (name) => show[name], (name) => { show[name] = !show[name] }),
}
if (FIELDS.length > 1) { choices("layers", [["one", "One field", "All flights on one battlefield"]], () => state.one, () => { state.one = !state.one; fitted.clear() }) }
choices("kinds", Object.keys(KINDS).map((name) => [name, name[0].toUpperCase() + name.slice(1)]), (name) => state.kind === name, (name) => { state.kind = name })
choices("spans", [["engagement", "While missiles fly"], ["whole", "Whole flight"]], (name) => state.span === name, (name) => { state.span = name })
choices("speeds", SPEEDS.map((speed) => [speed, `${speed}×`]), (speed) => state.speed === speed, (speed) => { state.speed = speed })
paint(matchMedia("(prefers-color-scheme: light)").matches ? "light" : "dark")
const asked_for = new URLSearchParams(location.hash.slice(1))
if (CAMERAS.some(([name]) => name === asked_for.get("camera"))) { aim(asked_for.get("camera")); markers.cameras() }
play(false)
seek(Number(asked_for.get("t")) || 0)
