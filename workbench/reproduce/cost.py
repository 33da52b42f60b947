"""What a reproduction would still cost here: the trainings that are missing, and how long they and the flying take."""

from __future__ import annotations

from dataclasses import dataclass

from workbench.launcher import cpu_count
from workbench.reproduce.eta import TYPICAL_EVALUATION_S, left_s, training_s
from workbench.reproduce.matching import matching_runs, training_key
from workbench.reproduce.plan import Plan
from workbench.reproduce.provenance import provenance
from workbench.runs import RunStore


@dataclass(frozen=True)
class Cost:
    """An estimate; trainings of the fast profile that are learned early cost less."""

    trainings: int
    """Trainings the plan asks for."""
    there: int
    """Those that the runs folder already has."""
    under_way: int
    """Those that train or wait now, whoever started them."""
    evaluations: int
    left_s: float
    """Time until all is done [s]."""


def cost(plan: Plan, store: RunStore) -> Cost:
    """The cost of one item with what is in this runs folder; reads the runs, so not for a server's event loop."""
    runs = store.list() if plan.trainings else []
    configs = {training_key(config): config for config in plan.trainings}
    found = matching_runs(store, configs, provenance().scenario_digest) if plan.trainings else {}
    there = {key for key, run in found.items() if run.state.state == "finished"}
    under_way = sum(run.state.active for run in found.values())
    times: dict[str, float] = {}
    for key, config in configs.items():
        if key not in there and config.variant not in times:
            times[config.variant] = training_s(config, runs)
    needs = [times[config.variant] for key, config in configs.items() if key not in there]
    cores = cpu_count()
    flying_s = len(plan.wanted) * TYPICAL_EVALUATION_S * plan.episodes / 1000 / (1 if needs else cores)
    return Cost(len(configs), len(there), under_way, len(plan.wanted), left_s(needs, cores, flying_s))
