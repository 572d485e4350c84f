"""Which families hang on an emulated line, and what puts them there: one line each."""

from __future__ import annotations

from collections.abc import Mapping

from ..emulators.build import family_of
from ..errors import UnknownThing
from . import modules
from .line import LineMaker
from .listed import line as listed
from .tmc5xxx import line as tmc5xxx
from .tmcdrivers import line as tmcdrivers

LINES: Mapping[str, LineMaker] = {
    "tmc5xxx": tmc5xxx.make_line,
    "tmcdrivers": tmcdrivers.make_line,
    "tmcl": modules.make_line,
    "listed": listed.make_line,
}


def line_maker_of(model: str) -> LineMaker:
    """What puts emulators of `model` on a line. Raises UnknownThing for one that speaks on none."""
    family = family_of(model).name
    if family not in LINES:
        raise UnknownThing("family with a line", family, list(LINES))
    return LINES[family]
