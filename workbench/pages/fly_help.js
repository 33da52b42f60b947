// Keyboard shortcuts and legend in one dialog; the browser keeps the focus inside it and closes it on Esc.
const INK = "stroke='currentColor' fill='none' stroke-width='2'"
const SHAPES = {
  craft: "<path fill='currentColor' d='M22 9 13 7 6 1h-3l3 6-4-1v6l4-1-3 6h3l7-6z'/>",
  dot: "<circle cx='12' cy='9' r='5' fill='currentColor'/>",
  ring: `<circle cx='12' cy='9' r='4.5' ${INK}/>`,
  cross: `<path ${INK} d='M7 4l10 10M17 4 7 14'/>`,
  thick: "<path stroke='currentColor' stroke-width='4' stroke-linecap='round' d='M3 9h18'/>",
  drop: `<path ${INK} stroke-width='1.3' d='M12 1v16M7 17h10'/>`,
  thin: `<path ${INK} stroke-width='1.5' d='M2 14 22 4'/>`,
  dashes: `<path ${INK} stroke-dasharray='4 3' d='M1 9h22'/>`,
  bar: "<rect x='2' y='6' width='20' height='6' rx='3' fill='currentColor' opacity='.25'/><rect x='2' y='6' width='13' height='6' rx='3' fill='currentColor'/>",
  gate: `<path ${INK} d='M6 17V2h12v15M6 7h12M6 12h12'/>`,
  ticks: `<path ${INK} stroke-width='3' d='M7 1v5M16 12v5'/><path ${INK} opacity='.4' d='M1 9h22'/>`,
  shade: "<rect x='3' y='2' width='18' height='14' fill='currentColor' opacity='.35'/>",
  arrows: "<path fill='currentColor' d='M3 5h8l-4 8zM13 13h8l-4-8z'/>",
}

function make(tag, name, parent, words = "") {
  const node = document.createElement(tag)
  if (name) { node.className = name }
  node.textContent = words
  parent.append(node)
  return node
}

function fill(sheet, model) {
  const head = make("header", "", sheet)
  make("h2", "", head, "Keys and symbols")
  const close = make("button", "close", head, "✕")
  close.type = "button"
  close.setAttribute("aria-label", "Close")
  close.onclick = () => sheet.close()
  const columns = make("div", "columns", sheet)
  const keys = make("dl", "keys", columns)
  for (const [names, words] of model.keys) {
    const term = make("dt", "", keys)
    for (const name of names.split(" ")) { make("kbd", "", term, name) }
    make("dd", "", keys, words)
  }
  const symbols = make("ul", "symbols", columns)
  for (const [shape, colour, words] of model.symbols) {
    const row = make("li", "", symbols)
    const picture = make("span", "picture", row)
    picture.style.color = colour
    picture.innerHTML = `<svg viewBox='0 0 24 18' width='24' height='18' aria-hidden='true'>${SHAPES[shape]}</svg>`
    make("span", "", row, words)
  }
}

export function render({model}) {
  const root = document.createElement("div")
  const button = make("button", "open", root, "?")
  button.type = "button"
  button.title = "Keys and symbols (?)"
  button.setAttribute("aria-label", "Keys and symbols")
  const sheet = make("dialog", "sheet", root)
  sheet.setAttribute("aria-label", "Keys and symbols")
  fill(sheet, model)
  const toggle = () => { if (sheet.open) { sheet.close() } else { sheet.showModal() } }
  button.onclick = toggle
  sheet.onclick = (event) => { if (event.target === sheet) { sheet.close() } }
  function onKey(event) {
    const busy = event.composedPath()[0]
    if (busy instanceof Element && busy.closest("input:not([type=range]), textarea, select, [role=combobox], [contenteditable]")) { return }
    if (event.key === "?") { event.preventDefault(); toggle() }
  }
  document.addEventListener("keydown", onKey)
  model.on("remove", () => document.removeEventListener("keydown", onKey))
  return root
}
