"""The closer look of the Compare page: the paired table, two maps of survival, the gallery."""

from __future__ import annotations

import html
from collections.abc import Mapping

import panel as pn

from layouts.comparison_survival import survival_chart
from workbench.comparison.closely import Closely, repeatable
from workbench.comparison.grid import Cell, Grid
from workbench.pages.address import search
from workbench.pages.compare_settings import CompareSettings
from workbench.pages.compare_words import COMPARE_CSS, gallery, pairs_table
from workbench.scenarios import DEFAULT

MAP_SIZE = 320
HOW_TO_READ = (
    '<p class="quiet">Maps: one missile fired at once at the evader, whose nose points up; the launch range grows '
    "outwards. Blue: it survives. Orange: it is shot down. A click on a place flies that shot.</p>"
)
SIDE_BY_SIDE = """
:host { display: grid !important; grid-template-columns: minmax(0, 1fr) auto auto; gap: 10px 22px;
  height: auto !important }
@media (max-width: 1300px) { :host { grid-template-columns: auto auto }
  .pairs { grid-column: 1 / -1 } }
"""


class CompareCloser:
    """Panes that are changed in place."""

    def __init__(self) -> None:
        self._pairs, self._gallery = (
            pn.pane.HTML("", stylesheets=[COMPARE_CSS], margin=0, sizing_mode="stretch_width") for _ in range(2)
        )
        self._maps = [survival_chart(name, MAP_SIZE) for name in ("first", "second")]
        panes = [pn.pane.Bokeh(chart.figure, sizing_mode="fixed", margin=0) for chart in self._maps]
        self._pairs.param.update(styles={"overflow-x": "auto"}, css_classes=["pairs"])
        self.layout = pn.Column(
            pn.Row(self._pairs, *panes, sizing_mode="stretch_width", margin=0, stylesheets=[SIDE_BY_SIDE]),
            self._gallery,
            sizing_mode="stretch_width", margin=0, styles={"gap": "10px"},
        )  # fmt: skip

    def show(
        self, grid: Grid, settings: CompareSettings, close: Closely, labels: Mapping[str, str], inks: Mapping[str, str],
        theme: str,
    ) -> None:  # fmt: skip
        """Show what is known, and what is missing in words."""
        a, b = settings.policy, settings.against
        names, colours = (labels[a], labels[b]), (inks[a], inks[b])
        table = pairs_table(names, colours, settings.tasks, close.pairs, settings.task)
        self._pairs.object = table + HOW_TO_READ
        for chart, policy in zip(self._maps, (a, b), strict=True):
            shots, address = close.maps.get(policy), fly_address(grid, settings, policy, theme)
            if shots is None:
                chart.clear(_no_map(grid.cell(policy, settings.task), labels[policy]))
            else:
                chart.show(shots, labels[policy].removesuffix(" (shipped)"), address)
        self._gallery.object = self._pictures(grid, settings, close, inks[a], theme)

    def _pictures(self, grid: Grid, settings: CompareSettings, close: Closely, ink: str, theme: str) -> str:
        cell = grid.cell(settings.policy, settings.task)
        if cell.entry.blind:
            return _waiting(f"{html.escape(cell.entry.blind)}.")
        if cell.evaluation is None:
            return _waiting("Closest calls and failures appear here once this policy has flown this task.")
        if not repeatable(cell.entry.policy):
            return _waiting("This policy flies every engagement another way each time: there is nothing to fly again.")
        if not close.strips:
            return _waiting("No missile came near and nothing went wrong: there is nothing to show.")
        if close.tracks is None:
            return _waiting("Drawing the closest calls and the failures …")
        addresses = {episode: fly_address(grid, settings, settings.policy, theme, episode) for episode in close.tracks}
        return gallery(
            close.strips, close.tracks, cell.task.scenario.battlefield, ink, addresses, cell.evaluation.episodes
        )


def fly_address(grid: Grid, settings: CompareSettings, policy: str, theme: str, episode: int | None = None) -> str:
    """The Fly page with a policy of the comparison as A and the other as B: an episode, or the start of a shot's."""
    a, b = (grid.cell(one, settings.task) for one in (policy, _other(settings, policy)))
    start = {"seed": "0"} if episode is None else {"seed": str(grid.seed), "episode": str(episode)}
    return "/fly" + search({
        "a": a.entry.policy, "b": b.entry.policy or a.entry.policy,
        "scenario": "" if grid.scenario == DEFAULT else grid.scenario,
        "mask": ",".join(map(str, sorted(a.task.masked))), **start, "theme": theme,
    })  # fmt: skip


def _other(settings: CompareSettings, policy: str) -> str:
    return settings.against if policy == settings.policy else settings.policy


def _no_map(cell: Cell, label: str) -> str:
    if not cell.task.missiles:
        return "No missile flies in this task"
    return f"{label} cannot fly this task" if cell.entry.blind else "Mapping where it survives …"


def _waiting(sentence: str) -> str:
    return f'<div class="waiting">{sentence}</div>'
