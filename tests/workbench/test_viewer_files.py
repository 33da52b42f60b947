"""The Rerun viewer comes out of the wheel whole, once, and without links to elsewhere."""

from __future__ import annotations

import gzip
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import pytest

from workbench import viewer_files


@pytest.mark.slow
def test_several_who_ask_at_once_get_one_whole_viewer(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    with ThreadPoolExecutor(3) as askers:
        folders = set(askers.map(lambda _: viewer_files.ensure_viewer(), range(3)))
    folder = folders.pop()
    assert not folders
    assert folder.name == "rerun-viewer-" + viewer_files.importlib.metadata.version("rerun-sdk")
    assert {path.name for path in folder.iterdir()} >= set(viewer_files.FILES)
    assert [path.name for path in folder.parent.iterdir() if path.name != folder.name] == [".viewer.lock"]
    assert b"<link" in (folder / "index.html").read_bytes()
    assert b"googleapis" not in (folder / "index.html").read_bytes()
    wasm = (folder / "re_viewer_bg.wasm").read_bytes()
    assert wasm[:4] == b"\0asm"
    assert gzip.decompress((folder / "re_viewer_bg.wasm.gz").read_bytes()) == wasm


def test_a_wheel_without_its_program_is_one_sentence(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    monkeypatch.setattr(viewer_files.importlib.util, "find_spec", lambda name: None)
    with pytest.raises(viewer_files.ViewerError, match="reinstall it: pip install --force-reinstall rerun-sdk"):
        viewer_files.ensure_viewer()
    assert not viewer_files.viewer_folder().exists()


def test_a_cache_that_cannot_be_written_is_one_sentence(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "submas-workbench").write_text("a file where the folder should be")
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    with pytest.raises(viewer_files.ViewerError, match="cannot be put into"):
        viewer_files.ensure_viewer()
