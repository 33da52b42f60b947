// The list of what happened in both flights; a click moves the page's clock, and the clock dims what is still to come.
const text = (seconds) => `${Math.floor(seconds / 60)}:${String(Math.floor(seconds % 60)).padStart(2, "0")}`

export function render({model}) {
  const root = document.createElement("div")
  root.className = "events"
  root.setAttribute("role", "group")
  root.setAttribute("aria-label", "Events of both flights")
  const list = document.createElement("div")  // has columns where there is room; what scrolls must have none
  list.className = "list"
  root.append(list)
  let rows = [], now = 0, shown

  // scrollIntoView would scroll the page as well.
  function reveal(node) {
    const [box, place] = [root.getBoundingClientRect(), node.getBoundingClientRect()]
    if (place.top < box.top) { root.scrollTop -= box.top - place.top }
    if (place.bottom > box.bottom) { root.scrollTop += place.bottom - box.bottom }
  }

  function highlight() {
    let latest = null
    for (const row of rows) {
      const past = row.time <= now + 1e-6
      row.node.classList.toggle("future", !past)
      row.node.classList.remove("latest")
      if (past) { latest = row }
    }
    latest?.node.classList.add("latest")
    if (latest && latest.node !== shown) { reveal(latest.node) }
    shown = latest?.node
  }

  function draw() {
    list.replaceChildren()
    rows = model.events.map((event) => {
      const node = document.createElement("button")
      node.type = "button"
      node.title = "Move the clock here"
      const cells = [["when", text(event.time)], ["who", event.who], ["dot", ""], ["what", event.text]]
      for (const [name, words] of cells) {
        const cell = document.createElement("span")
        cell.className = name
        cell.textContent = words
        node.append(cell)
      }
      node.querySelector(".who").style.background = event.who_colour
      node.querySelector(".dot").style.background = event.colour
      node.classList.add(event.kind)
      node.onclick = () => window.dispatchEvent(new CustomEvent("flight-clock", {detail: event.time}))
      list.append(node)
      return {time: event.time, node}
    })
    highlight()
  }

  const onTime = (event) => { now = event.detail.time; highlight() }
  window.addEventListener("flight-time", onTime)
  model.on("events", draw)
  model.on("remove", () => window.removeEventListener("flight-time", onTime))
  draw()
  return root
}
