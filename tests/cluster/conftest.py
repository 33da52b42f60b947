"""A real Ray cluster of three nodes on this machine's loopback: the head, which only coordinates, and two that work."""

from __future__ import annotations

import importlib.util
import os
import secrets
import warnings
from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager
from functools import partial
from pathlib import Path
from typing import Any

import pytest

from agents import numerics
from tests.reliability.small_training import one_route
from workbench import launcher
from workbench.engine import Engine, open_engine
from workbench.engine_options import EngineOptions
from workbench.runs import RunStore

ENTRY = Path(__file__).with_name("held_training.py")
STORE_BYTES = 80 * 2**20
HEALTH = {"health_check_initial_delay_ms": 2000, "health_check_period_ms": 1000, "health_check_failure_threshold": 5}
TOKEN = secrets.token_hex(32)
"""One for all clusters of this process, which remembers it."""
OpenEngine = Callable[..., AbstractContextManager[Engine]]


def skip_without_ray() -> None:
    """Look without importing it: Ray reads its settings once, when it is imported."""
    if importlib.util.find_spec("ray") is None:
        pytest.skip("needs the extra [cluster]")


@pytest.fixture(scope="module")
def cluster() -> Iterator[Any]:
    """Three nodes, each with processes of its own; the second and the third have a core each."""
    skip_without_ray()
    before = dict(os.environ)
    os.environ.update(RAY_ENABLE_WINDOWS_OR_OSX_CLUSTER="0", RAY_USAGE_STATS_ENABLED="0", RAY_worker_niceness="0")
    os.environ.update(RAY_AUTH_MODE="token", RAY_AUTH_TOKEN=TOKEN)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # Ray's own
        from ray.cluster_utils import Cluster

        made = Cluster(initialize_head=True, head_node_args={"num_cpus": 0, **_node(), "_system_config": HEALTH})
        for _ in range(2):
            made.add_node(num_cpus=1, **_node())
        yield made
        made.shutdown()
    os.environ.clear()
    os.environ.update(before)


def _node() -> dict[str, Any]:
    return {"include_dashboard": False, "object_store_memory": STORE_BYTES, "node_ip_address": "127.0.0.1"}


@pytest.fixture
def store(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> RunStore:
    """An empty runs folder whose trainings are small ones that can be held."""
    monkeypatch.setattr(launcher, "ENTRY", (str(ENTRY),))
    monkeypatch.setattr(numerics, "choose_matmul_route", one_route)
    return RunStore(tmp_path / "runs")


@pytest.fixture
def engine(cluster: Any, store: RunStore) -> OpenEngine:
    """Opens an engine on the cluster."""

    def opened(store: RunStore = store, **options: Any) -> AbstractContextManager[Engine]:
        return open_engine(EngineOptions(engine="ray", ray_address=cluster.address, **options), store)

    return partial(opened)
