"""The simulator read where its arrays lie is the simulator; on the processor, and on a GPU where there is one."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest
import torch

from agents.config import VARIANTS, TrainingConfig
from agents.evasion import EVASION
from agents.expert import NavigationExpert
from agents.hyperparameters import SMOKE
from agents.stacked.warp_worlds import WarpWorlds, on_torchs_stream
from agents.stacked.worlds import HostWorlds
from agents.stage import Stage
from sim.task import Task, task_for
from sim.world import Outcome

LANES, STEPS = 40, 60
DEVICES = [
    "cpu",
    pytest.param(
        "cuda:0",
        marks=[pytest.mark.gpu, pytest.mark.skipif(not torch.cuda.is_available(), reason="no CUDA device here")],
    ),
]


def _stages() -> list[Stage]:
    """Two agents in different stages, with different seeds and different columns."""
    target = task_for()
    tasks = [target, target.mask([2, 4])]
    return [
        Stage(
            task=task,
            source=task.mask(task.missiles[-1:]),
            guide=NavigationExpert(),
            domain=EVASION,
            hyper=SMOKE,
            variant=VARIANTS["submas"],
            config=TrainingConfig(seed=seed),
        )
        for seed, task in enumerate(tasks)
    ]


def _actions(step: int, towards: torch.Tensor) -> torch.Tensor:
    """Exit-bound flights, shaken, so that many things happen."""
    g = torch.Generator().manual_seed(step)
    return (towards + 0.3 * torch.randn(towards.shape, generator=g)).clamp(-1.57, 1.57)[..., None]


@pytest.mark.parametrize("device", DEVICES)
def test_worlds_on_the_device_fly_as_worlds_on_the_host(device: str) -> None:
    layout, where = task_for().layout, torch.device(device)
    host = HostWorlds(EVASION, layout, 2, LANES, torch.device("cpu"))
    ours = WarpWorlds(layout, 2, LANES, where)
    exact = {"rtol": 0.0, "atol": 0.0} if device == "cpu" else {"rtol": 1e-4, "atol": 1e-2}
    ended = truncated = 0
    with on_torchs_stream(where):
        for agent, stage in enumerate(_stages()):
            torch.testing.assert_close(ours.open(agent, stage).cpu(), host.open(agent, stage), **exact)
            _begin_late(ours, host, agent)
        seen = host.restart(np.zeros((2, LANES), bool))
        for number in range(STEPS):
            action = _actions(number, seen[..., 6])
            told, mine = host.step(action), ours.step(action.to(where))
            for field in dataclasses.fields(told):
                expected, found = (getattr(each, field.name).cpu().double() for each in (told, mine))
                tolerance = exact if field.name != "reward" else {"rtol": 1e-6, "atol": 1e-4}
                torch.testing.assert_close(found, expected, **tolerance, msg=lambda t, n=field.name: f"{n}: {t}")
            over = told.over.numpy()
            ended += int(over.sum())
            truncated += int((told.over & ~told.terminated).sum())
            seen = host.restart(over)
            torch.testing.assert_close(ours.restart(over).cpu(), seen, **exact)
    assert ended >= 10 and truncated >= 5
    assert [world.next_episode for world in ours.worlds] == [world.next_episode for world in host.worlds]


def _begin_late(ours: WarpWorlds, host: HostWorlds, agent: int) -> None:
    """Put both worlds into states a few hundred steps into their flights, where missiles fly and episodes end."""
    world = host.worlds[agent]
    for _ in range(280):
        world.step(np.clip(world.observation[:, 6], -1.5, 1.5))
    flying = world.outcome == Outcome.FLYING
    assert flying.any()
    lane = int(np.flatnonzero(flying)[0])
    state = {name: np.where(_wide(flying, array), array, array[lane]) for name, array in world.state().items()}
    state["steps"][::5] = world.task.scenario.rules.max_steps - 20  # some come to the step limit
    ours.worlds[agent].restore(state)
    host._see(agent, world.restore(state))


def _wide(flying: np.ndarray, array: np.ndarray) -> np.ndarray:
    return flying.reshape(-1, *[1] * (array.ndim - 1))


def test_a_masked_missile_shows_the_default_block_to_every_column_of_the_widest_layout() -> None:
    ours = WarpWorlds(task_for().layout, 2, LANES, torch.device("cpu"))
    for agent, stage in enumerate(_stages()):
        seen = ours.open(agent, stage)
        assert seen.shape == (LANES, 15)
    names = task_for().layout.names
    block = seen[:, [names.index("r_2"), names.index("phi_2")]]
    assert torch.equal(block, torch.tensor(EVASION.default_block).expand(LANES, 2))


def test_a_scenario_with_fewer_columns_than_missiles_shows_only_its_own() -> None:
    task = Task(task_for().scenario).mask([3, 4])
    ours = WarpWorlds(task.layout, 1, 16, torch.device("cpu"))
    (_, stage) = _stages()
    assert ours.open(0, dataclasses.replace(stage, task=task)).shape == (16, 11)
