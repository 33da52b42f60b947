"""Features of observations as tensors: `agents.features.ObservationFeatures.encode` where the observations lie."""

from __future__ import annotations

from typing import Any

import numpy as np
import torch
from torch import Tensor

from agents.features import ObservationFeatures, stem, subtask_number
from agents.task import IntArray, Layout


class Encoder:
    """Encodes observations of one layout, the widest of all agents; columns of smaller ones are found by name."""

    def __init__(self, features: ObservationFeatures, device: torch.device | str) -> None:
        """Take over the features' scales and default block."""
        self.features, self.names = features, feature_names(features)
        layout, scales = features.layout, features.length_scales_m
        lengths, angles = _lengths(features), _angles(features)
        owner = [_owner(features, name) for name in layout.names]

        def tensor(values: Any, kind: torch.dtype) -> Tensor:
            return torch.tensor(values, dtype=kind, device=device)

        blocks = np.arange(layout.size)
        self._blocks = tensor([blocks[layout.block(one)].tolist() for one in features.subtasks], torch.int64)
        self._default = tensor(features.default_block, torch.float32)
        self._lengths, self._angles = tensor(lengths, torch.int64), tensor(angles, torch.int64)
        self._length_owner = tensor([owner[column] for column in lengths], torch.int64)
        self._angle_owner = tensor([owner[column] for column in angles], torch.int64)
        inverse = [1.0 / scales[stem(layout.names[column])] for column in lengths]
        self._inverse_scales = tensor(inverse, torch.float32)

    def encode(self, observation: Tensor) -> Tensor:
        """Features `[…, f]` of observations `[…, d]`."""
        flags = (observation[..., self._blocks] != self._default).any(dim=-1)
        shown = torch.cat((flags, torch.ones_like(flags[..., :1])), dim=-1).float()
        lengths = observation[..., self._lengths] * self._inverse_scales * shown[..., self._length_owner]
        angles, seen = observation[..., self._angles], shown[..., self._angle_owner]
        return torch.cat((lengths, angles.sin() * seen, angles.cos() * seen, flags.float()), dim=-1)

    def columns(self, features: ObservationFeatures) -> IntArray:
        """Feature columns that a smaller layout has too, in its own order."""
        return np.array([self.names.index(name) for name in feature_names(features)], int)

    def fresh_flags(self, target: Layout, source: Layout) -> Tensor:
        """1 for every flag of a subtask that `target` has and `source` lacks `[f]`, else 0.

        Where none of them is up, no block of Ψ(s) differs from the default: the transfer condition, Eq. (13).
        """
        fresh = {f"seen {subtask_number(target.names[column])}" for column in target.masked_columns(source)}
        return torch.tensor([float(name in fresh) for name in self.names], device=self._default.device)


def feature_names(features: ObservationFeatures) -> list[str]:
    """What each network input is made of, in order."""
    names = features.layout.names
    lengths, angles = ([names[column] for column in part] for part in (_lengths(features), _angles(features)))
    waves = [f"{wave} {name}" for wave in ("sin", "cos") for name in angles]
    return [*lengths, *waves, *(f"seen {subtask}" for subtask in features.subtasks)]


def _lengths(features: ObservationFeatures) -> list[int]:
    return [column for column, name in enumerate(features.layout.names) if stem(name) in features.length_scales_m]


def _angles(features: ObservationFeatures) -> list[int]:
    return [column for column, name in enumerate(features.layout.names) if stem(name) not in features.length_scales_m]


def _owner(features: ObservationFeatures, name: str) -> int:
    """Index of the subtask a column belongs to; the number of subtasks for shared columns."""
    subtask = subtask_number(name)
    return features.subtasks.index(subtask) if subtask else len(features.subtasks)
