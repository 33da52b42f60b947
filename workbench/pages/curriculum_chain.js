// The stages of a chain. A stage is dragged, or moved with the arrow keys; what it says is then told by Python.
const STEPS = {ArrowLeft: -1, ArrowUp: -1, ArrowRight: 1, ArrowDown: 1, Home: -99, End: 99}

function element(tag, className, text) {
  const made = document.createElement(tag)
  made.className = className
  if (text !== undefined) made.textContent = text
  return made
}

export function render({model}) {
  const root = element("div", "chain"), list = element("ol", ""), foot = element("div", "foot")
  const note = element("span", "note"), spoken = element("span", "spoken")
  const reset = element("button", "reset", "Back to Table 1's order")
  reset.type = "button"
  reset.onclick = () => send([...order()].sort((a, b) => a - b))
  spoken.setAttribute("aria-live", "polite")
  foot.append(note, reset)
  root.append(list, foot, spoken)
  let dragged = null, moved = false, started = null, focus = 0

  const order = () => [...list.querySelectorAll("li[data-missile]")].map(item => Number(item.dataset.missile))
  const send = met => { if (met.join() !== model.met.join()) model.met = met }

  function content(stage, index, count) {
    const top = element("span", "top"), chips = element("span", "chips")
    top.append(element("span", "", count > 1 ? `stage ${index + 1}` : "one stage"))
    if (model.movable) top.append(element("span", "grip", "⠿"))
    for (const missile of stage.known) {
      const chip = element("span", missile === stage.missile && count > 1 ? "chip new" : "chip", missile)
      chip.style.setProperty("--ink", stage.colours[missile])
      chips.append(chip)
    }
    return [top, chips, element("div", "title", stage.title), element("div", "guide", `guide: ${stage.guide}`)]
  }

  function card(stage, index, count) {
    const item = element("li", ""), box = element(model.movable ? "button" : "div", "stage")
    item.dataset.missile = stage.missile
    box.append(...content(stage, index, count))
    if (model.movable) {
      box.type = "button"
      box.title = "Drag to meet this missile earlier or later; or press the arrow keys"
      box.setAttribute("aria-label", `Stage ${index + 1} of ${count}: ${stage.title}, missile ${stage.missile} is new, ` +
        `guide: ${stage.guide}. Arrow keys move it.`)
      box.onkeydown = event => key(event, stage.missile)
      box.onpointerdown = event => { if (event.button === 0) begin(event, item) }
    }
    item.append(box)
    return item
  }

  function key(event, missile) {
    const step = STEPS[event.key]
    if (!step || event.ctrlKey || event.metaKey || event.altKey) return
    event.preventDefault()
    const met = order(), from = met.indexOf(missile)
    const to = Math.min(Math.max(from + step, 0), met.length - 1)
    met.splice(to, 0, ...met.splice(from, 1))
    focus = missile
    spoken.textContent = `Missile ${missile} is met in stage ${to + 1} of ${met.length}`
    send(met)
  }

  // The window is listened to, not the stage: moving an element in the document takes the pointer from it.
  function begin(event, item) {
    if (dragged) return
    dragged = item, moved = false, started = [event.clientX, event.clientY]
    const stop = keep => () => {
      removeEventListener("pointermove", drag)
      removeEventListener("pointerup", up)
      removeEventListener("pointercancel", cancel)
      end(keep)
    }
    const up = stop(true), cancel = stop(false)
    addEventListener("pointermove", drag)
    addEventListener("pointerup", up)
    addEventListener("pointercancel", cancel)
  }

  function drag(event) {
    if (!moved && Math.hypot(event.clientX - started[0], event.clientY - started[1]) < 5) return
    moved = true
    dragged.classList.add("dragging")
    const items = [...list.querySelectorAll("li[data-missile]")]
    const over = items.find(item => {
      const box = item.getBoundingClientRect()
      return item !== dragged && event.clientX > box.left && event.clientX < box.right
        && event.clientY > box.top && event.clientY < box.bottom
    })
    if (over) over[items.indexOf(over) > items.indexOf(dragged) ? "after" : "before"](dragged)
  }

  function end(keep) {
    dragged.classList.remove("dragging")
    focus = Number(dragged.dataset.missile)
    dragged = null
    if (moved && keep) send(order())
    else if (moved) draw()
  }

  function draw() {
    if (dragged) return
    const focused = focus || Number(root.getRootNode().activeElement?.parentElement?.dataset?.missile || 0)
    const count = model.stages.length
    root.className = model.movable ? "chain movable" : "chain"
    list.setAttribute("aria-label", model.movable ? "Stages in the order they are trained" : "The stage that is trained")
    list.replaceChildren(...model.stages.map((stage, index) => card(stage, index, count)))
    note.textContent = model.note
    reset.hidden = model.usual || !model.movable
    if (focused && model.movable) list.querySelector(`li[data-missile="${focused}"] button`)?.focus({preventScroll: true})
    focus = 0
  }

  model.on(["stages", "movable", "note", "usual"], draw)
  draw()
  return root
}
