"""Networks, optimisers and generators of torch as plain arrays, and back: every bit of what learning goes on from."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor, nn

from agents.arrays import Arrays


def module_arrays(module: nn.Module) -> Arrays:
    """Copies of all parameters and buffers of a network."""
    return {name: array_of(value) for name, value in module.state_dict().items()}


def load_module(module: nn.Module, arrays: Mapping[str, NDArray[Any]]) -> None:
    """Copy arrays into a network's own tensors, whatever these are views of.

    Raises:
        RuntimeError: a name or a shape does not fit.
    """
    module.load_state_dict({name: tensor_of(array) for name, array in arrays.items()})


def optimizer_arrays(optimizer: torch.optim.Optimizer) -> Arrays:
    """Copies of an optimiser's moments, named `parameter/moment`; none before its first step."""
    moments = optimizer.state_dict()["state"]
    return {f"{index}/{name}": array_of(value) for index, values in moments.items() for name, value in values.items()}


def load_optimizer(optimizer: torch.optim.Optimizer, arrays: Mapping[str, NDArray[Any]]) -> None:
    """Put moments back.

    Raises:
        ValueError: a moment does not fit its parameter.
    """
    parameters = [parameter for group in optimizer.param_groups for parameter in group["params"]]
    moments: dict[int, dict[str, Tensor]] = {}
    for name, array in arrays.items():
        index, moment = name.split("/")
        if array.ndim and array.shape != tuple(parameters[int(index)].shape):
            raise ValueError(f"{moment} of parameter {index} is {list(array.shape)}")
        moments.setdefault(int(index), {})[moment] = tensor_of(array)
    optimizer.load_state_dict({**optimizer.state_dict(), "state": moments})


def generator_array(generator: torch.Generator) -> NDArray[np.uint8]:
    """State of a generator of torch."""
    return generator.get_state().numpy().copy()


def load_generator(generator: torch.Generator, array: NDArray[np.uint8]) -> None:
    """Put a generator back."""
    generator.set_state(tensor_of(array))


def array_of(tensor: Tensor) -> NDArray[Any]:
    """A copy of a tensor's values."""
    return tensor.detach().numpy().copy()


def tensor_of(array: NDArray[Any]) -> Tensor:
    """A tensor with a copy of these values."""
    return torch.from_numpy(np.array(array))
