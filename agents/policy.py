"""Policies: anything that turns observations into actions, and the network policy that training makes.

Nothing here needs torch: a trained policy is three matrix products, and pages and commands start faster so.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from functools import cache
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, Final, Protocol

import numpy as np
from threadpoolctl import threadpool_limits

from agents.features import ObservationFeatures, adapt, subtask_number, unseen_subtasks
from agents.task import FloatArray, Layout, SubtaskTask
from sim.errors import UsageError

if TYPE_CHECKING:
    from agents.checkpoint import PolicyCard

Act = Callable[[FloatArray], FloatArray]
"""Observations `[B, d]` of one known task -> actions `[B, 1]` [rad]."""
Bend = Callable[[FloatArray], FloatArray]

ACTIVATIONS: Final[Mapping[str, Bend]] = MappingProxyType(
    {"relu": lambda x: np.maximum(x, 0.0, out=x), "tanh": lambda x: np.tanh(x, out=x)}
)
"""What a network does to its hidden layers, in place, by name."""
SQUASHES: Final[Mapping[str, Bend]] = MappingProxyType({"tanh": np.tanh, "clip": lambda x: np.clip(x, -1.0, 1.0)})
"""How a network's output becomes a share of the action limit, by name."""

ROWS: Final = 48
"""Observations are filled up to a multiple of this: a matrix product of few or odd rows is summed in another order, and
one rounding more is enough that a missile passes 50 m further away. So a flight is the same in a batch of any size.
OpenBLAS takes 16 rows at a time with AVX-512 and 24 without; both divide this."""
BLOCK: Final = 240
"""Of so many rows, a multiple of ROWS, a hidden layer stays in the cache: a thousand take a third of the time."""


class PolicyError(UsageError):
    """A policy cannot be used the way it was asked to be."""


class Policy(Protocol):
    """A deterministic or random rule that flies."""

    @property
    def name(self) -> str:
        """Name in commands, tables and figures."""
        ...

    @property
    def layout(self) -> Any:
        """Layout it was trained with, None if it reads any; `act` takes every layout within it."""
        ...

    def act(self, observation: FloatArray, layout: Any) -> FloatArray:
        """Actions `[B, 1]` [rad] for observations `[B, d]` of this layout."""
        ...


def bind(policy: Policy, task: SubtaskTask) -> Act:
    """The policy as a function of the task's own observations `[B, d]` -> `[B, 1]`.

    A policy that knows more subtasks than the task has sees the missing ones as never detected.

    Raises:
        PolicyError: the task has subtasks that the policy was never trained with.
    """
    layout = task.layout
    if policy.layout is not None:
        check_sees(policy.name, policy.layout, layout)
    return lambda observation: policy.act(observation, layout)


def check_sees(name: str, known: Layout, present: Layout) -> None:
    """Raise `PolicyError` if a policy with layout `known` is blind to a subtask of layout `present`."""
    blind = unseen_subtasks(known, present)
    if not blind:
        return
    trained = sorted({subtask_number(column) for column in known.names} - {0})
    raise PolicyError(
        f"policy '{name}' was trained with {_missiles(trained)} and cannot see {_missiles(blind)} of this "
        f"task; mask {'it' if len(blind) == 1 else 'them'} (--mask {','.join(map(str, blind))})"
    )


def _missiles(numbers: Sequence[int]) -> str:
    if not numbers:
        return "no missile"
    return f"missile{'s' if len(numbers) > 1 else ''} {', '.join(map(str, numbers))}"


@cache
def leave_products_whole() -> None:
    """From now on no thread of this process shares a matrix product of NumPy's with others.

    They are too small to gain by it: on a machine that trains at the same time, threads wait for each other, 15 ms a
    step instead of 0.05 ms. And where a product is cut depends on its rows, so that a flight would not be the same in
    a batch of any size.
    """
    threadpool_limits(limits=1, user_api="blas")


class NetworkPolicy:
    """A ReLU network with a tanh output, the deterministic policy μ_θ of Eq. 3; PPO's has other bends."""

    def __init__(
        self,
        name: str,
        features: ObservationFeatures,
        layers: Sequence[tuple[FloatArray, FloatArray]],
        action_limit: float,
        card: PolicyCard | None = None,
        *,
        activation: str = "relu",
        squash: str = "tanh",
    ) -> None:
        """Layers are (weight `[out, in]`, bias `[out]`) pairs, first to last; bends are of ACTIVATIONS and SQUASHES."""
        self.name = name
        self.features = features
        self.layers = tuple(layers)
        self.action_limit = action_limit
        self.card = card
        self.activation, self.squash = activation, squash
        self._weights = [(np.ascontiguousarray(weight.T), bias) for weight, bias in self.layers]
        leave_products_whole()

    @property
    def layout(self) -> Layout:
        """Layout the policy was trained with."""
        return self.features.layout

    def act(self, observation: FloatArray, layout: Layout) -> FloatArray:
        """Actions `[B, 1]` [rad] for observations `[B, d]` of any layout within the policy's own."""
        if layout is not self.layout and layout.names != self.layout.names:
            check_sees(self.name, self.layout, layout)
            observation = adapt(observation, layout, self.layout, self.features.default_block)
        return self.act_on_features(self.features.encode(observation))

    def act_on_features(self, hidden: FloatArray) -> FloatArray:
        """Actions `[B, 1]` [rad] for encoded observations `[B, f]`."""
        count, width = hidden.shape
        if count % ROWS:
            hidden = np.concatenate([hidden, np.zeros((-count % ROWS, width), hidden.dtype)])
        actions = np.empty((len(hidden), 1), hidden.dtype)
        for begin in range(0, len(hidden), BLOCK):
            actions[begin : begin + BLOCK] = self._forward(hidden[begin : begin + BLOCK])
        return actions[:count] * np.float32(self.action_limit)

    def _forward(self, hidden: FloatArray) -> FloatArray:
        activate, squash = ACTIVATIONS[self.activation], SQUASHES[self.squash]
        for weight, bias in self._weights[:-1]:
            hidden = hidden @ weight
            hidden += bias
            activate(hidden)
        weight, bias = self._weights[-1]
        return squash(hidden @ weight + bias)
