// How the open run stands. Times go on by themselves between two epochs; the tab's title, a notification and a line for
// screen readers say the same to who is not looking.
const BELL = "submas-notify", KNOWN = "submas-live-known"
const LABELS = {pause: "Save everything at the end of this epoch and end the process; it can go on later, bit for bit",
  stop: "End the training at the end of this epoch; its best policy is judged and kept",
  resume: "Go on from the last checkpoint, now or when a core is free",
  kill: "End the process at once; the run can be resumed from its last checkpoint"}

function element(tag, className, parent, text) {
  const made = document.createElement(tag)
  made.className = className
  if (text !== undefined) made.textContent = text
  parent?.append(made)
  return made
}

function button(className, parent, text, title) {
  const made = element("button", className, parent, text)
  made.type = "button"
  if (title) made.title = title
  return made
}

function read(store, key) { try { return store.getItem(key) } catch { return null } }
function write(store, key, value) { try { store.setItem(key, value) } catch { /* private */ } }

function clock(seconds) {
  const whole = Math.max(0, Math.round(seconds)), two = (n) => String(n).padStart(2, "0")
  const hours = Math.floor(whole / 3600), minutes = Math.floor(whole / 60) % 60
  return hours ? `${hours}:${two(minutes)}:${two(whole % 60)}` : `${minutes}:${two(whole % 60)}`
}

function set(node, text) { if (node.textContent !== text) node.textContent = text }

export function render({model}) {
  const root = element("div", "head"), top = element("div", "row top", root), what = element("div", "what", top)
  const state = element("span", "state", what), title = element("span", "title", what), scenario = element("span", "times", what)
  const buttons = element("div", "buttons", top)
  const fly = element("a", "fly", buttons, "Fly newest policy"), acts = {}
  for (const [name, look] of [["resume", "main"], ["pause", ""], ["stop", "danger"], ["kill", "danger"]]) {
    acts[name] = button(look, buttons, "", LABELS[name])
  }
  const bell = button("bell", buttons, "Notify me")
  const progress = element("div", "progress", root), bar = element("div", "bar", progress), done = element("i", "", bar)
  const percent = element("span", "percent", progress)
  bar.setAttribute("role", "progressbar")
  bar.setAttribute("aria-label", "Progress of the whole run")
  const row = element("div", "row", root), now = element("span", "now", row), times = element("span", "times", row)
  const advice = element("p", "advice", root)
  const help = element("div", "row", root), shell = element("span", "command", help), code = element("code", "", shell)
  const copy = button("", shell, "Copy", "Copy the command; it does the same as the button")
  const log = element("details", "", root), tail = element("pre", "", log)
  log.prepend(element("summary", "", null, "The end of its log"))
  const spoken = element("span", "spoken", root)
  spoken.setAttribute("role", "status")
  spoken.setAttribute("aria-live", "polite")
  const dialog = element("dialog", "", root)
  const asks = element("h2", "", dialog, "Stop this run?")
  asks.id = "live-stop"
  dialog.setAttribute("aria-labelledby", asks.id)
  element("p", "", dialog, "It stops at the end of its epoch, and its best policy is judged and kept. It can be resumed later.")
  const answers = element("div", "row", dialog), no = button("", answers, "Let it learn on"), yes = button("sure", answers, "Stop this run")

  let facts = {}, told = 0
  // Whatever came of it, the buttons then say how the run stands.
  const ask = (wish) => { model.asked = [wish, model.asked[1] + 1]; setTimeout(draw, 5000) }
  for (const name of ["resume", "pause", "kill"]) {
    acts[name].onclick = () => { acts[name].disabled = true; ask(name) }
  }
  acts.stop.onclick = () => dialog.showModal()
  no.onclick = () => dialog.close()
  yes.onclick = () => { dialog.close(); acts.stop.disabled = true; ask("stop") }
  fly.onclick = (event) => { if (!facts.fly) event.preventDefault() }
  copy.onclick = async () => {
    try { await navigator.clipboard.writeText(facts.command); set(copy, "Copied") } catch { getSelection().selectAllChildren(code); set(copy, "Press Ctrl+C") }
    setTimeout(() => set(copy, "Copy"), 2000)
  }

  function tick() {
    if (!facts.id) return
    const since = facts.state === "running" ? (performance.now() - told) / 1000 : 0, parts = []
    if (facts.where) parts.push(facts.where)
    if (facts.worked_s || facts.state === "running") parts.push(`${clock(facts.worked_s + since)} worked`)
    if (facts.likely_s !== null) parts.push(`usually ${clock(facts.likely_s - since)} left`)
    if (facts.most_s !== null) parts.push(`at most ${clock(facts.most_s - since)} left`)
    if (facts.resumes) parts.push(`resumed ${facts.resumes === 1 ? "once" : `${facts.resumes} times`}`)
    set(times, parts.join(" · "))
  }

  function draw() {
    facts = JSON.parse(model.facts)
    root.hidden = !facts.id
    if (!facts.id) { document.title = "Live · SubMas"; return }
    told = performance.now()
    root.style.setProperty("--ink", facts.ink)
    set(state, facts.state); set(title, facts.title); set(now, facts.now)
    set(scenario, facts.scenario ? `scenario ${facts.scenario}` : "")
    const share = Math.round(100 * facts.progress)
    done.style.width = `${100 * facts.progress}%`
    bar.setAttribute("aria-valuenow", share)
    set(percent, `${share} %`)
    set(advice, facts.advice)
    advice.hidden = !facts.advice
    for (const [name, act] of Object.entries(acts)) {
      const wanted = facts.buttons[name]
      act.hidden = !wanted
      if (wanted) { set(act, wanted.label); act.disabled = Boolean(wanted.off) }
    }
    drawFly()
    help.hidden = !facts.command
    set(code, facts.command)
    log.hidden = !facts.log
    set(tail, facts.log)
    set(spoken, facts.said)
    document.title = facts.tab
    tick()
  }

  function drawFly() {
    const light = new URLSearchParams(location.search).get("theme") === "default"
    fly.setAttribute("aria-disabled", String(!facts.fly))
    facts.fly ? fly.href = facts.fly + (light ? "&theme=default" : "") : fly.removeAttribute("href")
    fly.title = facts.fly ? `Fly ${facts.newest}` : "There is no policy yet: the first one is saved after the first held-out evaluation"
  }

  // Notifications: permission is asked for when the button is pressed, never before.
  const can = "Notification" in window
  const wanted = () => can && Notification.permission === "granted" && read(localStorage, BELL) === "on"
  function drawBell() {
    const blocked = can && Notification.permission === "denied"
    bell.disabled = !can || blocked
    bell.classList.toggle("on", wanted())
    bell.setAttribute("aria-pressed", String(wanted()))
    set(bell, wanted() ? "Notifying ✓" : "Notify me")
    bell.title = blocked ? "This browser blocks notifications of this address; its settings allow them again"
      : !can ? "This browser has no notifications at this address" : "A notification of the browser when a training ends, also while the tab is in the background"
  }
  bell.onclick = async () => {
    if (wanted()) write(localStorage, BELL, "off")
    else if (await Notification.requestPermission() === "granted") write(localStorage, BELL, "on")
    drawBell()
  }

  // What was known to be alive is kept in the tab, so that an end during a reload or a sleep is told as well.
  function hear() {
    const alive = new Set(JSON.parse(read(sessionStorage, KNOWN) ?? "[]"))
    for (const run of JSON.parse(model.watched)) {
      const lives = run.state === "queued" || run.state === "running"
      if (!lives && alive.delete(run.id) && wanted()) notify(run)
      if (lives) alive.add(run.id)
    }
    write(sessionStorage, KNOWN, JSON.stringify([...alive].slice(-200)))
  }
  function notify(run) {
    // The tag keeps two tabs from saying it twice.
    const note = new Notification(run.title, {body: run.words, tag: `submas-${run.id}-${run.state}`})
    note.onclick = () => { window.focus(); note.close() }
  }

  const timer = setInterval(tick, 1000)
  model.on("remove", () => clearInterval(timer))
  model.on("facts", draw)
  model.on("watched", hear)
  drawBell(); draw(); hear()
  return root
}
