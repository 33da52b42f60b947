// The tour: a card beside what it speaks of. It walks over pages, so where it stands is kept in this tab's session;
// that it was seen once is kept in the browser. It never takes the page away: everything under it can be used.
const SEEN = "submas-tour-seen", PLACE = "submas-tour", PATIENCE_MS = 8000, LOOK_MS = 250, GAP = 14

function read(store, key) { try { return store.getItem(key) } catch { return null } }
function write(store, key, value) { try { value === null ? store.removeItem(key) : store.setItem(key, value) } catch { /* private */ } }

function element(tag, className, text) {
  const made = document.createElement(tag)
  made.className = className
  if (text !== undefined) made.textContent = text
  return made
}

// The first visible element that a selector finds, also inside the shadows that components live in.
function find(selector, root = document) {
  for (const hit of root.querySelectorAll(selector)) if (hit.getClientRects().length) return hit
  for (const host of root.querySelectorAll("*")) {
    const hit = host.shadowRoot && find(selector, host.shadowRoot)
    if (hit) return hit
  }
  return null
}

// As a person would: pages are exchanged without loading everything anew.
function follow(address) {
  const link = element("a")
  link.href = address
  document.body.append(link)
  link.click()
  link.remove()
}

// Only who comes to the first page as it is: an address with a query shows what somebody meant to be seen.
function firstVisit(model) {
  const asked = document.documentElement.dataset.opened ?? performance.getEntriesByType("navigation")[0]?.name
  const opened = new URL(asked ?? location.href)
  return !read(localStorage, SEEN) && !navigator.webdriver && model.here === model.stops.find(stop => stop.page)?.page && !opened.search
}

export function render({model}) {
  const root = element("div", ""), start = element("button", "start"), ring = element("div", "ring"), note = element("div", "note")
  start.type = "button"
  start.dataset.tour = "button"
  start.title = "A minute's walk through the pages"
  start.setAttribute("aria-label", "Take the tour")
  start.append(element("span", "long", "Take the tour"), element("span", "short", "Tour"))
  const head = element("h2", ""), text = element("p", ""), row = element("div", "row"), count = element("span", "count")
  const buttons = {skip: "Skip", back: "Back", next: "Next"}
  for (const name in buttons) {
    const label = buttons[name]
    buttons[name] = element("button", name, label)
    buttons[name].type = "button"
  }
  head.id = "tour-head", text.id = "tour-text"
  row.append(count, buttons.skip, buttons.back, buttons.next)
  note.append(head, text, row)
  note.setAttribute("role", "dialog")
  note.setAttribute("aria-labelledby", head.id)
  note.setAttribute("aria-describedby", text.id)
  for (const layer of [ring, note]) layer.setAttribute("popover", "manual")
  root.append(start, ring, note)
  let at = -1, anchor = null, timer = 0, since = 0

  function go(index) {
    if (index < 0 || index >= model.stops.length) return end(index > 0)
    const stop = model.stops[index]
    write(sessionStorage, PLACE, JSON.stringify({index, origin: origin()}))
    if (!isHere(stop)) return leave(`/${stop.page}`)
    show(index)
  }

  function isHere(stop) { return stop !== undefined && (!stop.page || stop.page === model.here) }
  function saved() { try { return JSON.parse(read(sessionStorage, PLACE)) } catch { return null } }
  function origin() { return saved()?.origin ?? location.pathname + location.search }

  function leave(address) {
    const light = new URLSearchParams(location.search).get("theme") === "default"
    follow(light && !address.includes("?") ? `${address}?theme=default` : address)
  }

  function show(index) {
    const stop = model.stops[index], last = index === model.stops.length - 1
    at = index, anchor = null, since = performance.now()
    head.textContent = stop.head
    text.textContent = stop.text
    count.textContent = `${index + 1} of ${model.stops.length}`
    buttons.back.hidden = index === 0
    buttons.skip.hidden = last
    buttons.next.textContent = last ? "Done" : index === 0 ? "Start" : "Next"
    write(localStorage, SEEN, "1")
    if (!note.matches(":popover-open")) note.showPopover()
    clearInterval(timer)
    timer = setInterval(look, LOOK_MS)
    look()
    buttons.next.focus({preventScroll: true})
  }

  // Pages fill as they load: what the card speaks of may come later, move, or be replaced.
  function look() {
    if (!root.isConnected) return clearInterval(timer)
    const before = anchor
    if (!anchor?.isConnected || !anchor.getClientRects().length) {
      const stop = model.stops[at], given = stop.anchors.map(selector => find(selector)).find(Boolean)
      const waited = performance.now() - since > PATIENCE_MS
      anchor = given ?? (waited || !stop.anchors.length ? find(`a[href^="/${stop.page}"]`) : null)
    }
    if (anchor && anchor !== before) anchor.scrollIntoView({block: "nearest"})
    place()
  }

  function place() {
    const wide = innerWidth, high = innerHeight, card = note.getBoundingClientRect()
    if (!anchor) {
      if (ring.matches(":popover-open")) ring.hidePopover()
      return put((wide - card.width) / 2, (high - card.height) / 2)
    }
    const found = anchor.getBoundingClientRect()
    const box = {left: Math.max(found.left, 6), top: Math.max(found.top, 6), right: Math.min(found.right, wide - 6), bottom: Math.min(found.bottom, high - 6)}
    Object.assign(ring.style, {left: `${box.left - 3}px`, top: `${box.top - 3}px`, width: `${box.right - box.left + 6}px`, height: `${box.bottom - box.top + 6}px`})
    if (!ring.matches(":popover-open")) { ring.showPopover(); note.hidePopover(); note.showPopover(); buttons.next.focus({preventScroll: true}) }
    const left = Math.min(Math.max(box.left, 16), wide - card.width - 16)
    if (box.bottom + GAP + card.height < high) return put(left, box.bottom + GAP)
    if (box.top - GAP - card.height > 0) return put(left, box.top - GAP - card.height)
    if (box.right + GAP + card.width < wide) return put(box.right + GAP, Math.max(box.top, 16))
    if (box.left - GAP - card.width > 0) return put(box.left - GAP - card.width, Math.max(box.top, 16))
    put(wide - card.width - 24, high - card.height - 24)
  }

  function put(left, top) { Object.assign(note.style, {left: `${left}px`, top: `${top}px`}) }

  function end(done) {
    const from = origin(), elsewhere = new URL(from, location.href).pathname !== location.pathname
    clearInterval(timer)
    at = -1
    write(sessionStorage, PLACE, null)
    for (const layer of [ring, note]) if (layer.matches(":popover-open")) layer.hidePopover()
    if (done && elsewhere) return follow(from)
    start.focus({preventScroll: true})
  }

  start.onclick = () => go(0)
  buttons.skip.onclick = () => end(false)
  buttons.back.onclick = () => go(at - 1)
  buttons.next.onclick = () => go(at + 1)
  note.onkeydown = event => {
    const step = {ArrowRight: 1, ArrowLeft: -1}[event.key]
    if (event.key === "Escape") end(false)
    else if (step && at + step >= 0) go(at + step)
    else if (event.key === "Tab" || event.key === "Enter" || event.key === " ") return event.stopPropagation()
    event.stopPropagation()
  }
  const onKey = event => { if (at >= 0 && event.key === "Escape") end(false) }
  const onResize = () => { if (at >= 0) place() }
  addEventListener("keydown", onKey)
  addEventListener("resize", onResize)
  model.on("remove", () => {
    clearInterval(timer)
    removeEventListener("keydown", onKey)
    removeEventListener("resize", onResize)
  })

  const stood = saved()
  const begin = () => {
    if (!root.isConnected) return setTimeout(begin, 50)
    if (stood && isHere(model.stops[stood.index])) show(stood.index)
    else if (stood) write(sessionStorage, PLACE, null)
    else if (firstVisit(model)) go(0)
  }
  begin()
  return root
}
