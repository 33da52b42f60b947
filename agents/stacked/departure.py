"""An agent out of its stack: the very training by itself, which goes on where the stacked one stood.

So a stacked training is saved like any other, and what was interrupted on a GPU can be resumed on a laptop. From there
on it draws other random numbers than the stack would have.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np
import torch
from torch import Tensor, nn

from agents.layers import Layer, layers_of
from agents.networks import Critic
from agents.replay import SCALARS
from agents.resume import take_snapshot
from agents.snapshot import Snapshot
from agents.stacked.learner import StackedTd3
from agents.stacked.replay import StackedReplay
from agents.stacked.stack import Stack
from agents.stage import Stage
from agents.task import FloatArray, IntArray
from agents.td3_fast import FastTd3
from agents.training_state import TrainingState


def snapshot_of(stage: Stage, state: TrainingState, stack: Stack, place: int) -> Snapshot:
    """The training of one agent at the end of an epoch, as `agents.resume.take_snapshot` takes it of one by itself."""
    lanes, layout = stack.lanes, stage.task.layout
    names = stack.encoder.features.layout.names
    columns = stack.encoder.columns(stage.domain.features(layout))
    alone = dataclasses.replace(
        state,
        learner=learner_of(stack.learner, place, columns, stage),
        replay=OwnReplay(stack.replay, place, columns),
        world=stack.worlds.worlds[place],
        observation=_array(lanes.observation[place])[:, [names.index(name) for name in layout.names]],
        features=_array(lanes.features[place])[:, columns],
        reused=_array(lanes.reused[place]),
        noise=_array(lanes.noise[place]),
        restarted=_array(lanes.restarted[place]),
        lane_return=_array(lanes.episode_return[place]),
        generator=np.random.default_rng([stage.seed, state.epoch]),
    )
    return take_snapshot(stage, alone)


@dataclass(frozen=True)
class OwnReplay:
    """One agent's stored transitions in the columns of its own task, by time slot."""

    replay: StackedReplay
    place: int
    columns: IntArray

    @property
    def added(self) -> int:
        """Time slots stored so far."""
        return int(self.replay.added[self.place])

    def blocks(self, first: int) -> Iterator[tuple[int, FloatArray]]:
        """Blocks of consecutive slots from number `first` on, oldest first: number of the first slot, rows."""
        f = self.replay.features
        kept = np.concatenate((self.columns, np.arange(f, f + SCALARS), f + SCALARS + self.columns))
        for number, rows in self.replay.blocks(self.place, first):
            yield number, np.ascontiguousarray(rows[:, kept])


@torch.no_grad()
def learner_of(stack: StackedTd3, place: int, columns: IntArray, stage: Stage) -> FastTd3:
    """A learner by itself with one agent's networks, moments and counts."""
    alone = FastTd3(len(columns), stack.hyper, stack.action_limit, stage.seed)
    for module, flat in (
        (alone.actor, stack.actor.values),
        (alone.target_actor, stack.target_actor),
        (alone.average_actor, stack.average_actor),
        (alone.critics, stack.critics.values),
        (alone.target_critics, stack.target_critics),
    ):
        _fill(module, flat[place], stack, columns)
    for optimizer, module, group in (
        (alone.actor_optimizer, alone.actor, stack.actor),
        (alone.critic_optimizer, alone.critics, stack.critics),
    ):
        if float(group.steps[place, 0]):
            moments = {"exp_avg": group.mean, "exp_avg_sq": group.square}
            state: dict[str, Any] = {name: _flat(module, flat[place], stack, columns) for name, flat in moments.items()}
            (parameter,) = optimizer.param_groups[0]["params"]
            optimizer.state[parameter] = {"step": group.steps[place, 0].cpu().clone(), **state}
    alone.updates = int(stack.updates[place])
    return alone


def _fill(module: nn.Module, rows: Tensor, stack: StackedTd3, columns: IntArray) -> None:
    """Write rows `[twins, P]` into an actor or twin critics."""
    actor = len(rows) == 1
    layers = layers_of(rows.cpu(), (stack.actor if actor else stack.critics).shape)
    inputs = [*columns] if actor else [*columns, stack.features]
    if actor:
        _fill_network(module, layers, 0, inputs)
        return
    for twin, critic in enumerate(module.children()):
        _fill_network(critic, layers, twin, inputs)


def _fill_network(module: nn.Module, layers: list[Layer], index: int, inputs: list[int]) -> None:
    linear = [one for one in module.modules() if isinstance(one, nn.Linear)]
    for number, (layer, one) in enumerate(zip(layers, linear, strict=True)):
        weight = layer.weight[index]
        one.weight.copy_((weight if number else weight[inputs]).t())
        one.bias.copy_(layer.bias[index, 0])
    if isinstance(module, Critic):
        for layer, norm in zip(layers, module.norms or (), strict=False):
            assert isinstance(norm, nn.LayerNorm) and layer.scale is not None and layer.shift is not None
            norm.weight.copy_(layer.scale[index, 0])
            norm.bias.copy_(layer.shift[index, 0])


def _flat(like: nn.Module, rows: Tensor, stack: StackedTd3, columns: IntArray) -> Tensor:
    """Moments `[twins, P]` in the order in which `FastTd3` keeps its flat parameters."""
    fresh = FastTd3(len(columns), stack.hyper, stack.action_limit, 0)
    actor = len(rows) == 1
    module, flat = (fresh.actor, fresh.flat_actor) if actor else (fresh.critics, fresh.flat_critics)
    assert type(module) is type(like)
    _fill(module, rows, stack, columns)
    return flat.values.detach().clone()


def _array(values: Tensor) -> Any:
    return values.cpu().numpy().copy()
