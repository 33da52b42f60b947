"""Draws an animation for a page: flies what an order on the command line names, and prints how far it is."""

from __future__ import annotations

import json
import sys
from pathlib import Path
from typing import Any

from sim.errors import SubMasError


def make(order: dict[str, Any]) -> None:
    """Fly both policies from one initial state and write the file, saying `done total` on standard output.

    Raises:
        SubMasError: a policy, the scenario or the encoder is not there, or the file cannot be written.
    """
    from agents.policy import bind
    from sim.scenario_file import load_scenario
    from sim.task import Task
    from sim.trajectory import fly
    from workbench.exports import export
    from workbench.policies import resolve_policy
    from workbench.runs import RunStore

    task, store = Task(load_scenario(order["scenario"]), frozenset(order["masked"])), RunStore(Path(order["runs"]))
    a, b = (fly(task, bind(resolve_policy(order[who], store), task), order[who], order["seed"]) for who in "ab")
    export(a, Path(order["out"]), b, lambda done, total: print(done, total, flush=True))


def main() -> int:
    """One order as JSON; a failure is one sentence on standard error."""
    try:
        make(json.loads(sys.argv[1]))
    except SubMasError as error:
        print(error, file=sys.stderr)
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
