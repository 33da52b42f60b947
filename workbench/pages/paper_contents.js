// Contents of the Paper page: one entry per table and figure, with how it stands; arrows of the browser go back and forth.
export function render({model}) {
  const root = document.createElement("nav")
  root.setAttribute("aria-label", "Tables and figures")

  function draw() {
    const focused = [...root.children].indexOf(root.getRootNode().activeElement)
    root.replaceChildren(...model.items.map((item) => {
      const entry = document.createElement("button")
      entry.type = "button"
      entry.dataset.state = item.state
      entry.title = item.hint
      if (item.name === model.section) { entry.setAttribute("aria-current", "page") }
      for (const [name, text] of [["dot", ""], ["title", item.title], ["sub", item.sub]]) {
        const node = document.createElement("span")
        node.className = name
        node.textContent = text
        entry.append(node)
      }
      entry.onclick = () => { model.section = item.name }
      return entry
    }))
    if (focused >= 0) { root.children[focused].focus() }
  }

  // Panel hears nothing of the browser's back and forward. The page's idea of its address is set right in silence,
  // or it would push the address that was just left as a new one.
  function tell(values) {
    for (const document of window.Bokeh.documents) {
      for (const each of document.all_models) {
        if (each.type === "panel.models.location.Location") { each.setv(values, {silent: true}) }
      }
    }
  }

  function went() {
    tell({search: window.location.search})
    model.address = window.location.search
  }

  // #table4 is a short way to write ?section=table4, and becomes that.
  function hash() {
    const name = window.location.hash.slice(1)
    if (!model.items.some((item) => item.name === name)) { return }
    window.history.replaceState({}, "", window.location.pathname + window.location.search)
    tell({hash: ""})
    model.section = name
  }

  window.addEventListener("popstate", went)
  window.addEventListener("hashchange", hash)
  model.on("remove", () => { window.removeEventListener("popstate", went); window.removeEventListener("hashchange", hash) })
  model.on("section", draw)
  model.on("items", () => { draw(); hash() })
  draw()
  return root
}
