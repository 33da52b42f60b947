// Panel loads components through es-module-shims, which reads and rewrites every module, so that the browser can neither
// stream nor keep its compiled form: a quarter of a second of each page. Ours come whole and need no import map; the
// browser's own import is enough. Stands after es-module-shims, before the first component.
{
  const ours = (address) => import(address)
  ours.addImportMap = () => {}
  window.importShim = ours
}
