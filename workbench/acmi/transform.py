"""Where a body is and how it lies in the terms of ACMI 2.2: degrees, clockwise from north, right bank positive."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

METRES_PER_DEGREE = 111_320.0
"""Length of a degree of longitude on the equator and of latitude near it; the field is centred on 0° N, 0° E."""


def yaw_deg(heading_rad: ArrayLike) -> NDArray[np.float64]:
    """Headings counter-clockwise from +x (east) as yaw clockwise from +y (north), in [0, 360)."""
    # Rounded first: 359.999 must not be written as 360.0.
    return np.round(90.0 - np.degrees(heading_rad), 2) % 360.0


def transforms(
    position_m: NDArray, heading_rad: NDArray, pitch_rad: NDArray, bank_rad: NDArray | None = None
) -> list[str]:
    """Values of `T=` in its nine-field form, one per row of `position_m` [T, 3].

    Lon|Lat|Alt|Roll|Pitch|Yaw|U|V|Heading: degrees with 7 decimals (1 cm), metres with 2, angles with 2. Our x is east
    and U, our y is north and V. A bank to the left is positive here and negative there; None is a body without bank.
    """
    x, y, altitude = position_m.T
    roll = np.zeros(len(x)) if bank_rad is None else -np.degrees(bank_rad)
    yaw = yaw_deg(heading_rad)
    columns = (x / METRES_PER_DEGREE, y / METRES_PER_DEGREE, altitude, roll, np.degrees(pitch_rad), yaw, x, y, yaw)
    decimals = (7, 7, 2, 2, 2, 2, 2, 2, 2)
    texts = [number_texts(column, places) for column, places in zip(columns, decimals, strict=True)]
    return ["|".join(row) for row in zip(*texts, strict=True)]


def number_texts(values: NDArray, decimals: int) -> list[str]:
    """Numbers with so many decimals at most and no zeros at the end: `0.5`, `12`, never `-0`."""
    return [_short(f"{value:.{decimals}f}") for value in np.asarray(values).tolist()]


def _short(text: str) -> str:
    text = text.rstrip("0").rstrip(".") if "." in text else text
    return "0" if text == "-0" else text
