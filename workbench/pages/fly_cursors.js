// The clock over the figures: a line over every curve over time, and a dot wherever a curve or a track is just then.
// Bokeh would redraw a whole figure to move a line in it; elements of our own above its canvas cost nothing.
const LOOK_MS = 600

function make(parent, style) {
  const node = document.createElement("i")
  node.setAttribute("aria-hidden", "true")
  Object.assign(node.style, {position: "absolute", left: "0", top: "0", pointerEvents: "none", willChange: "transform", ...style})
  parent.append(node)
  return node
}

// Index of the last sample at or before a time, in ascending times with at least one sample.
function before(times, time) {
  let low = 0, high = times.length - 1
  while (low < high) {
    const middle = (low + high + 1) >> 1
    if (times[middle] <= time) { low = middle } else { high = middle - 1 }
  }
  return low
}

function between(values, times, index, time) {
  const one = values[index], other = values[Math.min(index + 1, values.length - 1)]
  const span = times[Math.min(index + 1, times.length - 1)] - times[index]
  if (!Number.isFinite(other) || span <= 0) { return one }
  return one + (other - one) * Math.min(Math.max((time - times[index]) / span, 0), 1)
}

function lines(plot) {
  const drawn = plot.model.renderers.filter((one) => one.glyph?.type === "Line" && one.data_source.data.time_s !== undefined)
  return drawn.map((renderer) => ({renderer, dot: null}))
}

export function render({model}) {
  const root = document.createElement("div")
  let time = 0, found = [], looked = -1e9

  function forget({line, curves}) {
    line.remove()
    for (const {dot} of curves) { dot?.remove() }
  }

  function look(stamp) {
    if (stamp - looked < LOOK_MS) { return }
    looked = stamp
    const wanted = (view) => view.frame && view.canvas_view?.overlays_el && view.model.tags?.includes?.(model.tag)
    const present = new Set(globalThis.Bokeh?.index.query(wanted) ?? [])
    const lost = found.filter((one) => !present.has(one.plot) || !one.line.isConnected)
    for (const one of lost) { forget(one) }
    found = found.filter((one) => !lost.includes(one))
    const known = new Set(found.map((one) => one.plot))
    for (const plot of present) {
      if (known.has(plot)) { continue }
      const line = make(plot.canvas_view.overlays_el, {width: "1.5px", background: "#7d8794", display: "none"})
      found.push({plot, line, curves: lines(plot)})
    }
  }

  function drawDot(plot, curve) {
    const {renderer} = curve, {data} = renderer.data_source, {bbox, x_scale, y_scale} = plot.frame
    let shown = renderer.visible && data.time_s.length > 0
    if (shown) {
      const x = data[renderer.glyph.x.field], y = data[renderer.glyph.y.field], index = before(data.time_s, time)
      const place = [x_scale.compute(between(x, data.time_s, index, time)), y_scale.compute(between(y, data.time_s, index, time))]
      shown = time >= data.time_s[0] - 1e-6 && time <= data.time_s[data.time_s.length - 1] + 1e-6 && place.every(Number.isFinite)
        && place[0] >= bbox.left && place[0] <= bbox.right && place[1] >= bbox.top && place[1] <= bbox.bottom
      if (shown) {
        curve.dot ??= make(plot.canvas_view.overlays_el, {width: "9px", height: "9px", margin: "-4.5px", borderRadius: "50%",
          boxShadow: "0 0 0 1.5px var(--panel-background-color, #fff)"})
        curve.dot.style.background = renderer.glyph.line_color.value
        curve.dot.style.transform = `translate(${place[0]}px, ${place[1]}px)`
      }
    }
    if (curve.dot) { curve.dot.style.display = shown ? "" : "none" }
  }

  function draw() {
    look(performance.now())
    for (const {plot, line, curves} of found) {
      const {bbox, x_scale} = plot.frame, x = x_scale.compute(time)
      const overTime = plot.model.tags.includes("over-time")
      const shown = overTime && bbox.width > 0 && x >= bbox.left - 1 && x <= bbox.right + 1
      line.style.display = shown ? "" : "none"
      if (shown) { Object.assign(line.style, {height: `${bbox.height}px`, transform: `translate(${x - 0.75}px, ${bbox.top}px)`}) }
      for (const curve of curves) { drawDot(plot, curve) }
    }
  }

  const onTime = (event) => { time = event.detail.time; draw() }
  window.addEventListener("flight-time", onTime)
  // Figures that were zoomed, hidden by their legend or drawn just now.
  const keep = setInterval(() => { if (root.isConnected) { draw() } }, 250)
  model.on("remove", () => {
    clearInterval(keep)
    window.removeEventListener("flight-time", onTime)
    for (const one of found) { forget(one) }
  })
  return root
}
