"""Where committed result sets and the document about them live; nowhere in an installation without a checkout."""

from __future__ import annotations

from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]


def committed_results() -> Path | None:
    """`assets/results` of the checkout this code runs from, or None where it is installed."""
    return ROOT / "assets/results" if (ROOT / "pyproject.toml").is_file() else None


def document() -> Path:
    """The document whose blocks show the committed result sets."""
    return ROOT / "docs/reproduction.md"
