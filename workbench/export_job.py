"""Draws an animation for a page: flies what an order on the command line names, and prints how far it is."""

from __future__ import annotations

import json
import sys
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from sim.errors import SubMasError

if TYPE_CHECKING:
    from sim.trajectory import Act, Trajectory
    from workbench.pages.fly_settings import FlySettings


@dataclass(frozen=True)
class Order:
    """What a process of its own shall fly and draw."""

    query: dict[str, str]
    """What the page shows, as its address says it: policies, scenario, mask, initial state."""
    branch: dict[str, Any] | None
    """The branch of one of them, as `Branch` has it; None without one."""
    runs: str
    out: str


def make(order: Order) -> None:
    """Fly what the order names and write the file, saying `done total` on standard output.

    Raises:
        SubMasError: a policy, the scenario or the encoder is not there, or the file cannot be written.
    """
    from workbench.exports import export

    first, *others = flown(order)
    export(first, Path(order.out), *others, update=lambda done, total: print(done, total, flush=True))


def flown(order: Order) -> list[Trajectory]:
    """Both flights from the same initial state, and the branch if there is one; every substep recorded."""
    from agents.policy import bind
    from sim.scenario_file import load_scenario
    from sim.task import Task
    from sim.trajectory import fly
    from workbench.branch import Branch, fly_branch
    from workbench.pages.fly_start import start_of
    from workbench.policies import resolve_policy
    from workbench.runs import RunStore

    settings, store = _settings(order.query), RunStore(Path(order.runs))
    task, state = start_of(Task(load_scenario(settings.scenario), settings.masked), settings)

    def act(spec: str) -> Act:
        return bind(resolve_policy(spec, store), task)

    flights = {
        letter: fly(task, act(spec), spec, settings.seed, settings.episode, state=state)
        for letter, spec in (("A", settings.a), ("B", settings.b))
    }
    if order.branch is None:
        return [*flights.values()]
    branch = Branch(**{**order.branch, "headings_deg": tuple(order.branch["headings_deg"])})
    heir = act(branch.policy) if branch.policy else None
    return [*flights.values(), fly_branch(flights[branch.of], branch, heir, state=state)]


def _settings(query: dict[str, str]) -> FlySettings:
    """What the address asks for; the page has read it before, so that all of it is on offer."""
    from workbench.pages.fly_settings import default_settings, read_settings

    policies = [query["a"], query["b"]]
    settings, problems = read_settings(query, policies, [query.get("scenario", "")], default_settings(policies))
    if problems:
        raise SubMasError(problems[0])
    return settings


def main() -> int:
    """One order as JSON; a failure is one sentence on standard error."""
    try:
        make(Order(**json.loads(sys.argv[1])))
    except SubMasError as error:
        print(error, file=sys.stderr)
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
