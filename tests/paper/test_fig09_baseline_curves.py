"""Fig. 9: SubMas-RL beside TD3, PPO and SAC on the target task, and what SubMas-RL had flown before."""

from __future__ import annotations

from pathlib import Path

from layouts.paper_curves import baseline_figure
from layouts.paper_inks import ink
from layouts.paper_panels import Panel
from tests.paper.test_fig08_ablation_curves import band, lines_of, texts
from tests.workbench.reproduce.samples import made
from workbench.reproduce.pictures import draw
from workbench.reproduce.scorecard import complete, scorecard

ALGORITHMS = ("submas", "td3", "ppo", "sac")


def test_four_algorithms_share_two_panels() -> None:
    bands = tuple(band(algorithm, 0.2 * place) for place, algorithm in enumerate(ALGORITHMS))
    figure = baseline_figure(Panel("target task", bands, bands), "the caption")
    assert len(figure.axes) == 2
    assert all(lines_of(figure.axes[0], algorithm) for algorithm in ALGORITHMS)
    assert [text.get_text() for text in figure.legends[0].get_texts()] == ["SUBMAS", "TD3", "PPO", "SAC"]
    assert "the caption" in texts(figure)


def test_all_four_can_be_told_apart() -> None:
    assert len({ink(algorithm) for algorithm in ALGORITHMS}) == 4


def test_it_is_drawn_from_a_result_set(tmp_path: Path) -> None:
    assert draw(made("fig9"), tmp_path / "fig9.png")
    assert (tmp_path / "fig9.png").read_bytes().startswith(b"\x89PNG")


def test_the_steps_of_the_easier_tasks_are_told() -> None:
    # SubMas-RL has not learned the target task in fewer steps because its chain is not counted.
    notes = scorecard("fig9", made("fig9")).notes
    assert any("all its tasks together, median in millions: SubMas-RL 3.28, TD3 3.28" in note for note in notes)


def test_it_is_complete_with_every_seed_of_every_algorithm() -> None:
    assert complete(made("fig9", seeds=2))
    assert not complete(made("fig9", seeds=2, without=("sac",)))
    assert any("SAC 0" in note for note in scorecard("fig9", made("fig9", without=("sac",))).notes)
