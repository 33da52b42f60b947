// A grid of thousands of runs: only the lines in view exist, and Python sends them as one scrolls. Every text is a text node.
const LINE = 34, AHEAD = 8
const PIN = "<svg viewBox='0 0 24 24' width='14' height='14'><path fill='currentColor' d='M15 3 21 9 19.5 10.5 18.6 10.2 14.5 14.3 14.8 17.6 13.4 19 9.2 14.8 4.4 19.6 4 20 4.4 19.2 8.5 14 5 10.6 6.4 9.2 9.7 9.5 13.8 5.4 13.5 4.5z'/></svg>"
let serial = 0

function make(tag, name, parent, attributes = {}, text = "") {
  const node = document.createElement(tag)
  if (name) { node.className = name }
  for (const [key, value] of Object.entries(attributes)) { node.setAttribute(key, value) }
  if (text) { node.textContent = text }
  parent?.append(node)
  return node
}

// Every run of a group as a dot, the interval as a bar, the mean as a stroke.
function strip(line, parent) {
  const box = make("span", "strip", parent, {"aria-hidden": "true"})
  const at = (share) => `${100 * share}%`
  if (line.low !== null && line.high !== null) {
    const bar = make("i", "interval", box)
    bar.style.left = at(line.low)
    bar.style.width = at(Math.max(line.high - line.low, 0.004))
  }
  if (line.base !== null) { make("i", "base", box).style.left = at(line.base) }
  for (const dot of line.dots) { make("i", "dot", box).style.left = at(dot) }
  if (line.value !== null) { make("i", "mean", box).style.left = at(line.value) }
}

const CELLS = {
  state(cell, line) {
    cell.classList.add(`is-${line.state}`)
    make("span", "sign", cell, {"aria-hidden": "true"}, line.sign)
    cell.append(` ${line.state}`)
    if (line.error) { cell.title = line.error }
    if (line.state === "running" && line.progress !== undefined) { cell.style.setProperty("--share", `${100 * line.progress}%`) }
  },
  name(cell, line) {
    if (line.kind === "pinned" || line.pinned) {
      make("span", "pin", cell, {title: "The pinned baseline", role: "img", "aria-label": "Pinned baseline"}).innerHTML = PIN
    }
    make("span", "words", cell, {}, line.name)
    if (line.note) { make("span", "note", cell, {title: line.note, role: "img", "aria-label": "Has a note"}, "✎") }
    cell.title = line.name
  },
  success(cell, line) {
    if (line.value !== null && line.value !== undefined) { cell.style.setProperty("--share", `${100 * line.value}%`) }
    make("span", "figure", cell, {}, line.success ?? "")
    if (line.gap) { make("span", `gap ${line.gap.startsWith("+") ? "over" : "under"}`, cell, {title: "Percentage points over the dragging expert on the same task"}, line.gap) }
  },
  tags(cell, line) { for (const tag of line.tags ?? []) { make("span", "tag", cell, {}, tag) } },
}

export function render({model}) {
  const root = make("div", "table", null, {role: "grid", "aria-label": "Runs", tabindex: "0"})
  const id = `runs-${++serial}`
  const head = make("div", "head row", root, {role: "row"})
  const top = make("div", "top", root, {role: "rowgroup"})
  const view = make("div", "view", root, {role: "presentation"})
  const sheet = make("div", "sheet", view, {role: "rowgroup"})
  const nothing = make("div", "nothing", view)
  const every = JSON.parse(model.columns)
  let lines = [], columns = [], shape = "", drawing = 0, waiting = 0
  const ask = (what, key) => { model.asked = [what, key, model.asked[2] + 1] }

  function chooseColumns() {
    const width = root.clientWidth || 1200
    columns = every.filter((column) => !column.least || width >= column.least)
    const wanted = columns.map((c) => c.grow ? `minmax(${c.width}px, ${c.grow}fr)` : `${c.width}px`).join(" ")
    if (wanted === shape) { return }
    shape = wanted
    root.style.setProperty("--columns", `34px ${shape}`)
    drawHead()
  }

  function drawHead() {
    head.replaceChildren()
    make("span", "cell", head, {role: "columnheader", title: "Tick runs to see their curves"}).append(make("span", "hidden", null, {}, "Curve"))
    for (const column of columns) {
      const cell = make("span", `cell${column.right ? " right" : ""}`, head, {role: "columnheader"})
      const falling = model.sort === `-${column.sort}`, rising = model.sort === column.sort
      cell.setAttribute("aria-sort", falling ? "descending" : rising ? "ascending" : "none")
      if (!column.sort) { cell.textContent = column.title; continue }
      const button = make("button", falling || rising ? "on" : "", cell, {type: "button", title: `${column.help ? `${column.help}. ` : ""}Click to sort`}, column.title)
      make("i", "arrow", button, {"aria-hidden": "true"}, falling ? "▼" : rising ? "▲" : "")
      // Figures are wanted largest first, words in their order.
      const starts = ["success", "return", "steps", "time", "started"].includes(column.sort)
      button.onclick = () => { model.sort = falling ? column.sort : rising ? `-${column.sort}` : starts ? `-${column.sort}` : column.sort; drawHead() }
    }
  }

  function tick(row, line) {
    const cell = make("span", "cell tick", row, {role: "gridcell"})
    if (line.kind === "pinned" && line.key.startsWith("expert")) { return }
    const words = line.slot >= 0 ? "Hide the curve of" : "Show the curve of"
    const box = make("button", line.slot >= 0 ? "box on" : "box", cell, {type: "button", tabindex: "-1", role: "checkbox",
      "aria-checked": String(line.slot >= 0), "aria-label": `Curve of ${line.name ?? line.label}`, title: `${words} ${line.name ?? line.label}`})
    if (line.slot >= 0) { box.style.setProperty("--ink", model.inks[line.slot] ?? "currentColor") }
    box.onclick = (event) => { event.stopPropagation(); ask("tick", line.key) }
  }

  function rowOf(line, number) {
    const row = make("div", `row ${line.kind}${line.problem ? " bad" : ""}`, null, {role: "row", id: `${id}-${number}`, "aria-rowindex": String(number + 2)})
    tick(row, line)
    if (line.kind === "group") { return groupRow(row, line) }
    if (line.key === model.focused) { row.classList.add("focused"); row.setAttribute("aria-selected", "true") }
    for (const column of columns) {
      if (line.problem && !["state", "name"].includes(column.name)) { continue }
      const cell = make("span", `cell ${column.name}${column.right ? " right" : ""}`, row, {role: "gridcell"})
      const fill = CELLS[column.name]
      fill ? fill(cell, line) : cell.append(line[column.name] ?? "")
    }
    if (line.problem) { make("span", "cell problem", row, {role: "gridcell", title: line.problem}, line.problem) }
    if (!line.key.startsWith("expert")) { row.onclick = () => { model.focused = line.key } }
    return row
  }

  function groupRow(row, line) {
    const cell = make("span", "cell wide", row, {role: "gridcell"})
    const fold = make("button", "fold", cell, {type: "button", tabindex: "-1", "aria-expanded": String(line.open), title: line.open ? "Hide its runs" : "List its runs"})
    make("i", "", fold, {"aria-hidden": "true"}, line.open ? "▾" : "▸")
    make("span", "label", fold, {}, line.label)
    make("span", "many", cell, {}, `${line.count} run${line.count === 1 ? "" : "s"}`)
    strip(line, cell)
    make("span", "figure", cell, {title: "Interquartile mean of the best held-out success rates, and its 95 % bootstrap interval"}, line.success)
    row.onclick = () => ask("fold", line.label)
    return row
  }

  function draw() {
    drawing = 0
    chooseColumns()
    lines = JSON.parse(model.lines)
    const pinned = JSON.parse(model.pinned)
    top.replaceChildren(...(pinned ? [rowOf(pinned, -1)] : []))
    sheet.style.height = `${model.total * LINE}px`
    sheet.replaceChildren(...lines.map((line, index) => {
      const row = rowOf(line, model.offset + index)
      row.style.top = `${(model.offset + index) * LINE}px`
      return row
    }))
    nothing.textContent = model.total ? "" : model.empty
    nothing.hidden = model.total > 0
    root.setAttribute("aria-rowcount", String(model.total + 1))
    const at = lines.findIndex((line) => line.key === model.focused)
    at < 0 ? root.removeAttribute("aria-activedescendant") : root.setAttribute("aria-activedescendant", `${id}-${model.offset + at}`)
    scrolled()
  }
  const later = () => { drawing ||= requestAnimationFrame(draw) }

  function scrolled() {
    const first = Math.floor(view.scrollTop / LINE), last = Math.min(first + Math.ceil(view.clientHeight / LINE), model.total)
    const held = [model.offset + (model.offset ? AHEAD : 0), model.offset + lines.length - (model.offset + lines.length < model.total ? AHEAD : 0)]
    if (first >= held[0] && last <= held[1]) { return }
    clearTimeout(waiting)
    waiting = setTimeout(() => { model.first = first }, 40)
  }

  function move(by) {
    const runs = lines.filter((line) => line.kind === "run")
    const at = runs.findIndex((line) => line.key === model.focused)
    const next = runs[at < 0 ? 0 : Math.min(Math.max(at + by, 0), runs.length - 1)]
    if (!next) { return }
    model.focused = next.key
    const place = (model.offset + lines.indexOf(next)) * LINE
    if (place < view.scrollTop) { view.scrollTop = place }
    if (place + LINE > view.scrollTop + view.clientHeight) { view.scrollTop = place + LINE - view.clientHeight }
  }

  root.onkeydown = (event) => {
    if (event.target !== root) { return }
    const steps = {ArrowDown: 1, ArrowUp: -1, PageDown: 10, PageUp: -10}
    if (event.key in steps) { event.preventDefault(); move(steps[event.key]) }
    if (event.key === " " && model.focused) { event.preventDefault(); ask("tick", model.focused) }
  }
  view.onscroll = scrolled
  const watch = new ResizeObserver(() => { const before = shape; chooseColumns(); before === shape ? scrolled() : later() })
  watch.observe(root)
  model.on("remove", () => watch.disconnect())
  model.on("sort", () => { view.scrollTop = 0; drawHead() })
  model.on(["lines", "offset", "total", "pinned", "focused", "inks", "empty"], later)
  chooseColumns()
  later()
  return root
}
