"""`docs/reproduction.md` and the committed result sets: what the page says is what the sets hold, and nothing else."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
from PIL import Image

from tests.workbench.reproduce.samples import made
from workbench.cli import COMMANDS
from workbench.reproduce.document import BLOCK, SHOWN, block, filled, refresh, report
from workbench.reproduce.measurements import shipped_digest
from workbench.reproduce.pictures import source_of
from workbench.reproduce.places import committed_results, document
from workbench.reproduce.protocol import REPORT_SEED, SELECTION_SEED
from workbench.reproduce.result_file import load, save
from workbench.reproduce.scorecard import TITLES

RESULTS = committed_results()
assert RESULTS is not None
PAGE = document().read_text(encoding="utf-8")
SETS = sorted(RESULTS.glob("*/*.json"))


def test_the_page_shows_what_the_committed_result_sets_hold() -> None:
    # After a change: `workbench reproduce` with an item, or only `refresh(document(), committed_results())`.
    assert RESULTS is not None
    assert filled(PAGE, RESULTS, document()) == PAGE


def test_every_item_has_its_block_and_its_heading() -> None:
    assert [item for item, _ in BLOCK.findall(PAGE)] == list(SHOWN)
    for title in TITLES.values():
        assert f"\n## {title}\n" in PAGE


@pytest.mark.parametrize("path", SETS, ids=lambda path: f"{path.parent.name} {path.stem}")
def test_a_committed_result_set_is_sound_and_small(path: Path) -> None:
    result = load(path)
    assert result is not None
    assert (result.item, result.profile) == (path.stem, path.parent.name)
    assert path.stat().st_size < 200_000
    # Figures depend on the simulator: all numbers of one set come from one world.
    assert {number.scenario_digest for number in result.numbers} <= {result.scenario_digest}
    for number in result.numbers:
        assert number.evaluation_seed == (REPORT_SEED if number.purpose == "report" else SELECTION_SEED)
        assert number.episodes == result.episodes
        assert str(number.evaluation_seed) in number.command


@pytest.mark.parametrize("path", SETS, ids=lambda path: f"{path.parent.name} {path.stem}")
def test_a_committed_picture_was_drawn_from_the_committed_set(path: Path) -> None:
    result, picture = load(path), path.with_suffix(".png")
    assert result is not None
    if result.item == "table4":
        assert not picture.exists()
        return
    with Image.open(picture) as image:
        assert image.info["Description"] == source_of(result)
    assert picture.stat().st_size < 200_000


@pytest.mark.parametrize("item", ["fig12", "fig13"])
def test_what_needs_no_training_is_of_the_policies_that_are_shipped(item: str) -> None:
    # Red after new policies were put into assets/policies: run `workbench reproduce fig12` and `fig13` again.
    assert RESULTS is not None
    result = load(RESULTS / "fast" / f"{item}.json")
    assert result is not None
    flown = [(number.policy, number.policy_digest) for number in result.numbers]
    flown += [(flight.policy, flight.policy_digest) for flight in result.flights]
    assert flown
    for policy, digest in flown:
        assert digest == shipped_digest(policy), policy


def test_commands_on_the_page_exist() -> None:
    assert set(re.findall(r"^workbench ([a-z]+)", PAGE, re.MULTILINE)) <= set(COMMANDS)


def test_what_was_not_run_is_said_not_to_be() -> None:
    for item in SHOWN:
        assert f"* Not run yet: `workbench reproduce {item}` runs it." in block(item, None, "results")
    assert "not run yet" in block("table4", made("table4", seeds=2, without=("ppo",)), "results")


def test_a_block_tells_seeds_commands_and_failures() -> None:
    text = block("table4", made("table4", seeds=2, without=("ppo",), success=lambda *_: 0.9), "results")
    assert (
        "Seeds trained, of 2 asked for: SubMas-RL 2, w/oPd 2, w/oPr 2, DecPd 2, DecPr 2, TD3 2, PPO 0, SAC 2." in text
    )
    assert "bootstrap intervals are too narrow" in text
    assert "\nworkbench train --curriculum --variant submas --profile fast --seeds 0,1\n" in text
    # Ids of runs mean nothing elsewhere.
    assert "runs/RUN/policies/target.safetensors" in text and "2026" not in text


def test_blocks_are_replaced_and_the_rest_is_left_alone(tmp_path: Path) -> None:
    page = tmp_path / "docs" / "page.md"
    page.parent.mkdir()
    page.write_text("# Mine\n\n<!-- fig13 fast -->\nwhat it was\n<!-- end -->\n\nKept.\n")
    save(made("fig13"), tmp_path / "results" / "fast" / "fig13.json")
    assert refresh(page, tmp_path / "results")
    text = page.read_text()
    assert text.startswith("# Mine\n\n<!-- fig13 fast -->\n![Fig. 13") and text.endswith("<!-- end -->\n\nKept.\n")
    assert "](../results/fast/fig13.png)" in text and "what it was" not in text
    assert not refresh(page, tmp_path / "results")


def test_a_result_set_that_changes_makes_the_page_untrue(tmp_path: Path) -> None:
    # The control of the first test: it would notice.
    assert RESULTS is not None
    save(made("fig13", success=lambda *_: 0.123), tmp_path / "fast" / "fig13.json")
    assert filled(PAGE, tmp_path, document()) != PAGE


def test_outside_of_a_checkout_there_is_a_report(tmp_path: Path) -> None:
    save(made("fig9"), tmp_path / "smoke" / "fig9.json")
    text = report(tmp_path, "smoke")
    assert "](./fig9.png)" in text
    assert text.count("\n## ") == len(SHOWN)
    assert text.count("* Not run yet") == len(SHOWN) - 1
