// What a view shows at a time: battlefield, gate, paths, trails, bodies, ends of missiles, labels.
const STEP = {grid: 20, gate: 36, tail: 75, beam: 26}
const SHADE = {dark: data.grounds.dark, light: data.grounds.light}

for (const flight of data.flights) {
  for (const body of flight.bodies) {
    body.points = body.time_s.map((_time, i) => [body.x_m[i] / 1e3, body.y_m[i] / 1e3, body.altitude_m[i] / 1e3 * data.exaggeration])
    body.colour = rgb(body.ink)
  }
  flight.evader = flight.bodies[0]
  flight.missiles = flight.bodies.filter((body) => body.missile)
}

// What of a flight is drawn: of a branch, on the field of the flight it left, what comes after its moment.
const drawn = data.flights.map((flight) => {
  const from = flight.branch_s
  if (flight.branch_of === null) { return flight }
  const bodies = flight.bodies.filter((body) => body.gone_s === null || body.gone_s > from).map((body) => later(body, from))
  return {...flight, bodies, evader: bodies[0], missiles: bodies.filter((body) => body.missile), marks: flight.marks.filter((mark) => mark.time_s > from)}
})

function later(body, from) {
  const kept = Math.min(before(body.time_s, from - 1e-6) + 1, body.time_s.length - 1)
  return Object.fromEntries(Object.entries(body).map(([name, value]) => [name, Array.isArray(value) && name !== "colour" ? value.slice(kept) : value]))
}

// The last sample at or before a time; -1 before the first.
function before(times, time) {
  let low = -1, high = times.length
  while (high - low > 1) { const middle = (low + high) >> 1; if (times[middle] <= time) { low = middle } else { high = middle } }
  return low
}

function placeOf(body, time) {
  const times = body.time_s, i = clamp(before(times, time), 0, times.length - 1), j = Math.min(i + 1, times.length - 1)
  const share = j > i ? clamp((time - times[i]) / (times[j] - times[i]), 0, 1) : 0
  const mean = (values) => values[i] + (values[j] - values[i]) * share
  const radians = (values) => mean(values) * Math.PI / 180
  return {
    at: body.points[i].map((value, axis) => value + (body.points[j][axis] - value) * share), mean, index: share < 0.5 ? i : j,
    heading: radians(body.heading_deg), pitch: radians(body.pitch_deg), bank: body.bank_deg ? radians(body.bank_deg) : 0,
  }
}

const flies = (body, time) => body.time_s[0] <= time && (body.gone_s === null || time <= body.gone_s)

// The part of a path between two times, ends interpolated.
function part(body, from, to) {
  const [first, last] = [before(body.time_s, from) + 1, before(body.time_s, to) + 1]
  return [placeOf(body, from).at, ...body.points.slice(first, last), placeOf(body, to).at]
}

function corners() {
  const {length_km: length, width_km: width} = data.field
  return [[-length / 2, -width / 2, 0], [length / 2, -width / 2, 0], [length / 2, width / 2, 0], [-length / 2, width / 2, 0]]
}

function drawField(pen, view, shade) {
  const [a, b, c, d] = corners(), green = rgb(data.inks.gate), gate = STEP.gate * data.scale
  fill(pen, view, [a, b, c, d], css(shade.field))
  for (let x = Math.ceil(a[0] / STEP.grid) * STEP.grid; x <= b[0]; x += STEP.grid) { stroke(pen, view, [[x, a[1], 0], [x, c[1], 0]], css(shade.grid), 1) }
  for (let y = Math.ceil(a[1] / STEP.grid) * STEP.grid; y <= c[1]; y += STEP.grid) { stroke(pen, view, [[a[0], y, 0], [b[0], y, 0]], css(shade.grid), 1) }
  stroke(pen, view, [a, b, c, d, a], css(shade.border), 1.6)
  const [low, high] = [-1, 1].map((side) => data.field.exit_y_km + side * data.field.exit_half_width_km)
  const ink = ease(green, shade.far, shade.lift)
  fill(pen, view, [[b[0], low, 0], [b[0], high, 0], [b[0], high, gate], [b[0], low, gate]], css(ink, 0.18))
  for (let rung = 0; rung <= 6; rung++) { stroke(pen, view, [[b[0], low, gate * rung / 6], [b[0], high, gate * rung / 6]], css(ink, 0.85), 1.4) }
  for (const y of [low, high]) { stroke(pen, view, [[b[0], y, 0], [b[0], y, gate]], css(ink), 2.4) }
  const above = screen(view, [b[0], (low + high) / 2, gate])
  if (show.labels && above) { text(pen, [above[0] - 12, above[1] - 9], "exit", css(ink), css(shade.background)) }
}

function drawPath(pen, view, body, time, shade) {
  const ink = ease(body.colour, shade.far, shade.lift), first = body.time_s[0]
  stroke(pen, view, body.points, css(ink, 0.22), 1.2)
  if (time <= first) { return }
  stroke(pen, view, part(body, first, time), css(ink, 0.55), 1.6)
  if (!flies(body, time)) { return }
  const start = Math.max(first, time - STEP.tail)
  for (let piece = 0; piece < 8; piece++) {
    const [from, to] = [piece, piece + 1].map((end) => start + (time - start) * end / 8)
    stroke(pen, view, part(body, from, to), css(ink, 0.25 + 0.75 * (piece + 1) / 8), 1.2 + 0.35 * piece)
  }
}

function drawSight(pen, view, flight, time, shade) {
  const flown = flight.missiles.filter((missile) => flies(missile, time))
  if (!flown.length || !flies(flight.evader, time)) { return }
  const evader = placeOf(flight.evader, time), length = STEP.beam * data.scale
  const across = [-Math.sin(evader.heading) * length, Math.cos(evader.heading) * length, 0]
  stroke(pen, view, [plus(evader.at, across, -1), plus(evader.at, across)], css(shade.border, 0.95), 1.4, [5, 4])
  for (const missile of flown) { stroke(pen, view, [evader.at, placeOf(missile, time).at], css(missile.colour, 0.55), 1, [2, 4]) }
}

function drawBody(pen, view, body, time, shade) {
  const place = placeOf(body, time), ink = ease(body.colour, shade.far, shade.lift)
  const foot = [place.at[0], place.at[1], 0]
  stroke(pen, view, [place.at, foot], css(ink, 0.45), 1)
  const spot = screen(view, foot)
  if (spot) { pen.beginPath(); pen.arc(spot[0], spot[1], 2, 0, 7); pen.fillStyle = css(ink, 0.6); pen.fill() }
  const pixel = seen(view, place.at)[2] / view.focal
  // Never too small to see a bank, never so large that one hides another.
  const size = clamp(body.size_km, (body.missile ? 14 : 22) * pixel, (body.missile ? 26 : 52) * pixel)
  solid(pen, view, data.meshes[body.mesh], place, ink, size)
}

// Names beside the bodies; where they would cover each other they move up, at the end of a thin line.
function drawLabels(pen, view, flown, time, shade) {
  const taken = []
  pen.textAlign = "left"
  pen.textBaseline = "alphabetic"
  pen.font = "600 12px system-ui, sans-serif"
  for (const [flight, body] of flown) {
    const place = placeOf(body, time), at = screen(view, place.at)
    if (!at) { continue }
    const name = body === flight.evader ? flight.letter || "evader" : "interceptor"
    const words = body.missile ? `${body.missile} · ${distance(body.range_m[place.index])}` : name
    const width = pen.measureText(words).width + 4
    const spots = Array.from({length: 9}, (_none, i) => [[14, -13 - 15 * i], [-14 - width, -13 - 15 * i], [14, 22 + 15 * i]]).flat()
    const boxes = spots.map(([x, y]) => ({left: at[0] + x, top: at[1] + y - 12, width, height: 15}))
    const box = boxes.find((one) => !taken.some((other) => overlap(one, other))) ?? boxes[0]
    taken.push(box, {left: at[0] - 7, top: at[1] - 7, width: 14, height: 14})
    const ink = ease(body.colour, shade.far, 0.25), foot = [clamp(at[0], box.left, box.left + width), box.top + (box.top < at[1] ? 14 : 2)]
    if (Math.abs(foot[1] - at[1]) > 26) { pen.lineWidth = 0.8; line(pen, [at, foot], css(ink, 0.5)) }
    text(pen, [box.left, box.top + 12], words, css(ink), css(shade.field, 0.9))
  }
}

const overlap = (a, b) => a.left < b.left + b.width && b.left < a.left + a.width && a.top < b.top + b.height && b.top < a.top + a.height

function drawEnds(pen, view, flight, time, shade) {
  for (const mark of flight.marks.filter((one) => one.time_s <= time)) {
    const at = [mark.x_m / 1e3, mark.y_m / 1e3, mark.altitude_m / 1e3 * data.exaggeration], place = screen(view, at)
    if (!place) { continue }
    const young = clamp(1 - (time - mark.time_s) / 12, 0, 1), ink = rgb(mark.ink)
    if (mark.kind === "evaded") {
      pen.beginPath(); pen.arc(...place, 4 + 10 * young, 0, 7); pen.strokeStyle = css(ink, 0.9); pen.lineWidth = 1.6; pen.stroke()
    } else {
      const glow = pen.createRadialGradient(...place, 1, ...place, 14 + 26 * young)
      glow.addColorStop(0, css([255, 214, 130], 0.95)); glow.addColorStop(0.4, css([255, 130, 50], 0.6)); glow.addColorStop(1, css([255, 90, 40], 0))
      pen.beginPath(); pen.arc(...place, 14 + 26 * young, 0, 7); pen.fillStyle = glow; pen.fill()
      text(pen, [place[0] + 16, place[1] + 24], "shot down", css(rgb(data.inks.failure)), css(shade.field, 0.9), 13)
    }
  }
}

function drawView(pen, view, flights, time, mode) {
  const shade = SHADE[mode], {left, top, width, height} = view.box
  pen.save()
  pen.beginPath(); pen.rect(left, top, width, height); pen.clip()
  const sky = pen.createLinearGradient(0, top, 0, top + height)
  sky.addColorStop(0, css(ease(shade.background, shade.field, 0.9))); sky.addColorStop(0.55, css(shade.background))
  pen.fillStyle = sky
  pen.fillRect(left, top, width, height)
  pen.lineCap = "round"; pen.lineJoin = "round"
  drawField(pen, view, shade)
  for (const flight of flights) { for (const body of flight.bodies) { if (show.trails) { drawPath(pen, view, body, time, shade) } } }
  for (const flight of flights) { if (show.beams) { drawSight(pen, view, flight, time, shade) } drawEnds(pen, view, flight, time, shade) }
  const flown = flights.flatMap((flight) => flight.bodies.filter((body) => flies(body, time)).map((body) => [flight, body]))
  const depth = ([, body]) => seen(view, placeOf(body, time).at)[2]
  flown.sort((a, b) => depth(b) - depth(a))
  for (const [, body] of flown) { drawBody(pen, view, body, time, shade) }
  if (show.labels) { drawLabels(pen, view, flown.reverse(), time, shade) }
  pen.restore()
}
