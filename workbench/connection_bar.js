// Says what became of the server when the page has lost it, and opens the page anew once the server answers.

const LOOK_MS = 2000
const AGAIN_MS = 20_000  // a page that is lost again at once is not opened anew for ever
const LAST = "connection-bar-reload"
const WORDS = {
  cut: "The connection to the workbench was cut. Trying again …",
  stopped: "No answer: the workbench was stopped or cannot be reached. Trainings go on. " +
    "Start it again (workbench serve) and open the address it prints.",
  restarted: "The workbench was started again, with a new token. Open the address it printed.",
  stale: "This page was cut off and is no longer current. Reload it: what you see is in its address.",
}
const CSS = `
  #connection-bar { position: fixed; z-index: 10000; top: 0; left: 0; right: 0; display: flex; gap: 16px;
    align-items: center; justify-content: center; padding: 12px 20px; background: #7a1f1f; color: #ffffff;
    font: 500 15px/1.4 system-ui, sans-serif; box-shadow: 0 2px 12px #0008 }
  #connection-bar[hidden] { display: none }
  #connection-bar button { font: inherit; color: inherit; background: #ffffff22; border: 1px solid #ffffffaa;
    border-radius: 4px; padding: 4px 12px; cursor: pointer; white-space: nowrap }
  [id^="reconnect-notification"] { display: none !important }`  // Panel's own words for it

function makeBar() {
  document.getElementById("connection-bar")?.remove()  // of the page that was here before
  const bar = document.createElement("div")
  bar.id = "connection-bar"
  bar.setAttribute("role", "alert")
  bar.hidden = true
  const words = document.createElement("span")
  const button = document.createElement("button")
  button.type = "button"
  button.textContent = "Reload"
  button.onclick = () => location.reload()
  const style = document.createElement("style")
  style.textContent = CSS
  bar.append(style, words, button)
  document.body.append(bar)
  return (state) => {
    bar.hidden = state === ""
    bar.dataset.state = state
    words.textContent = WORDS[state] ?? ""
    button.hidden = state !== "stale"
  }
}

async function answer() {
  try {
    return (await fetch("/healthz", {cache: "no-store"})).status
  } catch {
    return 0
  }
}

function follow(bokeh) {
  const show = makeBar()
  let looking = null
  const look = async () => {
    const status = await answer()
    if (looking === null) return
    if (status === 401) return show("restarted")
    if (status !== 200) return show("stopped")
    if (Date.now() - Number(sessionStorage.getItem(LAST)) < AGAIN_MS) return show("stale")
    sessionStorage.setItem(LAST, String(Date.now()))
    location.reload()
  }
  bokeh.on_event("connection_lost", () => {
    if (looking !== null) return
    show("cut")
    looking = setInterval(look, LOOK_MS)
  })
  bokeh.on_event("client_reconnected", () => {
    clearInterval(looking)
    looking = null
    show("")
  })
}

const followed = new WeakSet()

export function render({view}) {
  // A page that comes back draws everything again, in the same document.
  if (followed.has(view.model.document)) return
  followed.add(view.model.document)
  follow(view.model.document)
}
