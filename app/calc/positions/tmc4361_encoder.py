"""Angles of a TMC4361's closed loop: 1024 microsteps are an electrical turn.

CL_OFFSET is taken for the coils' phase less ENC_POS with the rotor in the middle of the field, which is what
calibration stores; no source states its sign. Facts: closed loop, section 6.
"""

from __future__ import annotations

ELECTRICAL_TURN = 1024


def load_angle_deg(mscnt: int, encoder: int, offset: int, *, reversed_: bool = False) -> float:
    """How far the field leads the rotor, -180..180 [deg electrical], positive in the positive direction.

    Parameters
    ----------
    mscnt : place in the microstep table, 0..1023
    encoder : ENC_POS [microsteps]
    offset : CL_OFFSET, as calibration has stored it
    reversed_ : GENERAL_CONF.reverse_motor_dir: the table is read backwards
    """
    way = -1 if reversed_ else 1
    lead = way * (mscnt - way * encoder - offset)
    return ((lead + ELECTRICAL_TURN // 2) % ELECTRICAL_TURN - ELECTRICAL_TURN // 2) * 360 / ELECTRICAL_TURN
