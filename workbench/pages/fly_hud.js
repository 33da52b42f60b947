// Read-outs of both flights. The series came with the flights; everything here follows the page's clock without a round trip.
function make(tag, name, parent, words = "") {
  const node = document.createElement(tag)
  if (name) { node.className = name }
  node.textContent = words
  parent.append(node)
  return node
}

// Nobody reads numbers that change faster.
const READ_MS = 100

// Assigning equal text would still cost a layout.
function say(node, words) { if (node.textContent !== words) { node.textContent = words } }

function at(values, every, time) {
  const place = Math.min(Math.max(time / every, 0), values.length - 1)
  const low = Math.floor(place), high = Math.min(low + 1, values.length - 1)
  return values[low] + (place - low) * (values[high] - values[low])
}

const signed = (value, digits = 0) => {
  const words = Math.abs(value).toFixed(digits)
  return Number(words) === 0 ? words : `${value < 0 ? "−" : "+"}${words}`
}
const wrapped = (degrees) => { const turn = ((degrees + 180) % 360 + 360) % 360 - 180; return turn === -180 ? 180 : turn }
const kilometres = (value) => value < 1 ? `${Math.round(1000 * value)} m` : `${value.toFixed(1)} km`
const closing = (value) => `${value >= 0 ? "▼" : "▲"} ${Math.abs(value).toFixed(0)} m/s`

function table(flight, root) {
  const box = make("section", "hud", root)
  box.setAttribute("aria-label", `Read-outs of flight ${flight.letter}`)
  box.style.setProperty("--ink", flight.colour)
  const head = make("div", "head", box)
  make("b", "letter", head, flight.letter)
  const cells = {}
  for (const [name, title] of [["speed", "Speed"], ["load", "Load factor"], ["bank", "Bank, left positive"], ["turn", "Turn the policy asks for, left positive"]]) {
    cells[name] = make("span", name, head)
    cells[name].title = title
  }
  const guide = flight.guide ? make("div", "guide", box) : null
  const rows = make("div", "rows", box)
  const lines = [line(rows, "interceptor", "interceptor", "")]
  for (const missile of flight.missiles) { lines.push(line(rows, `${missile.number}`, "missile", missile.colour)) }
  return {flight, cells, guide, lines, box}
}

function line(rows, words, kind, colour) {
  const node = make("div", `line ${kind}`, rows)
  if (colour) { node.style.setProperty("--ink", colour) }
  make("i", "dot", node)
  make("span", "name", node, words)
  const parts = {node}
  for (const name of ["range", "closure", "azimuth"]) { parts[name] = make("span", name, node) }
  const bar = make("span", "energy", node)
  bar.title = "Energy left, of the missile's greatest"
  parts.level = make("i", "level", bar)
  if (kind !== "missile") { bar.classList.add("none") }
  parts.words = make("span", "words", node)
  return parts
}

function drawMissile(parts, missile, time) {
  const state = time < missile.launch ? "ahead" : time <= missile.end ? "flying" : missile.fate
  parts.node.className = `line missile ${state}`
  if (state === "ahead") { return }
  if (state !== "flying") { say(parts.words, state === "hit" ? `hit, ${missile.miss}` : `evaded, missed by ${missile.miss}`); return }
  const since = time - missile.launch, read = (name) => at(missile[name], missile.every, since)
  say(parts.range, kilometres(read("range")))
  say(parts.closure, closing(read("closure")))
  const azimuth = wrapped(read("azimuth"))
  say(parts.azimuth, `${signed(azimuth)}°`)
  parts.azimuth.classList.toggle("beam", Math.abs(Math.abs(azimuth) - 90) < 5)
  const energy = Math.round(read("energy"))
  parts.level.style.setProperty("--share", `${energy}%`)
}

function draw({flight, cells, guide, lines, box}, clock) {
  const time = Math.min(clock, flight.end), read = (name) => at(flight[name], flight.every, time)
  const step = Math.min(Math.floor(time / flight.step + 1e-6), flight.turn.length - 1)
  box.classList.toggle("over", clock > flight.end)
  say(cells.speed, `${read("speed").toFixed(0)} m/s`)
  say(cells.load, `${read("load").toFixed(1)} g`)
  say(cells.bank, `bank ${signed(read("bank"))}°`)
  say(cells.turn, `turn ${signed(flight.turn[step])}°`)
  if (guide) {
    const held = flight.allowed[step]
    guide.classList.toggle("prevented", !held)
    say(guide, `guide ${signed(flight.guide[step])}° · ${held ? "transfer allowed" : "transfer prevented"}`)
  }
  say(lines[0].range, kilometres(read("range")))
  say(lines[0].closure, closing(read("closure")))
  flight.missiles.forEach((missile, index) => drawMissile(lines[index + 1], missile, time))
}

export function render({model}) {
  const root = document.createElement("div")
  root.className = "huds"
  let tables = [], time = 0, shown = 0, rest = 0
  const show = () => {
    shown = time
    for (const one of tables) { draw(one, time) }
  }
  const build = () => {
    root.replaceChildren()
    tables = JSON.parse(model.flights).map((flight) => table(flight, root))
    root.hidden = !model.visible_hud
    show()
  }
  const onTime = (event) => {
    time = event.detail.time
    if (rest) { return }
    show()
    rest = setTimeout(() => { rest = 0; if (shown !== time) { show() } }, READ_MS)
  }
  window.addEventListener("flight-time", onTime)
  model.on(["flights", "visible_hud"], build)
  model.on("remove", () => { clearTimeout(rest); window.removeEventListener("flight-time", onTime) })
  build()
  return root
}
