"""The lineage of a run: which policy guided its first stage, its stages one guiding the next, and whom it guided."""

from __future__ import annotations

import re
from collections.abc import Mapping
from typing import Any

from layouts.run_lineage import Link, lineage
from layouts.theme import NEUTRAL, POLICY_A, SUCCESS
from sim.errors import SubMasError, shorten
from workbench.pages.address import search
from workbench.pages.live_promotion import never_promotes
from workbench.policies import EXPERTS, SHIPPED_LABELS, natural_guide
from workbench.run_folder import RUN_ID
from workbench.run_index.index import RunIndex
from workbench.run_index.query import RunSearch
from workbench.run_index.record import RunRecord
from workbench.runs import Run
from workbench.stages import end_of, promoted, summarise
from workbench.terminal import percent

MOST_ANCESTORS = 8
MOST_GUIDED = 12


def lineage_of(run: Run, record: RunRecord, index: RunIndex) -> str:
    """HTML of a run's lineage. Reads its metrics: not for the event loop."""
    return lineage(_before(run, index), _stages(run), _after(record, index))


def _before(run: Run, index: RunIndex) -> list[Link]:
    """The guides before the run, the first one first."""
    links: list[Link] = []
    guide, seen = _guide(run), {run.id}
    while guide and len(links) < MOST_ANCESTORS:
        found = RUN_ID.search(guide)
        record = index.get(found[0]) if found else None
        if record is None or record.id in seen:
            links.append(Link(_words(guide), "guides the first stage" if not links else "guide"))
            break
        seen.add(record.id)
        links.append(_run_link(record))
        guide = record.guide
    return links[::-1]


def _guide(run: Run) -> str:
    try:
        return run.config.guide or natural_guide(run.config)
    except SubMasError:
        return ""


def _words(guide: str) -> str:
    return EXPERTS.get(guide) or SHIPPED_LABELS.get(guide) or shorten(guide, 60)


def _run_link(record: RunRecord) -> Link:
    words = " · ".join(filter(None, [record.task, "in the trash" if record.trashed else percent(record.success)]))
    return Link(shorten(record.title, 40), words, "/runs" + search({"run": record.id}), POLICY_A)


def _stages(run: Run) -> list[Link]:
    try:
        learned, events = summarise(run.metrics()), run.events()
        never = never_promotes(run.config.hyperparameters)
    except (SubMasError, KeyError, TypeError):  # rows of another program, or damaged ones
        learned, events, never = [], [], True
    if not learned:
        return [Link("no stage yet", ink=NEUTRAL, here=True)]
    return [_stage_link(stage, None if never else end_of(events, str(stage["task"]))) for stage in learned]


def _stage_link(stage: Mapping[str, Any], end: Mapping[str, Any] | None) -> Link:
    """A stage; grey if it ended without having passed."""
    words = [percent(stage["success_rate"]), f"{stage['epochs']} epochs"]
    failed = end is not None and not promoted(end)
    words += ["not passed"] if failed else []
    return Link(str(stage["task"]), " · ".join(words), ink=NEUTRAL if failed else SUCCESS, here=True)


def _after(record: RunRecord, index: RunIndex) -> list[Link]:
    wanted = re.compile(re.escape(record.id))
    guided = [each for each in index.find(RunSearch(record.id, sort="started")) if wanted.search(each.guide)]
    return [_run_link(each) for each in guided[:MOST_GUIDED]]
