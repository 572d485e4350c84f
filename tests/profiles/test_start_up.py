"""A start-up of every model, from power-on: tried dry, applied, taken back where a write fails, and then a move."""

from __future__ import annotations

import math
from pathlib import Path

import pytest

from app.calc.families import CHIPS as CALCULATED
from app.devices.core.axis_limits import AxisLimits
from app.devices.core.config import AxisSettings
from app.devices.core.device import Device
from app.devices.core.start_up import Figures
from app.devices.manager import DeviceChange
from app.errors import CannotMove, OutOfRange, SoftLimit, UsageError, WrongState
from app.profiles.errors import ProfileTakenBack
from app.profiles.items import items_by_key
from app.profiles.service import ProfileService
from app.profiles.start_up import Motor, StartUp, StartUpRequest, dry_run, start_up
from app.registers.catalog import MODELS

from .harness import Bench, bench

RAMPS = [name for name, model in MODELS.items() if model.counts_position]
STEPPED = [name for name in MODELS if name not in RAMPS]
READABLE = [
    name for name, model in MODELS.items() if any(row.access.readable and row.access.writable for row in model.table)
]
"""Of the others nobody knows what was there before, so nothing can be taken back."""
CURRENTS = ["tmc5031", "tmc5062", "tmc5072", "tmc5130", "tmc5160"]


async def nothing(*_: object) -> None:
    """No settings of an axis change here."""


def service(tmp_path: Path) -> ProfileService:
    return ProfileService(tmp_path, lambda _: "", nothing)


async def value(device: Device, name: str, axis: int | None = None) -> int:
    return (await device.registers.read(name, axis)).value


async def cannot_move(device: Device) -> None:
    """From power-on a module moves, and what is stepped rotates: speed, or the bridges, go to 0 first."""
    if not device.family.counts_position:
        await device.registers.write("CHOPCONF", 0, fields={"toff": 0})
        own = device.family.can("own_velocity")
        with pytest.raises(CannotMove if own else WrongState, match="the driver is off" if own else "no velocity"):
            await device.motion.rotate(0, 1000)
        return
    if device.family.kind == "module":
        await device.registers.write("maximum_positioning_speed", value=0)
    for axis in device.axes:
        with pytest.raises(WrongState, match=r"cannot move|would not move|cannot change its speed"):
            await device.motion.move(axis.index, 1000)


async def settled(b: Bench, axis: int) -> int:
    for _ in range(40):
        await b.clock.advance(0.1)
        state = await b.device.monitor.axis_state(axis)
        if not state.moving and state.position_reached:
            return state.position
    raise AssertionError("it does not arrive")


async def moves(b: Bench, axis: int) -> None:
    """It moves as told, or rotates where it counts no position, or follows the steps that come in."""
    if b.device.family.counts_position:
        started = await b.device.motion.move(axis, 2_000)
        assert started.warnings == []
        assert await settled(b, axis) == 2_000
        return
    own = b.device.family.can("own_velocity")
    if own:
        await b.device.motion.rotate(axis, 20_000)
    else:
        b.stepped(20_000.0)
    await b.clock.advance(1.0)
    state = await b.device.monitor.axis_state(axis)
    if b.device.model in READABLE:
        assert state.velocity_pps == pytest.approx(20_000, rel=0.005)
    assert state.moving
    if not own:
        b.stepped(0.0)
        await b.clock.advance(0.5)
    assert (await b.device.stop_axes([axis]))[0].ok
    await b.clock.advance(0.5)


@pytest.mark.parametrize("model", MODELS)
async def test_a_model_from_power_on_moves_after_its_start_up(model: str, tmp_path: Path) -> None:
    async with bench(model, started=False) as b:
        await cannot_move(b.device)
        before = b.truth()
        tried = await dry_run(b.device, StartUpRequest())
        assert b.truth() == before, "a dry run writes nothing"
        assert (tried.written, tried.axes) == (None, [axis.index for axis in b.device.axes])
        done = await start_up(service(tmp_path), b.device, StartUpRequest())
        names = {(each.name, each.axis) for each in tried.diff.differences}
        assert {(each.name, each.axis) for each in done.written or ()} == names
        items = items_by_key(model)
        after = b.truth()
        for change in done.written or ():
            (key,) = [key for key, it in items.items() if (it.row.name, it.row.axis) == (change.name, change.axis)]
            assert items[key].row.decode(after[key]) == pytest.approx(change.wanted, abs=2), change
        for axis in b.device.axes:
            await moves(b, axis.index)
        again = await start_up(service(tmp_path), b.device, StartUpRequest())
        assert again.written == []


async def test_what_nobody_has_written_to_is_set_up_too(tmp_path: Path) -> None:
    async with bench("tmc2660", started=False) as b:
        done = await start_up(service(tmp_path), b.device, StartUpRequest())
        assert {each.name for each in done.written or ()} == {"DRVCONF", "DRVCTRL", "SMARTEN", "SGCSCONF", "CHOPCONF"}
        await moves(b, 0)


@pytest.mark.parametrize("model", READABLE)
async def test_a_write_that_fails_in_the_middle_is_taken_back(model: str, tmp_path: Path) -> None:
    async with bench(model, started=False) as b:
        await cannot_move(b.device)
        before = b.truth()
        steps = (await dry_run(b.device, StartUpRequest())).diff.writes
        write, done = b.device.registers.write, 0

        async def refusing(*args: object, **kwargs: object) -> object:
            nonlocal done
            done += 1
            if done == max(2, steps // 2):
                raise WrongState("not this one")
            return await write(*args, **kwargs)  # type: ignore[arg-type]

        b.device.registers.write = refusing  # type: ignore[method-assign, assignment]
        with pytest.raises(ProfileTakenBack) as caught:
            await start_up(service(tmp_path), b.device, StartUpRequest())
        assert (type(caught.value), caught.value.left) == (ProfileTakenBack, [])
        assert done > steps // 2
        assert b.truth() == before


async def test_one_axis_alone_is_set_up(tmp_path: Path) -> None:
    async with bench("tmc5072", started=False) as b:
        done = await start_up(service(tmp_path), b.device, StartUpRequest(axes=[1]))
        assert done.axes == [1]
        assert {each.axis for each in done.written or ()} <= {None, 1}
        with pytest.raises(WrongState):
            await b.device.motion.move(0, 100)
        await b.device.motion.move(1, 100)
        assert await settled(b, 1) == 100


@pytest.mark.parametrize("model", CURRENTS)
async def test_amperes_become_scales_by_the_sense_resistor(model: str, tmp_path: Path) -> None:
    """0.5 A of a coil by 0.22 ohm, a tenth at rest; the figures by the formula of each sheet, not below nor above."""
    async with bench(model, started=False) as b:
        motor = Motor(rated_current_a=0.5, sense_resistor_ohm=0.22)
        await start_up(service(tmp_path), b.device, StartUpRequest([0], Figures(hold_current_a=0.05), motor))
        chopconf = (await b.device.registers.read("CHOPCONF", 0)).fields
        held = b.device.registers.kept(0, ("current",))
        current = next(each for each in held if each.name.startswith("IHOLD_IRUN"))
        if model == "tmc5160":
            scaler = (
                next(each.value for each in b.device.registers.kept(0) if each.name.startswith("GLOBAL_SCALER")) or 256
            )
            full_a = 0.325 / 0.22 / math.sqrt(2) * scaler / 256
        else:
            volts = 0.18 if chopconf["vsense"] else (0.325 if model == "tmc5130" else 0.32)
            full_a = volts / (0.22 + 0.02) / math.sqrt(2)
        run_a, hold_a = (full_a * (current.fields[name] + 1) / 32 for name in ("IRUN", "IHOLD"))
        assert 0.47 < run_a <= 0.5
        assert hold_a == pytest.approx(0.05, abs=full_a / 32)


async def test_figures_and_motor_are_what_the_device_is_set_to(tmp_path: Path) -> None:
    async with bench("pd42-1241", started=False) as b:
        figures = Figures(velocity_pps=20_000.0, acceleration_pps2=40_000.0, microsteps=16, run_scale=99, hold_scale=9)
        done = await start_up(
            service(tmp_path), b.device, StartUpRequest(figures=figures, motor=Motor(full_steps_per_rev=400))
        )
        wanted = {"maximum_positioning_speed": 20_000, "maximum_acceleration": 40_000, "microstep_resolution": 4}
        wanted |= {"maximum_current": 99, "standby_current": 9, "motor_fullstep_resolution": 400}
        for name, number in wanted.items():
            assert await value(b.device, name) == pytest.approx(number, abs=5), name
        assert [each.name for each in done.settings] == ["full_steps_per_rev"]
        assert done.chosen == []


async def test_an_encoder_shows_the_position_when_its_resolution_is_set(tmp_path: Path) -> None:
    async with bench("tmc4361", started=False) as b:
        await b.device.registers.write("ENC_POS", 0, 700)
        done = await start_up(service(tmp_path), b.device, StartUpRequest(figures=Figures(counts_per_rev=40_000)))
        assert any("ENC_POS" in told for told in done.prepared)
        assert await value(b.device, "ENC_POS", 0) == 0


@pytest.mark.parametrize(
    ("model", "figures", "error", "told"),
    [
        ("tmc5031", Figures(microsteps=16), UsageError, "256"),
        ("tmc5031", Figures(counts_per_rev=4000), UsageError, "encoder"),
        ("tmc428", Figures(microsteps=256), UsageError, "64"),
        ("tmc428", Figures(run_scale=0), OutOfRange, "1..8"),
        ("tmc428", Figures(velocity_pps=5e6), UsageError, "unreachable"),
        ("tmc4210", Figures(run_current_a=1.0), UsageError, "driver sets the current"),
        ("tmc4361", Figures(run_scale=3), UsageError, "power stage"),
        ("tmc5160", Figures(run_current_a=1.0), UsageError, "sense_resistor_ohm"),
        ("tmc5160", Figures(run_scale=32), OutOfRange, "0..31"),
        ("pd42-1241", Figures(counts_per_rev=4000), UsageError, "encoder"),
        ("tmc2209", Figures(velocity_pps=1000.0), UsageError, "has no ramp: leave velocity_pps out"),
        ("tmc2209", Figures(acceleration_pps2=1000.0), UsageError, "has no ramp: leave acceleration_pps2 out"),
        ("tmc2209", Figures(counts_per_rev=4000), UsageError, "encoder"),
        ("tmc2209", Figures(run_scale=32), OutOfRange, "0..31"),
    ],
)
async def test_what_a_device_cannot_be_set_to_is_refused_before_anything_is_written(
    model: str, figures: Figures, error: type[UsageError], told: str, tmp_path: Path
) -> None:
    async with bench(model, started=False) as b:
        before = b.truth()
        for attempt in (
            dry_run(b.device, StartUpRequest(figures=figures)),
            start_up(service(tmp_path), b.device, StartUpRequest(figures=figures)),
        ):
            with pytest.raises(error, match=told):
                await attempt
        assert b.truth() == before


@pytest.mark.parametrize("model", RAMPS)
async def test_defaults_stay_within_the_soft_limits_and_wishes_beyond_are_refused(model: str, tmp_path: Path) -> None:
    async with bench(model, started=False) as b:
        limits = AxisLimits(velocity_max_pps=3_000.0, acceleration_max_pps2=10_000.0)
        axes = tuple(AxisSettings(limits=limits) for _ in b.device.axes)
        await b.manager.edit(b.device.id, DeviceChange(axes=axes))
        with pytest.raises(SoftLimit):
            await dry_run(b.device, StartUpRequest(figures=Figures(velocity_pps=100_000.0)))
        told: StartUp = await start_up(service(tmp_path), b.device, StartUpRequest())
        assert {each.name for each in told.chosen} >= {"velocity_pps", "acceleration_pps2"}
        await b.device.motion.move(0, 1_000)
        assert await settled(b, 0) == 1_000


@pytest.mark.parametrize("model", [name for name in STEPPED if name in READABLE])
async def test_currents_of_what_is_stepped_stay_within_the_soft_limits(model: str, tmp_path: Path) -> None:
    async with bench(model, started=False) as b:
        await b.device.registers.write("IHOLD_IRUN", 0, fields={"IRUN": 4, "IHOLD": 2})
        ranged = MODELS[model].current_scale == "full_scale"
        limits = AxisLimits(velocity_max_pps=3_000.0, current_max_a=0.5, sense_resistor_ohm=0.11)
        if ranged:  # after a reset in its lowest range
            limits = AxisLimits(current_max_a=0.1, current_full_scale_a=1.0)
        await b.manager.edit(b.device.id, DeviceChange(axes=(AxisSettings(limits=limits),)))
        with pytest.raises(SoftLimit):
            await dry_run(b.device, StartUpRequest(figures=Figures(run_scale=31)))
        told: StartUp = await start_up(service(tmp_path), b.device, StartUpRequest())
        if ranged:
            return
        (run,) = [each.value for each in told.chosen if each.name == "run_scale"]
        (volts, _) = CALCULATED[model].sensing.full_scale_v
        assert 0.9 * 0.5 < (run + 1) / 32 * volts / 0.13 / math.sqrt(2) <= 0.5
        if not MODELS[model].can("own_velocity"):
            return
        with pytest.raises(SoftLimit):
            await b.device.motion.rotate(0, 100_000)
        await b.device.motion.rotate(0, 2_900)
