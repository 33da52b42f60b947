"""The sections of the Paper page: which table or figure, what it is about, and how it stands."""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass
from typing import Any, Final

from workbench.pages.paper_results import Results
from workbench.pages.paper_scores import points_of
from workbench.pages.paper_settings import differing_settings
from workbench.pages.paper_sheet import Block, heading, words
from workbench.reproduce.protocol import Item
from workbench.reproduce.result_set import ResultSet
from workbench.reproduce.scorecard import complete


@dataclass(frozen=True)
class Section:
    """One entry of the contents."""

    name: str
    title: str
    about: str
    """What it is, in a few words."""
    paper: str
    """What the paper shows there, in a sentence or two."""
    item: Item | None = None
    """The result set it is drawn from."""


SECTIONS: Final = (
    Section("overview", "Scorecard", "every point at once",
            "Hou et al. (2023), item by item: what the paper says, what comes out here, and whether it holds."),
    Section("table1", "Table 1", "state spaces",
            "The state of every task of the chain: masking a missile removes its two numbers from the target's 15."),
    Section("table2", "Table 2", "hyperparameters", "The numbers of training, where ours differ, and why."),
    Section("table3", "Table 3", "ablations", "Which parts of SubMas-RL each of the compared algorithms has."),
    Section("table4", "Table 4", "all algorithms on the target task",
            "Return and success of SubMas-RL, four ablations and three baselines: best of ten seeds, 1000 episodes.",
            "table4"),
    Section("fig8", "Fig. 8", "ablations while they learn",
            "Learning curves of SubMas-RL and its four ablations on four tasks, ten seeds each.", "fig8"),
    Section("fig9", "Fig. 9", "SubMas-RL and learning from scratch",
            "Learning curves on the target task beside TD3, PPO and SAC, which start from nothing.", "fig9"),
    Section("fig10", "Fig. 10", "SubMas-RL flies the target task",
            "Two pictures of one engagement: (a) it manoeuvres and evades four missiles, (b) it reaches the exit.",
            "fig12"),
    Section("fig11", "Fig. 11", "the dragging expert flies it",
            "The expert on the same task: (a) it keeps its heading across the line of sight, (b) all are evaded.",
            "fig12"),
    Section("fig12", "Fig. 12", "azimuth of the missiles",
            "Where each missile is seen from the evader's nose while it is evaded, for SubMas-RL and the expert.",
            "fig12"),
    Section("fig13", "Fig. 13", "SubMas-RL and the expert on all tasks",
            "Return and success of both on the five tasks of the chain, 1000 episodes each.", "fig13"),
)  # fmt: skip
NAMES: Final = {section.name: section for section in SECTIONS}
SCORED: Final[tuple[Item, ...]] = ("table4", "fig8", "fig9", "fig12", "fig13")
"""Items with points, in the paper's order."""
STATE_HINTS: Final = {
    "code": "read from the code", "done": "complete", "part": "some of it is run", "none": "not run yet",
}  # fmt: skip


def contents(results: Results) -> list[dict[str, Any]]:
    """Entries of the list of contents."""
    items = []
    for section in SECTIONS:
        state = _state(section, results)
        items.append(
            {"name": section.name, "title": section.title, "sub": section.about, "state": state,
             "hint": f"{section.title}, {section.about}: {STATE_HINTS[state]}"}
        )  # fmt: skip
    return items


def overview_blocks(results: Results) -> list[Block]:
    """The scorecard of everything: how many points hold, then every point."""
    scored = {item: points_of(item, results.sets.get(item)) for item in SCORED}
    counts = Counter(point["verdict"] for points in scored.values() for point in points)
    tiles = [
        {"t": str(counts[verdict]), "sub": label, "verdict": verdict}
        for verdict, label in (
            ("yes", "points hold"), ("no", "do not hold"), ("undecided", "are undecided"),
            ("–", "have nothing to judge"), ("", "are not run yet"),
        )
        if counts[verdict] or verdict in ("yes", "no", "")
    ]  # fmt: skip
    blocks: list[Block] = [{"kind": "tiles", "tiles": tiles}]
    blocks.append(
        words(
            f"Tables 1 and 3 are the paper's; of Table 2 the profile fast changes {differing_settings()} numbers, each "
            "with its reason. The simulator is our own, so absolute returns and times compare only roughly. "
            "“Undecided” means that intervals leave both possible.",
            "quiet",
        )
    )
    for item, points in scored.items():
        section = NAMES[item]
        blocks.append({**heading(section.title, section.about), "section": item})
        blocks.append({"kind": "points", "points": points})
    return blocks


def _state(section: Section, results: Results) -> str:
    if section.item is None:
        return "code"
    result: ResultSet | None = results.sets.get(section.item)
    if result is None or not (result.numbers or result.curves or result.flights):
        return "none"
    if section.name in ("fig10", "fig11"):
        return "done" if result.replays else "none"
    return "done" if complete(result) else "part"
