"""Run this: what a reproduction would cost here, the button that starts it in the background, and how it goes on."""

from __future__ import annotations

import asyncio
import html
from collections.abc import Callable
from functools import partial
from typing import Any

import panel as pn
import panel_material_ui as pmui

from agents.config import PROFILES
from sim.errors import SubMasError
from workbench.pages.number_field import NumberField
from workbench.pages.paper_results import results_root
from workbench.pages.paper_sheet import PaperSheet, command, words
from workbench.reproduce import background
from workbench.reproduce.background import Order
from workbench.reproduce.cost import Cost, cost
from workbench.reproduce.job import Job, Kind, kind_of, read_job
from workbench.reproduce.plan import Plan, make_plan
from workbench.reproduce.protocol import BASELINES, EPISODES, TRAINED_FOR, Item
from workbench.reproduce.seed_counts import SeedCounts
from workbench.runs import RunStore
from workbench.terminal import duration

MOST_SEEDS = 100
SEEDS_AT_FIRST = SeedCounts(ablations=5, submas=10, baselines=3)
PROFILE_WORDS = {"fast": "fast: minutes a task", "paper": "paper: Table 2, hours a task", "smoke": "smoke: seconds"}
SHORT_EPISODES = 50
"""Episodes behind a number of the profile smoke, which is there to try things out."""


class RunPanel:
    """Settings, cost, button and progress of one item."""

    def __init__(self, store: RunStore, started: Callable[[str], None]) -> None:
        """`started` hears the profile of a reproduction that was begun."""
        self._store, self._started = store, started
        self._item: Item = "table4"
        self._asked = 0
        self._make_widgets()
        self._cost = PaperSheet(margin=0, sizing_mode="stretch_width")
        self._run = pmui.Button(label="Run this", icon="play_arrow", color="primary", margin=0, width=150)
        self._run.on_click(self._start)
        self._make_progress()
        self._seed_row = pmui.Row(*self._seeds.values(), margin=0, sx={"gap": "10px"})
        self.layout = pmui.Column(
            self._profile, self._seed_row, self._cost, self._run, self._progress,
            margin=0, sizing_mode="stretch_width", sx={"gap": "12px"},
        )  # fmt: skip

    def _make_widgets(self) -> None:
        common: dict[str, Any] = {"size": "small", "margin": 0, "sizing_mode": "stretch_width"}
        options = {PROFILE_WORDS[name]: name for name in ("fast", "paper", "smoke") if name in PROFILES}
        self._profile = pmui.Select(label="Profile", options=options, value="fast", **common)
        labels = {"submas": "Seeds of SubMas-RL", "ablations": "of each ablation", "baselines": "of each baseline"}
        self._seeds = {
            name: NumberField(
                label=label, value=getattr(SEEDS_AT_FIRST, name), start=1, end=MOST_SEEDS,
                margin=0, sizing_mode="stretch_width",
            )
            for name, label in labels.items()
        }  # fmt: skip
        for widget in (self._profile, *self._seeds.values()):
            widget.param.watch(self._change, "value")

    def _make_progress(self) -> None:
        self._bar = pmui.LinearProgress(value=0, variant="determinate", sizing_mode="stretch_width", margin=0, height=8)
        self._words = pn.pane.HTML("", margin=0, sizing_mode="stretch_width", styles={"font-size": "13.5px"})
        self._stop = pmui.Button(
            label="Stop", icon="stop_circle", color="error", variant="outlined", margin=0, width=120
        )
        self._stop.on_click(self._ask)
        self._progress = pmui.Column(
            self._words, self._bar, self._stop, margin=0, sizing_mode="stretch_width", sx={"gap": "8px"}, visible=False
        )
        keep = pmui.Button(label="Let running trainings finish", color="primary", margin=0)
        end = pmui.Button(label="Stop them as well", color="error", margin=0)
        back = pmui.Button(label="Go on", variant="text", margin=0)
        keep.on_click(partial(self._end, trainings_too=False))
        end.on_click(partial(self._end, trainings_too=True))
        back.on_click(self._close)
        sentence = "Nothing new is started. What is trained and flown by then is kept, and running it again goes on."
        self._dialog = pmui.Dialog(
            sentence, pmui.Row(keep, end, back, margin=(16, 0, 0, 0)), title="Stop this reproduction?", open=False
        )

    @property
    def dialog(self) -> pmui.Dialog:
        """Asks before it stops; belongs into the page's layout once."""
        return self._dialog

    @property
    def kind(self) -> Kind:
        """Which of the runs folder's jobs the item belongs to."""
        return kind_of([self._item])

    def show(self, item: Item, profile: str) -> None:
        """Offer to run this item, with the profile whose results are shown."""
        self._item = item
        trained = TRAINED_FOR[item]
        self._seeds["submas"].visible = "submas" in trained
        self._seeds["baselines"].visible = any(variant in BASELINES for variant in trained)
        self._seeds["ablations"].visible = any(variant not in ("submas", *BASELINES) for variant in trained)
        self._profile.visible = self._seed_row.visible = bool(trained)
        self._profile.value = profile if trained and profile in PROFILES else "fast"
        self._change()
        self.look()

    def look(self) -> None:
        """Show how the job of this kind stands; called again and again."""
        root, kind = self._store.root, self.kind
        starting, job = background.beginning(root, kind), read_job(root, kind)
        failed = background.failure(root, kind)
        alive = starting or (job is not None and job.alive)
        self._run.disabled = alive
        self._progress.visible = alive or bool(failed) or (job is not None and job.state != "finished")
        self._bar.visible = self._stop.visible = alive
        self._stop.disabled = starting
        self._bar.value = 0 if job is None or starting else round(100 * min(max(job.share, 0.0), 1.0))
        self._words.object = _standing(job, starting, failed)

    def _plan(self) -> Plan:
        counts = SeedCounts(**{name: int(widget.value or 1) for name, widget in self._seeds.items()})
        profile = str(self._profile.value)
        return make_plan(self._item, profile, counts, SHORT_EPISODES if profile == "smoke" else EPISODES)

    def _change(self, _event: object = None) -> None:
        self._asked += 1
        pn.state.execute(partial(self._estimate, self._plan(), self._asked), schedule=True)

    async def _estimate(self, plan: Plan, asked: int) -> None:
        self._cost.blocks = [command(plan.command), words("Looking what is there …", "quiet")]
        try:
            price = await asyncio.to_thread(cost, plan, self._store)
        except SubMasError as error:
            self._cost.blocks = [words(f"{error}.")]
            return
        if asked == self._asked:  # else the settings have changed in the meantime
            where = f"Results go to {results_root(self._store)}; those that come with the workbench stay as they are."
            self._cost.blocks = [command(plan.command), words(price_words(price)), words(where, "quiet")]

    def _start(self, _event: object) -> None:
        plan = self._plan()
        self._run.disabled = True
        order = Order(plan.item, plan.profile, plan.seeds, plan.episodes)
        try:
            background.start(self._store.root, results_root(self._store), order)
        finally:
            self.look()
        self._started(plan.profile)

    def _ask(self, _event: object) -> None:
        if self.kind == "flights":
            self._end(None, trainings_too=False)
        else:
            self._dialog.open = True

    def _close(self, _event: object) -> None:
        self._dialog.open = False

    def _end(self, _event: object, trainings_too: bool) -> None:
        self._dialog.open = False
        background.stop(self._store, self.kind, trainings_too)
        self.look()


def price_words(price: Cost) -> str:
    """An estimate in a sentence or two."""
    flown = f"{price.evaluations} evaluations" if price.evaluations else "two engagements"
    if not price.trainings:
        return f"No training; {flown}, about {duration(max(price.left_s, 10.0))} on this machine."
    there = f", {price.there} of them are in this runs folder" if price.there else ""
    there += f", {price.under_way} under way" if price.under_way else ""
    left = f"about {_long(price.left_s)} on this machine at most" if price.left_s else "nothing left to do"
    return f"{price.trainings} trainings{there}; {flown}; {left}."


def _long(seconds: float) -> str:
    if seconds < 5400:
        return f"{max(seconds / 60, 1):.0f} min"
    return f"{seconds / 3600:.0f} h" if seconds < 48 * 3600 else f"{seconds / 86400:.1f} days"


def _standing(job: Job | None, starting: bool, failed: str) -> str:
    """How a job stands, as HTML."""
    if starting:
        return "<b>Starting …</b>"
    if failed:
        return f"<b>It could not begin:</b> {html.escape(failed)}"
    if job is None:
        return ""
    heads = {
        "running": "Running", "failed": "Ended, but not all went well", "interrupted": "Stopped",
        "died": "It died; run it again to go on", "finished": "Done",
    }  # fmt: skip
    links = " ".join(f'<a href="/live?run={html.escape(run)}">{html.escape(run)}</a>' for run in job.running)
    parts = [
        f"<b>{heads.get(job.state, 'Unknown')}</b>: {html.escape(', '.join(job.items))}, profile "
        f"{html.escape(job.profile)}; {html.escape(job.doing)}",
        f"trains now: {links}" if links else "",
        *(html.escape(line) for line in background.said(job)[:3]),
    ]
    return "<br>".join(filter(None, parts))
