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
    before = torch.backends.mkldnn.matmul.fp32_precision
    monkeypatch.setattr(numerics, "relative_error", lambda left, right: 1e-3)
    assert numerics.choose_matmul_route() == "default"
    assert torch.backends.mkldnn.matmul.fp32_precision == before
