"""Words in pictures drawn without a browser: every character becomes one that a font here can draw.

matplotlib draws an empty box for a character its font lacks, and warns. A name may be anybody's, so here such a
character takes another installed font, else its plainer form, else its code.
"""

from __future__ import annotations

import unicodedata
from functools import cache
from pathlib import Path

FAMILY = "DejaVu Sans"
"""matplotlib brings it along, so pictures of plain names are the same everywhere."""


def picture_text(words: str) -> tuple[str, list[str]]:
    """The words as they can be drawn, and the font families to draw them with."""
    own = _characters(_own_font())
    missing = frozenset(words) - own
    families = [FAMILY, *_family_with(missing)]
    if len(families) == 1:
        words = "".join(c if c in own else _plainer(c, own) for c in words)
    return words, families


def _plainer(character: str, known: frozenset[str]) -> str:
    """A letter without what its compatibility form adds (full width, ligature), or the code of the character."""
    plain = unicodedata.normalize("NFKD", character)
    plain = "".join(c for c in plain if c in known)
    return plain or character.encode("unicode_escape").decode()


@cache
def _family_with(missing: frozenset[str]) -> list[str]:
    """The first installed family, by name, that has all of these characters; none if there is none."""
    from matplotlib.font_manager import fontManager

    if not missing:
        return []
    for font in sorted(fontManager.ttflist, key=lambda font: (font.name, str(font.fname))):
        # The font of last resort has a box for everything: what this module is there to avoid.
        if font.style == "normal" and not font.name.startswith("Last Resort") and missing <= _characters(font.fname):
            return [font.name]
    return []


@cache
def _characters(path: str) -> frozenset[str]:
    from matplotlib.ft2font import FT2Font

    try:
        return frozenset(map(chr, FT2Font(path).get_charmap()))
    except (OSError, RuntimeError):
        return frozenset()


@cache
def _own_font() -> str:
    from matplotlib import get_data_path

    return str(Path(get_data_path()) / "fonts/ttf/DejaVuSans.ttf")
