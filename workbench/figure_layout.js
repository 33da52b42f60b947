// When the children of a part change while it is given another size, Bokeh lays out figures that it has made but not yet
// set out, and throws: the part keeps its old size. Such a figure is passed over; its turn comes with the new children.
{
  const {PlotView} = Bokeh.require("models/plots/plot_canvas")
  for (const step of ["measure_layout", "after_layout"]) {
    const take = PlotView.prototype[step]
    PlotView.prototype[step] = function () {
      if (this.layout != null) take.call(this)
    }
  }
}
