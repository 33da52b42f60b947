"""The `workbench` command: finds the command's module, reads its arguments, turns errors into sentences."""

from __future__ import annotations

import contextlib
import importlib
import io
import sys
from collections.abc import Iterator, Sequence
from types import ModuleType

import tyro

from sim.errors import SubMasError, shorten

COMMANDS = (
    "serve",
    "fly",
    "evaluate",
    "study",
    "train",
    "resume",
    "pause",
    "stop",
    "runs",
    "calibrate",
    "reproduce",
    "stability",
    "bench",
    "doctor",
)
DESCRIPTION = """SubMas-RL workbench: curriculum reinforcement learning with missiles as maskable subtasks.

Without a command it serves the pages and opens the browser. Each command has its own --help."""
INTERRUPTED = 130


def main(arguments: Sequence[str] | None = None) -> int:
    """Run one command; returns its exit code: 0 done, 1 failed, 2 wrong usage, 130 interrupted."""
    given = list(sys.argv[1:] if arguments is None else arguments)
    try:
        return _run(given)
    except SubMasError as error:
        return _fail(str(error), error.exit_code)
    except KeyboardInterrupt:
        print("workbench: interrupted", file=sys.stderr)
        return INTERRUPTED
    except BrokenPipeError:
        # Whoever read our output (head, a pager) has seen enough; nothing is left to say, also not at exit.
        sys.stdout = None
        return 0
    except OSError as error:
        if error.filename is None:
            raise
        # A path that somebody gave: too long a name, no permission, a full disk.
        return _fail(f"{shorten(str(error.filename))}: {(error.strerror or str(error)).lower()}", SubMasError.exit_code)
    except SystemExit as end:
        return end.code if isinstance(end.code, int) else 1


def _fail(sentence: str, code: int) -> int:
    from workbench.terminal import print_line

    print_line(f"workbench: {sentence}", error=True)
    return code


def _run(given: list[str]) -> int:
    if not given or (given[0].startswith("-") and given[0] not in ("-h", "--help")):
        given = ["serve", *given]
    config = (tyro.conf.FlagCreatePairsOff,)
    if given[0] in COMMANDS:
        # Only the command that runs is imported: the others would make every start slower.
        module = command(given[0])
        with _nothing_steers(given):
            args = tyro.cli(module.Args, prog=f"workbench {given[0]}", args=given[1:], config=config)
        return module.run(args)
    # Help, or an unknown command: tyro prints it and exits.
    every = {name: command(name).Args for name in COMMANDS}
    with _nothing_steers(given):
        tyro.extras.subcommand_cli_from_dict(
            every, prog="workbench", description=DESCRIPTION, args=given, config=config
        )
    return 0


@contextlib.contextmanager
def _nothing_steers(given: Sequence[str]) -> Iterator[None]:
    """What tyro says of arguments that could steer a terminal is shown with those characters as escapes."""
    if all(word.isprintable() for word in given):
        yield
        return
    from workbench.terminal import print_line

    said = io.StringIO()
    try:
        with contextlib.redirect_stderr(said), contextlib.redirect_stdout(said):
            yield
    finally:
        for line in said.getvalue().splitlines():
            print_line(line, error=True)


def command(name: str) -> ModuleType:
    """The module of one command: `Args`, its arguments, and `run(args)`, which returns the exit code."""
    return importlib.import_module(f"workbench.commands.{name}")


if __name__ == "__main__":
    sys.exit(main())
