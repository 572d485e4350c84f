"""Drivers behind 40-bit datagrams, over their emulators: what differs from a UART and a velocity of their own."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from app.conditions.judge import AxisObservation, judge
from app.devices.core.axis_limits import AxisLimits
from app.devices.core.capabilities import LatchedFlags, MslutTable
from app.devices.core.config import AxisSettings
from app.devices.core.start_up import AxisStartUp, Figures
from app.devices.tmcdrivers.start_up import plan
from app.errors import OtherModel, SoftLimit, WrongState
from app.links import datagram40
from tests.devices.tmcdrivers.harness import Bench, bench

MODEL = "tmc2130"


async def stepped(b: Bench, hz: float) -> None:
    b.patch(pins={"step_hz": hz})
    await b.clock.advance(0.5)


async def test_it_finds_its_chip_and_no_other() -> None:
    async with bench(MODEL) as b:
        assert await b.device.identity.probe() == "a TMC2130 answers, version 0x11"
        b.chip._chip.kind = replace(b.chip._chip.kind, version=0x30)
        with pytest.raises(OtherModel, match="0x30"):
            await b.device.identity.probe()


async def test_writes_are_read_back_or_come_back_with_the_next_datagram() -> None:
    async with bench(MODEL) as b:
        done = await b.device.registers.write("CHOPCONF", None, fields={"toff": 5})
        assert (done.verified, done.fields["toff"]) == (True, 5)
        done = await b.device.registers.write("COOLCONF", None, fields={"sgt": -3})
        assert (done.verified, b.held("COOLCONF") >> 16 & 0x7F) == (True, 0x7D)


@pytest.mark.parametrize("way", [1, -1])
async def test_it_follows_steps_and_says_who_could_stop_them(way: int) -> None:
    async with bench(MODEL, motor="rigid") as b:
        await b.put(IHOLD_IRUN=0x10_08, CHOPCONF=0x0401_01D5)  # 16 microsteps
        await stepped(b, way * 1600.0)
        state = await b.state()
        assert (state.moving, state.mode) == (True, "step/dir")
        assert state.velocity_pps == pytest.approx(way * 1600, rel=0.01)
        assert b.device.axes[0].microsteps_per_full_step == 16
        (outcome,) = await b.device.stop_axes([0])
        assert isinstance(outcome.problem, WrongState)
        with pytest.raises(WrongState, match="no velocity of its own"):
            await b.device.motion.rotate(0, 100.0)
        await stepped(b, 0.0)
        (outcome,) = await b.device.stop_axes([0])
        assert outcome.ok


async def test_what_reading_gstat_clears_is_kept_for_its_user() -> None:
    async with bench(MODEL) as b:
        state = await b.state()
        before = b.device.monitor.signs(0, state).resets or 0
        b.patch(power_cycle=True)
        for _ in range(2):
            state = await b.state()
            assert state.flags["reset"]
        assert b.device.monitor.signs(0, state).resets == before + 1
        assert await b.value("GSTAT") == 1
        assert await b.value("GSTAT") == 0
        b.patch(power_cycle=True)
        assert await b.value("GSTAT") == 1, "nobody has looked before its user"
        assert b.device.monitor.signs(0, await b.state()).resets == before + 2
        b.patch(power_cycle=True)
        assert (await b.state()).flags["reset"]
        await b.device.need(LatchedFlags).clear_flags(0)
        assert not (await b.state()).flags["reset"]


async def test_a_datagram_by_hand_that_reads_gstat_is_heard() -> None:
    async with bench(MODEL) as b:
        await b.state()
        before = b.device.monitor.signs(0, await b.state()).resets or 0
        await b.put(COOLCONF=5)
        b.patch(power_cycle=True)
        answer = await b.device.raw.exchange(datagram40.read(0x01))
        assert answer.decoded["fields"] == {"reset": 1, "drv_err": 0, "uv_cp": 0}
        assert b.device.monitor.signs(0, await b.state()).resets == before + 1
        assert [r.value for r in b.device.registers.kept(0) if r.name == "COOLCONF"] == [0]


async def test_a_stall_is_a_flag_and_a_channel() -> None:
    async with bench(MODEL) as b:
        await b.put(IHOLD_IRUN=0x1F_08, CHOPCONF=0x0001_01D5, TCOOLTHRS=0xFFFFF, COOLCONF=0x40 << 16)
        await stepped(b, 51_200.0)
        b.patch(load_torque_nm=0.2)
        await stepped(b, 51_200.0)
        assert (await b.state()).flags["StallGuard"]
        names = ["driver_flags.0", "load_value.0", "velocity.0"]
        samples = b.device.telemetry.sample_plan(names)
        taken = await b.device.telemetry.take_samples(samples)
        row = samples.decode(np.asarray(taken.times_s), b"".join(taken.replies))[0]
        assert int(row[0]) & 1
        assert row[1] < 1023
        assert row[2] == pytest.approx(51_200, rel=0.01)


@pytest.mark.parametrize(
    ("change", "kind", "words"),
    [
        ({"motor": {"short_to_ground": "b"}}, "driver_fault", "phase B is shorted"),
        ({"motor": {"temperature_c": 160.0}}, "driver_fault", "too hot"),
        ({"motor": {"temperature_c": 130.0}}, "ready", "the driver warns that it is hot"),
        ({"pins": {"enn": True}}, "cannot_move", "ENN"),
        ({"power_cycle": True}, "cannot_move", "the driver is off"),
    ],
)
async def test_conditions(change: dict[str, object], kind: str, words: str) -> None:
    async with bench(MODEL) as b:
        await b.put(IHOLD_IRUN=0x10_08, CHOPCONF=0x0001_01D5)
        b.patch(**change)
        await b.clock.advance(0.01)
        state = await b.state()
        found = judge(AxisObservation(0, "connected", state=state, signs=b.device.monitor.signs(0, state)))
        assert (found.kind, words in found.cause) == (kind, True), found


@pytest.mark.parametrize(("model", "readable"), [(MODEL, False), ("tmc2240", True)])
async def test_the_microstep_table_is_written_and_told(model: str, readable: bool) -> None:
    async with bench(model) as b:
        table = b.device.need(MslutTable)
        held = await table.read_mslut()
        assert (held.written, held.registers.words[0], held.registers.start) == (readable, 0xAAAAB554, 0xF70000)
        changed = type(held.registers)((*held.registers.words[:7], 0x404223), held.registers.select, 0xF80001)
        held = await table.write_mslut(changed)
        assert (held.written, held.registers, b.held("MSLUT[7]")) == (True, changed, 0x404223)


async def test_start_up_by_amperes_and_the_limit_of_current() -> None:
    limits = AxisLimits(sense_resistor_ohm=0.11, current_max_a=1.0)
    async with bench(MODEL, AxisSettings("x", limits=limits)) as b:
        wanted = AxisStartUp(0, b.device.axes[0].settings, Figures(run_current_a=0.97, microsteps=16))
        done = await b.device.registers.write_many((await plan(b.device, [wanted])).items)
        assert done.failed is None
        chopconf = b.device.family.table.get("CHOPCONF", 0).unpack(await b.value("CHOPCONF"))
        assert (chopconf["toff"], chopconf["hstrt"], chopconf["hend"], chopconf["mres"]) == (5, 5, 3, 4)
        full_v = 0.18 if chopconf["vsense"] else 0.32
        rms = full_v / 0.13 * ((b.held("IHOLD_IRUN") >> 8 & 31) + 1) / 32 / 2**0.5
        assert rms == pytest.approx(0.97, rel=0.03)
        await stepped(b, 1600.0)
        assert b.chip.ground_truth(0).shaft_fullsteps == pytest.approx(50, abs=2)
        with pytest.raises(SoftLimit):
            await b.device.registers.write("CHOPCONF", None, fields={"vsense": 0})


async def test_a_tmc2240_measures_its_load_temperature_and_supply() -> None:
    async with bench("tmc2240") as b:
        assert await b.device.identity.probe() == "a TMC2240 answers, version 0x40"
        await b.put(GCONF=0xC, IHOLD_IRUN=0x1F_08, CHOPCONF=0x1041_0153, DRV_CONF=2)
        b.patch(supply_v=30.0, motor={"temperature_c": 55.0})
        await stepped(b, 51_200.0)
        samples = b.device.telemetry.sample_plan(["stallguard4.0", "chip_temperature.0", "supply.0"])
        taken = await b.device.telemetry.take_samples(samples)
        load, celsius, volts = samples.decode(np.asarray(taken.times_s), b"".join(taken.replies))[0]
        assert load == await b.value("SG4_RESULT") > 0
        assert celsius == pytest.approx(55, abs=0.1)
        assert volts == pytest.approx(30, abs=0.01)


async def test_a_tmc2240_starts_up_in_the_lowest_range_that_will_do_and_keeps_its_limit() -> None:
    limits = AxisLimits(current_full_scale_a=2.1, current_max_a=1.2)
    async with bench("tmc2240", AxisSettings("x", limits=limits)) as b:
        wanted = AxisStartUp(0, b.device.axes[0].settings, Figures(run_current_a=1.0, microsteps=16))
        done = await b.device.registers.write_many((await plan(b.device, [wanted])).items)
        assert done.failed is None
        assert (b.held("DRV_CONF") & 3, b.held("GLOBAL_SCALER")) == (1, 0)
        rms = 2.1 * 24 / 36 * ((b.held("IHOLD_IRUN") >> 8 & 31) + 1) / 32
        assert rms == pytest.approx(1.0, rel=0.04)
        with pytest.raises(SoftLimit):
            await b.device.registers.write("DRV_CONF", None, fields={"CURRENT_RANGE": 2})
        with pytest.raises(SoftLimit):
            await b.device.registers.write("IHOLD_IRUN", None, fields={"IRUN": 31})
