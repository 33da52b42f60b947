// A number that counts when it is entered: by Enter, by leaving the field, by − and +, by arrow and page keys.
const PAGE = 10

export function render({model}) {
  const frame = document.createElement("fieldset"), legend = document.createElement("legend"), input = document.createElement("input")
  input.type = "number"
  input.step = "1"
  input.inputMode = "numeric"

  function enter(number) {
    if (Number.isFinite(number)) { model.value = Math.min(Math.max(Math.round(number), model.start), model.end) }
    draw()
  }

  function stepper(sign, by, verb) {
    const button = document.createElement("button")
    button.type = "button"
    button.tabIndex = -1  // the arrow keys do the same from the field itself
    button.textContent = sign
    button.onclick = () => enter(model.value + by)
    return {button, draw: () => {
      button.setAttribute("aria-label", `${verb}: ${model.label}`)
      button.disabled = by < 0 ? model.value <= model.start : model.value >= model.end
    }}
  }
  const steppers = [stepper("−", -1, "One less"), stepper("+", 1, "One more")]

  function draw() {
    legend.textContent = model.label
    input.setAttribute("aria-label", model.label)
    frame.title = model.words
    input.min = model.start
    input.max = model.end
    input.value = model.value
    steppers.forEach((one) => one.draw())
  }

  input.onchange = () => enter(input.value === "" ? NaN : Number(input.value))
  input.onkeydown = (event) => {
    const by = {PageUp: PAGE, PageDown: -PAGE, ArrowUp: 1, ArrowDown: -1}[event.key]
    if (by) { event.preventDefault(); enter(model.value + by) }
  }
  for (const name of ["value", "start", "end", "label", "words"]) { model.on(name, draw) }
  frame.append(legend, steppers[0].button, input, steppers[1].button)
  draw()
  return frame
}
