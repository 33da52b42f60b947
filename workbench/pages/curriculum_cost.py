"""What a launch trains and what it costs, in words."""

from __future__ import annotations

import html
from collections.abc import Sequence

from agents.config import VARIANTS, TrainingConfig
from workbench.estimate import Estimate, Speed
from workbench.launcher import cpu_count
from workbench.scenarios import other_scenario

ALGORITHMS = {"td3": "", "sac": " with SAC", "ppo": " with PPO"}


def what_words(configs: Sequence[TrainingConfig], first_guide: str) -> str:
    """What will be trained, as HTML. `first_guide` guides the first stage of whoever has a guide."""
    variants = {config.variant: None for config in configs}
    seeds = {config.seed: None for config in configs}
    count = len(configs)
    product = f": {len(variants)} variants × {len(seeds)} seed{'s' * (len(seeds) > 1)}" if len(variants) > 1 else ""
    where = f" on <b>{html.escape(elsewhere)}</b>" if (elsewhere := other_scenario(configs[0].scenario)) else ""
    parts = [f"<b>{count} run{'s' * (count > 1)}</b>{product}{where}"]
    guided = [config for config in configs if VARIANTS[config.variant].guided]
    alone = next((config for config in configs if not VARIANTS[config.variant].guided), None)
    if guided:
        parts.append(f"{_stages(guided[0])}, guided by <b>{html.escape(first_guide)}</b>")
    if alone:
        parts.append(f"{'from scratch: ' * bool(guided)}{_stages(alone)}, without a guide")
    return "; ".join(parts) + "."


def _stages(config: TrainingConfig) -> str:
    count = len(config.stages)
    return f"{count} stage{'s' * (count > 1)} of at most {config.hyperparameters.epochs} epochs"


def cost_words(cost: Estimate, runs: int) -> str:
    """How long it takes, as HTML."""
    if cost.likely_s is None:
        time = f"At most <b>{long(cost.at_most_s)}</b>"
    else:
        time = f"About <b>{long(cost.likely_s)}</b>, at most {long(cost.at_most_s)}"
    together = f" for all {runs}" if runs > 1 else ""
    at_once = f"; {cost.at_once} at once on {cpu_count()} cores" if runs > 1 else ""
    return f"{time}{together}{at_once}."


def source_words(cost: Estimate) -> str:
    """Where the speeds come from, as HTML."""
    said = [_source(*kind, speed) for kind, speed in (cost.speeds or {}).items()]
    return " ".join(said)


def _source(profile: str, algorithm: str, speed: Speed) -> str:
    epoch = f"{speed.epoch_s:.1f} s an epoch ({profile}{ALGORITHMS[algorithm]})"
    if speed.source == "runs":
        return f"{epoch}, measured in {speed.runs} earlier run{'s' * (speed.runs > 1)} on this machine."
    if speed.source == "probe":
        return f"{epoch}, measured on this machine on {html.escape(speed.when)}: processor time of a part of an epoch."
    return f"{epoch}: typical of a desktop machine, <b>not measured on this one yet</b>."


def long(seconds: float) -> str:
    """A duration as a person says it."""
    if seconds < 90:
        return f"{seconds:.0f} s"
    return f"{seconds / 60:.0f} min" if seconds < 5400 else f"{seconds / 3600:.1f} h"
