// Panel writes each change of the address with pushState. What is no step of its own takes the place of the present one;
// so does what a page fills in as it opens, where its address said nothing.
export function render({model}) {
  const push = history.pushState
  let opening = model.fills
  const chosen = (search) => {
    const query = new URLSearchParams(search)
    return model.names.map((name) => query.get(name) ?? "")
  }

  history.pushState = function (state, title, url) {
    const next = new URL(url, location.href), [before, after] = [chosen(location.search), chosen(next.search)]
    const chose = before.some((value, i) => value !== after[i] && !(opening && value === ""))
    const step = next.pathname !== location.pathname || chose
    opening = false
    return (step ? push : history.replaceState).call(history, state, title, url)
  }

  const arrive = () => location.reload()
  window.addEventListener("popstate", arrive)
  model.on("remove", () => {
    history.pushState = push
    window.removeEventListener("popstate", arrive)
  })
  return document.createElement("span")
}
