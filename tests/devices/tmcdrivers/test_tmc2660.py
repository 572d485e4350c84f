"""A TMC2660 over its emulator: written, never read back, but for a status."""

from __future__ import annotations

import math

import numpy as np
import pytest

from app.conditions.judge import AxisObservation, judge
from app.devices.core.axis_limits import AxisLimits
from app.devices.core.config import AxisSettings
from app.devices.core.start_up import AxisStartUp, Figures
from app.devices.tmcdrivers.family import plan
from app.errors import OutOfRange, SoftLimit, UsageError, WrongState
from app.links.spi_access import HIDDEN, TaggedAccess
from app.registers.tmcdrivers.tmc2660 import FORMAT
from tests.devices.tmcdrivers.harness import Bench, bench

MODEL = "tmc2660"
OHM = AxisSettings("x", limits=AxisLimits(sense_resistor_ohm=0.1, current_max_a=1.5))


async def set_up(b: Bench, **figures: float) -> None:
    one = AxisStartUp(0, b.device.config.axes[0], Figures(**figures))  # type: ignore[arg-type]
    result = await b.device.registers.write_many((await plan(b.device, [one])).items)
    assert result.failed is None


def words(b: Bench) -> dict[int, int]:
    """What the chip holds, by the maker's addresses."""
    return {FORMAT.address_of(tag << 17): word for tag, word in b.chip._chip.words.items()}  # type: ignore[attr-defined]


async def test_nothing_is_asked_before_something_is_written() -> None:
    async with bench(MODEL) as b:
        assert b.device.state == "connected"
        assert set(words(b).values()) == {0}, "no datagram has gone out: each would write"
        assert await b.device.registers.read_all() == []
        with pytest.raises(WrongState, match="write register 0xf once"):
            await b.device.registers.read("DRVSTATUS_SG")
        state = await b.state()
        assert state.flags == {}
        condition = judge(AxisObservation(0, "connected", state=state, signs=b.device.monitor.signs(0, state)))
        assert (condition.kind, condition.cause[:10]) == ("cannot_move", "nothing of")
        assert "may be there" in await b.device.identity.probe()


async def test_what_is_written_is_kept_and_told_as_kept() -> None:
    async with bench(MODEL) as b:
        done = await b.device.registers.write("SGCSCONF", None, fields={"CS": 20, "sgt": -3})
        assert (done.verified, "cannot say" in done.note) == (None, True)
        assert words(b)[0xE] == 20 | 0x7D << 8
        await b.device.registers.write("SGCSCONF", None, fields={"CS": 9})
        assert words(b)[0xE] == 9 | 0x7D << 8, "the other field as it was written before"
        (kept,) = b.device.registers.kept()
        assert (kept.name, kept.kept, kept.fields["sgt"]) == ("SGCSCONF", True, -3)
        with pytest.raises(WrongState, match="write only"):
            await b.device.registers.read("SGCSCONF")


async def test_reading_a_status_leaves_drvconf_as_it_was() -> None:
    async with bench(MODEL, motor="rigid") as b:
        await set_up(b)
        before = words(b)
        b.patch(pins={"step_hz": 1600.0})
        await b.clock.advance(0.5)
        state = await b.state()
        assert (state.moving, state.mode, state.flags["STST"]) == (True, "step/dir", False)
        assert (await b.value("DRVSTATUS_SG")) >> 10 > 0
        assert words(b) == before
        assert b.device.axes[0].microsteps_per_full_step == 16
        (outcome,) = await b.device.stop_axes([0])
        assert isinstance(outcome.problem, WrongState)
        with pytest.raises(WrongState, match="counts no position"):
            await b.device.motion.move(0, 100)


async def test_faults_are_told_with_what_helps() -> None:
    async with bench(MODEL) as b:
        await set_up(b)
        b.patch(motor={"temperature_c": 151.0, "short_to_ground": "b"})
        await b.clock.advance(0.01)
        state = await b.state()
        assert {name for name, on in state.flags.items() if on} >= {"OT", "OTPW"}
        condition = judge(AxisObservation(0, "connected", state=state, signs=b.device.monitor.signs(0, state)))
        assert (condition.kind, "too hot" in condition.cause) == ("driver_fault", True)


async def test_channels_ask_with_drvconf_as_it_is_now() -> None:
    async with bench(MODEL, motor="rigid") as b:
        telemetry = b.device.telemetry
        plan_ = telemetry.sample_plan(["load_value.0", "actual_current_scale.0", "driver_flags.0"])
        taken = await telemetry.take_samples(plan_)
        assert np.isnan(plan_.decode(np.asarray(taken.times_s), taken.replies[0])).all()
        await set_up(b, run_scale=11)
        await b.device.registers.write("DRVCONF", None, fields={"TS2G": 2})
        await b.clock.advance(0.01)
        taken = await telemetry.take_samples(plan_)
        _, scale, flags = plan_.decode(np.asarray(taken.times_s), taken.replies[0])[0]
        assert scale == 11
        assert int(flags) & 0x7F == 0
        assert words(b)[0xF] >> 8 & 3 == 2, "a question that was made before would have set it back"
        hidden = plan_.decode(np.zeros(1), b"\x00\x00\x01" * 4)[0]
        assert np.isnan(hidden[:2]).all()
        assert hidden[2] == 0


async def test_a_controller_may_hide_the_value_but_not_the_flags() -> None:
    access = TaggedAccess(FORMAT)
    replies = [b"\x00\x00\x00", (0x86 << 4 | HIDDEN).to_bytes(3, "big")]
    assert access.words_or_flags(replies) == [0x86]
    assert access.known(replies) == [False]
    with pytest.raises(WrongState, match="flags alone"):
        access.words(replies)


async def test_start_up_sets_currents_within_limits() -> None:
    async with bench(MODEL, OHM) as b:
        await set_up(b, run_current_a=1.0)
        conf, scale = words(b)[0xF], words(b)[0xE] & 0x1F
        volts = 0.165 if conf >> 6 & 1 else 0.310
        amperes = volts / 0.1 / math.sqrt(2) * (scale + 1) / 32
        assert 0.9 < amperes <= 1.0
        assert words(b)[0xC] & 0xF
        with pytest.raises(OutOfRange, match="full scale"):
            await set_up(b, run_current_a=2.5)
        with pytest.raises(UsageError, match="no such thing"):
            await set_up(b, velocity_pps=100.0)
        with pytest.raises(SoftLimit):
            await b.device.registers.write("DRVCONF", None, fields={"vsense": 0})
        with pytest.raises(SoftLimit):
            await b.device.raw.exchange((0b111 << 17).to_bytes(3, "big"))
        done = await b.device.raw.exchange((0b110 << 17 | 3).to_bytes(3, "big"))
        assert (done.decoded["register"], done.decoded["fields"]["CS"]) == ("SGCSCONF", 3)  # type: ignore[index]


async def test_a_datagram_by_hand_tells_what_was_selected_before_it() -> None:
    async with bench(MODEL) as b:
        raw = await b.device.raw.exchange((7 << 17 | 2 << 4).to_bytes(3, "big"))
        assert raw.decoded["answer"] == {}, "nobody knows what it shows"
        await set_up(b, run_scale=9)
        await b.clock.advance(0.1)
        raw = await b.device.raw.exchange((7 << 17 | 1 << 4).to_bytes(3, "big"))
        assert raw.decoded["answer"] == {"SE": 9, "SG_UPPER": 0}
        assert raw.decoded["flags"] == {"SG": False, "OT": False, "OTPW": False} | dict.fromkeys(
            ("S2GA", "S2GB", "OLA", "OLB"), False
        ) | {"STST": True}
        raw = await b.device.raw.exchange((7 << 17 | 1 << 4).to_bytes(3, "big"))
        assert list(raw.decoded["answer"]) == ["SG_RESULT"]  # type: ignore[call-overload]


async def test_after_a_failure_of_the_link_nothing_is_known() -> None:
    async with bench(MODEL) as b:
        await set_up(b)
        assert len(b.device.registers.kept()) == 5
        b.patch(faults={"unplugged": True})
        await b.clock.advance(3.0)
        states = [b.device.state]
        b.patch(faults={"unplugged": False})
        await b.clock.advance(3.0)
        states.append(b.device.state)
        assert states == ["failed", "connected"]
        assert [one.name for one in b.device.registers.kept()] == ["DRVCONF"], "what a question writes anyway"
