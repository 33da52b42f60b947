// A button that opens the list of formats; a file that Python has made is saved as soon as it arrives.
export function render({model}) {
  const root = document.createElement("div")
  root.className = "export"
  const open = document.createElement("button")
  open.type = "button"
  open.textContent = "Export"
  open.title = "Save these flights as a file"
  open.setAttribute("aria-haspopup", "menu")
  const menu = document.createElement("div")
  menu.className = "menu"
  menu.setAttribute("role", "menu")
  menu.hidden = true
  const told = document.createElement("p")
  told.setAttribute("role", "status")
  const bar = document.createElement("progress")
  bar.max = 1
  bar.setAttribute("aria-label", "Progress of the export")
  root.append(open, menu, bar, told)
  let count = 0

  function make(tag, parent, words = "") {
    const node = document.createElement(tag)
    node.textContent = words
    parent.append(node)
    return node
  }

  function entry(parent, choice, who, words) {
    const button = make("button", parent, words)
    button.type = "button"
    button.setAttribute("role", "menuitem")
    button.onclick = () => { show(false); count += 1; model.asked = [choice.suffix, who, count] }
    return button
  }

  function list() {
    menu.replaceChildren()
    const [last, ...first] = [...model.who].reverse()
    make("p", menu, `${first.reverse().join(", ")} and ${last} on one clock`)
    for (const choice of model.choices.filter((one) => one.all)) {
      const button = entry(menu, choice, "all", "")
      make("b", button, choice.kind)
      button.append(` ${choice.words}`)
    }
    make("p", menu, "One flight")
    for (const choice of model.choices.filter((one) => !one.all)) {
      const row = make("div", menu)
      row.className = "row"
      make("b", row, choice.kind)
      make("span", row, choice.words)
      for (const who of model.who) {
        const button = entry(row, choice, who, who)
        button.title = `${choice.words} of ${who}`
        button.setAttribute("aria-label", `${who} · ${choice.kind}: ${choice.words}`)
      }
    }
  }

  function show(on) {
    menu.hidden = !on
    open.setAttribute("aria-expanded", String(on))
    if (on) { menu.querySelector("button").focus() }
  }

  function draw() {
    open.disabled = !model.who.length || model.share >= 0
    bar.hidden = model.share < 0
    bar.value = Math.max(model.share, 0)
    told.textContent = model.busy
    told.hidden = !model.busy
  }

  function save() {
    if (!model.file?.data) { return }
    const link = document.createElement("a")
    link.href = URL.createObjectURL(new Blob([model.file.data]))
    link.download = model.file.name
    link.click()
    setTimeout(() => URL.revokeObjectURL(link.href), 1000)
  }

  const outside = (event) => { if (!event.composedPath().includes(root)) { show(false) } }
  open.onclick = () => show(menu.hidden)
  root.onkeydown = (event) => {
    if (event.key === "Escape") { show(false); open.focus() }
    const step = {ArrowDown: 1, ArrowRight: 1, ArrowUp: -1, ArrowLeft: -1}[event.key]
    if (!step || menu.hidden) { return }
    event.preventDefault()
    event.stopPropagation()
    const entries = [...menu.querySelectorAll("button")], here = entries.indexOf(event.composedPath()[0])
    entries[(here + step + entries.length) % entries.length].focus()
  }
  document.addEventListener("pointerdown", outside)
  model.on(["busy", "share", "who"], draw)
  model.on("who", list)
  model.on("file", save)
  model.on("remove", () => document.removeEventListener("pointerdown", outside))
  list()
  draw()
  return root
}
