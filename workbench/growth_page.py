"""The measured part of `docs/growth.md`: tables of what `growth` measured, and what 10, 100, 1000 machines would do."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Final

from workbench.growth import GrowthFigures
from workbench.run_files import write_bytes
from workbench.terminal import duration

BLOCK: Final = "<!-- growth -->\n"
END: Final = "\n<!-- end -->"
MACHINES: Final = (1, 10, 100, 1000)
EVALUATION_RUNS: Final = 230
"""Trainings of the paper's evaluation (§4)."""
SWEEP_RUNS: Final = 10_000
STAGES: Final = 4
USUAL_SHARE: Final = 0.5
"""Share of its epochs that a training is taken to need: a stage ends as soon as it is learned."""
LOOKS_PER_S: Final = 2.0
"""How often a node asks the head, see `cluster.run_agent.LOOK_S`."""


@dataclass(frozen=True)
class Fleet:
    """So many machines like this one."""

    machines: int
    at_once: int
    evaluation_s: float
    """The paper's evaluation."""
    sweep_s: float
    """Ten thousand trainings."""
    questions_share: float
    """Share of what the head answers."""
    streamed_mb_per_s: float
    """What would come to the head if every epoch's checkpoint were streamed."""


def fleet(figures: GrowthFigures, machines: int, cores: int) -> Fleet:
    """A worked estimate; a training needs one core, and no longer than the slowest is ever worked."""
    best = max(case.updates_per_s / min(case.seeds, cores) for case in figures.seeds if case.seeds <= cores)
    epoch_s = figures.cost.updates_per_epoch / best
    run_s = STAGES * figures.cost.epochs * USUAL_SHARE * epoch_s
    at_once = machines * cores
    return Fleet(
        machines, at_once,
        evaluation_s=run_s * -(-EVALUATION_RUNS // at_once),
        sweep_s=run_s * -(-SWEEP_RUNS // at_once),
        questions_share=LOOKS_PER_S * min(at_once, SWEEP_RUNS) / figures.head.questions_per_s,
        streamed_mb_per_s=min(at_once, SWEEP_RUNS) * figures.cost.checkpoint_mb_per_epoch / epoch_s,
    )  # fmt: skip


def markdown(figures: GrowthFigures, cores: int, load: float) -> str:
    """The tables."""
    return "\n\n".join(_parts(figures, cores, load))


def _parts(figures: GrowthFigures, cores: int, load: float) -> Iterator[str]:
    busy = "" if load < 0.5 * cores else ", so **the machine was busy with other work**: on an idle one all is faster"
    yield f"Measured by `workbench bench growth` on {cores} cores; the load before it was {load:.1f}{busy}."
    yield "### Lanes, missiles, substeps"
    yield _table(
        ("lanes", "missiles flying", "substeps", "one step", "per lane"),
        [(f"{c.lanes}", f"{c.missiles_flying}", f"{c.substeps}", f"{c.step_us:,.0f} µs",
          f"{1e3 * c.step_us / c.lanes:,.0f} ns") for c in figures.steps],
    )  # fmt: skip
    yield f"A lane takes {figures.memory_bytes_per_lane:,.0f} bytes."
    yield "### Seeds side by side"
    alone = figures.seeds[0].updates_per_s
    yield _table(
        ("seeds at once", "updates/s together", "against one", "memory of each"),
        [(f"{c.seeds}", f"{c.updates_per_s:,.0f}", f"{c.updates_per_s / alone:.2f} ×", f"{c.memory_mb:,.0f} MB")
         for c in figures.seeds],
    )  # fmt: skip
    yield "### Runs in a folder"
    yield _table(
        ("runs", "index, first look", "next look", "`workbench runs`"),
        [(f"{c.runs:,}", f"{c.first_look_s:.2f} s", f"{c.next_look_s:.3f} s", f"{c.list_s:.2f} s")
         for c in figures.runs],
    )  # fmt: skip
    yield "### The head of a cluster"
    head, cost = figures.head, figures.cost
    yield _table(
        ("what", "measured"),
        [("questions whether a run is to stop", f"{head.questions_per_s:,.0f} a second"),
         ("rows of metrics, each on the disk", f"{head.rows_per_s:,.0f} a second"),
         ("checkpoints, each on the disk", f"{head.mb_per_s:,.0f} MB/s"),
         ("an epoch of `fast`, streamed", f"{cost.checkpoint_mb_per_epoch:.1f} MB"),
         ("experience a checkpoint of `fast` holds at most", f"{cost.replay_mb:,.0f} MB")],
    )  # fmt: skip
    yield "### 10, 100 and 1000 such machines"
    yield _table(
        ("machines", "trainings at once", f"{EVALUATION_RUNS} trainings", f"{SWEEP_RUNS:,} trainings",
         "head: share of questions", "head: if every epoch is streamed"),
        [(f"{f.machines:,}", f"{f.at_once:,}", duration(f.evaluation_s), duration(f.sweep_s),
          f"{f.questions_share:.1%}", f"{f.streamed_mb_per_s:,.0f} MB/s")
         for f in (fleet(figures, machines, cores) for machines in MACHINES)],
    )  # fmt: skip


def _table(columns: Sequence[str], rows: Sequence[Sequence[str]]) -> str:
    lines = (columns, ["---"] * len(columns), *rows)
    return "\n".join("| " + " | ".join(line) + " |" for line in lines)


def refresh(document: Path, text: str) -> bool:
    """Write the measured part of the document anew; False where there is no document."""
    if not document.is_file():
        return False
    before, rest = document.read_text(encoding="utf-8").split(BLOCK)
    write_bytes(document, f"{before}{BLOCK}{text}{END}{rest.split(END, 1)[1]}".encode())
    return True
