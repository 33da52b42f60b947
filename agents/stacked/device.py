"""Which devices a stack can be on, said before anything is started."""

from __future__ import annotations

import torch

from agents.config import ConfigError


def checked_device(name: str) -> str:
    """`cpu`, or a CUDA device that is there.

    Raises:
        ConfigError: another name, or no such graphics card for this build of torch.
    """
    kind, _, number = name.partition(":")
    if kind not in ("cpu", "cuda") or (number and not (kind == "cuda" and number.isascii() and number.isdigit())):
        raise ConfigError(f"device is '{name[:60]}'; legal are cpu, cuda and cuda:N")
    if kind == "cpu":
        return name
    count = torch.cuda.device_count()
    if not count:
        raise ConfigError(
            f"device is '{name}', and torch {torch.__version__} finds no graphics card here; "
            "use cpu, or see docs/gpu.md"
        )
    if int(number or 0) >= count:
        raise ConfigError(f"device is '{name}'; legal here are cpu and cuda:0 to cuda:{count - 1}")
    return f"cuda:{int(number or 0)}"
