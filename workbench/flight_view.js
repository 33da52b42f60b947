// The 3-D replay in its frame. viser's own control panel and notices are hidden: the page has the controls.
const HIDE = `
  [data-floating-window], [data-dock-region], [data-dock-bar], .mantine-Notifications-root, .mantine-Affix-root { display: none !important }
  body { background: transparent }`
const CAMERAS = [["overview", "Overview"], ["top", "Top"], ["chase-a", "Follow A"], ["chase-b", "Follow B"]]

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
  root.append(frame, cover, bar)

  function hide() {
    const page = frame.contentDocument
    if (!page?.head || page.getElementById("workbench-style")) { return }
    const style = page.createElement("style")
    style.id = "workbench-style"
    style.textContent = HIDE
    page.head.append(style)
  }

  function drawBar() {
    const branch = model.branch ? [["chase-branch", "Follow branch"]] : []
    const buttons = [...CAMERAS, ...branch].map(([name, words]) => {
      const button = document.createElement("button")
      button.type = "button"
      button.textContent = words
      button.classList.toggle("on", model.camera === name)
      button.setAttribute("aria-pressed", String(model.camera === name))
      button.onclick = () => { model.camera = name; model.look += 1; drawBar() }
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
    photo.textContent = "PNG"
    photo.title = "Save this view as a picture"
    photo.classList.add("apart")
    photo.onclick = () => { photo.textContent = "…"; model.photo += 1 }
    bar.replaceChildren(...buttons, both, photo)
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
  model.on(["camera", "overlay", "branch"], drawBar)
  model.on("picture", () => {
    if (!model.picture) { return }
    const link = document.createElement("a")
    link.href = model.picture
    link.download = "flight.png"
    link.click()
    drawBar()
  })
  model.on("remove", () => clearInterval(watch))
  drawBar()
  return root
}
