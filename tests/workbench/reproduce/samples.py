"""Result sets made up for tests: everything in its place, numbers as told."""

from __future__ import annotations

from collections.abc import Callable, Sequence

from agents.evaluation import wilson_interval
from workbench.reproduce.plan import make_plan
from workbench.reproduce.protocol import EPISODES, Item
from workbench.reproduce.result_set import (
    Curve,
    Flight,
    MissileCurve,
    Number,
    Replay,
    ReplayMissile,
    ResultSet,
    Training,
)
from workbench.reproduce.seed_counts import SeedCounts

Success = Callable[[str, str, int, str], float]
"""Variant, task, seed and purpose -> success rate."""


def perfect(variant: str, task: str, seed: int, purpose: str) -> float:
    return 1.0


def made(
    item: Item, seeds: int = 10, success: Success = perfect, points: int = 3, without: Sequence[str] = ()
) -> ResultSet:
    """A result set with a number for all that the item asks for, without some algorithms."""
    plan = make_plan(item, "fast", SeedCounts.each(seeds), EPISODES)
    wanted = [one for one in plan.wanted if one.variant not in without]
    numbers = [
        number(one.variant, one.task, one.seed, one.purpose, success(one.variant, one.task, one.seed or 0, one.purpose))
        for one in wanted
    ]
    trainings = [
        Training(
            variant=config.variant, seed=config.seed, state="finished", run=run_id(config.variant, config.seed),
            wall_s=1234.5, cpu_s=987.5, env_steps=3_276_800,
            command=f"workbench train --curriculum --variant {config.variant} --profile fast --seeds {config.seed}",
        )
        for config in plan.trainings
        if config.variant not in without
    ]  # fmt: skip
    steps = tuple(20_480 * (index + 1) for index in range(points))
    curves = [
        Curve(
            variant=one.variant, task=one.task, seed=one.seed or 0, env_steps=steps,
            success_rate=(success(one.variant, one.task, one.seed or 0, "curve"),) * points,
            mean_return=(-123,) * points,
        )
        for one in wanted
        if item in ("fig8", "fig9")
    ]  # fmt: skip
    return ResultSet(
        item=item, profile="fast", scenario="default", scenario_digest="0123456789ab", episodes=EPISODES,
        seeds=tuple(range(seeds)) if plan.trainings else (), command=plan.command, code_version="0.1.0",
        source_digest="ba9876543210", left_out=plan.left_out, trainings=tuple(trainings), numbers=tuple(numbers),
        curves=tuple(curves), replays=tuple(replay(v) for v in ("submas", "expert")) if item == "fig12" else (),
        flights=tuple(flight(variant) for variant in ("submas", "expert")) if item == "fig12" else (),
    )  # fmt: skip


def run_id(variant: str, seed: int | None) -> str:
    return f"20260101-120000-{variant.replace('-', '')[:4]:x<4}{seed or 0:02}"


def number(variant: str, task: str, seed: int | None, purpose: str, success: float, episodes: int = EPISODES) -> Number:
    """A number whose return follows from its success."""
    low, high = wilson_interval(round(success * episodes), episodes)
    run = run_id(variant, seed)
    policy = f"runs/{run}/policies/{task}.safetensors"
    return Number(
        variant=variant, task=task, seed=seed, purpose=purpose, success_rate=success,  # type: ignore[arg-type]
        success_ci95=(round(low, 4), round(high, 4)), mean_return=round(-400.0 + 900.0 * success, 2),
        mean_length_s=1006.7, outcomes={"exit": 900, "shot_down": 50, "left_field": 50},
        episodes=episodes, evaluation_seed=2**46, epochs=64, env_steps=655_360, wall_s=1234.5, run=run, policy="",
        policy_digest="0123456789ab", scenario_digest="0123456789ab",
        command=f"workbench evaluate {policy} --mask 2,3,4 --episodes {episodes} --seed {2**46}",
    )  # fmt: skip


def flight(variant: str, beam_share: float = 0.9) -> Flight:
    """Two missiles; the second wraps from left to right and back."""
    missiles = (
        MissileCurve(number=1, fate="evaded", launch_s=0.0, end_s=3.0, azimuth_deg=(0.0, -90.0, -90.0, -90.0)),
        MissileCurve(number=2, fate="evaded", launch_s=1.0, end_s=3.0, azimuth_deg=(None, 170.0, -170.0, 175.0)),
    )
    return Flight(
        variant=variant, policy="submas-target", seed=2**46, episode=3, outcome="exit", duration_s=900.0,
        beam_share=beam_share, time_s=(0.0, 1.0, 2.0, 3.0), missiles=missiles, scenario_digest="0123456789ab",
        command="workbench reproduce fig12",
    )  # fmt: skip


def replay(variant: str) -> Replay:
    """Three points; missile 2 is fired late and misses, the others never are."""
    missiles = (
        ReplayMissile(number=1, fate="evaded", end_s=8.0, first=0, track_km=((50.0, 0.0), (10.0, 5.0), (0.0, 9.0))),
        ReplayMissile(number=2, fate="evaded", end_s=8.0, first=1, track_km=((40.0, 0.0), (5.0, 5.0))),
    )
    return Replay(
        variant=variant, policy="submas-target", seed=4, outcome="exit", duration_s=900.0, moment_s=4.0,
        field_km=(220.0, 100.0), exit_km=(0.0, 5.0), time_s=(0.0, 4.0, 8.0),
        evader_km=((-100.0, 0.0), (-50.0, 20.0), (110.0, 1.0)), interceptor_km=((90.0, 0.0), (50.0, 0.0), (20.0, 3.0)),
        missiles=missiles, scenario_digest="0123456789ab",
    )  # fmt: skip
