"""Every chip with a chopper inside, in what their calculations differ: one line a family."""

from __future__ import annotations

from .tmc5xxx.chips import CHIPS as SIXPOINT
from .tmcdrivers.chips import CHIPS as DRIVERS

CHIPS = {**SIXPOINT, **DRIVERS}
