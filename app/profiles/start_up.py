"""Start-up: a device set up after power-on so that its axes can move, tried dry or applied as one transaction.

The family plans it (`devices.starting`); what it plans becomes a profile of just these registers, so that comparing,
applying with read-back and the rollback are those of profiles.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace

from ..devices.core.config import AxisSettings
from ..devices.core.device import Device
from ..devices.core.results import WriteItem
from ..devices.core.start_up import AxisStartUp, Chosen, Figures, StartPlan
from ..devices.families import family_of
from ..errors import UsageError
from ..registers.model import Register, to_raw
from .capture import axis_part, unread
from .diff import Diff, Difference, diff
from .document import ParameterPart, ProfileDocument, RegisterPart, Tables
from .errors import Change
from .items import Key, items_by_key, key_of
from .service import ProfileService
from .steps import steps_of

NAME = "start-up"


@dataclass(frozen=True, slots=True)
class Motor:
    """What a motor and its power stage are; None as the axis's settings have it.

    rated_current_a : of a coil, RMS [A]
    sense_resistor_ohm, current_full_scale_a : as in the soft limits of an axis; used here, not kept
    """

    full_steps_per_rev: int | None = None
    rated_current_a: float | None = None
    sense_resistor_ohm: float | None = None
    current_full_scale_a: float | None = None


@dataclass(frozen=True, slots=True)
class StartUpRequest:
    """Which axes shall be set up, none for all, for which motor, and how they shall move."""

    axes: Sequence[int] = ()
    figures: Figures = field(default_factory=Figures)
    motor: Motor = field(default_factory=Motor)


@dataclass(frozen=True, slots=True)
class StartUp:
    """What a start-up writes, or has written: `written` is None of a dry run.

    chosen : figures that nobody asked for, and why they are these
    prepared : what was done before, so that nothing moves; it stays
    """

    axes: list[int]
    diff: Diff
    chosen: list[Chosen]
    warnings: list[str]
    written: list[Change] | None = None
    prepared: Sequence[str] = ()
    settings: Sequence[Difference] = ()
    took_s: float | None = None


async def dry_run(device: Device, wish: StartUpRequest) -> StartUp:
    """What a start-up would write. Raises what `start_up` would before its first write, but for an axis that moves."""
    device.session.require_connected()
    wanted, plan = await _plan(device, wish)
    document = _document(device, wanted, plan)
    await device.registers.check_writes([step.write() for step in steps_of(document)])
    return _told(wanted, plan, await diff(device, document))


async def start_up(profiles: ProfileService, device: Device, wish: StartUpRequest) -> StartUp:
    """Set the device up: all of it, or as it was before. Raises what `ProfileService.apply` does, and UsageError for
    figures that its registers cannot hold."""
    device.session.require_connected()
    wanted, plan = await _plan(device, wish)
    outcome = await profiles.apply(device, _document(device, wanted, plan), encoders=plan.encoders)
    applied = outcome.applied
    return replace(
        _told(wanted, plan, applied.diff),
        written=applied.written,
        prepared=applied.prepared,
        settings=outcome.settings,
        took_s=outcome.took_s,
    )


def _told(wanted: Sequence[AxisStartUp], plan: StartPlan, difference: Diff) -> StartUp:
    warnings = [*difference.warnings, *plan.warnings, *(text for one in wanted for text in one.warnings)]
    return StartUp([one.axis for one in wanted], difference, [each for one in wanted for each in one.chosen], warnings)


async def _plan(device: Device, wish: StartUpRequest) -> tuple[list[AxisStartUp], StartPlan]:
    axes = sorted({device.axis(axis).index for axis in wish.axes}) or [axis.index for axis in device.axes]
    wanted = [
        AxisStartUp(axis, _with_motor(device.axes[axis].settings, wish.motor), wish.figures, wish.motor.rated_current_a)
        for axis in axes
    ]
    return wanted, await family_of(device.model).start_plan(device, wanted)


def _with_motor(settings: AxisSettings, motor: Motor) -> AxisSettings:
    limits = settings.limits
    if motor.sense_resistor_ohm is not None:
        limits = replace(limits, sense_resistor_ohm=motor.sense_resistor_ohm, current_full_scale_a=None)
    if motor.current_full_scale_a is not None:
        limits = replace(limits, current_full_scale_a=motor.current_full_scale_a)
    full_steps = settings.full_steps_per_rev if motor.full_steps_per_rev is None else motor.full_steps_per_rev
    return replace(settings, full_steps_per_rev=full_steps, limits=limits)


def _document(device: Device, wanted: Sequence[AxisStartUp], plan: StartPlan) -> ProfileDocument:
    """The plan as a profile of these registers alone; what is no configuration is left out."""
    table, items = device.family.table, items_by_key(device.model)
    rows: dict[Key, Register] = {}
    values: dict[Key, WriteItem] = {}
    for item in plan.items:
        found = table.find(item.name, item.axis)
        if found is None:
            raise UsageError(f"a {device.family.title} has no register {item.name}")
        key = key_of(found[0])
        known = items.get(key)
        if known is None or known.row is not found[0]:
            continue  # state: the transaction itself keeps the axis where it stands
        if item.value is not None:
            item = replace(item, value=known.row.decode(to_raw(item.value, known.row.width) & known.mask))
        if item.fields is not None:
            before = values[key].fields if key in values else _unknown_fields(device, known.row)
            item = replace(item, fields={**(before or {}), **item.fields})
        rows[key], values[key] = found[0], item
    settings = [axis.settings for axis in device.axes]
    for one in wanted:
        settings[one.axis] = replace(settings[one.axis], full_steps_per_rev=one.settings.full_steps_per_rev)
    registers = [_register(rows[key], item) for key, item in values.items()] if device.family.kind == "chip" else []
    parameters = [
        ParameterPart(name=rows[key].name, value=item.value or 0)
        for key, item in values.items()
        if device.family.kind == "module"
    ]
    return ProfileDocument(
        name=NAME,
        model=device.model,
        clock_hz=device.clock_hz,
        axes=[axis_part(each) for each in settings],
        registers=registers,
        parameters=parameters,
        tables=Tables.model_validate({name: list(words) for name, words in plan.tables.items()}),
    )


def _register(row: Register, item: WriteItem) -> RegisterPart:
    return RegisterPart(
        name=row.name, axis=row.axis, value=item.value, fields=None if item.fields is None else dict(item.fields)
    )


def _unknown_fields(device: Device, row: Register) -> dict[str, int | str]:
    """All fields, as after a reset, of a register that cannot be read and of which nobody knows what it holds."""
    item = items_by_key(device.model)[key_of(row)]
    if row.access.readable or unread(device, item) is not None:
        return {}
    return {part.name: part.unpack(row.reset or 0) for part in item.fields}
