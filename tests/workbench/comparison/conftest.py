"""What all tests of comparisons need: a store, a cache, a piece of work."""

from __future__ import annotations

from pathlib import Path

import pytest

from workbench.comparison.cache import ComparisonCache
from workbench.runs import RunStore


@pytest.fixture
def store(tmp_path: Path) -> RunStore:
    return RunStore(tmp_path / "runs")


@pytest.fixture
def cache(tmp_path: Path) -> ComparisonCache:
    return ComparisonCache(tmp_path / "cache")
