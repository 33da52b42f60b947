// One clock moves everything: scene, curves, read-outs, events. All words are put in as text, never as markup.
const find = (id) => document.getElementById(id)
const root = document.documentElement
// Each flight has a field; a branch is drawn on that of the flight it left.
const FIELDS = data.flights.flatMap((flight, i) => flight.branch_of === null ? [i] : [])
const BRANCH = data.flights.find((flight) => flight.branch_of !== null)
const SPEEDS = [1, 5, 10, 20, 50]
const CAMERAS = [["overview", "Overview"], ["top", "Top"], ["follow", "Follow"], ["free", "Free"], ...(BRANCH ? [["branch", `Follow ${BRANCH.letter}`]] : [])]
const LAYERS = [["labels", "Labels", "Names and distances"], ["trails", "Trails", "Paths"], ["beams", "±90°", "Beam of the evader and lines of sight, while missiles fly"]]
const EDGE = {top: 58, bottom: 92}  // of the scene: buttons above, read-outs below
const state = {time: 0, playing: false, speed: 20, camera: "overview", free: "overview", kind: "azimuth", span: "engagement", one: false, mode: "dark"}
let orbit = still(), stamp = 0, asked = false, plots = [], fitted = new Map(), settling = 0

function still() { return {yaw: 0, tilt: 0, zoom: 1, shift: [0, 0, 0]} }
function clock(seconds) { const whole = Math.floor(seconds + 1e-6); return `${Math.floor(whole / 60)}:${String(whole % 60).padStart(2, "0")}` }
function distance(metres) { return metres < 1000 ? `${Math.round(metres)} m` : `${(metres / 1e3).toFixed(1)} km` }

function make(tag, parent, words = "", attributes = {}) {
  const node = document.createElement(tag)
  node.textContent = words
  for (const [name, value] of Object.entries(attributes)) { node.setAttribute(name, value) }
  parent.append(node)
  return node
}

function boxes() {
  const {clientWidth: width, clientHeight: height} = find("scene")
  const count = state.one ? 1 : FIELDS.length
  return Array.from({length: count}, (_none, i) => ({left: width * i / count, top: 0, width: width / count, height}))
}

// The whole field from above its long side; in a narrow view from a corner, where more of it fits.
function fieldPose(top, box) {
  const key = `${top} ${box.left} ${box.width} ${box.height}`
  if (!fitted.has(key)) {
    const points = corners().flatMap((corner) => [corner, [corner[0], corner[1], data.ceiling_km]])
    const narrow = clamp((2.4 - box.width / box.height) / 1.4, 0, 1)
    const part = {left: box.left + 14, top: EDGE.top, width: box.width - 28, height: Math.max(box.height - EDGE.top - EDGE.bottom, 80)}
    fitted.set(key, top ? fit(points, 0, data.cameras.top_tilt_rad, box, part) : fit(points, -0.75 * narrow, 0.62 + 0.15 * narrow, box, part))
  }
  return fitted.get(key)
}

function followPose(flight, time) {
  const here = placeOf(flight.evader, time).at, rules = data.cameras
  const way = minus(placeOf(flight.evader, time + 4).at, placeOf(flight.evader, time - rules.lookback_s).at)
  const ahead = unit([way[0], way[1], 0])
  return poseBetween(plus(plus(here, ahead, -rules.behind_km), [0, 0, 1], rules.above_km), plus(plus(here, ahead, rules.ahead_km), [0, 0, -1], rules.below_km))
}

function viewOf(i, box) {
  const kind = state.camera === "free" ? state.free : state.camera
  const followed = kind === "branch" && (state.one || BRANCH.branch_of === i) ? BRANCH : data.flights[i]
  const base = ["follow", "branch"].includes(kind) ? followPose(followed, state.time) : fieldPose(kind === "top", box)
  return lookFrom({
    yaw: base.yaw + orbit.yaw, tilt: clamp(base.tilt + orbit.tilt, 0.03, data.cameras.top_tilt_rad),
    distance: base.distance * orbit.zoom, target: plus(base.target, orbit.shift),
  }, box)
}

function colours() {
  const style = getComputedStyle(root)
  return Object.fromEntries(["ink", "faint", "line"].map((name) => [name, style.getPropertyValue(`--${name}`).trim()]))
}

function spanShown() {
  if (state.span === "engagement") { return data.engagement_s }
  return [0, Math.max(data.duration_s, 1)]
}

function draw() {
  asked = false
  const pen = prepare(find("scene"))
  boxes().forEach((box, i) => drawView(pen, viewOf(i, box), drawn.filter((one, k) => state.one || k === i || one.branch_of === i), state.time, state.mode))
  const inks = colours()
  if (boxes().length > 1) { pen.fillStyle = inks.line; pen.fillRect(boxes()[1].left - 0.5, 0, 1, boxes()[1].height) }
  plots = data.flights.map((flight, i) => drawPlot(find("plots").children[i].firstChild, flight, state.kind, spanShown(), state.time, inks))
  data.flights.forEach(tellNow)
  const {time} = state
  find("now").textContent = clock(time)
  find("rail").value = time
  find("rail").setAttribute("aria-valuetext", clock(time))
  let last = null
  for (const row of find("events").children) {
    const past = Number(row.dataset.time) <= time + 1e-6
    row.firstChild.classList.toggle("past", past)
    row.firstChild.classList.remove("last")
    if (past) { last = row }
  }
  last?.firstChild.classList.add("last")
  if (last && state.playing) { find("events").scrollTop = last.offsetTop - find("events").clientHeight / 2 }
}

function redraw() { if (!asked) { asked = true; requestAnimationFrame(draw) } }

function tellNow(flight, i) {
  const table = find("readouts").children[i].firstChild, {time} = state
  table.tBodies[0].replaceChildren()
  const row = (ink, words) => { const line = table.tBodies[0].insertRow(); words.forEach((word) => { line.insertCell().textContent = word }); line.cells[0].style.color = ink }
  if (time >= flight.facts.length_s && time > 0) { row(flight.evader.ink, [flight.letter || "evader", flight.outcome]); return }
  const evader = placeOf(flight.evader, time)
  const turn = evader.bank * 180 / Math.PI
  row(flight.evader.ink, [flight.letter || "evader", `${Math.round(evader.mean(flight.evader.speed_m_s))} m/s`, `${(evader.mean(flight.evader.altitude_m) / 1e3).toFixed(1)} km high`, `bank ${Math.abs(Math.round(turn))}°${Math.abs(turn) < 0.5 ? "" : turn > 0 ? " left" : " right"}`])
  for (const missile of flight.missiles.filter((one) => flies(one, time))) {
    const at = placeOf(missile, time), then = placeOf(missile, Math.max(time - 0.5, missile.time_s[0]))
    const passed = Math.max(Math.min(0.5, time - missile.time_s[0]), 1e-3)
    const closing = (then.mean(missile.range_m) - at.mean(missile.range_m)) / passed
    row(missile.ink, [`missile ${missile.missile}`, distance(at.mean(missile.range_m)), `${closing >= 0 ? "closing" : "opening"} ${Math.abs(Math.round(closing))} m/s`, `at ${Math.round(missile.azimuth_deg[at.index])}°`])
  }
}

function seek(time) {
  state.time = clamp(time, 0, data.duration_s)
  redraw()
  clearTimeout(settling)
  // A place in the replay can be shared: the address keeps it. Some browsers forbid that for files.
  settling = setTimeout(() => { try { history.replaceState(null, "", `#t=${state.time.toFixed(1)}&camera=${state.camera}`) } catch { /* not here */ } }, 300)
}

function run(now) {
  if (!state.playing) { return }
  const passed = Math.min(now - stamp, 250) / 1000
  stamp = now
  seek(state.time + passed * state.speed)
  if (state.time >= data.duration_s) { play(false) } else { requestAnimationFrame(run) }
}

function play(on) {
  if (on && state.time >= data.duration_s) { state.time = 0 }
  state.playing = on
  find("play").querySelector("path").setAttribute("d", on ? "M7 5h3.6v14H7zM13.4 5H17v14h-3.6z" : "M8 5.5v13l11-6.5z")
  find("play").setAttribute("aria-pressed", String(on))
  if (on) { stamp = performance.now(); requestAnimationFrame(run) }
  seek(state.time)
}

function choices(id, entries, current, choose) {
  const buttons = entries.map(([name, words, title = ""]) => {
    const button = make("button", find(id), words, {type: "button", title})
    button.onclick = () => { choose(name); mark(); redraw() }
    return [name, button]
  })
  const mark = () => buttons.forEach(([name, button]) => button.setAttribute("aria-pressed", String(current(name))))
  mark()
  return mark
}

function aim(name) {
  if (name === "free" && state.camera !== "free") { state.free = state.camera } else { orbit = still() }
  state.camera = name
}
