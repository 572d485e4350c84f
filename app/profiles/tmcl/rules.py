"""Which registers are configuration, and in which order they are safe to write."""

from __future__ import annotations

from ...links.tmcl_language import INSTRUCTIONS, standard_include
from ...registers.tmcl.modules import MODULES
from ..rules import Busy, Language, ProfileRules
from .expected import expected
from .physical import physical

RULES = ProfileRules(
    state=frozenset(
        {"target_position", "actual_position", "target_speed", "ramp_mode", "encoder_position", "encoder_clear_on_null"}
        # Lifting the protection erases the program; the tick and the dice are never what they were.
        | {"external_encoder_position", "tmcl_code_protection", "tmcl_tick_timer", "random_number"}
    ),
    # In which units speeds count first of all.
    order=(
        *("units", "motor", "current", "chopper", "stealthchop", "coolstep", "stallguard", "ramp", "motion", "encoder"),
        *("switches", "reference search", "interrupts", "application", "coordinates", "variables", "step/dir"),
    ),
    busy=(Busy("tmcl_application_status", None, "", "a program runs on the module: stop it first"),),
    physical=physical,
    expected=expected,
    language=Language(INSTRUCTIONS, lambda model, name: standard_include(MODULES[model], name)),
)
