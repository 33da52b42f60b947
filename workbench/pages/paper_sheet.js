// Tables, points, commands and notes of the Paper page; a number that is clicked shows where it comes from.
// Everything that is shown is set as text: names of runs and errors of trainings are only data.
const VERDICTS = {"yes": "holds", "no": "does not hold", "undecided": "undecided", "–": "nothing to judge", "": "not run yet"}

function make(tag, className = "", text = "") {
  const node = document.createElement(tag)
  if (className) { node.className = className }
  if (text) { node.textContent = text }
  return node
}

async function copied(text) {
  try { await navigator.clipboard.writeText(text); return true } catch { /* not a secure address, or not allowed */ }
  const area = make("textarea")
  area.value = text
  document.body.append(area)
  area.select()
  const done = document.execCommand("copy")
  area.remove()
  return done
}

function command(label, text) {
  const row = make("div", "command")
  if (label) { row.append(make("span", "label", label)) }
  const button = make("button", "copy", "Copy")
  button.type = "button"
  button.setAttribute("aria-label", `Copy: ${text}`)
  button.onclick = async () => {
    button.textContent = await copied(text) ? "Copied" : "Select and copy"
    setTimeout(() => { button.textContent = "Copy" }, 1600)
  }
  row.append(make("code", "", text), button)
  return row
}

export function render({model}) {
  const root = make("div", "sheet")

  function part(one) {
    const open = one.refs?.length || one.section
    const node = open ? make("button", "part link") : one.href ? make("a", "part") : make("span", "part")
    node.append(make("span", one.strike ? "gone" : "", one.t))
    if (one.sub) { node.append(make("small", "", one.sub)) }
    if (one.tone) { node.classList.add(one.tone) }
    if (one.block) { node.classList.add("block") }
    if (one.ink) { node.style.setProperty("--ink", one.ink); node.classList.add("inked") }
    if (one.title) { node.title = one.title }
    if (one.href) { node.href = one.href }
    if (open) { node.type = "button" }
    if (one.section) { node.onclick = () => model.send_msg({section: one.section}) }
    if (one.refs?.length) {
      const same = () => one.refs.join() === model.chosen.join()
      node.setAttribute("aria-expanded", String(same()))
      node.onclick = () => { model.chosen = same() ? [] : [...one.refs] }
    }
    return node
  }

  function table(block) {
    const table = make("table"), head = make("tr"), body = make("tbody")
    for (const column of block.columns) {
      const cell = make("th", "", column.t)
      cell.scope = "col"
      if (column.sub) { cell.append(make("small", "", column.sub)) }
      head.append(cell)
    }
    for (const row of block.rows) {
      const line = make("tr")
      row.forEach((parts, index) => {
        const cell = make(index === 0 ? "th" : "td")
        if (index === 0) { cell.scope = "row" }
        cell.append(...parts.map(part))
        line.append(cell)
      })
      body.append(line)
    }
    const top = make("thead"), frame = make("div", "scroll")
    top.append(head)
    table.append(top, body)
    frame.append(table)
    return frame
  }

  function points(block) {
    const list = make("ul", "points")
    for (const point of block.points) {
      const row = make("li"), verdict = make("span", "verdict", VERDICTS[point.verdict] ?? point.verdict)
      verdict.dataset.verdict = point.verdict
      const says = make("div", "says")
      says.append(make("b", "", point.says), make("small", "", point.where))
      if (point.verdict) { says.append(make("div", "here", point.here)) }
      row.append(verdict, says)
      list.append(row)
    }
    return list
  }

  function details(keys) {
    const box = make("div", "details")
    box.setAttribute("role", "region")
    box.setAttribute("aria-label", "Where this number comes from")
    const head = make("div", "detail-head"), close = make("button", "copy", "Close")
    close.type = "button"
    close.onclick = () => { model.chosen = [] }
    head.append(make("b", "", keys.length > 1 ? `Behind it: ${keys.length} numbers` : "Where it comes from"), close)
    box.append(head)
    for (const key of keys) {
      const record = model.records[key]
      if (!record) { continue }
      const entry = make("div", "record"), facts = make("dl")
      entry.append(make("b", "", record.title))
      for (const [name, text] of record.facts) {
        const pair = make("div")
        pair.append(make("dt", "", name), make("dd", "", text))
        facts.append(pair)
      }
      const links = make("div", "links")
      for (const [label, href] of record.links) {
        const link = make("a", "", label)
        link.href = href
        links.append(link)
      }
      entry.append(facts, links, ...record.commands.map(([label, text]) => command(label, text)))
      box.append(entry)
    }
    return box
  }

  function downloads(block) {
    const row = make("div", "downloads")
    for (const [kind, label] of block.files) {
      const button = make("button", "download", label)
      button.type = "button"
      button.onclick = () => { button.disabled = true; model.send_msg({download: kind}) }
      row.append(button)
    }
    return row
  }

  const kinds = {
    table, points, downloads,
    heading: (block) => {
      const node = make("h3", "", block.t)
      if (block.sub) { node.append(make("small", "", block.sub)) }
      if (block.section) {
        const open = make("button", "copy open", "Open")
        open.type = "button"
        open.setAttribute("aria-label", `Open ${block.t}`)
        open.onclick = () => model.send_msg({section: block.section})
        node.append(open)
      }
      return node
    },
    text: (block) => make("p", block.tone ?? "", block.t),
    notes: (block) => {
      const list = make("ul", "notes")
      list.append(...block.notes.map((note) => make("li", "", note)))
      return list
    },
    command: (block) => command(block.label ?? "", block.t),
    tiles: (block) => {
      const row = make("div", "tiles")
      for (const tile of block.tiles) {
        const node = make("div", "tile")
        node.dataset.verdict = tile.verdict
        node.append(make("b", "", tile.t), make("span", "", tile.sub))
        row.append(node)
      }
      return row
    },
  }

  function draw() {
    const nodes = []
    let shown = false
    for (const block of model.blocks) {
      nodes.push(kinds[block.kind](block))
      if (block.kind === "table" && model.chosen.length && !shown) {
        shown = true
        nodes.push(details(model.chosen))
      }
    }
    const focused = root.getRootNode().activeElement
    const place = [...root.querySelectorAll("button, a")].indexOf(focused)
    root.replaceChildren(...nodes)
    if (place >= 0) { root.querySelectorAll("button, a")[place]?.focus({preventScroll: true}) }
  }

  function save({file}) {
    root.querySelectorAll(".download").forEach((button) => { button.disabled = false })
    if (!file) { return }
    const bytes = Uint8Array.from(atob(file.base64), (sign) => sign.charCodeAt(0))
    const link = make("a")
    link.href = URL.createObjectURL(new Blob([bytes], {type: file.type}))
    link.download = file.name
    link.click()
    setTimeout(() => URL.revokeObjectURL(link.href), 1000)
  }

  model.on(["blocks", "records"], draw)
  model.on("chosen", () => {
    draw()
    root.querySelector(".details")?.scrollIntoView({block: "nearest", behavior: "smooth"})
  })
  model.on("msg:custom", (message) => save(message.data ?? message))
  draw()
  return root
}
