"""Every chip and module that stepscope knows, by model name."""

from __future__ import annotations

from typing import Literal

from ..errors import UnknownThing
from .entry import Model
from .listed import models as listed
from .listed import package
from .maps.models import MAPS
from .tmc5xxx import models as tmc5xxx
from .tmc428 import models as tmc428
from .tmc4361 import models as tmc4361
from .tmcdrivers import models as tmcdrivers
from .tmcl import models as tmcl

FAMILIES: tuple[tuple[Model, ...], ...] = (
    tmc428.MODELS,
    tmc4361.MODELS,
    tmc5xxx.MODELS,
    tmcdrivers.MODELS,
    tmcl.MODELS,
)


class _Models(dict[str, Model]):
    """Models by name. Those that only an installed package lists are found by their names, and never gone through: each
    is read when it is asked for. Those of register maps come and go."""

    def __missing__(self, name: str) -> Model:
        if name in MAPS:
            return MAPS[name]
        try:
            return listed.model(name)
        except UnknownThing as error:
            raise KeyError(name) from error


MODELS = _Models({model.name: model for family in FAMILIES for model in family})
CHIPS_32 = {name: model for name, model in MODELS.items() if model.datagram_bits == 32}
"""TMC428 and TMC4210: one ramp generator, one kind of datagram, and so the same promises in most tests."""


def find_model(name: str) -> Model:
    """The model that the user calls `name`. Raises UnknownThing, with what to install where that may be the cure;
    UsageError for one that is listed and cannot be read."""
    try:
        return MODELS[name]
    except KeyError:
        raise UnknownThing("model", name, sorted(MODELS), listed.hint()) from None


def is_model(name: str) -> bool:
    """Whether there is a model of that name; of a listed one it may turn out that it cannot be read."""
    return name in MAPS or is_known(name)


def is_known(name: str) -> bool:
    """The same without register maps: none of them may be called so."""
    return name in MODELS or listed.known(name)


def kind_of(name: str) -> Literal["chip", "module"] | None:
    """What the model of that name is, without its having been read; None where there is none."""
    known = dict.get(MODELS, name) or MAPS.get(name) or package.listings().get(name)
    return None if known is None else known.kind


def maps() -> tuple[Model, ...]:
    """Models of register maps."""
    return tuple(MAPS[name] for name in sorted(MAPS))


def listings() -> tuple[Model, ...]:
    """Models that only the installed package lists, as far as they are known without having been read."""
    return tuple(listed.entry(listing) for name, listing in package.listings().items() if name not in MODELS)


__all__ = [
    "CHIPS_32",
    "FAMILIES",
    "MODELS",
    "Model",
    "find_model",
    "is_known",
    "is_model",
    "kind_of",
    "listings",
    "maps",
]
