"""The faster matrix product is only taken where it is as exact."""

from __future__ import annotations

from collections.abc import Iterator

import pytest
import torch

from agents import numerics


@pytest.fixture(autouse=True)
def _restore() -> Iterator[None]:
    matmul, before = torch.backends.mkldnn.matmul, torch.backends.mkldnn.matmul.fp32_precision
    yield
    matmul.fp32_precision = before
    torch.set_flush_denormal(False)


def test_whatever_is_chosen_is_exact_to_float32() -> None:
    route = numerics.prepare_torch()
    assert route in ("onednn", "default")
    generator = torch.Generator().manual_seed(1)
    left, right = torch.randn((256, 256), generator=generator), torch.randn((256, 256), generator=generator)
    assert numerics.relative_error(left, right) < 1e-6


def test_an_inexact_route_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(numerics, "relative_error", lambda left, right: 1e-3)
    assert numerics.choose_matmul_route() == "default"
    assert torch.backends.mkldnn.matmul.fp32_precision == "none"


def test_it_chooses_the_same_again_whatever_was_taken_before(monkeypatch: pytest.MonkeyPatch) -> None:
    matmul, seconds = torch.backends.mkldnn.matmul, {"none": 2.0, "bf16": 1.0}
    monkeypatch.setattr(numerics, "_fastest_s", lambda left, right: seconds[matmul.fp32_precision])
    monkeypatch.setattr(numerics, "relative_error", lambda left, right: 0.0)
    assert [numerics.choose_matmul_route() for _ in range(2)] == ["onednn", "onednn"]
    assert numerics.matmul_route() == "onednn"
    seconds["bf16"] = 2.0
    assert numerics.choose_matmul_route() == "default"
    assert numerics.matmul_route() == "default"
