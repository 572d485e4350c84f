"""Every chip and module that stepscope knows, by model name."""

from __future__ import annotations

from typing import Literal

from ..errors import UnknownThing
from .entry import Model
from .listed import models as listed
from .listed import package
from .listed.package import Listing
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
        listing = listing_of(name)
        if listing is None:
            raise KeyError(name)
        return listed.model(listing)


MODELS = _Models({model.name: model for family in FAMILIES for model in family})
_WELL = dict(MODELS)
"""Those that are known well."""
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
    return name in MODELS or listing_of(name) is not None


def kind_of(name: str) -> Literal["chip", "module"] | None:
    """What the model of that name is, without its having been read; None where there is none."""
    known = dict.get(MODELS, name) or MAPS.get(name) or listing_of(name)
    return None if known is None else known.kind


def maps() -> tuple[Model, ...]:
    """Models of register maps."""
    return tuple(MAPS[name] for name in sorted(MAPS))


def listings() -> tuple[Model, ...]:
    """Models that only the installed package lists, as far as they are known without having been read."""
    return tuple(listed.entry(listing) for name in package.listings() if (listing := _offered(name)) is not None)


def listing_of(name: str) -> Listing | None:
    """What the installed package lists under that name; of a model that is known well as it is offered beside that."""
    if name in _WELL:
        return None
    base = name.removesuffix(listed.BESIDE)
    listing = _offered(base)
    return listing if listing is not None and listing.name == name else None


def why_not(name: str) -> str:
    """Why a listed model of that name cannot be used, as far as is known; empty where it can."""
    listing = listing_of(name)
    return "" if listing is None else listed.why_not(listing)


def _offered(name: str) -> Listing | None:
    """What the package lists under `name`. One that is known well it offers only where that lacks something."""
    listing = package.listings().get(name)
    if listing is None or name not in _WELL:
        return listing
    return listed.beside(listing, _WELL[name])


__all__ = [
    "CHIPS_32",
    "FAMILIES",
    "MODELS",
    "Model",
    "find_model",
    "is_known",
    "is_model",
    "kind_of",
    "listing_of",
    "listings",
    "maps",
    "why_not",
]
