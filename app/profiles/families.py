"""The profile rules of each family: one line each."""

from __future__ import annotations

from collections.abc import Mapping

from ..registers.catalog import MODELS
from .listed import rules as listed
from .rules import ProfileRules
from .tmc5xxx import rules as tmc5xxx
from .tmc428 import rules as tmc428
from .tmc4361 import rules as tmc4361
from .tmcdrivers import rules as tmcdrivers
from .tmcl import rules as tmcl

FAMILIES: Mapping[str, ProfileRules] = {
    "tmc428": tmc428.RULES,
    "tmc4361": tmc4361.RULES,
    "tmc5xxx": tmc5xxx.RULES,
    "tmcdrivers": tmcdrivers.RULES,
    "tmcl": tmcl.RULES,
    "listed": listed.RULES,
}


def rules_of(model: str) -> ProfileRules:
    """Raises KeyError for an unknown model."""
    return FAMILIES[MODELS[model].family]
