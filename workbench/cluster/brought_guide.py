"""A run's guide on its way to a node: the policy file, unless it is one that every node has."""

from __future__ import annotations

import contextlib
from pathlib import Path

from sim.errors import SubMasError
from workbench.runs import Run, RunStore


def guide_files(run: Run, store: RunStore) -> dict[str, bytes]:
    """The guide's files, where it is a run or a file: what is shipped is on every node."""
    from workbench.policies import EXPERTS, SUFFIX, shipped_policies
    from workbench.runs import is_run_id
    from workbench.training import BROUGHT_GUIDE

    spec = run.config.guide
    if not spec or spec in EXPERTS or spec in shipped_policies():
        return {}
    # One that is gone is missed, and told, by the training.
    with contextlib.suppress(SubMasError, OSError):
        path = store.get(spec).policy_path() if is_run_id(spec) else Path(spec).expanduser()
        return {BROUGHT_GUIDE: path.read_bytes()} if path and path.suffix == SUFFIX else {}
    return {}
