"""What docs/exports.md says is so: every command writes its file, every snippet runs, every suffix has both."""

from __future__ import annotations

import re
import shlex
from pathlib import Path

import pytest

from tests.workbench.flights import shorten_films
from workbench import cli
from workbench.exports import FORMATS


@pytest.fixture(autouse=True)
def _short_films(monkeypatch: pytest.MonkeyPatch) -> None:
    shorten_films(monkeypatch)


ROOT = Path(__file__).parents[2]
PAGE = ROOT / "docs/exports.md"
TEXT = PAGE.read_text(encoding="utf-8")
SECTIONS = dict(re.findall(r"^## (\S+)\n(.*?)(?=^## |\Z)", TEXT, re.MULTILINE | re.DOTALL))


def snippets(text: str, language: str) -> list[str]:
    return re.findall(rf"^```{language}\n(.*?)^```", text, re.MULTILINE | re.DOTALL)


def test_every_format_has_a_line_in_the_table_and_a_section() -> None:
    assert re.findall(r"^\| `(\.\S+)` \|", TEXT, re.MULTILINE) == list(FORMATS) == list(SECTIONS)


@pytest.mark.parametrize("suffix", SECTIONS)
def test_the_command_writes_what_the_snippet_reads(
    suffix: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    (line,), (code,) = snippets(SECTIONS[suffix], ""), snippets(SECTIONS[suffix], "python")
    assert cli.main(shlex.split(line)[1:]) == 0
    assert [path.name for path in tmp_path.iterdir()] == [f"flight{suffix}"]
    capsys.readouterr()
    exec(compile(code, f"{PAGE.name} {suffix}", "exec"), {})
    assert capsys.readouterr().out


def test_the_first_snippet_runs(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    exec(compile(snippets(TEXT.partition("\n## ")[0], "python")[0], PAGE.name, "exec"), {})
    assert [path.name for path in tmp_path.iterdir()] == ["dragging.acmi"]


def test_pictures_and_links_of_the_page_exist() -> None:
    for target in re.findall(r"\]\((?!https?:)([^)#]+)\)", TEXT):
        assert (PAGE.parent / target).is_file(), target
