// Runs under way and runs that ended, one line each. Lines are kept from one look to the next: the focus stays.
const NAMES = {alive: "Under way", ended: "Ended"}

function element(tag, className, parent, text) {
  const made = document.createElement(tag)
  made.className = className
  if (text !== undefined) made.textContent = text
  parent?.append(made)
  return made
}

function set(node, text) { if (node.textContent !== text) node.textContent = text }

export function render({model}) {
  const root = element("nav", ""), lists = {}, made = new Map()
  root.setAttribute("aria-label", "Trainings")
  for (const name of ["alive", "ended"]) {
    const head = element("h2", "", root), list = element("ul", "", root)
    head.textContent = NAMES[name]
    list.setAttribute("aria-label", NAMES[name])
    lists[name] = {head, list, count: element("small", "", head)}
  }
  const none = element("p", "", root, "No run yet.")
  const foot = element("div", "foot", root)
  const seeds = element("button", "more", foot, "All its seeds"), alone = element("button", "more", foot, "It alone")
  seeds.type = alone.type = "button"
  seeds.title = "Lay over it the curves of the runs that differ in nothing but the seed"
  alone.title = "Draw the curves of the opened run alone"
  const all = element("a", "", foot, "All runs")
  all.title = "Every run, to search, group and compare"
  const ask = (what, id = "") => { model.asked = [what, id, model.asked[2] + 1] }
  seeds.onclick = () => ask("seeds")
  alone.onclick = () => ask("alone")

  function make(id) {
    const item = element("li", ""), run = element("button", "run", item), parts = {item, run}
    run.type = "button"
    parts.dot = element("span", "dot", run)
    parts.name = element("span", "name", run)
    parts.words = element("span", "words", run)
    parts.detail = element("span", "detail", run)
    parts.bar = element("span", "bar", run)
    parts.share = element("i", "", parts.bar)
    parts.state = element("span", "spoken", run)
    const beside = element("label", "beside", item)
    parts.beside = beside, parts.box = element("input", "", beside), parts.mark = element("i", "", beside)
    parts.box.type = "checkbox"
    run.onclick = () => ask("open", id)
    parts.box.onchange = () => ask("beside", id)
    run.onkeydown = walk
    return parts
  }

  function walk(event) {
    const step = {ArrowDown: 1, ArrowUp: -1}[event.key]
    if (!step || event.ctrlKey || event.metaKey || event.altKey) return
    const runs = [...root.querySelectorAll(".run")], next = runs[runs.indexOf(event.currentTarget) + step]
    if (next) { event.preventDefault(); next.focus() }
  }

  function fill(parts, line) {
    parts.item.className = line.open ? "open" : ""
    line.open ? parts.run.setAttribute("aria-current", "true") : parts.run.removeAttribute("aria-current")
    parts.item.style.setProperty("--ink", line.ink)
    line.curve ? parts.item.style.setProperty("--curve", line.curve) : parts.item.style.removeProperty("--curve")
    parts.dot.className = `dot ${line.state}`
    parts.run.title = `${line.title} · ${line.detail}: ${line.state}`
    set(parts.name, line.title); set(parts.words, line.words); set(parts.detail, line.detail); set(parts.state, `, ${line.state}`)
    parts.bar.hidden = !line.alive
    parts.share.style.width = `${100 * line.share}%`
    parts.box.hidden = line.open
    parts.box.checked = line.beside
    parts.mark.hidden = !(line.open && line.curve)
    parts.beside.title = line.open ? "Its curves are drawn" : "Lay its curves over those of the opened run"
    parts.box.setAttribute("aria-label", `Curves of ${line.title}, ${line.detail}`)
  }

  let seen = ""
  function draw() {
    const lines = JSON.parse(model.lines), wanted = new Set(lines.map((line) => line.id))
    for (const [id, parts] of made) if (!wanted.has(id)) { parts.item.remove(); made.delete(id) }
    const places = {alive: 0, ended: 0}
    for (const line of lines) {
      if (!made.has(line.id)) made.set(line.id, make(line.id))
      const parts = made.get(line.id), name = line.alive ? "alive" : "ended", list = lists[name].list
      if (list.children[places[name]] !== parts.item) list.insertBefore(parts.item, list.children[places[name]] ?? null)
      places[name] += 1
      fill(parts, line)
    }
    for (const [name, {head, list, count}] of Object.entries(lists)) {
      head.hidden = list.hidden = !places[name]
      set(count, String(places[name]))
    }
    const open = lines.find((line) => line.open)?.id
    if (open && open !== seen) made.get(open).item.scrollIntoView({block: "nearest"})
    seen = open
    seeds.hidden = !open
    alone.hidden = !lines.some((line) => line.beside)
    all.href = "/runs" + (new URLSearchParams(location.search).get("theme") === "default" ? "?theme=default" : "")
    all.hidden = !lines.length
    none.hidden = lines.length > 0
  }
  model.on("lines", draw)
  draw()
  return root
}
