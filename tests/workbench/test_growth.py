"""The growth page: its estimate is arithmetic on what was measured, and its block is renewed in place."""

from __future__ import annotations

from pathlib import Path

import pytest

from workbench.bench.growth import GrowthCase
from workbench.growth import GrowthFigures, HeadCase, RunCost, RunsCase, SeedsCase
from workbench.growth_page import BLOCK, END, fleet, markdown, refresh

PAGE = Path(__file__).parents[2] / "docs/growth.md"
FIGURES = GrowthFigures(
    steps=[GrowthCase(1024, 4, 20, "cpu", 2048.0)],
    memory_bytes_per_lane=500.0,
    seeds=[SeedsCase(1, 400.0, 300.0), SeedsCase(2, 640.0, 300.0), SeedsCase(4, 640.0, 300.0)],
    runs=[RunsCase(100, 0.5, 0.01, 0.1)],
    head=HeadCase(questions_per_s=1000.0, rows_per_s=200.0, mb_per_s=150.0),
    cost=RunCost(epochs=100, updates_per_epoch=640, checkpoint_mb_per_epoch=10.0, replay_mb=220.0),
)


def test_machines_add_up_until_there_is_nothing_left_to_share() -> None:
    # The best rate of a core is 400 updates/s: an epoch takes 1.6 s, a training 4 · 100 · 0.5 epochs = 320 s.
    one, ten, many = (fleet(FIGURES, machines, cores=2) for machines in (1, 10, 1000))
    assert (one.at_once, one.evaluation_s, one.sweep_s) == (2, 115 * 320.0, 5000 * 320.0)
    assert (ten.evaluation_s, ten.sweep_s) == (12 * 320.0, 500 * 320.0)
    assert (many.evaluation_s, many.sweep_s) == (320.0, 5 * 320.0)
    assert one.questions_share == pytest.approx(2 * 2.0 / 1000.0)
    assert ten.streamed_mb_per_s == pytest.approx(20 * 10.0 / 1.6)


def test_the_block_is_renewed_and_the_rest_of_the_page_stays(tmp_path: Path) -> None:
    page = tmp_path / "growth.md"
    page.write_text(f"before\n{BLOCK}Not run yet.{END}\nafter\n")
    assert refresh(page, markdown(FIGURES, 2, 0.3)) and not refresh(tmp_path / "none.md", "")
    text = page.read_text()
    assert text.startswith("before\n") and text.endswith(f"{END}\nafter\n") and "Not run yet" not in text
    assert "| 1024 | 4 | 20 | 2,048 µs | 2,000 ns |" in text and "| 1,000 | 2,000 |" in text
    assert "busy" not in text and "busy" in markdown(FIGURES, 2, 5.0)


def test_the_page_holds_measured_figures() -> None:
    block = PAGE.read_text(encoding="utf-8").split(BLOCK)[1].split(END)[0]
    assert "Measured by `workbench bench growth`" in block and "| 1,000 |" in block
