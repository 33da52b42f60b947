"""The lattice has every task once, and the chain of Algorithm 3 runs through it (Fig. 5, Table 1)."""

from __future__ import annotations

from itertools import pairwise
from math import comb

from bokeh.models import GlyphRenderer

from layouts.lattice import lattice_figure, mask_text, masks_by_level, nested_chain


def test_sixteen_tasks_in_levels_of_one_four_six_four_one() -> None:
    levels = masks_by_level(4)
    assert [len(level) for level in levels] == [comb(4, k) for k in range(5)]
    assert len({mask for level in levels for mask in level}) == 16


def test_the_chain_unmasks_one_missile_at_a_time() -> None:
    chain = nested_chain(4)
    assert chain[0] == {1, 2, 3, 4}
    assert chain[-1] == frozenset()
    assert [sorted(a - b) for a, b in pairwise(chain)] == [[1], [2], [3], [4]]


def test_nodes_carry_the_mask_as_the_command_line_takes_it() -> None:
    _figure, source = lattice_figure()
    assert set(source.data["mask"]) == {mask_text(m) for level in masks_by_level(4) for m in level}
    assert source.data["task"][list(source.data["mask"]).index("")] == "target task"


def test_all_neighbours_are_joined() -> None:
    figure, _source = lattice_figure()
    edges = [r for r in figure.select(GlyphRenderer) if type(r.glyph).__name__ == "Line"]
    assert len(edges) == 4 * 2**3


def test_a_known_success_rate_is_written_under_its_task() -> None:
    _figure, source = lattice_figure(success={frozenset({4}): 0.915})
    assert source.data["caption"][list(source.data["mask"]).index("4")] == "91.5%"


def test_the_selected_task_has_a_ring() -> None:
    _figure, source = lattice_figure(selected=frozenset({2}))
    assert max(source.data["ring_width"]) == source.data["ring_width"][list(source.data["mask"]).index("2")]
