// Python would be a round trip late, and has better things to do while the clock runs.
const text = (seconds) => {
  const whole = Math.floor(seconds + 1e-6)
  return `${Math.floor(whole / 60)}:${String(whole % 60).padStart(2, "0")}`
}

export function render({model}) {
  const root = document.createElement("span"), moment = document.createElement("b")
  let time = 0

  function draw() {
    moment.textContent = text(time)
    model.over ? root.replaceChildren("is over: move the clock back") : root.replaceChildren("from ", moment, " on")
  }

  const onTime = (event) => { time = event.detail.time; draw() }
  window.addEventListener("flight-time", onTime)
  model.on("over", draw)
  model.on("remove", () => window.removeEventListener("flight-time", onTime))
  draw()
  return root
}
