"""Getting a motor to run (DS-TMC428 chapter 13): everything that has to be set before the first target, in its
order."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from ...calc.driver_chain.chain import build_chain
from ...calc.driver_chain.signals import KNOWN_DRIVERS
from ...calc.microsteps.table import design_table
from ...calc.ramps.pmul_pdiv import design, inverse
from ...calc.units.mechanics import Mechanics
from ...errors import UsageError
from ..core.capabilities import DriverChainRam, MicrostepRam
from ..core.device import Device
from ..core.results import WriteItem
from ..core.start_up import AxisStartUp, StartPlan
from .memory import RampMemory


@dataclass(frozen=True, slots=True)
class AxisStart:
    """What one axis is set to, in register values. `usrs` is for chips that drive a chain.

    pmul and pdiv are designed from these, reduced as the data sheets advise. The stop switches are
    in force where `stops` is.
    """

    v_max: int
    a_max: int
    pulse_div: int
    ramp_div: int
    usrs: int = 6
    v_min: int = 1
    stops: bool = True


DRIVERS = ("tmc236", "tmc236", "tmc236")
STEP_DIR = "tmc4210"
"""Whose ramps are found without a microstep resolution of the chip's own."""
GLOBAL_AT, INTERFACE_AT = 0x3F, 0x34
CLK2_DIV = 7
"""The fastest clock of the driver chain, good for TMC236 and its family (DS-TMC428 9.7)."""


EIGHTHS, HOLD_EIGHTHS = 8, 4
"""Full scale, and what is enough at rest (DS-TMC428 8.9)."""
RAM_WORDS = 32
MICROSTEPS = (64, 32, 16, 8, 4, 2, 1)
CURRENTS = "is_agtat_is_aleat_is_v0_a_threshold"


async def start_up(device: Device, axes: Sequence[AxisStart], drivers: Sequence[str] = DRIVERS) -> None:
    """Set a chip up after power-on, ready for `move` and `rotate`.

    A TMC428 gets driver chain, microstep table, LSMD and global parameters with multiplexed
    switches sampled at rest, and so does a TMC429 that is not told to give steps (en_sd); a TMC4210 its step/direction
    output and right switch. Then each axis.

    Raises BenchError: at the first write that the chip did not take, with the rest not tried.
    """
    if _by_chain(device):
        # RAM first: as long as it is noise, a datagram to the chain may never end (DS-TMC428 chapter 11).
        chain = build_chain(drivers)
        await device.need(DriverChainRam).write_driver_chain(chain.ram_words, chain.lsmd)
        await device.need(MicrostepRam).write_microstep_table(design_table().values)
    for item in _global_items(device):
        await device.registers.write(item.name, item.axis, item.value, item.fields)
    for axis, start in enumerate(axes):
        for item in _axis_items(device, axis, start):
            await device.registers.write(item.name, item.axis, item.value, item.fields)


def _drivers(device: Device) -> list[str]:
    """The drivers that are named, of the other axes those of the makers' boards."""
    named = {axis: driver.model for axis, driver in device.drivers_behind() if driver.model in KNOWN_DRIVERS}
    return [named.get(axis.index, DRIVERS[axis.index]) for axis in device.axes]


async def plan(device: Device, wanted: Sequence[AxisStartUp]) -> StartPlan:
    """What a chip after power-on needs, in its order; all axes share the driver chain and the table."""
    spi = _by_chain(device)
    items = _global_items(device)
    tables: dict[str, Sequence[int]] = {}
    if spi:
        chain = build_chain(_drivers(device))
        words = [*chain.ram_words, *[0] * (RAM_WORDS - len(chain.ram_words))]
        tables = {"driver_chain": words, "microstep": design_table().values}
        items[0].fields = {**(items[0].fields or {}), "LSMD": chain.lsmd}
    for one in wanted:
        start = _start_of(device, one)
        items += _axis_items(device, one.axis, start)
        if spi:
            items.append(_currents(one))
        else:
            one.require_no_current("its step/direction driver sets the current")
    return StartPlan(items, tables)


def _start_of(device: Device, one: AxisStartUp) -> AxisStart:
    """The registers nearest to the figures. Raises UsageError where none are near."""
    figures = one.figures
    if figures.counts_per_rev:
        raise UsageError(f"a {device.family.title} reads no encoder: leave counts_per_rev out")
    if figures.stop_low_active:
        raise UsageError(f"the stop switches of a {device.family.title} have a polarity for all: write it by hand")
    spi = _by_chain(device)
    driver = one.settings.driver_microsteps
    microsteps = one.microsteps(MICROSTEPS[0], MICROSTEPS) if spi else driver
    if not spi and figures.microsteps not in (None, driver):
        raise UsageError("the step/direction driver makes the microsteps: set driver_microsteps of the axis")
    velocity, slope = one.velocity_pps(microsteps), one.acceleration_pps2(microsteps)
    if figures.deceleration_pps2 not in (None, slope):
        raise UsageError(f"a {device.family.title} brakes as it accelerates: leave deceleration_pps2 out")
    mechanics = Mechanics(one.settings.full_steps_per_rev, microsteps)
    try:
        near = inverse(device.model if spi else STEP_DIR, velocity, slope, mechanics, device.clock_hz)
    except ValueError as error:
        raise UsageError(str(error)) from error
    one.warnings += [f"axis {one.axis}: {said}" for said in near.warnings]
    return AxisStart(near.v_max, near.a_max, near.pulse_div, near.ramp_div, near.usrs or 0, stops=figures.stops)


def _currents(one: AxisStartUp) -> WriteItem:
    """Codes of an eighth each, 0 for full scale: one in motion, one at rest."""
    shares = one.share_of_full_scale()
    if shares is None:
        run, hold = one.scales(EIGHTHS, EIGHTHS, HOLD_EIGHTHS, least=1)
    else:
        run, hold = (max(1, min(EIGHTHS, int(share * EIGHTHS * (1 + 1e-9)))) for share in shares)
    codes = {"is_agtat": run, "is_aleat": run, "is_v0": hold}
    return WriteItem(CURRENTS, one.axis, fields={name: eighths % EIGHTHS for name, eighths in codes.items()})


def _memory(device: Device) -> RampMemory:
    memory = device.part(RampMemory)
    assert memory is not None  # this plans for no other family
    return memory


def _by_chain(device: Device) -> bool:
    """Whether the motors are driven through the chain of SPI drivers: a TMC429 told to give steps is not."""
    return _memory(device).drives_chain


def _global_items(device: Device) -> list[WriteItem]:
    table = device.family.table
    shared = table.at(GLOBAL_AT)
    assert shared is not None
    if _by_chain(device):
        return [WriteItem(shared.name, fields={"clk2_div": CLK2_DIV, "continuous_update": 1, "refmux": 1})]
    interface = table.at(INTERFACE_AT)
    assert interface is not None
    # A TMC429 has its right switches at pins of their own, or none.
    own = [WriteItem(shared.name, fields={"mot1r": 1})] if len(device.axes) == 1 else []
    return [WriteItem(interface.name, fields={"en_sd": 1}), *own]


def _axis_items(device: Device, axis: int, start: AxisStart) -> list[WriteItem]:
    pair = design(device.model, start.a_max, start.ramp_div, start.pulse_div, evaluate=False)
    if pair.pmul is None or pair.p_mul is None or pair.pdiv is None:
        raise UsageError(f"no pmul and pdiv fit a_max {start.a_max} with these dividers: {'; '.join(pair.warnings)}")
    rows = _memory(device).rows[axis]
    dividers: dict[str, int | str] = {"pulse_div": start.pulse_div, "ramp_div": start.ramp_div}
    if _by_chain(device):
        dividers["usrs"] = start.usrs
    # Without its fixed leading one the mantissa has seven bits.
    pmul = pair.pmul if rows.pmul.width == 7 else pair.p_mul
    ignored = int(not start.stops)
    return [
        WriteItem("v_min", axis, start.v_min),
        WriteItem("v_max", axis, start.v_max),
        WriteItem(rows.dividers.name, axis, fields=dividers),
        WriteItem("a_max", axis, start.a_max),
        WriteItem("pmul_pdiv", axis, fields={"pmul": pmul, "pdiv": pair.pdiv}),
        WriteItem(
            rows.reference.name,
            axis,
            fields={rows.mode.name: "RAMP_MODE", "disable_stop_l": ignored, "disable_stop_r": ignored},
        ),
    ]
