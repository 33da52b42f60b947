// Title and curves of one panel. Values are the latest ones; while the pointer is over any figure, those of that moment.
function words(value, {digits, share}) {
  if (value === null || value === undefined || !Number.isFinite(value)) return "–"
  const text = (share ? 100 * value : value).toLocaleString("en", {minimumFractionDigits: digits, maximumFractionDigits: digits})
  return text.replace("-", "−") + (share ? " %" : "")
}

export function render({model}) {
  const root = document.createElement("div"), title = document.createElement("h3"), made = new Map()
  root.className = "legend"
  root.append(title)
  let hovered = null

  function draw() {
    title.textContent = model.title
    title.title = model.help
    if (made.size !== model.curves.length) {
      for (const curve of model.curves) {
        const button = document.createElement("button"), mark = document.createElement("i"), label = document.createElement("span")
        const value = document.createElement("b")
        button.type = "button"
        label.textContent = curve.label
        button.append(mark, label, value)
        button.style.setProperty("--ink", curve.ink)
        button.onclick = () => { model.asked = [curve.name, model.asked[1] + 1] }
        root.append(button)
        made.set(curve.name, {button, value})
      }
    }
    root.classList.toggle("hover", hovered !== null)
    for (const curve of model.curves) {
      const {button, value} = made.get(curve.name), shown = !model.hidden.includes(curve.name)
      const text = words((hovered ?? model.latest)[curve.name], curve)
      if (value.textContent !== text) value.textContent = text
      button.className = model.several ? "several" : ""
      button.setAttribute("aria-pressed", String(shown))
      button.title = `${curve.label}: ${curve.help}. Click to ${shown ? "hide" : "show"} it.`
    }
  }

  const hear = (event) => { hovered = event.detail; draw() }
  window.addEventListener("live-hover", hear)
  model.on("remove", () => window.removeEventListener("live-hover", hear))
  model.on(["title", "help", "curves", "latest", "several", "hidden"], draw)
  draw()
  return root
}
