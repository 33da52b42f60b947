"""The address of a page: its query is what a person can share, and never trusted."""

from __future__ import annotations

from urllib.parse import parse_qsl, urlencode

import panel as pn

from sim.errors import ScenarioError
from sim.scenario_file import load_scenario
from workbench.runs import Run
from workbench.scenarios import DEFAULT


def read_query() -> dict[str, str]:
    """Values of the address this session was opened with; the last one where a name occurs twice."""
    return {name: values[-1].decode(errors="replace") for name, values in pn.state.session_args.items()}


def write_query(**values: str) -> None:
    """Bring the address of this page up to date; an empty value is left out of it."""
    location = pn.state.location
    if location is not None:
        location.search = search({**dict(parse_qsl(location.search.removeprefix("?"))), **values})


def fly_address(run: Run) -> str:
    """The Fly page with a run's best policy, on the task it was trained for; what it cannot see is masked."""
    scenario = run.config.scenario
    try:
        missiles = range(1, load_scenario(scenario).launch.missiles + 1)
    except ScenarioError:  # its file has gone: the policy can still be flown elsewhere
        return "/fly" + search({"a": run.id})
    masked = ",".join(str(missile) for missile in missiles if missile not in run.policy_missiles())
    return "/fly" + search({"a": run.id, "scenario": "" if scenario == DEFAULT else scenario, "mask": masked})


def go_to(address: str, **values: str) -> None:
    """Open another page in this tab, in the same colours."""
    location = pn.state.location
    if location is None:
        return
    theme = dict(parse_qsl(location.search.removeprefix("?"))).get("theme", "")
    # In this order: the browser leaves as soon as it hears of the new path.
    location.search = search({**values, "theme": theme})
    location.param.update(pathname=address, reload=True)


def search(values: dict[str, str]) -> str:
    """The query part of an address, `?` included; empty values are left out."""
    kept = {name: value for name, value in values.items() if value}
    return f"?{urlencode(kept)}" if kept else ""
