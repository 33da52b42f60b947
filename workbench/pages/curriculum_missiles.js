// Missiles as large pictures to click: lit while the missile is a subtask, a dashed outline when it is masked.
const BODY = "M50 4 C57 12 60 22 60 34 L60 112 L40 112 L40 34 C40 22 43 12 50 4 Z"
const FINS = "M40 44 L26 60 L40 62 Z M60 44 L74 60 L60 62 Z M40 88 L20 114 L20 122 L40 112 Z M60 88 L80 114 L80 122 L60 112 Z"
const FLAME = "M43 114 C40 128 46 132 50 150 C54 132 60 128 57 114 Z"

function picture(number) {
  return `<svg viewBox="0 0 100 152" aria-hidden="true">
    <path class="flame" d="${FLAME}"/><path class="fins" d="${FINS}"/><path class="body" d="${BODY}"/>
    <path class="band" d="M40 38 H60 M40 104 H60"/>
    <text x="50" y="80" text-anchor="middle">${number}</text></svg>`
}

export function render({model}) {
  const root = document.createElement("div")
  root.className = "row"
  root.setAttribute("role", "group")
  root.setAttribute("aria-label", "Subtasks: missiles to evade; click to mask")

  function toggle(number) {
    const masked = new Set(model.masked)
    masked.has(number) ? masked.delete(number) : masked.add(number)
    model.masked = [...masked].sort((a, b) => a - b)
    draw()
  }

  function tile(colour, number, masked) {
    const button = document.createElement("button")
    button.type = "button"
    button.className = masked ? "tile masked" : "tile"
    button.style.setProperty("--ink", colour)
    button.setAttribute("aria-pressed", String(!masked))
    button.setAttribute("aria-label", `Missile ${number}`)
    button.title = masked ? `Missile ${number} is masked; click to make it a subtask again` : `Missile ${number} is a subtask; click to mask it`
    button.innerHTML = picture(number)
    const caption = document.createElement("span")
    caption.textContent = masked ? "masked" : "subtask"
    button.append(caption)
    button.onclick = () => toggle(number)
    return button
  }

  function draw() {
    const masked = new Set(model.masked), focused = [...root.children].indexOf(root.getRootNode().activeElement)
    root.replaceChildren(...model.colours.map((colour, index) => tile(colour, index + 1, masked.has(index + 1))))
    if (focused >= 0) root.children[focused].focus()
  }

  model.on(["masked", "colours"], draw)
  draw()
  return root
}
