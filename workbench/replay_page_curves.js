// Curves over time with a cursor (Fig. 12): one plot per flight on common scales; a press or a drag sets the clock.
const KINDS = {
  azimuth: {label: "azimuth [deg]", values: (body) => body.azimuth_deg, bodies: (flight) => flight.missiles, range: [-180, 180], ticks: [-180, -90, 0, 90, 180]},
  range: {label: "range [km]", values: (body) => body.range_m, factor: 1e-3, bodies: (flight) => flight.missiles},
  speed: {label: "speed [m/s]", values: (body) => body.speed_m_s, bodies: (flight) => flight.bodies},
}
const ROOM = {left: 42, right: 10, top: 22, bottom: 19}

function roundStep(span, wanted) {
  const rough = span / wanted, power = 10 ** Math.floor(Math.log10(rough))
  return [1, 2, 5, 10].map((factor) => factor * power).find((step) => step >= rough)
}

function ticksBetween(low, high, wanted) {
  const step = roundStep(high - low, wanted), found = []
  for (let tick = Math.ceil(low / step) * step; tick <= high + 1e-9; tick += step) { found.push(Math.round(tick * 1e6) / 1e6) }
  return found
}

function heights(kind) {
  if (kind.range) { return kind.range }
  const all = data.flights.flatMap((flight) => kind.bodies(flight)).map((body) => Math.max(...kind.values(body)))
  return [0, 1.08 * Math.max(1, ...all) * (kind.factor ?? 1)]
}

function layPlot(canvas, kind, span) {
  const [low, high] = heights(kind), width = canvas.clientWidth - ROOM.left - ROOM.right, height = canvas.clientHeight - ROOM.top - ROOM.bottom
  return {
    span, low, high, right: ROOM.left + width, bottom: ROOM.top + height,
    x: (time) => ROOM.left + width * (time - span[0]) / (span[1] - span[0]),
    y: (value) => ROOM.top + height * (high - value) / (high - low),
    time: (x) => span[0] + (span[1] - span[0]) * (x - ROOM.left) / width,
  }
}

function drawFrame(pen, plot, kind, title, colours) {
  pen.font = "11px system-ui, sans-serif"
  pen.lineWidth = 1
  pen.textBaseline = "middle"
  pen.textAlign = "right"
  for (const tick of kind.ticks ?? ticksBetween(plot.low, plot.high, 4)) {
    const beam = kind.ticks && Math.abs(tick) === 90
    line(pen, [[ROOM.left, plot.y(tick)], [plot.right, plot.y(tick)]], beam ? colours.faint : colours.line, beam ? [3, 3] : [])
    pen.fillStyle = colours.faint
    pen.fillText(String(tick), ROOM.left - 6, plot.y(tick))
  }
  pen.textAlign = "center"
  pen.textBaseline = "top"
  for (const tick of ticksBetween(...plot.span, Math.max(3, (plot.right - ROOM.left) / 75))) { pen.fillText(`${tick} s`, clamp(plot.x(tick), 30, plot.right - 14), plot.bottom + 5) }
  pen.textAlign = "left"
  pen.fillStyle = colours.ink
  pen.font = "600 12px system-ui, sans-serif"
  pen.fillText(title, ROOM.left, 3)
}

function line(pen, points, colour, dash = []) {
  pen.beginPath()
  points.forEach((point, i) => pen[i ? "lineTo" : "moveTo"](...point))
  pen.strokeStyle = colour
  pen.setLineDash(dash)
  pen.stroke()
  pen.setLineDash([])
}

function drawCurve(pen, plot, kind, body, time) {
  const values = kind.values(body), factor = kind.factor ?? 1
  const draw = (first, last, alpha) => {
    pen.beginPath()
    for (let i = first; i <= last; i++) {
      const leap = i > first && kind.range && Math.abs(values[i] - values[i - 1]) > 180
      pen[i > first && !leap ? "lineTo" : "moveTo"](plot.x(body.time_s[i]), plot.y(values[i] * factor))
    }
    pen.strokeStyle = css(body.colour, alpha)
    pen.lineWidth = 1.9
    pen.setLineDash(body.dashed ? [6, 3] : [])
    pen.stroke()
    pen.setLineDash([])
  }
  const now = before(body.time_s, time)
  draw(0, values.length - 1, 0.38)
  if (now < 0) { return }
  draw(0, now, 1)
  if (!flies(body, time)) { return }
  pen.beginPath()
  pen.arc(plot.x(time), plot.y(values[now] * factor), 3.6, 0, 7)
  pen.fillStyle = css(body.colour)
  pen.fill()
}

function drawPlot(canvas, flight, name, span, time, colours) {
  const pen = prepare(canvas), kind = KINDS[name], plot = layPlot(canvas, kind, span)
  drawFrame(pen, plot, kind, `${flight.letter ? `${flight.letter} · ` : ""}${kind.label}`, colours)
  pen.save()
  pen.beginPath(); pen.rect(ROOM.left, ROOM.top - 3, plot.right - ROOM.left, plot.bottom - ROOM.top + 6); pen.clip()
  pen.lineJoin = "round"
  for (const body of kind.bodies(flight)) { drawCurve(pen, plot, kind, body, time) }
  for (const event of flight.events) {
    if (event.kind === "closest") { continue }
    pen.fillStyle = event.ink
    pen.fillRect(plot.x(event.time_s) - 0.75, ROOM.top - 3, 1.5, 8)
  }
  pen.lineWidth = 1.5
  line(pen, [[plot.x(time), ROOM.top - 3], [plot.x(time), plot.bottom + 3]], colours.ink)
  pen.restore()
  if (!kind.bodies(flight).length) { pen.fillStyle = colours.faint; pen.font = "12px system-ui"; pen.fillText("No missile was launched.", ROOM.left + 12, ROOM.top + 14) }
  return plot
}

// A canvas as sharp as the screen; drawing units are those of the page.
function prepare(canvas) {
  const ratio = globalThis.devicePixelRatio || 1, [width, height] = [canvas.clientWidth, canvas.clientHeight].map((side) => Math.max(1, Math.round(side * ratio)))
  if (canvas.width !== width || canvas.height !== height) { canvas.width = width; canvas.height = height }
  // Drawn by the processor: some thousand short lines are dear on a graphics card, and dearest where software plays one.
  const pen = canvas.getContext("2d", {willReadFrequently: true})
  pen.setTransform(ratio, 0, 0, ratio, 0, 0)
  pen.clearRect(0, 0, canvas.clientWidth, canvas.clientHeight)
  return pen
}
