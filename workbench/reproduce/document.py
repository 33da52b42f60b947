"""`docs/reproduction.md`: text by hand around blocks that are written from result sets, and checked by a test."""

from __future__ import annotations

import os
import re
from pathlib import Path
from typing import cast

from workbench.reproduce.protocol import Item
from workbench.reproduce.result_file import load
from workbench.reproduce.result_set import ResultSet
from workbench.reproduce.scorecard import scorecard
from workbench.run_files import write_bytes

BLOCK = re.compile(r"<!-- (table4|fig8|fig9|fig12|fig13) (\w+) -->\n.*?<!-- end -->", re.DOTALL)
"""A block: what it shows, of which profile; what is between the marks belongs to the command."""


RUN = re.compile(r"runs/[0-9]{8}-[0-9]{6}-[a-z0-9]{6}/")
SHOWN: tuple[Item, ...] = ("table4", "fig8", "fig9", "fig12", "fig13")
"""Items in the paper's order."""


def block(item: Item, result: ResultSet | None, pictures: str) -> str:
    """One item in Markdown: picture, tables, points and notes; `pictures` is the folder of the picture, as linked."""
    card = scorecard(item, result)
    drawn = result is not None and bool(result.curves or result.flights or (item == "fig13" and result.numbers))
    parts = [f"![{card.title}]({pictures}/{item}.png)"] if drawn and item != "table4" else []
    parts += [table.markdown() for table in card.tables]
    parts.append("\n".join(f"* {note}" for note in card.notes))
    if result is not None and result.numbers:
        parts.append(_commands(result))
    return "\n\n".join(parts)


def filled(text: str, results: Path, document: Path) -> str:
    """The document with every block written anew from the result sets in `results/PROFILE/`."""

    def fill(found: re.Match[str]) -> str:
        item, profile = cast(Item, found[1]), found[2]
        folder = results / profile
        link = os.path.relpath(folder, document.parent)
        written = block(item, load(folder / f"{item}.json"), link)
        return f"<!-- {item} {profile} -->\n{written}\n<!-- end -->"

    return BLOCK.sub(fill, text)


def refresh(document: Path, results: Path) -> bool:
    """Write the blocks of a document anew; returns whether it is any different from before."""
    before = document.read_text(encoding="utf-8")
    after = filled(before, results, document)
    if after != before:
        write_bytes(document, after.encode())
    return after != before


def report(results: Path, profile: str) -> str:
    """All items of one profile as a document of its own."""
    head = "# Reproduction\n\nOurs beside the paper's, from the result sets in this folder.\n"
    parts = []
    for item in SHOWN:
        written = block(item, load(results / profile / f"{item}.json"), ".")
        parts.append(f"## {scorecard(item, None).title}\n\n{written}\n")
    return "\n".join([head, *parts])


def _commands(result: ResultSet) -> str:
    """The commands behind the numbers, to be unfolded; the result set holds the one behind each."""
    seeds: dict[str, list[str]] = {}
    for training in result.trainings:
        command, seed = training.command.rsplit(" ", 1)
        seeds.setdefault(command, []).append(seed)
    trained = [f"{command} {','.join(found)}" for command, found in seeds.items()]
    # Runs have names of their own on every machine; the result set says which was which seed.
    flown = dict.fromkeys(RUN.sub("runs/RUN/", number.command) for number in result.numbers)
    lines = "\n".join([*trained, *flown])
    return f"<details><summary>The commands behind the numbers</summary>\n\n```\n{lines}\n```\n\n</details>"
