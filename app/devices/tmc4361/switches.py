"""Switches and stops by STATUS: what holds the motor from which way, and the level at HOME_REF.

HOME_REF is shown nowhere; it follows from HOME_ERROR_F, as far as that says anything.
"""

from __future__ import annotations

from collections.abc import Mapping

from . import roles

SWITCH_FLAGS = {
    "left switch": ("STOPL_ACTIVE_F", "stop_left_en", -1),
    "right switch": ("STOPR_ACTIVE_F", "stop_right_en", 1),
    "left virtual stop": ("VSTOPL_ACTIVE_F", "virtual_left_limit_en", -1),
    "right virtual stop": ("VSTOPR_ACTIVE_F", "virtual_right_limit_en", 1),
}
"""What stops: its flag in STATUS, what switches it on in REFERENCE_CONF, and which way it stops."""


def stopped_by(flags: Mapping[str, int], reference: Mapping[str, int], way: int) -> str:
    """What holds the motor from going `way` (+1, -1), by fields of STATUS and REFERENCE_CONF; "" where nothing does."""
    swapped = -1 if reference["invert_stop_direction"] else 1  # of switches alone (DS-TMC4361 9)
    for name, (flag, switched_on, stops) in SWITCH_FLAGS.items():
        stops_at = stops if "virtual" in name else stops * swapped
        if flags[flag] and reference[switched_on] and stops_at * way > 0:
            return name
    return ""


def is_pressed(name: str, flags: Mapping[str, int], reference: Mapping[str, int]) -> bool | None:
    """Whether a stop switch is active; None where it is off, for its flag tells of an enabled one alone."""
    flag, switched_on, _ = SWITCH_FLAGS[name]
    return True if flags[flag] else False if reference[switched_on] else None


BY_LEVEL = {3: True, 12: False}
"""home_event codes of a switch that tells the side, and which level the positive side has."""
BY_ZONE = {2: True, 4: True, 6: True, 9: False, 11: False, 13: False}
"""home_event codes of a switch that is active around home, and the level that it has there."""


def home_level(reference_conf: int, error: bool, position: int, x_home: int, margin: int) -> bool | None:
    """Whether HOME_REF is high; None where the configuration, or the place, does not tell.

    Within HOME_SAFETY_MARGIN of X_HOME the level is not judged (DS-TMC4361 9). Outside, a switch that tells the side
    has the level of the side unless there is an error, and one with an active zone is active only where there is one.
    """
    code = roles.HOME_EVENT.unpack(reference_conf)
    away = position - x_home
    if abs(away) <= margin:
        return None
    if code in BY_LEVEL:
        expected = BY_LEVEL[code] == (away > 0)
        return expected != error
    if code in BY_ZONE:
        return BY_ZONE[code] == error
    return None
