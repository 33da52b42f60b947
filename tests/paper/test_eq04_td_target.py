"""Eq. (4): y = r + γ min over both target critics of Q'(s', a')."""

from __future__ import annotations

import torch

from agents.td3 import clipped_double_q, td_target


def test_hand_computed_target() -> None:
    reward = torch.tensor([[1.0], [1.0]])
    discount = torch.tensor([0.9, 0.0])
    first, second = torch.tensor([[10.0], [10.0]]), torch.tensor([[8.0], [12.0]])
    value = clipped_double_q(first, second, torch.tensor([1.0]))
    assert value.tolist() == [[8.0], [10.0]]
    # 1 + 0.9 * 8; after a terminal state comes nothing.
    torch.testing.assert_close(td_target(reward, discount, value), torch.tensor([[8.2], [1.0]]))


def test_two_returns_come_from_the_critic_whose_weighted_sum_is_smaller() -> None:
    first, second = torch.tensor([[5.0, -4.0]]), torch.tensor([[3.0, -1.0]])
    # α = 1: 1 against 2; α = 0: 5 against 3.
    assert clipped_double_q(first, second, torch.tensor([1.0, 1.0])).tolist() == [[5.0, -4.0]]
    assert clipped_double_q(first, second, torch.tensor([1.0, 0.0])).tolist() == [[3.0, -1.0]]
