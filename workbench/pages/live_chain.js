// The stages of a training. A card is made once and then only told what has changed, so that its bars glide.
const SIGNS = {done: "✓", spent: "■", now: "▶", halted: "‖", waiting: "…"}

function element(tag, className, parent, text) {
  const made = document.createElement(tag)
  made.className = className
  if (text !== undefined) made.textContent = text
  parent?.append(made)
  return made
}

function make(list) {
  const item = element("li", "", list), parts = {item}
  const top = element("div", "top", item)
  parts.place = element("span", "", top)
  parts.sign = element("span", "sign", top)
  const line = element("div", "line", item)
  parts.title = element("span", "title", line)
  parts.chips = element("span", "chips", line)
  parts.chips.title = "The missiles of this task; masked ones are struck out, the new one has a ring"
  parts.guide = element("div", "guide", item)
  const best = element("div", "best", item)
  best.title = "Best success of the stage in held-out evaluation: without noise and guide, on fresh initial states"
  parts.best = element("span", "", best)
  element("small", "", best, " best held-out")
  const bar = element("div", "bar", item)
  bar.setAttribute("role", "progressbar")
  parts.bar = bar, parts.share = element("i", "", bar)
  const times = element("div", "line small", item)
  parts.epochs = element("span", "", times)
  parts.time = element("span", "time", times)
  parts.rule = element("div", "small", item)
  parts.rule.title = "When the stage is passed: held-out evaluations of one policy, each on fresh initial states, or all its epochs"
  times.title = "A stage takes at most this long; it ends as soon as it is passed"
  parts.gauge = element("div", "gauge", item)
  const scale = element("span", "scale", parts.gauge)
  parts.scale = scale, parts.value = element("i", "", scale), parts.threshold = element("b", "", scale)
  parts.pips = element("span", "pips", parts.gauge)
  parts.now = element("div", "small", item)
  return parts
}

function chips(parts, missiles) {
  parts.chips.replaceChildren(...missiles.map(({number, ink, masked, new: fresh}) => {
    const chip = element("span", `chip${masked ? " masked" : ""}${fresh ? " new" : ""}`, null, number)
    chip.style.setProperty("--chip", ink)
    return chip
  }))
  const flown = missiles.filter(each => !each.masked).map(each => each.number)
  parts.chips.setAttribute("role", "img")
  parts.chips.setAttribute("aria-label", `missile${flown.length === 1 ? "" : "s"} ${flown.join(", ")} of ${missiles.length}`)
}

function gauge(parts, card) {
  parts.gauge.hidden = card.threshold === null
  parts.gauge.style.display = card.threshold === null ? "none" : ""
  if (card.threshold === null) return
  parts.scale.title = `Success of the latest policy; the line is the ${Math.round(1000 * card.threshold) / 10} % it needs`
  parts.value.style.width = `${100 * (card.value ?? 0)}%`
  parts.threshold.style.left = `${100 * card.threshold}%`
  parts.pips.title = `Evaluations the latest policy has passed, of ${card.of}`
  parts.pips.replaceChildren(...Array.from({length: card.of}, (_, n) => element("i", n < card.least ? "on" : "", null)))
}

function fill(parts, card) {
  parts.item.className = card.kind
  card.kind === "now" ? parts.item.setAttribute("aria-current", "step") : parts.item.removeAttribute("aria-current")
  for (const name of ["place", "title", "guide", "best", "epochs", "time", "rule", "now"]) {
    if (parts[name].textContent !== card[name]) parts[name].textContent = card[name]
  }
  parts.sign.textContent = `${SIGNS[card.kind]} ${card.word}`
  parts.share.style.width = `${100 * card.share}%`
  parts.bar.setAttribute("aria-valuenow", Math.round(100 * card.share))
  parts.bar.setAttribute("aria-label", `Progress of ${card.title}`)
  parts.now.style.display = card.now ? "" : "none"
  chips(parts, card.missiles)
  gauge(parts, card)
}

export function render({model}) {
  const list = element("ol", "")
  list.setAttribute("aria-label", "Stages in the order they are trained")
  let made = []
  function draw() {
    const cards = JSON.parse(model.cards)
    if (cards.length !== made.length) {
      list.replaceChildren()
      made = cards.map(() => make(list))
    }
    cards.forEach((card, number) => fill(made[number], card))
  }
  model.on("cards", draw)
  draw()
  return list
}
