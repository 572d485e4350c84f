"""What the first look saw of the encoder on its ways, as a record tells it."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from pydantic import Field

from ...telemetry.sampling import FloatArray
from ..parts import Part

POINTS = 150
"""Of a way, for a plot."""


class EncoderWay(Part):
    """A way, thinned out for a plot: means of neighbouring samples."""

    forward: bool = Field(description="to greater positions")
    position_fullsteps: list[float] = Field(description="of the motor's counter [full steps]")
    deviation_fullsteps: list[float] = Field(
        description="encoder less position, from the mean of all ways; a count that is set wrong is made up for, where "
        "nothing is broken [full steps]"
    )


class LookFound(Part):
    """The encoder on ways there and back."""

    ways: list[EncoderWay]


def look_found(ways: Sequence[tuple[FloatArray, FloatArray]], scale: float, full_step: int) -> LookFound | None:
    """Of ways, each its positions and what the encoder told there, which is microsteps times `scale`; None for no way.

    full_step : [microsteps]
    """
    moved = [(position, scale * encoder - position) for position, encoder in ways if len(position)]
    if not moved:
        return None
    middle = float(np.concatenate([deviation for _, deviation in moved]).mean())
    return LookFound(
        ways=[
            EncoderWay(
                forward=bool(position[-1] >= position[0]),
                position_fullsteps=_thinned(position / full_step),
                deviation_fullsteps=_thinned((deviation - middle) / full_step),
            )
            for position, deviation in moved
        ]
    )


def _thinned(values: FloatArray) -> list[float]:
    parts = np.array_split(values, min(POINTS, len(values)))
    return [round(float(part.mean()), 4) for part in parts]
