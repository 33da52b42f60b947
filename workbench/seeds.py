"""Lists of seeds as a person writes them: one run is launched per seed."""

from __future__ import annotations

from sim.errors import UsageError

LIMIT = 100
SEED_MAX = 2**31 - 1


def parse_seeds(text: str) -> list[int]:
    """Seeds from `0`, `0,1,2` or `0-4`, each once, in order.

    Raises:
        UsageError: anything else, a seed outside 0..SEED_MAX, or more than LIMIT of them.
    """
    seeds: list[int] = []
    try:
        for part in text.split(","):
            first, dash, last = part.strip().partition("-")
            low, high = int(first), int(last) if dash else int(first)
            if not 0 <= low <= high <= SEED_MAX or high - low >= LIMIT:
                raise ValueError(part)
            seeds += range(low, high + 1)
    except ValueError:
        shown = text if len(text) <= 60 else text[:60] + "…"
        raise UsageError(f"seeds '{shown}' is not a list of at most {LIMIT} seeds; write 0 or 0,1,2 or 0-4") from None
    if len(set(seeds)) > LIMIT:
        raise UsageError(f"seeds names {len(set(seeds))} seeds; legal are at most {LIMIT}")
    return list(dict.fromkeys(seeds))
