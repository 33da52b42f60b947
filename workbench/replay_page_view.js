// Perspective on a 2-D canvas: poses, projection, lines and solids. Kilometres, +z up; a view is one part of the canvas.
const NEAR_KM = 0.5
const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
const minus = (a, b) => [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
const plus = (a, b, factor = 1) => [a[0] + factor * b[0], a[1] + factor * b[1], a[2] + factor * b[2]]
const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
const unit = (a) => { const size = Math.hypot(...a) || 1; return [a[0] / size, a[1] / size, a[2] / size] }
const clamp = (value, low, high) => Math.min(Math.max(value, low), high)
const ease = (colour, other, share) => colour.map((value, i) => Math.round(value + (other[i] - value) * share))
const css = (colour, alpha = 1) => `rgb(${colour[0]} ${colour[1]} ${colour[2]} / ${alpha})`
const rgb = (hex) => [1, 3, 5].map((start) => parseInt(hex.slice(start, start + 2), 16))

// A pose looks at `target` from `distance`, `tilt` above the horizon, `yaw` around it (0: from the south).
function lookFrom(pose, box) {
  const flat = Math.cos(pose.tilt)
  const back = [Math.sin(pose.yaw) * flat, -Math.cos(pose.yaw) * flat, Math.sin(pose.tilt)]
  const ahead = back.map((value) => -value)
  const right = unit(cross(ahead, [0, 0, 1]))
  const focal = box.height / 2 / Math.tan(data.cameras.field_of_view_rad / 2)
  return {
    eye: plus(pose.target, back, pose.distance), ahead, right, up: cross(right, ahead), focal, box,
    middle: [box.left + box.width / 2, box.top + box.height / 2],
  }
}

function poseBetween(eye, target) {
  const back = minus(eye, target), distance = Math.hypot(...back)
  return {target, distance, tilt: Math.asin(back[2] / distance), yaw: Math.atan2(back[0], -back[1])}
}

function seen(view, point) {
  const way = minus(point, view.eye)
  return [dot(way, view.right), dot(way, view.up), dot(way, view.ahead)]
}

const onScreen = (view, place) => [
  view.middle[0] + view.focal * place[0] / place[2], view.middle[1] - view.focal * place[1] / place[2],
]

function screen(view, point) {
  const place = seen(view, point)
  return place[2] > NEAR_KM ? onScreen(view, place) : null
}

// The pose from this direction in which all points just fit into a part of the box, its middle.
function fit(points, yaw, tilt, box, part) {
  const pose = {yaw, tilt, distance: 400, target: [0, 0, 0]}
  for (let round = 0; round < 5; round++) {
    let low = 5, high = 6000
    for (let i = 0; i < 26; i++) {
      pose.distance = (low + high) / 2
      const spread = bounds(points, lookFrom(pose, box))
      if (spread && spread.width < part.width && spread.height < part.height) { high = pose.distance } else { low = pose.distance }
    }
    pose.distance = high
    const view = lookFrom(pose, box), spread = bounds(points, view)
    const scale = pose.distance / view.focal
    const [across, down] = [spread.x - part.left - part.width / 2, spread.y - part.top - part.height / 2]
    pose.target = plus(plus(pose.target, view.right, across * scale), view.up, -down * scale)
  }
  return pose
}

function bounds(points, view) {
  const places = points.map((point) => screen(view, point))
  if (places.includes(null)) { return null }
  const [left, right] = [Math.min, Math.max].map((end) => end(...places.map((place) => place[0])))
  const [top, bottom] = [Math.min, Math.max].map((end) => end(...places.map((place) => place[1])))
  return {x: (left + right) / 2, y: (top + bottom) / 2, width: right - left, height: bottom - top}
}

function trace(pen, view, points) {
  pen.beginPath()
  let before = null, drawing = false
  for (const point of points) {
    const here = seen(view, point)
    if (before && (before[2] > NEAR_KM || here[2] > NEAR_KM)) {
      const [start, end] = [cut(before, here), cut(here, before)].map((place) => onScreen(view, place))
      if (!drawing || before[2] <= NEAR_KM) { pen.moveTo(...start) }
      pen.lineTo(...end)
      drawing = here[2] > NEAR_KM
    } else { drawing = false }
    before = here
  }
}

// What is behind the eye is cut off where the line passes the near plane.
function cut(place, other) {
  if (place[2] > NEAR_KM) { return place }
  const share = (NEAR_KM * 1.01 - place[2]) / (other[2] - place[2])
  return place.map((value, i) => value + (other[i] - value) * share)
}

function stroke(pen, view, points, colour, width, dash = []) {
  trace(pen, view, points)
  pen.strokeStyle = colour
  pen.lineWidth = width
  pen.setLineDash(dash)
  pen.stroke()
  pen.setLineDash([])
}

function fill(pen, view, corners, colour) {
  const places = corners.map((corner) => seen(view, corner))
  const kept = places.flatMap((place, i) => {
    const next = places[(i + 1) % places.length]
    const here = place[2] > NEAR_KM ? [place] : []
    return (place[2] > NEAR_KM) !== (next[2] > NEAR_KM) ? [...here, place[2] > NEAR_KM ? cut(next, place) : cut(place, next)] : here
  })
  if (kept.length < 3) { return }
  pen.beginPath()
  kept.forEach((place, i) => pen[i ? "lineTo" : "moveTo"](...onScreen(view, place)))
  pen.closePath()
  pen.fillStyle = colour
  pen.fill()
}

function text(pen, place, words, colour, halo, size = 12) {
  pen.font = `600 ${size}px system-ui, sans-serif`
  pen.lineJoin = "round"
  pen.lineWidth = 3.5
  pen.strokeStyle = halo
  pen.strokeText(words, ...place)
  pen.fillStyle = colour
  pen.fillText(words, ...place)
}

const LIGHT = unit([-0.35, -0.5, 0.8])

// Triangles from far to near, shaded by how they face the light.
function solid(pen, view, mesh, place, ink, size) {
  const [heading, pitch, bank] = [place.heading, -place.pitch, -place.bank]
  const [ch, sh, cp, sp, cb, sb] = [heading, pitch, bank].flatMap((angle) => [Math.cos(angle), Math.sin(angle)])
  const turn = ([x, y, z]) => {
    const [y1, z1] = [y * cb - z * sb, y * sb + z * cb]
    const [x2, z2] = [x * cp + z1 * sp, -x * sp + z1 * cp]
    return [x2 * ch - y1 * sh, x2 * sh + y1 * ch, z2]
  }
  const corners = mesh.vertices.map((vertex) => plus(place.at, turn(vertex), size))
  const places = corners.map((corner) => seen(view, corner))
  if (places.some((one) => one[2] < NEAR_KM)) { return }
  const depth = (face) => places[face[0]][2] + places[face[1]][2] + places[face[2]][2]
  for (const face of [...mesh.faces].sort((a, b) => depth(b) - depth(a))) {
    const [a, b, c] = face.map((number) => corners[number])
    const lit = Math.abs(dot(unit(cross(minus(b, a), minus(c, a))), LIGHT))
    pen.beginPath()
    face.forEach((number, i) => pen[i ? "lineTo" : "moveTo"](...onScreen(view, places[number])))
    pen.closePath()
    pen.fillStyle = pen.strokeStyle = css(ease([0, 0, 0], ink, 0.5 + 0.5 * lit))
    pen.lineWidth = 0.6
    pen.fill()
    pen.stroke()
  }
}
