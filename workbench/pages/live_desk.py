"""What the Live page shows, gathered away from the event loop: only what has changed since the last look is read."""

from __future__ import annotations

from dataclasses import dataclass

from agents.config import TrainingConfig
from sim.errors import ScenarioError, SubMasError
from workbench.context import AppContext
from workbench.estimate import epoch_seconds, usual_s
from workbench.launcher import cpu_count
from workbench.pages.address import fly_address
from workbench.pages.live_cards import event_list
from workbench.pages.live_chain import Learned, chain_json
from workbench.pages.live_columns import axis, learning_of, stage_starts
from workbench.pages.live_curves import LiveDrawing, latest_values
from workbench.pages.live_head import head_facts
from workbench.pages.live_list import list_lines, listed, watched_json
from workbench.pages.live_settings import LiveSettings
from workbench.pages.live_watch import RunWatch
from workbench.queue_place import QueuePlace, queue_place
from workbench.run_files import RunFileError, read_json
from workbench.run_index.query import RunSearch
from workbench.run_index.record import RunRecord
from workbench.run_state import ACTIVE, RunState

MOST_LOOKED_AT = 200
"""Earlier runs, the newest, that tell how long trainings like this usually take."""


@dataclass(frozen=True)
class LiveSides:
    """What stands beside the run."""

    lines: str
    watched: str


@dataclass(frozen=True)
class LiveRun:
    """What is shown of the opened run."""

    facts: str
    chain: str
    events: str
    drawing: LiveDrawing
    problem: str = ""
    """Why not all of it can be shown."""


@dataclass(frozen=True)
class LiveLook:
    """What a look has found; a part that has not changed is None."""

    settings: LiveSettings
    """The view, with the run that was opened where the address named none."""
    sides: LiveSides | None
    run: LiveRun | None
    problem: str = ""
    """Why the run cannot be shown at all."""
    finished: str = ""
    """Id of the newest run to look back at, where nothing is opened."""


class LiveDesk:
    """One session's look at the runs. One `look` at a time."""

    def __init__(self, context: AppContext) -> None:
        self._store, self._index = context.store, context.index
        self._watches: dict[str, RunWatch] = {}
        self._likely: dict[str, float | None] = {}
        self._listed: object = None
        self._drawn: tuple[LiveSettings, QueuePlace | None] | None = None
        self._queue: tuple[object, QueuePlace | None] = (None, None)

    def look(self, settings: LiveSettings, follow: bool = True) -> LiveLook:
        """What this view shows now; without `follow` from the index as it stands, which is quick."""
        if follow:
            self._index.look()
        if not settings.run:
            settings = settings.opening(self._newest(ACTIVE))
        sides = self._sides(settings)
        if not settings.run:
            self._forget(settings)
            return LiveLook(settings, sides, None, finished=self._newest(("finished",)))
        try:
            return LiveLook(settings, sides, self._run(settings))
        except SubMasError as error:
            self._drawn = None
            return LiveLook(settings, sides, None, problem=str(error))

    def seeds(self, settings: LiveSettings) -> list[str]:
        """Ids of the runs that differ from the opened one in nothing but the seed, the newest first."""
        opened = self._index.get(settings.run)
        if opened is None:
            return []
        alike = self._index.find(RunSearch(chosen={"variant": (opened.variant,), "profile": (opened.profile,)}))
        return [each.id for each in alike if each.id != opened.id and _kind(each) == _kind(opened)]

    def _newest(self, states: tuple[str, ...]) -> str:
        # A run that learns is worth more than one that waits.
        found = self._index.find(RunSearch(chosen={"state": states}))
        found.sort(key=lambda record: record.state == "queued")
        return found[0].id if found else ""

    def _sides(self, settings: LiveSettings) -> LiveSides | None:
        seen = (self._index.version, settings.run, settings.beside)
        if seen == self._listed:
            return None
        self._listed = seen
        records = listed(self._index, settings)
        return LiveSides(list_lines(records, settings), watched_json(records))

    def _run(self, settings: LiveSettings) -> LiveRun | None:
        self._forget(settings)
        changed = [self._watch(run_id).look() for run_id in (settings.run, *self._known(settings.beside))]
        watch = self._watches[settings.run]
        state, config = watch.run.state, watch.run.config
        place = self._place(watch.run.id, state)
        if not any(changed) and (settings, place) == self._drawn:
            return None
        self._drawn = settings, place
        likely_s = self._usual(watch.run.id, config) if state.state == "running" else None
        facts = head_facts(watch.run, state, watch.last, likely_s, *self._policy(watch), place)
        problem = watch.problem
        try:
            chain = chain_json(_learned(watch, config, state))
        except ScenarioError as error:
            chain, problem = "[]", problem or str(error)
        return LiveRun(facts, chain, event_list(watch.events), self._drawing(settings), problem)

    def _watch(self, run_id: str) -> RunWatch:
        """The watch of this run.

        Raises:
            SubMasError: there is no such run, or it is damaged.
        """
        run = self._store.get(run_id)
        if run.problem:
            self._watches.pop(run_id, None)
            raise RunFileError(f"run {run_id} cannot be shown: {run.problem}")
        if run_id not in self._watches:
            self._watches[run_id] = RunWatch(run)
        return self._watches[run_id]

    def _known(self, run_ids: tuple[str, ...]) -> list[str]:
        """Those of the runs beside that are there; one that was deleted is left out."""
        found = []
        for run_id in run_ids:
            try:
                self._watch(run_id)
                found.append(run_id)
            except SubMasError:
                self._watches.pop(run_id, None)
        return found

    def _forget(self, settings: LiveSettings) -> None:
        wanted = {settings.run, *settings.beside}
        self._watches = {run_id: watch for run_id, watch in self._watches.items() if run_id in wanted}

    def _drawing(self, settings: LiveSettings) -> LiveDrawing:
        watches = [self._watches[each] for each in (settings.run, *settings.beside) if each in self._watches]
        first = watches[0]
        return LiveDrawing(
            tuple(learning_of(watch, settings) for watch in watches),
            stage_starts(first, axis(first, settings.x)),
            latest_values(first.columns),
        )

    def _place(self, run_id: str, state: RunState) -> QueuePlace | None:
        """Where a waiting run stands in the queue, asked again whenever a run under way has changed."""
        if state.state != "queued":
            return None
        seen = (self._index.version, run_id)
        if self._queue[0] != seen:
            records = self._index.find(RunSearch(chosen={"state": ACTIVE}))
            alive = {each.id: self._store.get(each.id) for each in records if not each.problem}
            states = {each: run.state for each, run in alive.items() if not run.problem}
            place = queue_place(run_id, states, cpu_count(), lambda each: self._usual(each, alive[each].config))
            self._queue = seen, place
        return self._queue[1]

    def _usual(self, run_id: str, config: TrainingConfig) -> float | None:
        """How long such trainings usually take [s]: looked up once for a run."""
        if run_id not in self._likely:
            records = self._index.find(
                RunSearch(chosen={"variant": (config.variant,), "profile": (config.profile,)}), most=MOST_LOOKED_AT
            )
            runs = [self._store.get(each.id) for each in records if each.id != run_id and not each.problem]
            speeds = epoch_seconds(config, runs)
            self._likely[run_id] = usual_s(config, runs, speeds[0]) if speeds else usual_s(config, runs, 0.0) or None
        return self._likely[run_id]

    def _policy(self, watch: RunWatch) -> tuple[str, str]:
        """Address of the run's newest policy, and which one it is; empty while there is none."""
        if watch.run.policy_path() is None:
            return "", ""
        try:
            card = read_json(watch.run.path / "policy.json")
        except RunFileError:
            card = {}
        words = [f"the policy of {card['task']}"] if card.get("task") else ["its newest policy"]
        if isinstance(card.get("epoch"), int):
            words.append(f"after epoch {card['epoch']}")
        return fly_address(watch.run), ", ".join(words)


def _learned(watch: RunWatch, config: TrainingConfig, state: RunState) -> Learned:
    return Learned(config, state, watch.last, watch.stages(), watch.events, _evaluated(watch))


def _evaluated(watch: RunWatch) -> tuple[float, float] | None:
    """Success and mean length [s] of the latest held-out evaluation of the stage being learned."""
    stage, rates, lengths = (watch.columns[name] for name in ("stage", "success_rate", "length_mean_s"))
    for place in range(len(stage) - 1, -1, -1):
        if stage[place] != stage[-1]:
            return None
        if rates[place] == rates[place]:
            return rates[place], lengths[place]
    return None


def _kind(record: RunRecord) -> tuple[object, ...]:
    """What runs of one set share: everything but the seed."""
    return (
        record.scenario,
        record.subtasks,
        record.curriculum,
        record.variant,
        record.profile,
        record.guide,
        record.name,
    )
