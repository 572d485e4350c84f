"""Between the shapes of the contract and the records of the rooms behind it. No rules here, only translation."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import fields
from typing import cast

from pydantic import TypeAdapter, ValidationError

from ...calc.driver_chain.chain import Chain, build_chain, decode_chain
from ...calc.driver_chain.ram_words import unpack_words
from ...conditions.service import AxisAssessment, ConditionService
from ...deferred import DEFERRED
from ...devices.core import prediction, results
from ...devices.core.config import AxisSettings, slug, unique_slug
from ...devices.core.device import Device
from ...devices.core.results import StopOutcome
from ...devices.core.session import Axis
from ...emulators.build import family_of
from ...emulators.core.family import Emulator
from ...errors import UsageError, WrongState
from ...links.emulator import EmulatorPort
from ...links.registry import Link
from ...procedures import closed_loop
from ...procedures.closed_loop import Load
from ...registers.catalog import MODELS
from ..calc.schemas import Phase
from ..closed_loop.schemas import Recording, ResponseState, Score
from ..conditions.views import standing_out
from ..http.problems import findings, problem_of
from ..motion.schemas import AxisStateOut, MotionEnd, Prediction, StopResult, Switches
from ..schemas import (
    AxisConfig,
    AxisInfo,
    AxisLimits,
    ChannelInfo,
    DeviceInfo,
    DriverBehind,
    RegisterBatchResult,
    RegisterWritten,
)
from ..tables.schemas import ChainBit, ChainTable, DriverSpecIn
from .schemas import (
    AnyLink,
    Chip40Create,
    Chip40Link,
    ChipCreate,
    ChipLink,
    DriverCreate,
    DriverLink,
    ListedChipCreate,
    ListedChipLink,
    ListedCreate,
    ListedLink,
    ModuleCreate,
    ModuleLink,
    SixPointCreate,
    SixPointLink,
    of_model,
)


@contextmanager
def calculating() -> Iterator[None]:
    """The calculators refuse with ValueError, naming the range; at the edge that is the client's error."""
    try:
        yield
    except ValueError as error:
        raise UsageError(str(error)) from error


_LINKS: dict[str, TypeAdapter[AnyLink]] = {
    "chip": TypeAdapter(ChipLink, config=DEFERRED),
    "chip40": TypeAdapter(Chip40Link, config=DEFERRED),
    "sixpoint": TypeAdapter(SixPointLink, config=DEFERRED),
    "driver": TypeAdapter(DriverLink, config=DEFERRED),
    "module": TypeAdapter(ModuleLink, config=DEFERRED),
    "listed": TypeAdapter(ListedLink, config=DEFERRED),
    "listed-chip": TypeAdapter(ListedChipLink, config=DEFERRED),
}


def suited(link: AnyLink, model: str) -> AnyLink:
    """The link as that model understands it. Raises UsageError where it has no such link or option."""
    return require_suited(link.model_dump(exclude_unset=True) | {"kind": link.kind}, model)


def require_suited(link: Link, model: str) -> AnyLink:
    """`suited` for a link as it is kept."""
    try:
        return _LINKS[of_model({"model": model})].validate_python(dict(link))
    except ValidationError as error:
        raise UsageError(f"this link does not suit a {MODELS[model].title}: {findings(error)}") from error


def link_of(link: AnyLink, clock_hz: float | None) -> Link:
    """A link as it is kept: only what was said, so that defaults may become better.

    An emulated chip runs at the device's clock, unless it was told another one.
    """
    said = link.model_dump(mode="json", exclude_unset=True)
    said["kind"] = link.kind
    if _has_clock(link) and clock_hz is not None:
        said.setdefault("clock_hz", clock_hz)
    return said


def with_memory(
    link: Link,
    wanted: ChipCreate | Chip40Create | SixPointCreate | DriverCreate | ModuleCreate | ListedCreate | ListedChipCreate,
    others: Sequence[Device],
) -> Link:
    """An emulated module of a new connection gets a memory of its own, unless it was told another one."""
    if "eeprom" in type(wanted.link).model_fields.keys() - wanted.link.model_fields_set:
        taken = {str(other.link.get("eeprom")) for other in others}
        return {**link, "eeprom": unique_slug(slug(wanted.name)[:50], taken)}
    return link


def _has_clock(link: AnyLink) -> bool:
    """Whether it is to an emulated chip, which runs at a clock of its own."""
    return "clock_hz" in type(link).model_fields


def clock_of(link: AnyLink, clock_hz: float | None) -> float:
    """The clock that the driver reckons with [Hz]: as said, else the emulator's own; 0 for the model's default."""
    return clock_hz or link.model_dump(include={"clock_hz"}, exclude_unset=True).get("clock_hz", 0.0)


def axis_settings(axes: Sequence[AxisConfig] | None) -> tuple[AxisSettings, ...]:
    return tuple(AxisSettings.of(axis.model_dump()) for axis in axes or ())


def axis_config(settings: AxisSettings) -> AxisConfig:
    return AxisConfig(
        name=settings.name,
        full_steps_per_rev=settings.full_steps_per_rev,
        driver_microsteps=settings.driver_microsteps,
        gear_ratio=settings.gear_ratio,
        travel_mm_per_rev=settings.travel_mm_per_rev,
        limits=AxisLimits.model_validate(settings.limits),
        lost_steps_microsteps=settings.lost_steps_microsteps,
        following_error_microsteps=settings.following_error_microsteps,
    )


def axis_out(device: Device, state: results.AxisState, standing: AxisAssessment) -> AxisStateOut:
    """An axis as it was just read, with its condition."""
    read = {part.name: getattr(state, part.name) for part in fields(state)}
    read["switches"] = Switches.model_validate(state.switches)
    return AxisStateOut(**read, **standing_out(device, standing))


def device_info(device: Device, conditions: ConditionService, not_saved: str = "") -> DeviceInfo:
    """`not_saved` tells why the latest change of the connections is not on disk; "" where it is."""
    channels = device.telemetry.channels()
    own_rates = {channel.axis for channel in channels if channel.quantity == "velocity" and not channel.unit}
    return DeviceInfo(
        id=device.id,
        name=device.name,
        model=device.model,
        title=device.family.title,
        link=dict(device.link),
        clock_hz=device.clock_hz,
        state=device.state,
        problem=None if device.problem is None else problem_of(device.problem),
        notes=[
            *device.notes,
            *device.identity.shortcomings,
            *([not_saved] if not_saved and not device.config.demo else []),
        ],
        emulated=device.session.emulated,
        demo=device.config.demo,
        start_up=device.config.start_up,
        axes=[
            _axis_info(device, axis, conditions.standing(device, axis.index), rates_known=axis.index not in own_rates)
            for axis in device.axes
        ],
        drivers=[
            DriverBehind(
                axis=axis,
                device=driver.id,
                name=driver.name,
                model=driver.model,
                title=driver.family.title,
                state=driver.state,
            )
            for axis, driver in device.drivers_behind()
        ],
        channels=[ChannelInfo.model_validate(channel) for channel in channels],
        rate_max_hz=device.telemetry.rate_max_hz,
        chip_timed=device.session.chip_timed,
    )


def _axis_info(device: Device, axis: Axis, standing: AxisAssessment, *, rates_known: bool) -> AxisInfo:
    return AxisInfo(
        **standing_out(device, standing),
        index=axis.index,
        **dict(axis_config(axis.settings)),
        limit_warnings=device.limit_warnings(axis.index),
        microsteps_per_full_step=axis.microsteps_per_full_step,
        pulse_div=axis.pulse_div,
        ramp_div=axis.ramp_div,
        rates_known=rates_known,
    )


def stop_result(outcome: StopOutcome) -> StopResult:
    problem = None if outcome.problem is None else problem_of(outcome.problem)
    return StopResult(device=outcome.device, axis=outcome.axis, ok=outcome.ok, took_ms=outcome.took_ms, problem=problem)


def batch_result(result: results.BatchResult) -> RegisterBatchResult:
    return RegisterBatchResult(
        done=[RegisterWritten.model_validate(written) for written in result.done],
        failed=None if result.failed is None else problem_of(result.failed),
        not_tried=result.not_tried,
    )


def stops_out(ends: Sequence[results.MotionEnd]) -> list[MotionEnd]:
    """The latest first."""
    return [MotionEnd.model_validate(end) for end in reversed(ends)]


def prediction_out(expected: prediction.Prediction | None) -> Prediction | None:
    if expected is None:
        return None
    return Prediction(
        started_at_s=expected.started_at_s,
        duration_s=expected.duration_s,
        time_s=expected.time_s.tolist(),
        position=expected.position.tolist(),
        velocity_pps=expected.velocity_pps.tolist(),
        phases=[Phase.model_validate(phase) for phase in expected.phases],
    )


def response_out(state: closed_loop.ResponseState) -> ResponseState:
    recording = state.recording
    return ResponseState(
        state=state.state,
        phase=state.phase,
        progress=state.progress,
        message=state.message,
        started_at_s=state.started_at_s,
        recording=None if recording is None else _recording(recording),
        score=None if state.score is None else Score.model_validate(state.score),
    )


def _recording(recording: closed_loop.Recording) -> Recording:
    """NaN, which JSON does not know, becomes null."""
    columns = {
        field.name: [None if number != number else number for number in getattr(recording, field.name).tolist()]
        for field in fields(recording)
    }
    return Recording.model_validate(columns)


def load_of(device: Device, axis: int, torque_nm: float) -> Load:
    """How an emulated axis of `device` is loaded with `torque_nm` [Nm]. Raises WrongState for hardware."""
    if not isinstance(device.session.port, EmulatorPort):
        raise WrongState(f"{device.name} is not emulated here", "leave load_torque_nm out, and load it by hand")
    port = device.session.port
    wire = cast("Emulator", port.wire)
    load = family_of(wire.model).load
    if load is None:
        raise WrongState(f"{device.name} has no motor that a load could be put on")
    before_nm = load.read_nm(wire.state(port.take_turn()), axis)

    def put(load_nm: float) -> None:
        wire.patch(load.patch_of(axis, load_nm), port.take_turn())

    return Load(torque_nm, lambda: put(before_nm + torque_nm), lambda: put(before_nm))


def built_chain(drivers: Sequence[str | DriverSpecIn]) -> Chain:
    """Raises UsageError for drivers that make no chain."""
    with calculating():
        return build_chain(
            [driver if isinstance(driver, str) else driver.model_dump(exclude_none=True) for driver in drivers]
        )


def chain_table(ram_words: Sequence[int], lsmd: int) -> ChainTable:
    """What a RAM says, however it came about."""
    with calculating():
        decoded = decode_chain(ram_words, lsmd)
    return ChainTable(
        bits=[ChainBit.model_validate(bit) for bit in decoded.bits],
        ram_words=list(unpack_words(ram_words)),
        lsmd=decoded.lsmd,
        length_bits=decoded.length_bits,
        findings=[finding.text for finding in decoded.findings],
    )
