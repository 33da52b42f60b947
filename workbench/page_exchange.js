// A link to another page of the workbench exchanges what is in the document instead of loading a new one: Bokeh, Panel
// and Material UI, four megabytes of script, start once per tab and not once per page. The server knows nothing of it:
// the page comes as ever, and its part that embeds it is done here. Whatever is unusual is left to the browser.
{
  const PAGE = /^\/[a-z]*$/, ITEMS = /const render_items = (\[.*\]);/
  const {ClientConnection, pull_session} = Bokeh.require("client/connection")
  const connections = new Set(), connect = ClientConnection.prototype.connect
  let here = location.pathname, asked = null

  ClientConnection.prototype.connect = function () {
    connections.add(this)
    return connect.call(this)
  }

  // Bokeh's figures listen for pinches, Panel's description of the browser for another preference of colours, and they
  // never cease to, which would keep each of them for ever.
  const listeners = []
  for (const target of [visualViewport, MediaQueryList.prototype]) {
    const listen = target.addEventListener
    target.addEventListener = function (...listener) {
      listeners.push([this, listener])
      listen.apply(this, listener)
    }
  }

  const style = document.createElement("style")
  style.textContent = `html.exchanging, html.exchanging * { cursor: progress !important }
    #page-told { position: fixed; top: 0; width: 1px; height: 1px; margin: 0; overflow: hidden; clip-path: inset(50%) }`
  document.head.append(style)

  // A browser says the title of a page that it loads to those who listen; here it is said by the page.
  const told = Object.assign(document.createElement("p"), {id: "page-told", ariaLive: "polite"})
  addEventListener("DOMContentLoaded", () => document.body.append(told))

  // A page that is still being built would go on building in the middle of the next one.
  const settled = () => Bokeh.documents.length === 1 && Bokeh.documents[0].is_idle

  const parts = (page) => [...page.querySelectorAll("head script[src], head link[rel=stylesheet]")].map(
    (part) => part.getAttribute("src") ?? part.getAttribute("href"))

  async function ask(url, signal) {
    const answer = await fetch(url, {signal, headers: {Accept: "text/html"}})
    if (!answer.ok) throw new Error(`status ${answer.status}`)
    const words = await answer.text(), items = ITEMS.exec(words)
    if (items === null) throw new Error("no page of Bokeh's")
    const page = new DOMParser().parseFromString(words, "text/html"), loaded = new Set(parts(document))
    if (!parts(page).every((part) => loaded.has(part))) throw new Error("other scripts or colours")
    return {page, items: JSON.parse(items[1]), address: answer.url + url.hash}
  }

  function leave() {
    for (const connection of connections) connection.close()
    connections.clear()
    for (const left of Bokeh.documents.splice(0)) left.clear({sync: false})
    for (const [target, listener] of listeners.splice(0)) target.removeEventListener(...listener)
  }

  // What Bokeh.embed.embed_items does, but for its list of sessions, in which a page that was left would stay for ever.
  async function arrive({page, items: [item]}) {
    const [roots, old] = [page, document].map((of) => [...of.querySelectorAll("body > [data-root-id]")])
    old[0].before(...roots.map((root) => document.importNode(root)))
    for (const root of old) root.remove()
    document.title = page.title
    const socket = `${location.origin.replace("http", "ws")}${location.pathname}/ws`
    const session = await pull_session(socket, item.token, location.search.slice(1))
    const places = Object.values(item.roots).map((id) => document.getElementById(id))
    await Bokeh.embed.add_document_standalone(session.document, document.body, places)
    told.textContent = page.title
  }

  async function exchange(url, isNew) {
    if (!settled()) throw new Error("not settled")
    asked?.abort()
    const mine = asked = new AbortController()
    document.documentElement.classList.add("exchanging")
    try {
      const next = await ask(url, mine.signal)
      leave()
      // Not history.pushState: pages put their own in its place.
      if (isNew) History.prototype.pushState.call(history, {}, "", next.address)
      here = location.pathname
      document.documentElement.dataset.opened = next.address
      await arrive(next)
      if (isNew) scrollTo(0, 0)
    } finally {
      if (asked === mine) document.documentElement.classList.remove("exchanging")
    }
  }

  const unlessNewer = (otherwise) => (error) => { if (error.name !== "AbortError") otherwise() }

  document.addEventListener("click", (event) => {
    const link = event.composedPath().find((part) => part.localName === "a" && part.href)
    if (!link || event.defaultPrevented || event.button !== 0 || link.target || link.hasAttribute("download")) return
    if (event.ctrlKey || event.metaKey || event.shiftKey || event.altKey) return
    const url = new URL(link.href)
    if (url.origin !== location.origin || !PAGE.test(url.pathname)) return
    if (url.hash && url.pathname === location.pathname && url.search === location.search) return
    event.preventDefault()
    exchange(url, true).catch(unlessNewer(() => location.href === url.href ? location.reload() : location.assign(url)))
  })

  // Before the listeners of the pages, which take every step for one of their own.
  window.addEventListener("popstate", (event) => {
    if (location.pathname === here) return
    event.stopImmediatePropagation()
    exchange(new URL(location.href), false).catch(unlessNewer(() => location.reload()))
  }, true)
}
