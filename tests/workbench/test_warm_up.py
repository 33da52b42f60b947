"""What is loaded, and when."""

from __future__ import annotations

import logging
import subprocess
import sys
import threading
from pathlib import Path
from types import SimpleNamespace

import panel as pn
import pytest
from bokeh.document import Document
from bokeh.io.doc import patch_curdoc

from workbench import warm_up as module
from workbench.launcher import environment
from workbench.warm_up import FIRST, LATER

PAGES = [name for name in (*FIRST, *LATER) if name.startswith("workbench.pages.")]
HEAVY = ("matplotlib", "rerun", "torch", "pyarrow", "stable_baselines3")
"""Half a second and more each, and needed by a few visitors only: for pictures, recordings, trainings, tables."""


def test_no_page_loads_what_only_some_visitors_need() -> None:
    code = f"""
import importlib, sys
for name in {PAGES}:
    importlib.import_module(name)
print([name for name in {HEAVY} if name in sys.modules])
"""
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True, env=environment())
    assert done.stdout.strip() == "[]"


def test_every_page_is_warmed_up() -> None:
    from workbench.app import PAGES as pages

    assert {name.rpartition(".")[2] for name in PAGES} == set(pages)


def test_a_failure_is_logged_and_no_more(monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture) -> None:
    monkeypatch.setattr(module, "FIRST", ("no_such_module",))
    with caplog.at_level(logging.WARNING):
        module.warm_up(None, later_s=0.0)  # type: ignore[arg-type]
    assert "no_such_module" in caplog.text


def test_components_loaded_while_a_page_is_busy_are_every_pages(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    """Panel tells of a component's data only the page that was busy when its class was made, if there was one."""
    (tmp_path / "lately_loaded.py").write_text(
        "import threading\nfrom panel.custom import JSComponent\n"
        "class Late(JSComponent):\n    _esm = 'export function render() {}'\n"
    )
    monkeypatch.syspath_prepend(tmp_path)
    monkeypatch.setattr(module, "FIRST", ("lately_loaded",))
    monkeypatch.setattr(module, "_fly_a_step", lambda: (_ for _ in ()).throw(RuntimeError("enough")))
    busy = Document()
    busy._session_context = lambda: SimpleNamespace()  # type: ignore[assignment]
    monkeypatch.setitem(pn.state._connected, busy, True)
    thread = threading.Thread(target=module.warm_up, args=(None,))
    with patch_curdoc(busy):
        assert pn.state.curdoc is busy, "the page that the server is busy with"
        thread.start()
        thread.join(30)
    assert sys.modules["lately_loaded"].Late._data_model__initialized
