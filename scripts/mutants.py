#!/usr/bin/env python3
"""Break the program on purpose and see its tests fail: `python scripts/mutants.py [R5 S2 …]`.

Every bar of docs/reliability.md and docs/security.md has mutants in tests/mutants: one fault each, and the tests that
must notice it. First those tests are run on a copy of the repository as it is; then each fault is put into a copy of
its own and its tests are run there. The exit code is 1 if a fault was not noticed.
"""

from __future__ import annotations

import argparse
import contextlib
import os
import re
import shutil
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

import psutil

ROOT = Path(__file__).resolve().parents[1]
sys.path.insert(0, str(ROOT))  # the mutants are with the tests, which are not installed

from tests.mutants.catalogue import MUTANTS  # noqa: E402
from tests.mutants.mutant import Mutant, MutantError  # noqa: E402
from workbench.progress import bar  # noqa: E402
from workbench.terminal import duration, print_json, print_line, print_table  # noqa: E402

LIMIT_S = 300.0
"""How long the tests of one mutant may take."""
HANG_S = 60.0
"""How long one may take whose tests are expected never to end."""
PACKAGES = ("sim", "agents", "layouts", "workbench")
FAILED, TIMED_OUT = 1, 124
SEEN, NOT_SEEN = "red", "NOT SEEN"


@dataclass(frozen=True)
class Verdict:
    """What one test said of one mutant."""

    mutant: Mutant
    test: str
    seen: bool
    reason: str
    """What failed, in pytest's words, or why it does not count."""
    seconds: float


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the mutants that are asked for; the exit code."""
    options = _options(arguments)
    chosen = [
        each
        for each in MUTANTS
        if (not options.bars or each.bar in options.bars) and options.fault.lower() in each.fault.lower()
    ]
    if not chosen:
        print_line("mutants: there is none of these bars and words", error=True)
        return 2
    began_s = time.monotonic()
    try:
        with tempfile.TemporaryDirectory(prefix="mutants-") as folder, bar("mutants") as progress:
            tree = copy_of(ROOT, Path(folder, "whole"))
            if not options.no_green:
                assert_green(tree, chosen, progress.say)
            verdicts, first_s = [], time.monotonic()
            for number, each in enumerate(chosen):
                progress(number, len(chosen))
                verdicts += list(judged(each, tree, options.limit_s))
                progress.say(_line(number, chosen, verdicts, time.monotonic() - first_s))
    except MutantError as error:
        print_line(f"mutants: {error}", error=True)
        return 2
    report(verdicts, as_json=options.json, wall_s=time.monotonic() - began_s)
    return int(not all(verdict.seen for verdict in verdicts))


def _options(arguments: Sequence[str] | None) -> argparse.Namespace:
    parser = argparse.ArgumentParser(description="Break the program on purpose and see its tests fail.")
    parser.add_argument("bars", nargs="*", metavar="BAR", help="bars such as R5 or S2; all by default")
    parser.add_argument("--fault", default="", metavar="WORDS", help="only faults in whose sentence these words are")
    parser.add_argument("--no-green", action="store_true", help="do not run the tests on the unbroken program first")
    parser.add_argument("--limit-s", type=float, default=LIMIT_S, help=f"time limit of a mutant (default {LIMIT_S:g})")
    parser.add_argument("--json", action="store_true", help="one JSON object on standard output")
    options = parser.parse_args(arguments)
    if unknown := set(options.bars) - {each.bar for each in MUTANTS}:
        parser.error(f"no mutant of {', '.join(sorted(unknown))}")
    return options


def copy_of(root: Path, tree: Path) -> Path:
    """A copy of what git tracks or would, as it stands in the working tree; the packages are imported from there.

    Raises:
        MutantError: this is no working tree of git, or Python would import the packages from elsewhere.
    """
    listed = ["git", "ls-files", "-z", "--cached", "--others", "--exclude-standard"]
    found = subprocess.run(listed, cwd=root, capture_output=True, text=True, check=False)
    if found.returncode:
        raise MutantError(f"{root} is no working tree of git: {found.stderr.strip()}")
    for name in filter(None, found.stdout.split("\0")):
        if (root / name).is_file():
            (tree / name).parent.mkdir(parents=True, exist_ok=True)
            shutil.copy2(root / name, tree / name)
    code = f"import {', '.join(PACKAGES)}; print(*(package.__file__ for package in ({', '.join(PACKAGES)})))"
    told = subprocess.run([sys.executable, "-c", code], cwd="/", env=environment(tree), capture_output=True, text=True)
    if told.returncode or not all(Path(path).is_relative_to(tree) for path in told.stdout.split()):
        raise MutantError(f"the copy in {tree} is not what Python imports: {told.stdout}{told.stderr}")
    return tree


def environment(tree: Path) -> dict[str, str]:
    """The environment in which a copy's tests run: its packages come first, also in processes that they start."""
    # In CI a story of the browser is tried twice; elsewhere pytest cuts what failed to the width of the terminal.
    kept = {name: value for name, value in os.environ.items() if name not in ("CI", "BUILD_NUMBER")}
    return {**kept, "PYTHONPATH": str(tree), "COLUMNS": "400", "PYTEST_ADDOPTS": ""}


def assert_green(tree: Path, mutants: Sequence[Mutant], say: Callable[[str], None]) -> None:
    """Run every test of these mutants once on the program as it is.

    Raises:
        MutantError: one of them fails without any fault.
    """
    tests = sorted({test for each in mutants for test in each.tests})
    code, output, seconds = run_tests(tests, tree, limit_s=1800.0, stop=False)
    if code != 0:
        raise MutantError(f"the tests fail on the program as it is (pytest's code {code}):\n{output[-4000:]}")
    say(f"{len(tests)} tests are green on the program as it is, {duration(seconds)}")


def judged(each: Mutant, tree: Path, limit_s: float) -> Iterator[Verdict]:
    """The verdict of each test on a mutant, in a copy of its own."""
    with tempfile.TemporaryDirectory(prefix="mutant-", dir=tree.parent) as folder:
        own = Path(folder, "tree")
        shutil.copytree(tree, own, copy_function=os.link)
        each.apply(own)
        for test in each.tests:
            code, output, seconds = run_tests([test], own, HANG_S if each.hangs else limit_s)
            failures = re.findall(r"^FAILED \S.*? - (.*)$", output, re.MULTILINE)
            seen = (code == FAILED and bool(failures)) or (code == TIMED_OUT and each.hangs)
            reason = failures[0] if failures else _why_not(code)
            yield Verdict(each, test, seen, reason, seconds)


def _why_not(code: int) -> str:
    ends = {0: "the test passes", TIMED_OUT: "the test did not end in time", FAILED: "an error beside the test"}
    return ends.get(code, f"pytest ended with code {code}, nothing was tested")


def run_tests(tests: Sequence[str], tree: Path, limit_s: float, stop: bool = True) -> tuple[int, str, float]:
    """The exit code of pytest (TIMED_OUT where it had to be ended), what it printed, and how long it took [s]."""
    command = [sys.executable, "-m", "pytest", *tests, "-q", "-rfE", "--no-header", "-p", "no:cacheprovider"]
    began_s = time.monotonic()
    with tempfile.TemporaryFile("w+") as log:
        process = subprocess.Popen(
            [*command, *(["-x"] if stop else [])], cwd=tree, env=environment(tree), stdout=log, stderr=log
        )
        try:
            code = process.wait(limit_s)
        except subprocess.TimeoutExpired:
            code = TIMED_OUT
        finally:
            _end(process)
        log.seek(0)
        return code, log.read(), time.monotonic() - began_s


def _end(process: subprocess.Popen[bytes]) -> None:
    """End pytest and whatever it started, if it still runs."""
    if process.poll() is not None:
        return
    with contextlib.suppress(psutil.NoSuchProcess):
        for child in psutil.Process(process.pid).children(recursive=True):
            with contextlib.suppress(psutil.NoSuchProcess):
                child.kill()
    process.kill()
    process.wait()


def _line(number: int, chosen: Sequence[Mutant], verdicts: Sequence[Verdict], passed_s: float) -> str:
    left_s = passed_s / (number + 1) * (len(chosen) - number - 1)
    each, mine = chosen[number], [verdict for verdict in verdicts if verdict.mutant is chosen[number]]
    word = SEEN if all(verdict.seen for verdict in mine) else NOT_SEEN
    reason = mine[0].reason[:80]
    return f"{number + 1}/{len(chosen)} {each.bar} {word}: {each.fault} ({reason}), {duration(left_s)} left"


def report(verdicts: Sequence[Verdict], as_json: bool, wall_s: float) -> None:
    """The verdicts as a table, or as one JSON object."""
    missed = [verdict for verdict in verdicts if not verdict.seen]
    if as_json:
        rows = [{"bar": each.mutant.bar, "fault": each.mutant.fault, "file": each.mutant.file, "test": each.test,
                 "seen": each.seen, "reason": each.reason, "seconds": round(each.seconds, 1)}
                for each in verdicts]  # fmt: skip
        print_json({"mutants": rows, "not_seen": len(missed), "wall_s": round(wall_s, 1)})
        return
    words = [(each.mutant.bar, each.mutant.fault, each.test.removeprefix("tests/"), SEEN if each.seen else NOT_SEEN,
              f"{each.seconds:.0f} s") for each in verdicts]  # fmt: skip
    print_table(("bar", "fault", "test", "seen", "time"), words)
    for each in missed:
        print_line(f"NOT SEEN: {each.mutant.bar}, {each.mutant.fault}: {each.test}: {each.reason}")
    print_line(f"{len(verdicts) - len(missed)} of {len(verdicts)} verdicts are red, {duration(wall_s)}")


if __name__ == "__main__":
    sys.exit(main())
