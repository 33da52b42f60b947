"""Data files are found in a checkout and in an installation, and nowhere else."""

from __future__ import annotations

import sys
from pathlib import Path

import pytest

from sim import assets


def test_the_checkout_is_looked_at_first() -> None:
    assert assets.asset_path("scenarios", "default.toml").is_file()


def test_an_installed_copy_is_found(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(assets, "__file__", str(tmp_path / "lib" / "sim" / "assets.py"))
    monkeypatch.setattr(sys, "prefix", str(tmp_path))
    installed = tmp_path / "share/submas-workbench/assets"
    installed.mkdir(parents=True)
    assert assets.asset_path("policies") == installed / "policies"


def test_without_assets_the_error_says_where_they_were_looked_for(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(assets, "__file__", str(tmp_path / "lib" / "sim" / "assets.py"))
    monkeypatch.setattr(sys, "prefix", str(tmp_path))
    with pytest.raises(FileNotFoundError, match="share/submas-workbench/assets; reinstall submas-workbench"):
        assets.asset_path("scenarios")
