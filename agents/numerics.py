"""How torch computes in a training process: one thread, no denormals, the faster exact matrix product."""

from __future__ import annotations

import time
from typing import Any, Final

import torch

WORST_ERROR: Final = 1e-6
"""Largest relative error of a matrix product that still counts as float32."""
WORTHWHILE: Final = 1.3
"""Least speed-up for which the route is changed. Where it helps it is nearly twofold, elsewhere a few percent: a
busy machine must not decide by chance, because runs of one seed are equal only on one route."""

_PRECISIONS: Final = {"onednn": "bf16", "default": "none"}
"""Setting of torch behind each route."""


def prepare_torch(threads: int = 1, route: str = "") -> str:
    """Set up this process for training and return the route of float32 matrix products, chosen unless it is given.

    One thread per process: a product of 256 × 256 is too small to share, and several seeds are better apart. A
    training that is resumed has to take the route it began with, or its bits would differ.
    """
    torch.set_num_threads(threads)
    torch.set_flush_denormal(True)
    if route not in _PRECISIONS:
        return choose_matmul_route()
    matmul: Any = torch.backends.mkldnn.matmul  # type: ignore[attr-defined]
    matmul.fp32_precision = _PRECISIONS[route]
    return route


def matmul_route() -> str:
    """The route of float32 matrix products that is taken now."""
    matmul: Any = torch.backends.mkldnn.matmul  # type: ignore[attr-defined]
    return "onednn" if matmul.fp32_precision == _PRECISIONS["onednn"] else "default"


def choose_matmul_route() -> str:
    """Take oneDNN's kernels where they are as exact as float32 and faster, else leave torch's own: the name.

    The setting "bf16" only permits a lower precision. Processors without such units (AMD) compute in float32 with
    newer instructions and run twice as fast; those that have them would really round, so the product is measured.
    """
    # torch's stubs do not know this attribute.
    matmul: Any = torch.backends.mkldnn.matmul  # type: ignore[attr-defined]
    matmul.fp32_precision = _PRECISIONS["default"]  # whatever was taken before: both are measured
    generator = torch.Generator().manual_seed(0)
    left = torch.randn((128, 256), generator=generator)
    right = torch.randn((256, 256), generator=generator)
    usual_s = _fastest_s(left, right)
    matmul.fp32_precision = _PRECISIONS["onednn"]
    exact = relative_error(left, right) < WORST_ERROR
    if exact and _fastest_s(left, right) * WORTHWHILE < usual_s:
        return "onednn"
    matmul.fp32_precision = _PRECISIONS["default"]
    return "default"


def relative_error(left: torch.Tensor, right: torch.Tensor) -> float:
    """Error of the current float32 product against float64, relative to the size of the result."""
    exact = left.double() @ right.double()
    return float(((left @ right).double() - exact).norm() / exact.norm())


def _fastest_s(left: torch.Tensor, right: torch.Tensor, tries: int = 30) -> float:
    best = float("inf")
    for _ in range(tries):
        started = time.perf_counter()
        torch.mm(left, right)
        best = min(best, time.perf_counter() - started)
    return best
