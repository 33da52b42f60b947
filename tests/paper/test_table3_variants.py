"""Table 3: the ablations are rows of a table, not copies of code."""

from __future__ import annotations

from agents.config import VARIANTS, Variant


def test_the_rows_of_table_3() -> None:
    assert VARIANTS["submas"] == Variant(True, True, "adaptive", "adaptive")
    assert not VARIANTS["wo-pd"].distillation and VARIANTS["wo-pd"].reuse
    assert VARIANTS["wo-pr"].distillation and not VARIANTS["wo-pr"].reuse
    assert VARIANTS["wo-pd"].epsilon == VARIANTS["wo-pr"].alpha == "adaptive"
    assert VARIANTS["dec-pd"] == Variant(True, True, "decayed", "adaptive")
    assert VARIANTS["dec-pr"] == Variant(True, True, "adaptive", "decayed")


def test_the_baseline_of_section_4_3_has_no_guide() -> None:
    assert not VARIANTS["td3"].distillation and not VARIANTS["td3"].reuse
