"""`workbench doctor`: what works on this machine, what does not, and what to do about it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import asdict, dataclass
from pathlib import Path

from workbench.commands import doctor_folders, doctor_machine
from workbench.commands.doctor_machine import REINSTALL, Missing, dependencies
from workbench.terminal import print_json, print_table

Probe = tuple[str, Callable[[], str], bool]
"""Name, what looks (and raises when something is wrong), whether the workbench cannot do without."""


@dataclass(frozen=True)
class Args:
    """Check this machine: versions, simulator, learner, viewers, folders, ports, index; says what to do."""

    runs: Path = Path("runs")
    """Folder of the runs."""
    port: int = 5006
    """Port the pages are to be served at."""
    json: bool = False
    """One JSON object instead of a table."""


@dataclass(frozen=True)
class Check:
    """One thing looked at."""

    name: str
    ok: bool
    found: str
    needed: bool = True
    """Whether the workbench cannot do without."""
    advice: str = ""
    """What to do when it is not ok."""

    @property
    def state(self) -> str:
        """`ok`, `note` for what one can do without, `wrong` for what is needed."""
        return "ok" if self.ok else "wrong" if self.needed else "note"


def run(args: Args) -> int:
    """0 when everything needed is there, else 1."""
    checks = [*(look(*each) for each in dependencies()), *(look(*each) for each in probes(args.runs, args.port))]
    ok = all(check.ok for check in checks if check.needed)
    if args.json:
        print_json({"ok": ok, "checks": [{**asdict(check), "state": check.state} for check in checks]})
    else:
        print_table(("", "what", "found", "what to do"), [(c.state, c.name, c.found, c.advice) for c in checks])
    return 0 if ok else 1


def probes(runs: Path, port: int) -> list[Probe]:
    """What is looked at beside the installed packages."""
    return [
        ("Python", doctor_machine.python, True),
        ("tested versions", doctor_machine.tested_versions, False),
        ("simulator kernel", doctor_machine.kernel, True),
        ("Warp device", doctor_machine.warp_device, True),
        ("matrix products", doctor_machine.matrix_products, True),
        ("graphics card", doctor_machine.graphics_card, False),
        ("shipped policies", doctor_machine.policies, True),
        ("runs folder", lambda: doctor_folders.writable(runs), True),
        ("locks", lambda: doctor_folders.locks(runs), True),
        ("permissions", lambda: doctor_folders.permissions(runs), False),
        ("free disk", lambda: doctor_folders.free_disk(runs), False),
        ("runs", lambda: doctor_folders.readable(runs), False),
        ("index of the runs", lambda: doctor_folders.index(runs), False),
        ("port", lambda: doctor_folders.port_free(runs, port), False),
        ("Rerun viewer", doctor_machine.viewer, False),
        ("Chromium", doctor_machine.chromium, False),
    ]


def look(name: str, probe: Callable[[], str], needed: bool) -> Check:
    """Ask one probe; whatever it raises is what was found."""
    try:
        return Check(name, True, probe(), needed)
    except Missing as missing:
        return Check(name, False, str(missing), needed, missing.advice)
    except Exception as error:
        return Check(name, False, f"{type(error).__name__}: {error}", needed, REINSTALL)
