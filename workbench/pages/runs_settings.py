"""What a person has chosen on the Runs page, as it stands in the address: never trusted, never lost."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field, replace
from typing import Final
from urllib.parse import quote, unquote

from workbench.run_folder import is_run_id
from workbench.run_index.query import FACETS, NEWEST_FIRST, SORTS, RunSearch

SLOTS: Final = 10
"""Curves that may lie over each other; each place has its colour."""
EXPERT: Final = "expert-dragging"
NO_BASELINE: Final = "none"
GROUPS: Final = {
    "": "no groups",
    "variant": "variant",
    "settings": "all settings but the seed",
    "task": "task",
    "profile": "profile",
    "scenario": "scenario",
}
"""What runs may be put together by, and how that is called."""
METRICS: Final = {
    "success_rate": "success",
    "return_mean": "return",
    "train_success_rate": "success in training",
    "train_return_mean": "return in training",
    "alpha": "α, weight of distillation",
    "epsilon": "ε, probability of reuse",
    "beta": "β, success of the actor",
    "transfer_share": "share of steps with transfer",
    "critic_loss": "critic loss",
    "q_mean": "mean Q",
    "updates_per_s": "updates a second",
}
X_AXES: Final = {"steps": "steps", "time": "time", "epoch": "epochs"}
STAGES: Final = {"all": "all", "last": "the last"}
TEXT_LIMIT: Final = 200
VALUES_LIMIT: Final = 50


@dataclass(frozen=True)
class RunsSettings:
    """One view of the Runs page."""

    search: RunSearch = field(default_factory=RunSearch)
    group: str = ""
    opened: tuple[str, ...] = ()
    """Keys of the groups whose runs are listed."""
    shown: tuple[str, ...] = ()
    """What has a curve, by place: ids of runs or "group:" and a group's key; empty where a place is free."""
    run: str = ""
    """Id of the run that is read about."""
    baseline: str = EXPERT
    """What the others are measured against: the expert, a run's id, or NO_BASELINE."""
    metrics: tuple[str, str] = ("success_rate", "return_mean")
    x: str = "steps"
    stages: str = "all"
    smooth: int = 0
    """Weight of the past in the exponential mean [%], 0..99."""
    every_field: bool = False
    """Show fields that agree in the difference of configurations too."""

    def toggled(self, key: str) -> RunsSettings:
        """With this run or group shown if it was not, and the other way round; the last place makes room."""
        if key in self.shown:
            return replace(self, shown=_trimmed("" if each == key else each for each in self.shown))
        slots = [*self.shown]
        free = slots.index("") if "" in slots else len(slots)
        if free >= SLOTS:
            free = SLOTS - 1
        slots[free : free + 1] = [key]
        return replace(self, shown=tuple(slots))

    def without(self, keys: Iterable[str]) -> RunsSettings:
        """With none of these runs shown, read about or pinned."""
        gone = set(keys)
        return replace(
            self,
            shown=_trimmed("" if each in gone else each for each in self.shown),
            run="" if self.run in gone else self.run,
            baseline=EXPERT if self.baseline in gone else self.baseline,
        )

    @property
    def shown_runs(self) -> list[str]:
        """Ids of the single runs that have a curve, in the order of their places."""
        return [each for each in self.shown if is_run_id(each)]

    def to_query(self) -> dict[str, str]:
        """The values of the address; what is as it always is stands as empty and is left out."""
        search, plain = self.search, RunsSettings()
        return {
            "q": search.text,
            **{name: _joined(search.chosen.get(name, ())) for name in FACETS},
            "sort": "" if search.sort == NEWEST_FIRST else search.sort,
            "view": "trash" if search.trashed else "",
            "group": self.group,
            "open": _joined(self.opened),
            "show": _joined(self.shown),
            "run": self.run,
            "baseline": "" if self.baseline == EXPERT else self.baseline,
            "curves": "" if self.metrics == plain.metrics else _joined(self.metrics),
            "x": "" if self.x == plain.x else self.x,
            "stages": "" if self.stages == plain.stages else self.stages,
            "smooth": str(self.smooth) if self.smooth else "",
            "fields": "all" if self.every_field else "",
        }


def read_settings(query: Mapping[str, str]) -> RunsSettings:
    """The view an address asks for; what is not legal in it is left as it always is."""
    plain = RunsSettings()
    sort = query.get("sort", "")
    search = RunSearch(
        text=query.get("q", "")[:TEXT_LIMIT],
        chosen={name: values for name in FACETS if (values := _split(query.get(name, "")))},
        sort=sort if sort.removeprefix("-") in SORTS else NEWEST_FIRST,
        trashed=query.get("view") == "trash",
    )
    baseline = query.get("baseline", EXPERT)
    smooth = query.get("smooth", "")
    return RunsSettings(
        search=search,
        group=_one_of(GROUPS, query.get("group"), ""),
        opened=_split(query.get("open", "")),
        shown=_slots(query.get("show", "")),
        run=query.get("run", "")[:TEXT_LIMIT],
        baseline=baseline if baseline == NO_BASELINE or is_run_id(baseline) else EXPERT,
        metrics=_two_metrics(_split(query.get("curves", "")), plain.metrics),
        x=_one_of(X_AXES, query.get("x"), plain.x),
        stages=_one_of(STAGES, query.get("stages"), plain.stages),
        smooth=min(int(smooth), 99) if smooth.isascii() and smooth.isdigit() and len(smooth) < 4 else 0,
        every_field=query.get("fields") == "all",
    )


def group_key(name: str) -> str:
    """How a group is called among what has a curve."""
    return f"group:{name}"


def _one_of(legal: Mapping[str, str], value: str | None, otherwise: str) -> str:
    return value if value is not None and value in legal else otherwise


def _two_metrics(wanted: tuple[str, ...], otherwise: tuple[str, str]) -> tuple[str, str]:
    return (wanted[0], wanted[1]) if len(wanted) == 2 and set(wanted) <= set(METRICS) else otherwise


def _slots(text: str) -> tuple[str, ...]:
    slots: list[str] = []
    for part in map(unquote, text.split(",")):
        fits = is_run_id(part) or part.startswith("group:")
        slots.append(part if fits and part not in slots else "")
    return _trimmed(slots[:SLOTS])


def _trimmed(slots: Iterable[str]) -> tuple[str, ...]:
    """The places without free ones at the end."""
    kept = list(slots)
    while kept and not kept[-1]:
        kept.pop()
    return tuple(kept)


def _joined(values: Iterable[str]) -> str:
    return ",".join(quote(value, safe=" /:–·") for value in values)


def _split(text: str) -> tuple[str, ...]:
    return tuple(dict.fromkeys(unquote(part) for part in text.split(",")[:VALUES_LIMIT] if part))
