"""`workbench`, whose trainings are the small ones that can be held."""

from __future__ import annotations

import sys

import tests.cluster.held_training  # noqa: F401  replaces the launcher's entry
from workbench import cli

if __name__ == "__main__":
    sys.exit(cli.main())
