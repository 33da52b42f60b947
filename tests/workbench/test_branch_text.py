"""A branch in an address: what is written is read again, and nothing else gets in."""

from __future__ import annotations

import base64

import numpy as np
import pytest

from workbench.branch import Branch, BranchError
from workbench.branch_text import branch_text, read_branch

POLICIES = ["expert-dragging", "submas-target"]
MAX_STEPS = 1200


def test_a_policys_branch_reads_like_a_sentence() -> None:
    branch = Branch("A", 431, (), "expert-dragging")
    assert branch_text(branch) == "A,431,expert-dragging"
    assert read_branch("A,431,expert-dragging", POLICIES, MAX_STEPS) == branch


@pytest.mark.parametrize("policy", ["", "submas-target"])
@pytest.mark.parametrize("headings", [(0,), (359,) * 129, (5, 5, 6) * 40, (90,) * 1000, tuple(range(360))])
def test_what_is_written_is_read_again(policy: str, headings: tuple[int, ...]) -> None:
    branch = Branch("B", 17, headings, policy)
    assert read_branch(branch_text(branch), POLICIES, MAX_STEPS) == branch


def test_the_longest_branch_by_hand_is_short_enough_for_an_address() -> None:
    draws = np.random.default_rng(0).integers(0, 360, MAX_STEPS)
    branch = Branch("A", 0, tuple(int(d) for d in draws))
    assert len(branch_text(branch)) < 3300
    assert read_branch(branch_text(branch), POLICIES, MAX_STEPS) == branch


def _by_hand(*words: int) -> str:
    packed = b"".join(word.to_bytes(2, "big") for word in words)
    return "A,5,by-hand." + base64.urlsafe_b64encode(packed).decode().rstrip("=")


@pytest.mark.parametrize(
    "text",
    [
        "", "A", "A,5", "A,5,", "C,5,expert-dragging", "a,5,expert-dragging", "A,-1,expert-dragging",
        "A,1e3,expert-dragging", "A,²,expert-dragging", "A,1200,expert-dragging", "A,99999999999,expert-dragging",
        "A,5,nobody", "A,5,/etc/passwd", "A,5,<script>", "A,5,expert-dragging,expert-dragging",
        "A,5,by-hand.", "A,5,by-hand.!!!!", "A,5,by-hand.AAA=", "A,5,by-hand.AAAA", "A,5,by-hand.A",
        "A,5,by-hand.AAA,nobody", "A,5,by-hand.AAA,expert-dragging,x", "A,5,by-hand." + "A" * 100_000,
        _by_hand(360), _by_hand(511), _by_hand(*([0xFE00] * 10)), _by_hand(*([0] * 1196)),
    ],
)  # fmt: skip
def test_anything_else_is_refused_in_one_short_sentence(text: str) -> None:
    with pytest.raises(BranchError) as refused:
        read_branch(text, POLICIES, MAX_STEPS)
    sentence = str(refused.value)
    assert len(sentence) < 260
    assert "\n" not in sentence


def test_any_text_is_read_or_refused() -> None:
    draws = np.random.default_rng(1)
    alphabet = np.array(list("AB,0159by-hand.expert-dragging_=%<é\x00"))
    for _ in range(3000):
        text = "".join(draws.choice(alphabet, draws.integers(0, 40)))
        try:
            read_branch(text, POLICIES, MAX_STEPS)
        except BranchError:
            continue
        assert text.startswith(("A,", "B,"))
