// Search, facets and groups. Facets open as lists of boxes to tick in the browser's top layer, where nothing covers them.
let serial = 0

function make(tag, name, parent, attributes = {}, text = "") {
  const node = document.createElement(tag)
  node.className = name
  for (const [key, value] of Object.entries(attributes)) { node.setAttribute(key, value) }
  if (text) { node.textContent = text }
  parent?.append(node)
  return node
}

export function render({model}) {
  const root = make("div", "bar")
  const search = make("input", "search", root, {
    type: "search", placeholder: "Search runs: name, note, tag, id, variant …", "aria-label": "Search runs", spellcheck: "false",
    title: "All words must occur somewhere in a run. A minus before a word: it must not."})
  search.value = model.text
  const facets = make("div", "facets", root)
  const groupBox = make("label", "group", root, {title: "Put runs together; each group shows its success over seeds"}, "Group by ")
  const group = make("select", "", groupBox, {"aria-label": "Group runs by"})
  const clear = make("button", "quiet", root, {type: "button", title: "Show all runs again"}, "Clear filters")
  const counted = make("span", "counted", root, {role: "status"})
  const actions = make("span", "actions", root)
  const trash = make("button", "quiet trash", root, {type: "button"})

  search.oninput = () => { model.text = search.value }
  group.onchange = () => { model.group = group.value }
  clear.onclick = () => { search.value = ""; model.text = ""; model.chosen = {}; draw() }
  trash.onclick = () => { model.trash = !model.trash; draw() }
  const ask = (what) => { model.asked = [what, model.asked[1] + 1] }

  function choose(name, value, on) {
    const values = new Set(model.chosen[name] ?? [])
    on ? values.add(value) : values.delete(value)
    model.chosen = {...model.chosen, [name]: [...values]}
    label(name)
  }

  const buttons = new Map(), lists = new Map()
  let offered = []
  function label(name) {
    const facet = offered.find((each) => each.name === name), number = (model.chosen[name] ?? []).length
    const button = buttons.get(name)
    button.textContent = number ? `${facet.title}: ${number === 1 ? model.chosen[name][0] : number}` : facet.title
    button.classList.toggle("on", number > 0)
    button.title = `Show only runs with one of the ticked values of: ${facet.title}`
    clear.hidden = !model.text && !Object.values(model.chosen).some((values) => values.length)
  }

  function facetOf(name) {
    if (buttons.has(name)) { return lists.get(name) }
    const id = `facet-${name}-${++serial}`
    const button = make("button", "facet", facets, {type: "button", "aria-haspopup": "true", popovertarget: id})
    const list = make("div", "list", facets, {id, popover: "auto", role: "group"})
    button.popoverTargetElement = list
    list.addEventListener("toggle", () => {
      const box = button.getBoundingClientRect()
      list.style.left = `${Math.max(4, Math.min(box.left, window.innerWidth - list.offsetWidth - 8))}px`
      list.style.top = `${box.bottom + 4}px`
    })
    buttons.set(name, button)
    lists.set(name, list)
    return list
  }

  function drawFacet(facet) {
    const list = facetOf(facet.name), ticked = new Set(model.chosen[facet.name] ?? [])
    list.setAttribute("aria-label", facet.title)
    const focused = list.getRootNode().activeElement?.value
    list.replaceChildren(...facet.options.map(([value, count]) => {
      const line = make("label", "option")
      const box = make("input", "", line, {type: "checkbox", value})
      box.checked = ticked.has(value)
      box.onchange = () => choose(facet.name, value, box.checked)
      make("span", "value", line, {}, value)
      make("span", "count", line, {}, String(count))
      return line
    }))
    if (!facet.options.length) { make("p", "nothing", list, {}, facet.name === "tag" ? "No run has a tag yet: click a run and write some." : "No run yet.") }
    if (focused !== undefined && list.matches(":popover-open")) { [...list.querySelectorAll("input")].find((box) => box.value === focused)?.focus() }
    label(facet.name)
  }

  function drawActions() {
    actions.replaceChildren()
    if (!model.ticked) { return }
    make("span", "ticked", actions, {}, `${model.ticked} ticked`)
    const offers = model.trash ? [["Restore ticked", "restore"]] : [["Tag …", "tag"], ["Delete …", "delete"]]
    for (const [words, what] of [...offers, ["Untick", "untick"]]) {
      make("button", "quiet", actions, {type: "button"}, words).onclick = () => ask(what)
    }
  }

  function draw() {
    offered = JSON.parse(model.facets)
    offered.forEach(drawFacet)
    if (group.options.length !== Object.keys(model.groups).length) {
      group.replaceChildren(...Object.entries(model.groups).map(([value, words]) => make("option", "", null, {value}, words)))
    }
    group.value = model.group
    counted.textContent = model.counted
    trash.textContent = model.trash ? "← Back to the runs" : "Trash"
    trash.title = model.trash ? "Leave the trash" : "Deleted runs: look at them, bring them back"
    trash.setAttribute("aria-pressed", String(model.trash))
    drawActions()
  }

  const arrive = () => { model.visited = [window.location.search, model.visited[1] + 1] }
  window.addEventListener("popstate", arrive)
  model.on("remove", () => window.removeEventListener("popstate", arrive))
  model.on("text", () => { if (search.getRootNode().activeElement !== search) { search.value = model.text } ; draw() })
  model.on(["facets", "chosen", "group", "trash", "counted", "ticked"], draw)
  draw()
  return root
}
