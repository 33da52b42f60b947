// How the curves are looked at, and the line under the pointer over all of them. Bokeh would redraw a figure to move a
// line in it; elements of our own above its canvas cost nothing.
const LOOK_MS = 700
let serial = 0

function make(tag, name, parent, attributes = {}, text = "") {
  const node = document.createElement(tag)
  node.className = name
  for (const [key, value] of Object.entries(attributes)) node.setAttribute(key, value)
  if (text) node.textContent = text
  parent?.append(node)
  return node
}

// Index of the value nearest to x in ascending values.
function nearest(values, x) {
  let low = 0, high = values.length - 1
  while (low < high) {
    const middle = (low + high) >> 1
    if (values[middle] < x) low = middle + 1; else high = middle
  }
  return low > 0 && x - values[low - 1] < values[low] - x ? low - 1 : low
}

export function render({model}) {
  const root = make("div", "view"), id = ++serial
  const over = make("span", "part", root, {}, "Over"), axes = make("span", "axes", over, {role: "radiogroup", "aria-label": "Horizontal axis"})
  for (const [value, words] of Object.entries(model.axes)) {
    const label = make("label", "", axes, {title: `Draw all curves over ${words}`}, words)
    const box = make("input", "", null, {type: "radio", name: `live-x-${id}`, value, "aria-label": words})
    label.prepend(box)
    box.onchange = () => { model.x = value }
  }
  const smooth = make("label", "part", root, {title: "Exponential mean: how much the past weighs. What was measured stays behind it, faint."}, "Smooth")
  const slider = make("input", "", smooth, {type: "range", min: 0, max: 99, step: 1, "aria-label": "Smoothing in percent"}), value = make("span", "value", smooth)
  slider.oninput = () => { value.textContent = `${slider.value} %` }
  slider.onchange = () => { model.smooth = Number(slider.value) }
  const choose = make("button", "", root, {type: "button", "aria-haspopup": "true", title: "Which figures are shown"}, "Panels ▾")
  const list = make("div", "list", root, {popover: "auto", id: `live-panels-${id}`, role: "group", "aria-label": "Panels"})
  choose.popoverTargetElement = list
  list.addEventListener("toggle", () => {
    const box = choose.getBoundingClientRect()
    list.style.left = `${Math.max(4, Math.min(box.left, innerWidth - list.offsetWidth - 8))}px`
    list.style.top = `${Math.max(4, Math.min(box.bottom + 4, innerHeight - list.offsetHeight - 8))}px`
  })
  const boxes = model.panels.map(([key, title, help]) => {
    const line = make("label", "option", list), box = make("input", "", line, {type: "checkbox", value: key, "aria-label": title})
    const words = make("span", "", line, {}, title)
    make("small", "", words, {}, help)
    box.onchange = () => {
      const without = boxes.filter((each) => !each.checked).map((each) => each.value)
      if (without.length === boxes.length) { box.checked = true; return }
      model.without = without
    }
    return box
  })
  const under = make("span", "under", root)
  const hint = "Point at a curve: all panels show that moment"

  function draw() {
    for (const box of axes.querySelectorAll("input")) box.checked = box.value === model.x
    if (!root.getRootNode().activeElement || root.getRootNode().activeElement !== slider) slider.value = model.smooth
    value.textContent = `${slider.value} %`
    for (const box of boxes) box.checked = !model.without.includes(box.value)
    choose.textContent = model.without.length ? `Panels: ${boxes.length - model.without.length} of ${boxes.length} ▾` : "Panels ▾"
    under.textContent = hint
  }

  // The line under the pointer.
  let found = [], looked = -1e9, frame = 0
  function look(now) {
    if (now - looked < LOOK_MS) return
    looked = now
    const wanted = (view) => view.frame && view.canvas_view?.overlays_el && view.model.tags?.includes?.(model.tag)
    const present = new Set(globalThis.Bokeh?.index.query(wanted) ?? [])
    for (const one of found.filter((each) => !present.has(each.plot))) one.line.remove()
    found = found.filter((each) => present.has(each.plot))
    const known = new Set(found.map((each) => each.plot))
    for (const plot of present) if (!known.has(plot)) found.push({plot, line: lineOf(plot)})
  }

  function lineOf(plot) {
    const line = make("i", "", plot.canvas_view.overlays_el, {"aria-hidden": "true"})
    Object.assign(line.style, {position: "absolute", left: "0", top: "0", width: "1px", background: "#7d8794", display: "none", pointerEvents: "none"})
    const canvas = plot.canvas_view.el
    canvas.addEventListener("pointermove", (event) => {
      const place = event.clientX - canvas.getBoundingClientRect().left, box = plot.frame.bbox
      point(place < box.left || place > box.right ? null : plot.frame.x_scale.invert(place), plot)
    })
    canvas.addEventListener("pointerleave", () => point(null, plot))
    return line
  }

  function point(x, plot) {
    cancelAnimationFrame(frame)
    frame = requestAnimationFrame(() => show(x, plot))
  }

  function show(x, plot) {
    look(performance.now())
    const told = x === null ? null : valuesAt(x)
    for (const {plot: each, line} of found) {
      const box = each.frame.bbox, place = told ? each.frame.x_scale.compute(told.x) : NaN
      const visible = place >= box.left && place <= box.right
      line.style.display = visible ? "" : "none"
      if (visible) Object.assign(line.style, {height: `${box.height}px`, transform: `translate(${place}px, ${box.top}px)`})
    }
    const label = plot.model.below?.[0]?.axis_label ?? ""
    under.textContent = told ? `${Number(told.x.toPrecision(5))} ${label}${told.task ? ` · ${told.task}` : ""}` : hint
    window.dispatchEvent(new CustomEvent("live-hover", {detail: told?.values ?? null}))
  }

  // Values of the first run at its epoch nearest to x, by name of the curve.
  function valuesAt(x) {
    const values = {}
    let at = null, task = ""
    for (const {plot} of found) {
      for (const {glyph, name, data_source: source} of plot.model.renderers) {
        const xs = source.data.x
        if (glyph?.type === "VSpan" && xs?.length) {
          for (let i = 0; i < xs.length && xs[i] <= x; i++) task = source.data.task[i]
        }
        if (glyph?.type !== "Line" || !name || name in values || !xs?.length) continue
        const index = nearest(xs, x)
        values[name] = source.data[name][index]
        if (at === null || Math.abs(xs[index] - x) < Math.abs(at - x)) at = xs[index]
      }
    }
    return at === null ? null : {x: at, task, values}
  }

  const arrive = () => { model.visited = [location.search, model.visited[1] + 1] }
  const timer = setInterval(() => look(performance.now()), LOOK_MS)
  window.addEventListener("popstate", arrive)
  model.on("remove", () => { window.removeEventListener("popstate", arrive); clearInterval(timer) })
  model.on(["x", "smooth", "without"], draw)
  draw()
  return root
}
