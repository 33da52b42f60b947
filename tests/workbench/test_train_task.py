"""`workbench train` names any task and any order; what is not one is a sentence."""

from __future__ import annotations

import pytest

from agents.config import TrainingConfig
from sim.errors import SubMasError
from workbench.commands.train import Args, configuration
from workbench.policies import guide_for, natural_guide, title


def test_mask_and_order_reach_the_configuration() -> None:
    assert configuration(Args(mask="1,3"), 0) == TrainingConfig(mask="1,3")
    chain = configuration(Args(curriculum=True, mask="1", order="2,4,3"), 5)
    assert chain == TrainingConfig(curriculum=True, mask="1", order="2,4,3", seed=5)
    assert title(chain) == "Curriculum to missiles 2, 3, 4 in order 2, 4, 3 · submas · fast · seed 5"


@pytest.mark.parametrize(
    ("args", "sentence"),
    [
        (Args(mask="7"), "mask names missile 7; legal are 1 to 4"),
        (Args(order="4,3,2,1"), "a single stage has none"),
        (Args(curriculum=True, order="1,2"), "each of the missiles 1,2,3,4 once"),
        (Args(missiles=2, mask="3"), "legal are 1 to 2"),
    ],
)
def test_what_is_no_task_is_a_usage_error(args: Args, sentence: str) -> None:
    with pytest.raises(SubMasError, match=sentence) as caught:
        configuration(args, 0)
    assert caught.value.exit_code == 2


@pytest.mark.parametrize(
    ("mask", "guide"),
    [("", "submas-source-1"), ("3", "submas-source-2"), ("2,4", "submas-source-3"), ("1,2,4", "expert-navigation"),
     ("1", "")],
)  # fmt: skip
def test_a_stage_is_guided_by_a_shipped_policy_with_one_missile_less(mask: str, guide: str) -> None:
    assert natural_guide(TrainingConfig(mask=mask)) == guide


def test_a_task_that_no_shipped_policy_can_guide_says_what_to_do() -> None:
    with pytest.raises(SubMasError, match="a training with 2, 3, 4; choose one with --guide, or train the whole chain"):
        guide_for(TrainingConfig(mask="1"))
    assert guide_for(TrainingConfig(mask="1", guide="expert-navigation")).name == "expert-navigation"
