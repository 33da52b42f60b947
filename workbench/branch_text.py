"""A branch as text for an address, `A,431,expert-dragging` or `A,431,by-hand.AbCd…,expert-dragging`; distrusted."""

from __future__ import annotations

import base64
import binascii
import itertools
import re
from collections.abc import Collection, Iterable

from sim.errors import shorten
from workbench.branch import FULL_CIRCLE_DEG, Branch, BranchError

BY_HAND = "by-hand."
FLIGHTS = ("A", "B")
RUN_MAX = 128
"""Seconds of one heading that two bytes can say: 7 bits for the seconds less one, 9 bits for the degrees."""
STEP = re.compile("[0-9]{1,5}")
BASE64 = re.compile("[A-Za-z0-9_-]+")


def branch_text(branch: Branch) -> str:
    """The branch for an address; `read_branch` gives an equal one."""
    parts = [branch.of, str(branch.step)]
    if branch.by_hand:
        parts.append(BY_HAND + _packed(branch.headings_deg))
    return ",".join([*parts, *filter(None, [branch.policy])])


def read_branch(text: str, policies: Collection[str], max_steps: int) -> Branch:
    """The branch that an address asks for, which anybody may have written.

    Args:
        text: as `branch_text` writes it.
        policies: POLICY that may fly.
        max_steps: longest flight of the scenario [decision steps].

    Raises:
        BranchError: anything wrong, in one sentence that names it and what would be legal.
    """
    letter, _, rest = text.partition(",")
    step, _, rest = rest.partition(",")
    flown, _, after = rest.partition(",") if rest.startswith(BY_HAND) else ("", "", rest)
    if letter not in FLIGHTS or not STEP.fullmatch(step) or not rest:
        raise BranchError(
            f"branch {shorten(text)!r} is not a flight, a second and a policy, as in A,431,expert-dragging"
        )
    if int(step) >= max_steps:
        raise BranchError(f"branch {shorten(text)!r} begins at second {int(step)}; legal are 0 to {max_steps - 1}")
    if (after or not flown) and after not in policies:
        raise BranchError(f"branch {shorten(text)!r} is flown by policy {shorten(after)!r}, which is not known here")
    headings = _unpacked(flown.removeprefix(BY_HAND), max_steps - int(step)) if flown else ()
    return Branch(letter, int(step), headings, after)


def _packed(headings_deg: Iterable[int]) -> str:
    """Runs of equal headings, two bytes each, as base64 for addresses."""
    words = bytearray()
    for heading, run in itertools.groupby(headings_deg):
        seconds = len(list(run))
        while seconds > 0:
            words += (((min(seconds, RUN_MAX) - 1) << 9) | heading).to_bytes(2, "big")
            seconds -= RUN_MAX
    return base64.urlsafe_b64encode(bytes(words)).decode().rstrip("=")


def _unpacked(text: str, longest: int) -> tuple[int, ...]:
    # Checked for its length first: two bytes, so at most 2.7 characters, are at least one second.
    wrong = BranchError(
        f"the headings of a branch, {shorten(text)!r}, are not base64 of byte pairs with 0 to 359 degrees for at most "
        f"{longest} seconds; copy the address again"
    )
    if len(text) > 3 * longest or not BASE64.fullmatch(text):
        raise wrong
    try:
        words = base64.b64decode(text + "=" * (-len(text) % 4), altchars=b"-_", validate=True)
    except binascii.Error:
        raise wrong from None
    values = [int.from_bytes(words[i : i + 2], "big") for i in range(0, len(words), 2)]
    runs = [((value >> 9) + 1, value % 512) for value in values]
    if len(words) % 2 or sum(seconds for seconds, _ in runs) > longest or any(h >= FULL_CIRCLE_DEG for _, h in runs):
        raise wrong
    return tuple(heading for seconds, heading in runs for _ in range(seconds))
