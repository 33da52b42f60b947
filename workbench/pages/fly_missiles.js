// A mask as chips. Every click sends the whole list of masked missiles.
export function render({model}) {
  const root = document.createElement("div")
  root.className = "box"
  const label = document.createElement("span")
  label.className = "label"
  const chips = document.createElement("div")
  chips.className = "chips"
  chips.setAttribute("role", "group")
  chips.setAttribute("aria-label", "Missiles that fly; click to mask")
  root.append(label, chips)

  function draw() {
    const masked = new Set(model.masked)
    label.textContent = masked.size ? `Missiles (${masked.size} masked)` : "Missiles (click to mask)"
    chips.replaceChildren(...model.colours.map((colour, index) => {
      const number = index + 1, chip = document.createElement("button")
      chip.type = "button"
      chip.textContent = number
      chip.title = masked.has(number) ? `Missile ${number} is masked: it is never launched` : `Missile ${number} flies; click to mask it`
      chip.classList.toggle("masked", masked.has(number))
      chip.setAttribute("aria-pressed", String(!masked.has(number)))
      chip.setAttribute("aria-label", `Missile ${number}`)
      chip.style.setProperty("--ink", colour)
      chip.onclick = () => {
        masked.has(number) ? masked.delete(number) : masked.add(number)
        model.masked = [...masked].sort((a, b) => a - b)
        draw()
      }
      return chip
    }))
  }

  model.on(["masked", "colours"], draw)
  draw()
  return root
}
