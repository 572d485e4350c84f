"""Getting a TMC4361 to run after power-on: everything that has to be set before the first target, in its order."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from ...calc.ramps.sramp_parameters import default_bow
from ...calc.units.tmc4361 import Units
from ...errors import UsageError
from ..core.device import Device
from ..core.results import WriteItem
from ..core.start_up import AxisStartUp, StartPlan

S_RAMP_POSITIONING = 6
MICROSTEPS = (256, 128, 64, 32, 16, 8, 4, 2, 1)
"""By MSTEP_PER_FS; closed loop needs 256."""
STEP_CLOCKS, DIR_CLOCKS = 4, 4
"""STP_LENGTH_ADD and DIR_SETUP_TIME: long enough for any step/direction driver's input at 16 MHz."""

BETA, GAMMA = 255, 255
"""A quarter of an electrical turn, as recommended (TMC4361A, CL_BETA), and as much against back-EMF."""


@dataclass(frozen=True, slots=True)
class Closed:
    """What closed loop is set to, beside its calibration. The defaults follow Trinamic's own motors.

    gain : from deviation to commutation angle, outside of `tolerance`; 1 lets the field lead as much as the rotor lags
    tolerance : deviation inside which the gain is 1 [microsteps], 0..255
    window : deviation inside which a target counts as reached [microsteps]
    emf_from_pps, emf_over_pps : speed from which the angle against back-EMF grows, and over which range [pps]
    """

    gain: float = 1.0
    tolerance: int = 100
    window: int = 100
    emf_from_pps: int = 300_000
    emf_over_pps: int = 600_000


@dataclass(frozen=True, slots=True)
class Start:
    """How the axis moves. Velocities in pps, accelerations in pps^2, bows in pps^3.

    microsteps : per full step
    bow : of all four phases; None for the one with which a slope to `vmax` just touches `amax`
    counts_per_rev : of the encoder, four a line; 0 for none
    invert_encoder : the encoder counts the other way
    stops : the stop switches are in force
    stop_high_active : the level at which they stop
    """

    vmax: float
    amax: float
    dmax: float | None = None
    microsteps: int = MICROSTEPS[0]
    bow: float | None = None
    counts_per_rev: int = 0
    invert_encoder: bool = False
    stops: bool = True
    stop_high_active: bool = True
    closed: Closed | None = None


async def start_up(device: Device, start: Start, full_steps_per_rev: int | None = None) -> None:
    """Set a chip up after power-on, ready for `move` and `rotate` on S-ramps.

    Closed loop is prepared, not switched on: `procedures.closed_loop` does that. Raises BenchError at the first write
    that the chip did not take, with the rest not tried; UsageError for numbers that its registers cannot hold.
    """
    for item in _items(device, start, full_steps_per_rev or device.axes[0].settings.full_steps_per_rev):
        await device.registers.write(item.name, item.axis, item.value, item.fields)


async def plan(device: Device, wanted: Sequence[AxisStartUp]) -> StartPlan:
    """What a chip after power-on needs, in its order. The power stage is outside: it sets the current."""
    (one,) = wanted
    figures = one.figures
    one.require_no_current("the power stage outside does; scale it down with CURRENT_CONF and SCALE_VALUES")
    microsteps = one.microsteps(MICROSTEPS[0], MICROSTEPS)
    velocity, slope = one.velocity_pps(microsteps), one.acceleration_pps2(microsteps)
    start = Start(
        velocity,
        slope,
        one.deceleration_pps2(slope),
        microsteps,
        counts_per_rev=figures.counts_per_rev,
        invert_encoder=figures.invert_encoder,
        stops=figures.stops,
        stop_high_active=not figures.stop_low_active,
    )
    encoders = {one.axis: "ENC_POS"} if figures.counts_per_rev else {}
    return StartPlan(list(_items(device, start, one.settings.full_steps_per_rev)), encoders=encoders)


def _items(device: Device, start: Start, full_steps: int) -> Sequence[WriteItem]:
    units = Units(device.clock_hz)
    dmax = start.amax if start.dmax is None else start.dmax
    bow = default_bow(start.amax, start.vmax) if start.bow is None else start.bow

    def raw(name: str, value: float) -> WriteItem:
        try:
            return WriteItem(name, 0, units.to_raw(name, value))
        except ValueError as error:
            raise UsageError(str(error)) from error

    stops = int(start.stops)
    level = int(start.stop_high_active)
    return [
        # At rest until the very last write: without a speed limit nothing moves.
        WriteItem("VMAX", 0, 0),
        WriteItem("CLK_FREQ", 0, round(device.clock_hz)),
        WriteItem(
            "STEP_CONF", 0, fields={"mstep_per_fs": MICROSTEPS.index(start.microsteps), "fs_per_rev": full_steps}
        ),
        WriteItem(
            "STP_LENGTH_ADD___DIR_SETUP_TIME", 0, fields={"STP_LENGTH_ADD": STEP_CLOCKS, "DIR_SETUP_TIME": DIR_CLOCKS}
        ),
        WriteItem(
            "REFERENCE_CONF",
            0,
            fields={"stop_left_en": stops, "stop_right_en": stops, "pol_stop_left": level, "pol_stop_right": level},
        ),
        *_encoder(start),
        raw("AMAX", start.amax),
        raw("DMAX", dmax),
        *(raw(f"BOW{number}", bow) for number in (1, 2)),
        *(raw(f"BOW{number}", bow * dmax / start.amax) for number in (3, 4)),
        WriteItem("RAMPMODE", 0, S_RAMP_POSITIONING),
        raw("VMAX", start.vmax),
    ]


def _encoder(start: Start) -> Sequence[WriteItem]:
    if not start.counts_per_rev:
        return []
    items = [
        WriteItem("ENC_IN_RES", 0, start.counts_per_rev),
        WriteItem("ENC_IN_CONF", 0, fields={"invert_enc_dir": int(start.invert_encoder)}),
        WriteItem("ENC_VMEAN", 0, fields={"ENC_VMEAN_WAIT": 100, "ENC_VMEAN_FILTER": 7, "ENC_VMEAN_INT": 500}),
        WriteItem("ENC_POS", 0, 0),
        WriteItem("XTARGET", 0, 0),
        WriteItem("XACTUAL", 0, 0),
    ]
    closed = start.closed
    if closed is not None:
        items += [
            WriteItem("CL_ANGLES", 0, fields={"CL_BETA": BETA, "CL_GAMMA": GAMMA}),
            WriteItem("CL_DELTA_P", 0, round(closed.gain * 65536)),
            WriteItem("CL_TOLERANCE", 0, closed.tolerance),
            WriteItem("CL_TR_TOLERANCE", 0, closed.window),
            WriteItem("CL_VMIN_EMF", 0, closed.emf_from_pps),
            WriteItem("CL_VADD_EMF", 0, closed.emf_over_pps),
        ]
    return items
