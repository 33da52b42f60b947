"""The lattice has every task once, and the chain of Algorithm 3 runs through it (Fig. 5, Table 1)."""

from __future__ import annotations

from itertools import combinations, pairwise
from math import comb

import pytest

from layouts.lattice import Lattice, chain_of, lattice_figure, mask_text, masks_by_level, nested_chain
from layouts.theme import POLICY_A


@pytest.mark.parametrize("missiles", range(1, 9))
def test_every_task_stands_once_above_its_number_of_missiles(missiles: int) -> None:
    levels = masks_by_level(missiles)
    assert [len(level) for level in levels] == [comb(missiles, k) for k in range(missiles + 1)]
    nodes = lattice_figure(missiles).nodes.data
    assert sorted(nodes["mask"]) == sorted(mask_text(m) for level in levels for m in level)
    for x, mask in zip(nodes["x"], nodes["mask"], strict=True):
        left = missiles - len([number for number in mask.split(",") if number])
        assert abs(x - left) < 0.5
    assert len({*zip(nodes["x"], nodes["y"], strict=True)}) == 2**missiles


@pytest.mark.parametrize("missiles", range(3, 9))
def test_nodes_do_not_touch_in_the_narrowest_panel(missiles: int) -> None:
    nodes = lattice_figure(missiles, height=430).nodes.data
    across, up = 580 / (missiles + 1.2), (372 if missiles > 4 else 245) / 1.24
    columns = (nodes[name] for name in ("x", "y", "width", "height"))
    scale = across if missiles <= 4 else 1.0  # wide nodes are as wide as the figure lets them be
    boxes = [(x * across, y * up, width * scale, height) for x, y, width, height in zip(*columns, strict=True)]
    for (x, y, width, height), (u, v, wide, high) in combinations(boxes, 2):
        assert abs(x - u) > (width + wide) / 2 or abs(y - v) > (height + high) / 2
    assert max(abs(y) + height / 2 for _x, y, _width, height in boxes) < 0.62 * up


def test_the_chain_unmasks_one_missile_at_a_time() -> None:
    chain = nested_chain(4)
    assert chain[0] == {1, 2, 3, 4}
    assert chain[-1] == frozenset()
    assert [sorted(a - b) for a, b in pairwise(chain)] == [[1], [2], [3], [4]]


def test_nodes_say_what_the_task_is() -> None:
    nodes = lattice_figure(4).nodes.data
    assert nodes["task"][list(nodes["mask"]).index("")] == "target task"
    assert nodes["name"][list(nodes["mask"]).index("1,3")] == "24"
    six = lattice_figure(6).nodes.data
    names = dict(zip(six["mask"], six["name"], strict=True))
    assert (names["1,3"], names["5,6"], names["1,2,3,4,5,6"]) == ("2456", "1–4", "–")


def test_four_missiles_show_all_links_and_more_only_those_that_matter() -> None:
    assert len(lattice_figure(4).links.data["x0"]) == 4 * 2**3
    big = lattice_figure(8)
    assert len(big.links.data["x0"]) == 8
    big.select(frozenset({1, 8}))
    # Six easier neighbours and two harder ones, none of them a link of the chain.
    assert len(big.links.data["x0"]) == 8 + 8


def _ringed(lattice: Lattice) -> list[str]:
    rows = zip(lattice.nodes.data["mask"], lattice.nodes.data["ring_width"], strict=True)
    return [mask for mask, width in rows if width > 2]


@pytest.mark.parametrize("missiles", [4, 6, 7])
def test_the_selected_task_has_a_ring_and_a_name(missiles: int) -> None:
    lattice = lattice_figure(missiles, selected=frozenset({2}))
    assert _ringed(lattice) == ["2"]
    lattice.select(frozenset({1, 3}))
    assert _ringed(lattice) == ["1,3"]
    assert lattice.tag.data["text"] == (["2 4 5 6 7"] if missiles == 7 else [])
    lattice.select(frozenset())
    assert lattice.tag.data["text"] == []


def test_a_known_success_rate_is_written_under_its_task() -> None:
    nodes = lattice_figure(4, success={frozenset({4}): 0.915}).nodes.data
    assert nodes["caption"][list(nodes["mask"]).index("4")] == "91.5%"


@pytest.mark.parametrize("missiles", [4, 6])
def test_any_chain_can_be_drawn(missiles: int) -> None:
    # Missiles met in the order 3, 1: two stages up to the task with both.
    every = frozenset(range(1, missiles + 1))
    chain = chain_of(missiles, [3, 1])
    assert chain == [every, every - {3}, every - {1, 3}]
    lattice = lattice_figure(missiles)
    lattice.select(every - {1, 3}, chain)
    nodes, links = lattice.nodes.data, lattice.links.data
    blue = {mask for mask, fill in zip(nodes["mask"], nodes["fill"], strict=True) if fill == POLICY_A}
    assert blue == {mask_text(mask) for mask in chain}
    assert links["ink"].count(POLICY_A) == 2


def test_a_task_alone_is_a_chain_without_links() -> None:
    lattice = lattice_figure(4, chain=[frozenset({2})])
    assert POLICY_A not in lattice.links.data["ink"]
    assert lattice.nodes.data["fill"].count(POLICY_A) == 1
