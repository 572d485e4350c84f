"""Which families of emulators there are: one line each."""

from __future__ import annotations

from typing import Any

from .core.family import EmulatorFamily
from .listed import family as listed
from .tmc5xxx import family as tmc5xxx
from .tmc428 import family as tmc428
from .tmc4361 import family as tmc4361
from .tmcdrivers import family as tmcdrivers
from .tmcl import family as tmcl

FAMILIES: tuple[EmulatorFamily[Any, Any], ...] = (
    tmc428.FAMILY,
    tmc4361.FAMILY,
    tmc5xxx.FAMILY,
    tmcdrivers.FAMILY,
    tmcl.FAMILY,
    listed.FAMILY,
)
