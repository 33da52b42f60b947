// A closed list of choices opens by key as it does by mouse. The component of panel-material-ui keeps to itself whether
// it is open, and listens for clicks alone: Enter, space and arrows, which every list of a browser knows, did nothing.
{
  const closed = "[role=combobox][aria-haspopup=listbox][aria-expanded=false]:not([aria-disabled=true])"
  document.addEventListener("keydown", (event) => {
    const [field] = event.composedPath()
    if (!["Enter", " ", "ArrowDown", "ArrowUp"].includes(event.key) || !field.matches?.(closed)) { return }
    event.preventDefault()
    field.click()
    if (event.key === " ") {  // let go over the first choice, it would choose that one
      document.addEventListener("keyup", (up) => up.preventDefault(), {capture: true, once: true})
    }
  })
}
