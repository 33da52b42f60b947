"""A part of a page may be given another size while its figures are being made."""

from __future__ import annotations

from playwright.sync_api import Page, expect

from tests.conftest import Served

ONE_MORE = """async () => {
  const {PlotView} = Bokeh.require("models/plots/plot_canvas"), views = [...Bokeh.index.roots]
  const seen = (view) => view.children_views().filter(({model}) => model.visible)
  while (!(views.at(-1) instanceof PlotView)) views.push(...seen(views.pop()))
  const figure = views.at(-1), holder = figure.parent
  holder.model.document._callbacks.clear()  // the server knows nothing of what follows
  const build = holder.build_child_views
  const {x_range, y_range} = figure.model, size = {width: 200, height: 150}
  const one = new figure.model.constructor({x_range, y_range, ...size})
  let waits = null
  holder.build_child_views = async function () {
    const [created] = await build.call(this)
    holder.root.compute_layout()
    waits = created.is_paused
    return [created]
  }
  holder.model.setv({children: [...holder.model.children, one]}, {sync: false})
  await new Promise((resolve) => setTimeout(resolve, 500))
  return waits
}"""


def test_a_figure_that_is_not_set_out_yet_holds_up_nothing(visitor: Page, served: Served) -> None:
    visitor.goto(f"{served.address}/fly?tab=azimuth")
    figures = visitor.locator(".bk-Figure:visible")
    expect(figures).to_have_count(2)
    assert visitor.evaluate(ONE_MORE) is True  # nor is it drawn before its turn has come
    expect(figures).to_have_count(3)
    expect(figures.nth(2).locator("canvas").first).to_be_visible()
