"""Names of models as types: closed sets for schemas, which follow the catalog."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated, Any, Literal

from pydantic import AfterValidator, StringConstraints

from ..errors import UnknownThing
from .capabilities import Capability
from .catalog import MODELS, find_model, is_model


def _of(*names: str) -> Any:
    return Literal[names]


def _that_can(*capabilities: Capability) -> Any:
    """Those that can all of these."""
    return _of(*(model.name for model in MODELS.values() if model.capabilities.issuperset(capabilities)))


def _known(name: str) -> str:
    """`name` of a model. Raises ValueError where there is none; what is only listed is not read for that."""
    if not is_model(name):
        try:
            find_model(name)
        except UnknownThing as error:
            raise ValueError(str(error)) from error
    return name


ListedName = Annotated[str, StringConstraints(pattern=r"^[a-z0-9][a-z0-9-]{0,39}$"), AfterValidator(_known)]
"""A model that an installed package lists."""

if TYPE_CHECKING:
    AnyModelName = str
    ModelName = str
    ModuleName = str
    PmulName = str
    SRampName = str
    SixPointName = str
    MslutName = str
    DriverName = str
    ChopperName = str
    ScaleName = str
else:
    ModelName = _of(*MODELS)
    AnyModelName = ModelName | ListedName
    ModuleName = _that_can("parameters")
    PmulName = _that_can("ramp.pmul")
    SRampName = _that_can("ramp.s")
    SixPointName = _that_can("ramp.sixpoint", "registers")
    MslutName = _that_can("microsteps.mslut")
    DriverName = _that_can("step_input")
    ChopperName = _that_can("chopper", "registers")
    ScaleName = _that_can("current.scale")
