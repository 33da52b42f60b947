// Rerun's web viewer in a frame, following and moving the page's clock. The viewer's control protocol is private to its version
// (rerun-sdk 0.41), so every use of it is guarded: without it recordings still open, only the clocks are apart.
const bytes = new TextEncoder()
const varint = (value) => {
  let rest = BigInt(value)
  const out = []
  while (rest > 127n) { out.push(Number(rest & 127n) | 128); rest >>= 7n }
  return [...out, Number(rest)]
}
const field = (number, content) => [...varint((number << 3) | 2), ...varint(content.length), ...content]
const SETTLE_TRIES = 300  // a minute
const NANO = 1e9, PAUSED = [0x28, 1]

function setTime(timeline, seconds) {
  const nanos = [8, ...varint(Math.max(0, Math.round(seconds * NANO)))]
  return new Uint8Array(field(6, [...field(2, field(1, [...bytes.encode(timeline)])), ...field(3, nanos), ...PAUSED]))
}

// Fields of a protobuf message, as [number, content].
function* walk(message) {
  let at = 0
  const read = () => {
    let result = 0n, shift = 0n
    for (;;) {
      const byte = message[at++]
      result |= BigInt(byte & 127) << shift
      if (byte < 128) { return result }
      shift += 7n
    }
  }
  while (at < message.length) {
    const tag = Number(read()), number = tag >> 3, type = tag & 7
    if (type === 0) { yield [number, read()] }
    else if (type === 2) { const size = Number(read()); yield [number, message.slice(at, at + size)]; at += size }
    else if (type === 5) { at += 4 }
    else if (type === 1) { at += 8 }
    else { return }
  }
}

function get(message, ...path) {
  let found = message
  for (const wanted of path) {
    let next
    for (const [number, content] of walk(found)) { if (number === wanted) { next = content; break } }
    if (next === undefined) { return undefined }
    found = next
  }
  return found
}

// Kind, application and id of the recording that is shown.
function active(state) {
  const name = get(state, 2)
  return name && new TextDecoder().decode(name)
}

function cursor(state) {
  const name = active(state)
  if (!name) { return undefined }
  for (const [number, recording] of walk(state)) {
    if (number !== 3 || new TextDecoder().decode(get(recording, 1)) !== name) { continue }
    const nanos = get(recording, 3, 3, 1)
    return nanos === undefined ? undefined : Number(nanos) / NANO
  }
  return undefined
}

export function render({model}) {
  const root = document.createElement("div")
  root.className = "pane"
  const frame = document.createElement("iframe")
  frame.title = "Rerun viewer"
  frame.src = `${model.viewer}?hide_welcome_screen=1&persist=0&notebook=0&theme=${model.theme}`
  const cover = document.createElement("div")
  cover.className = "cover"
  cover.textContent = "Opening the Rerun viewer (14 MB the first time) …"
  root.append(frame, cover)
  let handle = null, now = model.start, wanted = null, last = null, busy = false, channel = 0, tries = 0

  const fail = (sentence) => { cover.textContent = sentence; cover.classList.remove("gone"); model.error = sentence }

  async function load() {
    if (!handle || !model.recording) { return }
    const answer = await fetch(model.recording, {credentials: "same-origin"})
    if (!answer.ok) { fail(`The recording could not be read (status ${answer.status}).`); return }
    const content = new Uint8Array(await answer.arrayBuffer()), id = `recording-${channel++}`
    handle.open_channel(id, model.recording)
    handle.send_rrd_to_channel(id, content)  // each call must be one whole recording
    handle.close_channel(id)
    tries = SETTLE_TRIES
    cover.classList.add("gone")
  }

  // A new recording begins at 0 once the viewer has read it, and until then it takes no time and tells that of the old one.
  function settle() {
    let state
    try { state = handle.viewer_state() } catch { tries = 0; return }
    const name = active(state), time = cursor(state)
    if (name && model.recording.includes(name.split(":").pop()) && Math.abs((time ?? -1) - now) < 0.05) { tries = 0; last = now; return }
    tries -= 1
    wanted = now
    push()
  }

  async function push() {
    if (!handle?.viewer_control || busy || wanted === null) { return }
    busy = true
    while (wanted !== null) {
      const time = wanted
      wanted = null
      last = time
      try { await handle.viewer_control(setTime(model.timeline, time)) } catch { break }
    }
    busy = false
  }

  const onTime = (event) => {
    now = event.detail.time
    if (!root.isConnected || Math.abs(now - (last ?? -1)) < 5e-3) { return }
    wanted = now
    push()
  }

  // A person may also drag the viewer's own cursor.
  function look() {
    if (!handle?.viewer_state || busy || wanted !== null) { return }
    let time
    try { time = cursor(handle.viewer_state()) } catch { return }
    if (time === undefined) { return }
    if (last !== null && Math.abs(time - last) > 0.05) { window.dispatchEvent(new CustomEvent("flight-clock", {detail: time})) }
    last = time
  }

  const watch = setInterval(() => {
    const inside = frame.contentWindow
    if (!handle && inside?._handle) { handle = inside._handle; model.ready = true; load() }
    if (handle && tries > 0) { settle() } else { look() }
  }, 200)
  window.addEventListener("flight-time", onTime)
  model.on("recording", load)
  model.on("remove", () => { clearInterval(watch); window.removeEventListener("flight-time", onTime) })
  return root
}
