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

  for (const choice of model.choices) {
    const entry = document.createElement("button")
    entry.type = "button"
    entry.setAttribute("role", "menuitem")
    const kind = document.createElement("b")
    kind.textContent = choice.kind
    entry.append(kind, ` ${choice.words}`)
    entry.onclick = () => { show(false); count += 1; model.asked = [choice.suffix, choice.who, count] }
    menu.append(entry)
  }

  function show(on) {
    menu.hidden = !on
    open.setAttribute("aria-expanded", String(on))
    if (on) { menu.querySelector("button").focus() }
  }

  function draw() {
    open.disabled = !model.ready || model.share >= 0
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
    const step = {ArrowDown: 1, ArrowUp: -1}[event.key]
    if (!step || menu.hidden) { return }
    event.preventDefault()
    event.stopPropagation()
    const entries = [...menu.children], here = entries.indexOf(event.composedPath()[0])
    entries[(here + step + entries.length) % entries.length].focus()
  }
  document.addEventListener("pointerdown", outside)
  model.on(["busy", "share", "ready"], draw)
  model.on("file", save)
  model.on("remove", () => document.removeEventListener("pointerdown", outside))
  draw()
  return root
}
