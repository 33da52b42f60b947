"""Which numbers of an earlier source count as those of the present one."""

from __future__ import annotations

from workbench.reproduce.provenance import SAME_FLIGHTS, flies_the_same


def test_a_source_flies_like_itself_and_like_the_one_it_is_said_to_equal() -> None:
    (earlier, present), *_ = SAME_FLIGHTS.items()
    assert flies_the_same(present, present)
    assert flies_the_same(earlier, present)
    assert not flies_the_same(present, earlier)
    assert not flies_the_same(earlier, "of tomorrow")
