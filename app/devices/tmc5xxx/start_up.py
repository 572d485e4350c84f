"""Getting a TMC5xxx to run after power-on: everything that has to be set before the first target, in its order.

Chopper and currents are those that the maker's host code begins with (NOTES-TMC5XXX 9), which suit a small motor
on an evaluation board: SpreadCycle with toff 3 (TMC5160) or 5, and a run current well below full scale.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from fractions import Fraction

from ...calc.tmc5xxx.chips import CHIPS
from ...calc.tmc5xxx.coil import SCALER_FULL, CurrentStage, range_share
from ...calc.units.tmc5xxx import acceleration_units, velocity_units
from ...errors import OutOfRange, UsageError
from ..core.axis_limits import full_scale_figures
from ..core.config import AxisSettings
from ..core.device import Device
from ..core.results import WriteItem
from ..core.start_up import HOLD_SHARE, AxisStartUp, StartPlan, scale_of
from .limits import full_scale_a

CHOPCONF: dict[str, int | str] = {"toff": 5, "hstrt": 5, "hend": 3, "tbl": 2, "chm": 0}
CHOPCONF_5160: dict[str, int | str] = {"toff": 3, "hstrt": 5, "hend": 2, "tbl": 2, "chm": 0}
IRUN, IRUN_5160, IHOLD, HOLD_DELAY = 0x17, 0x0A, 0x03, 0x07
TPOWERDOWN = 10
MICROSTEPS = (256, 128, 64, 32, 16, 8, 4, 2, 1)
"""By CHOPCONF.mres; a TMC5031 has the first alone."""
TABLE_MICROSTEPS = MICROSTEPS[0]
MOST = 31
"""The greatest IRUN and IHOLD."""
DECIMAL = 10_000


@dataclass(frozen=True, slots=True)
class Start:
    """How an axis moves. Velocities in pps, accelerations in pps^2; the rest of the ramp follows where it is None.

    dmax, d1, a1 : None for amax
    v1 : 0 leaves a1 and d1 out
    vstop : at least 10 chip units, as the data sheets advise, and not below vstart
    irun, ihold : 0..31; None for the maker's
    select : vsense, or of a TMC5160 the scaler of 256; None as it is set
    microsteps : per full step; None as it is set, and reckoned as 256
    current_range : of a chip that has ranges; None as it is set
    counts_per_rev : of the encoder, four a line; 0 for none. That of a second axis takes the pins of both right
        switches, which then stop nothing
    stops : the stop switches are in force, active at high level unless `stop_low_active`
    """

    vmax: float
    amax: float
    dmax: float | None = None
    v1: float = 0.0
    a1: float | None = None
    d1: float | None = None
    vstart: float = 0.0
    vstop: float = 10.0
    irun: int | None = None
    ihold: int | None = None
    select: int | None = None
    microsteps: int | None = None
    current_range: int | None = None
    counts_per_rev: int = 0
    invert_encoder: bool = False
    stops: bool = True
    stop_low_active: bool = False


async def plan(device: Device, wanted: Sequence[AxisStartUp]) -> StartPlan:
    """What each of these axes needs after power-on, in its order."""
    right_switch = not any(one.figures.counts_per_rev for one in wanted if one.axis)
    items: list[WriteItem] = []
    encoders = {}
    for one in wanted:
        figures = one.figures
        fine = device.family.table.get("CHOPCONF", one.axis).field_named("mres") is not None
        microsteps = one.microsteps(TABLE_MICROSTEPS, MICROSTEPS if fine else MICROSTEPS[:1])
        velocity, slope = one.velocity_pps(microsteps), one.acceleration_pps2(microsteps)
        braking = one.deceleration_pps2(slope)
        irun, ihold, select, current_range = _currents(device.model, one)
        start = Start(
            vmax=velocity,
            amax=slope,
            dmax=braking,
            d1=braking,
            irun=irun,
            ihold=ihold,
            select=select,
            microsteps=microsteps if fine else None,
            current_range=current_range,
            counts_per_rev=figures.counts_per_rev,
            invert_encoder=figures.invert_encoder,
            stops=figures.stops,
            stop_low_active=figures.stop_low_active,
        )
        if figures.counts_per_rev:
            if not _has(device, "ENC_CONST", one.axis):
                raise UsageError(f"a {device.family.title} reads no encoder: leave counts_per_rev out")
            encoders[one.axis] = "X_ENC"
        items += start_items(device, one.axis, start, right_switch=right_switch, settings=one.settings)
    return StartPlan(items, encoders=encoders)


def _currents(model: str, one: AxisStartUp) -> tuple[int, int, int | None, int | None]:
    """IRUN, IHOLD, vsense or the scaler, and the range, nearest to the amperes asked for, else the maker's.

    Raises UsageError where nobody knows what a scale is in A, OutOfRange beyond full scale.
    """
    sensing = CHIPS[model].sensing
    strong = sensing.scaled
    limits, run_a = one.settings.limits, one.run_current_a()
    full = full_scale_a(model, limits)
    if run_a is not None and full is not None and limits.current_full_scale_a is None:
        if run_a > full:
            raise OutOfRange("run_current_a", run_a, 0, full, "A RMS, full scale with this sense resistor")
        stage = CurrentStage(model, limits.sense_resistor_ohm)
        run, hold = stage.run_and_hold(run_a, min(one.hold_current_a(run_a), run_a))
        return run.scale, hold.scale, run.select, None
    shares = one.share_of_full_scale(full_scale_figures(model))
    if shares is not None:
        run_share, hold_share = shares
        enough = [n for n in range(len(sensing.range_va)) if range_share(model, n) >= max(run_share, hold_share)]
        current_range = enough[0] if enough else None
        of_range = 1.0 if current_range is None else range_share(model, current_range)
        irun, ihold = (scale_of(share / of_range, MOST) for share in shares)
        return irun, ihold, SCALER_FULL if strong else 0, current_range
    maker = IRUN_5160 if strong else IRUN
    if limits.current_max_a is not None and full is not None:
        maker = min(maker, scale_of(limits.current_max_a / full, MOST))
    return (*one.scales(MOST, maker, min(IHOLD, int(maker * HOLD_SHARE))), None, None)


async def start_up(device: Device, starts: Sequence[Start]) -> None:
    """Set a chip up after power-on, ready for `move` and `rotate`: one `Start` an axis.

    Raises BenchError at the first write that the chip did not take, with the rest not tried; UsageError for numbers
    that its registers cannot hold.
    """
    if len(starts) > len(device.axes):
        raise UsageError(f"a {device.family.title} has {len(device.axes)} axes, not {len(starts)}")
    second = any(start.counts_per_rev for start in starts[1:])
    for axis, start in enumerate(starts):
        for item in start_items(device, axis, start, right_switch=not second):
            await device.registers.write(item.name, item.axis, item.value, item.fields)


def start_items(
    device: Device, axis: int, start: Start, *, right_switch: bool = True, settings: AxisSettings | None = None
) -> Sequence[WriteItem]:
    """What `start_up` writes for one axis, in its order. Raises UsageError for numbers that no register can hold.

    right_switch : its pin is that of a switch, and not taken by the encoder of a second axis
    settings : of the axis as they will be; None for those that it has
    """
    strong = CHIPS[device.model].sensing.scaled

    def velocity(name: str, pps: float) -> WriteItem:
        return WriteItem(name, axis, _whole(name, velocity_units, pps, device.clock_hz))

    def rate(name: str, pps2: float | None) -> WriteItem:
        wanted = start.amax if pps2 is None else pps2
        return WriteItem(name, axis, _whole(name, acceleration_units, wanted, device.clock_hz))

    irun = (IRUN_5160 if strong else IRUN) if start.irun is None else start.irun
    ihold = IHOLD if start.ihold is None else start.ihold
    chopper = dict(CHOPCONF_5160 if strong else CHOPCONF)
    if start.microsteps is not None:
        chopper["mres"] = MICROSTEPS.index(start.microsteps)
    if start.select is not None and not strong:
        chopper["vsense"] = start.select
    stops, low = int(start.stops), int(start.stop_low_active)
    return [
        # At rest until the very last write: without a speed limit nothing moves.
        WriteItem("VMAX", axis, 0),
        WriteItem("RAMPMODE", axis, 0),
        *([WriteItem("TPOWERDOWN", axis, TPOWERDOWN)] if _has(device, "TPOWERDOWN", axis) else []),
        WriteItem("IHOLD_IRUN", axis, fields={"IHOLD": ihold, "IRUN": irun, "IHOLDDELAY": HOLD_DELAY}),
        *(
            [WriteItem("GLOBAL_SCALER", axis, start.select % SCALER_FULL)]
            if strong and start.select is not None
            else []
        ),
        *(
            [WriteItem("DRV_CONF", axis, fields={"CURRENT_RANGE": start.current_range})]
            if start.current_range is not None
            else []
        ),
        WriteItem("CHOPCONF", axis, fields=chopper),
        WriteItem(
            "SW_MODE",
            axis,
            fields={
                "stop_l_enable": stops,
                "stop_r_enable": stops if right_switch else 0,
                "pol_stop_l": low,
                "pol_stop_r": low,
            },
        ),
        *_encoder(device, axis, start, settings or device.axes[axis].settings),
        velocity("VSTART", start.vstart),
        velocity("VSTOP", max(start.vstop, start.vstart)),
        velocity("V1", start.v1),
        # without the further corners the ramp is that of the sisters
        *([WriteItem(name, axis, 0) for name in ("TVMAX", "V2", "A2")] if _has(device, "V2", axis) else []),
        rate("A1", start.a1),
        rate("D1", start.d1),
        *([rate("D2", start.d1)] if _has(device, "V2", axis) else []),
        rate("AMAX", start.amax),
        rate("DMAX", start.dmax),
        velocity("VMAX", start.vmax),
    ]


def _encoder(device: Device, axis: int, start: Start, settings: AxisSettings) -> Sequence[WriteItem]:
    if not start.counts_per_rev:
        return []
    microsteps = start.microsteps or TABLE_MICROSTEPS
    ratio = Fraction(settings.full_steps_per_rev * microsteps, start.counts_per_rev)
    decimal, word = encoder_constant(-ratio if start.invert_encoder else ratio)
    gconf = device.family.table.get("GCONF")
    second = axis > 0 and gconf.field_named("enc2_enable") is not None
    return [
        *([WriteItem("GCONF", None, fields={"enc2_enable": 1})] if second else []),
        WriteItem("ENCMODE", axis, fields={"enc_sel_decimal": int(decimal)}),
        WriteItem("ENC_CONST", axis, word),
        WriteItem("X_ENC", axis, 0),
        WriteItem("XTARGET", axis, 0),
        WriteItem("XACTUAL", axis, 0),
    ]


def encoder_constant(ratio: Fraction) -> tuple[bool, int]:
    """ENC_CONST for `ratio` microsteps a count, and whether it is decimal; the exact one of the two, or the nearer.

    The word is signed. Decimal negative: the integer part is one more below, and the fraction counts up from there
    (NOTES-TMC5XXX 8). Raises UsageError for a ratio that 16 bits before the point cannot hold.
    """
    if not 0 < abs(ratio) < 1 << 15:
        raise UsageError(f"an encoder of {float(ratio):g} microsteps a count: above 0 and below 32768 is possible")
    binary, decimal = round(ratio * 65536), round(ratio * DECIMAL)
    if abs(Fraction(binary, 65536) - ratio) <= abs(Fraction(decimal, DECIMAL) - ratio):
        return False, binary
    whole, fraction = divmod(decimal, DECIMAL)
    return True, whole * 65536 + fraction


def _whole(name: str, units: Callable[[float, float], int], value: float, clock_hz: float) -> int:
    try:
        return units(value, clock_hz)
    except ValueError as error:
        raise UsageError(f"{name}: {error}") from error


def _has(device: Device, name: str, axis: int) -> bool:
    return device.family.table.find(name, axis) is not None
