"""Names of the event and status bits of the TMC4361, and which of them an SPI status byte shows."""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType
from typing import Final

EVENTS: Final[Mapping[int, tuple[str, str]]] = MappingProxyType(
    {
        0: ("TARGET_REACHED", "XACTUAL met XTARGET"),
        1: ("POS_COMP_REACHED", "the compared position was passed"),
        2: ("VEL_REACHED", "VACTUAL met VMAX"),
        3: ("VEL_STATE_00", "the motor came to a standstill"),
        4: ("VEL_STATE_01", "the velocity became positive"),
        5: ("VEL_STATE_10", "the velocity became negative"),
        6: ("RAMP_STATE_00", "the velocity became constant"),
        7: ("RAMP_STATE_01", "the speed began to rise"),
        8: ("RAMP_STATE_10", "the speed began to fall"),
        9: ("MAX_PHASE_TRAP", "the speed of a trapezoid passed VBREAK"),
        10: ("FROZEN", "the pin NFREEZE went low; only a reset ends it"),
        11: ("STOPL_EVENT", "the left switch became active during motion to the left"),
        12: ("STOPR_EVENT", "the right switch became active during motion to the right"),
        13: ("VSTOPL_ACTIVE", "the left virtual stop was met"),
        14: ("VSTOPR_ACTIVE", "the right virtual stop was met"),
        15: ("HOME_ERROR", "the home switch contradicts the position"),
        16: ("XLATCH_DONE", "X_LATCH was written, or homing ended"),
        17: ("FS_ACTIVE", "full steps are used from now on"),
        18: ("ENC_FAIL", "the encoder deviates by more than ENC_POS_DEV_TOL"),
        19: ("N_ACTIVE", "the index of the encoder became active"),
        20: ("ENC_DONE", "ENC_LATCH was written"),
        21: ("SER_ENC_DATA_FAIL", "data of the serial encoder were wrong"),
        23: ("SER_DATA_DONE", "a configuration exchange with the serial encoder ended"),
        24: ("SERIAL_ENC_FLAGS", "a status flag of the serial encoder was set"),
        25: ("COVER_DONE", "the motor driver answered a cover datagram"),
        26: ("ENC_VEL0", "the encoder has not moved for ENC_VEL_ZERO clocks"),
        27: ("CL_MAX", "the commutation angle reached CL_BETA"),
        28: ("CL_FIT", "the deviation came inside CL_TOLERANCE"),
        29: ("STOP_ON_STALL", "a stall of the motor stopped the ramp"),
        30: ("MOTOR_EV", "a selected flag of the motor driver was set"),
        31: ("RST_EV", "the chip was reset"),
    }
)
"""(name, meaning) by bit of EVENTS, and of the registers that select events. Bit 22 has no name.

Sources: DS-TMC4361 7.2 (what events are); TMC4361A, PY4361, STEPPYR, TOM4361 (bits).
"""

EVENT_BITS: Final[Mapping[str, int]] = MappingProxyType({name: bit for bit, (name, _) in EVENTS.items()})
EVENT_MASK: Final = sum(1 << bit for bit in EVENTS)


SPI_STATUS_BITS: Final = 8


def selected_events(selection: int) -> tuple[int, ...]:
    """Event bits that the SPI status byte shows, in the order of its bits 0 to 7; at most eight.

    `selection` is SPI_STATUS_SELECTION. Where it names more than eight events the lowest eight are
    shown; status bits beyond the selected ones stay 0. Source: DS-TMC4361 7.2.
    """
    return tuple(bit for bit in range(32) if selection >> bit & 1)[:SPI_STATUS_BITS]


def event_names(events: int) -> tuple[str, ...]:
    """Names of the bits that are set in a word laid out like EVENTS, lowest bit first."""
    return tuple(name for bit, (name, _) in EVENTS.items() if events >> bit & 1)
