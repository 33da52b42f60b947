// The 3-D replay in its frame. viser's own control panel and notices are hidden: the page has the controls.
const HIDE = `
  [data-floating-window], [data-dock-region], [data-dock-bar], .mantine-Notifications-root, .mantine-Affix-root { display: none !important }`
const CAMERAS = [["overview", "Overview", "All of both battlefields"], ["top", "Top", "Straight down"],
  ["chase-a", "Chase A", "Behind evader A"], ["chase-b", "Chase B", "Behind evader B"]]
const BRANCH = ["chase-branch", "Chase branch", "Behind the evader of the branch"]
const FREE = ["free", "Free", "Stay here; drag turns, the wheel zooms, the right button moves"]
const DRAWN = [["readouts", "Read-outs", "Speed, load, range, closure, azimuth and energy over the picture"],
  ["labels", "Labels", "Names of bodies, and miss distances when a missile has passed"],
  ["trails", "Trails", "Whole paths, and the last 75 s of them"],
  ["sight", "Sight", "Lines from the evader to every missile in flight"],
  ["beams", "±90°", "Beam lines at ±90° off the evader's nose, where defensive dragging holds the closest missile"],
  ["energy", "Energy", "Trails of missiles by the energy they have left: bright is much, dull is little"]]
const PATIENCE_MS = 500
const PASSED_ON = new Set([" ", "?", "c", ",", ".", "[", "]"])

function isDark() {
  const colour = getComputedStyle(document.documentElement).getPropertyValue("--panel-background-color").trim()
  const probe = document.createElement("i")
  probe.style.color = colour
  document.body.append(probe)
  const [red, green, blue] = getComputedStyle(probe).color.match(/[\d.]+/g)?.map(Number) ?? [0, 0, 0]
  probe.remove()
  return red + green + blue < 384
}

function hasWebgl() {
  try { return document.createElement("canvas").getContext("webgl2") !== null } catch { return false }
}

export function render({model}) {
  const root = document.createElement("div")
  root.className = "view"
  const cover = document.createElement("div")
  cover.className = "cover"
  cover.textContent = "Opening the 3-D replay …"
  if (!hasWebgl()) {
    cover.textContent = "This browser offers no WebGL 2, so the 3-D replay cannot be drawn. The map and the curves below work without it."
    cover.classList.add("problem")
    root.append(cover)
    return root
  }
  const frame = document.createElement("iframe")
  frame.title = "3-D replay of both flights"
  if (model.address) { frame.src = model.address }
  model.on("address", () => { frame.src = model.address })
  const bar = document.createElement("div")
  bar.className = "bar"
  bar.setAttribute("role", "group")
  bar.setAttribute("aria-label", "Camera")
  const left = document.createElement("div")
  left.className = "bar left"
  left.setAttribute("role", "group")
  left.setAttribute("aria-label", "What is drawn")
  const bars = document.createElement("div")
  bars.className = "bars"
  bars.append(left, bar)
  const told = document.createElement("p")
  told.className = "told"
  told.setAttribute("role", "status")
  root.append(frame, cover, bars, told)

  function hide() {
    const page = frame.contentDocument
    if (!page?.head) { return }
    let style = page.getElementById("workbench-style")
    if (!style) {
      style = page.createElement("style")
      style.id = "workbench-style"
      page.head.append(style)
      hold(page)
    }
    const rules = `${HIDE} body, #root div[style*="background-color"] { background: ${model.ground || "transparent"} !important }`
    if (style.textContent !== rules) { style.textContent = rules }
  }

  // The second frame from now begins when the first has been painted; a hidden page draws none.
  function tellWhenPainted() {
    const due = model.due
    let told = false
    const tell = () => { if (!told && due > model.painted) { told = true; model.painted = due } }
    requestAnimationFrame(() => requestAnimationFrame(tell))
    setTimeout(tell, PATIENCE_MS)
  }

  function choose(name) { model.camera = name; model.look += 1; drawBar() }

  // Whoever takes hold of the picture wants to keep what she turns it to.
  function hold(page) {
    if (page.documentElement.dataset.held) { return }
    page.documentElement.dataset.held = "1"
    const free = () => { if (model.camera !== "free") { model.camera = "free"; drawBar() } }
    page.addEventListener("pointerdown", free, {capture: true, passive: true})
    page.addEventListener("wheel", free, {capture: true, passive: true})
    // Keys of the page work while the picture has the focus; the others turn the camera.
    page.addEventListener("keydown", (event) => {
      if (!PASSED_ON.has(event.key) || event.ctrlKey || event.altKey || event.metaKey) { return }
      event.preventDefault()
      const {key, code, shiftKey} = event
      document.dispatchEvent(new KeyboardEvent("keydown", {key, code, shiftKey, bubbles: true}))
    })
  }

  function toggles() {
    return DRAWN.map(([name, words, title]) => {
      const button = document.createElement("button"), on = model.drawn.includes(name)
      button.type = "button"
      button.textContent = words
      button.title = title
      button.classList.toggle("on", on)
      button.setAttribute("aria-pressed", String(on))
      button.onclick = () => {
        model.drawn = on ? model.drawn.filter((other) => other !== name) : [...model.drawn, name]
        drawBar()
      }
      return button
    })
  }

  function cameras() { return [...CAMERAS, ...(model.branch ? [BRANCH] : []), FREE] }

  function drawBar() {
    const focused = root.getRootNode().activeElement?.textContent
    const buttons = cameras().map(([name, words, title]) => {
      const button = document.createElement("button")
      button.type = "button"
      button.textContent = words
      button.title = `${title} (c for the next camera)`
      button.classList.toggle("on", model.camera === name)
      button.setAttribute("aria-pressed", String(model.camera === name))
      button.onclick = () => choose(name)
      return button
    })
    const both = document.createElement("button")
    both.type = "button"
    both.textContent = "One field"
    both.title = "Draw both flights on one battlefield"
    both.classList.toggle("on", model.overlay)
    both.classList.add("apart")
    both.setAttribute("aria-pressed", String(model.overlay))
    both.onclick = () => { model.overlay = !model.overlay; drawBar() }
    const photo = document.createElement("button")
    photo.type = "button"
    const drawing = model.photo !== (model.picture.number ?? 0)
    photo.textContent = drawing ? "PNG …" : "PNG"
    photo.title = drawing ? "The picture is being drawn" : model.picture.problem ?? "Save this view as a picture"
    photo.setAttribute("aria-disabled", String(drawing))
    photo.classList.add("apart")
    photo.classList.toggle("problem", Boolean(model.picture.problem) && !drawing)
    photo.onclick = () => { if (model.photo === (model.picture.number ?? 0)) { model.photo += 1; drawBar() } }
    bar.replaceChildren(...buttons, both, photo)
    left.replaceChildren(...toggles())
    for (const button of [...bar.children, ...left.children]) { if (focused && button.textContent === focused) { button.focus() } }
  }

  frame.addEventListener("load", hide)
  let seen = 0
  const watch = setInterval(() => {
    hide()
    const dark = isDark()
    if (dark !== model.dark) { model.dark = dark }
    // viser's canvas is black until its first frame; nothing tells when that is.
    if (frame.contentDocument?.querySelector("canvas") && ++seen > 4) { cover.classList.add("gone") }
  }, 300)
  function onKey(event) {
    const busy = event.composedPath()[0]
    const typing = busy instanceof Element && busy.closest("input:not([type=range]), textarea, select, [role=combobox], [contenteditable]")
    if (event.key !== "c" || typing || event.ctrlKey || event.altKey || event.metaKey) { return }
    const names = cameras().map(([name]) => name)
    choose(names[(names.indexOf(model.camera) + 1) % names.length])
  }

  document.addEventListener("keydown", onKey)
  model.on("remove", () => document.removeEventListener("keydown", onKey))
  model.on("ground", hide)
  model.on("due", tellWhenPainted)
  if (model.due > model.painted) { tellWhenPainted() }
  model.on(["camera", "overlay", "branch", "drawn"], drawBar)
  model.on("picture", () => {
    drawBar()
    told.textContent = model.picture.problem ?? ""
    if (!model.picture.data) { return }
    const link = document.createElement("a")
    link.href = URL.createObjectURL(new Blob([model.picture.data], {type: "image/png"}))
    link.download = "flight.png"
    link.click()
    setTimeout(() => URL.revokeObjectURL(link.href), 1000)
  })
  model.on("remove", () => clearInterval(watch))
  drawBar()
  return root
}
