"""Where a TMC4361 keeps the gains of its PID, which regulates every 128 clocks (DS-TMC4361 14.4)."""

from __future__ import annotations

from ..closed_loop.setting import LoopPlaces

POSITION_LOOP = LoopPlaces(
    proportional="PID_P",
    integral="PID_I",
    derivative="PID_D",
    clip="PID_I_CLIP___PID_D_CLKDIV",
    sum_clip="PID_I_CLIP",
    most="PID_DV_CLIP",
    tolerance="PID_TOLERANCE",
    shape="RAMPMODE",
    mode="ENC_IN_CONF",
    modus="regulation_modus",
    off=0,
    alone=2,
    cycle_clocks=128,
)
