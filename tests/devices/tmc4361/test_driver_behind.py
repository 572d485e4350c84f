"""The driver behind a TMC4361: datagrams to it, their answers, and what keeps them from going out."""

from __future__ import annotations

import pytest

from app.conditions.judge import AxisObservation, Condition, judge
from app.devices.core.capabilities import EventLog, StallStop
from app.devices.core.config import DeviceConfig
from app.devices.core.cover import CoverCarrier, CoverPort
from app.devices.core.device import Device
from app.emulators.tmc4361 import Tmc4361Patch
from app.emulators.tmc4361.options import FaultsChange
from app.errors import LinkDown, LinkTimeout, WrongState
from app.procedures.procedures import Procedures
from app.procedures.search import ReferenceSearchState
from app.procedures.stall_search import StallWanted
from tests.devices.tmc4361.harness import Bench, bench

TIMES = 4 << 20 | 4 << 24 | 4 << 28
TO_STEPS, TO_CURRENTS = 11 | TIMES, 10 | TIMES
DRVCONF = {TO_STEPS: 0xEF010, TO_CURRENTS: 0xEF090}
SMARTEN, SGCSCONF, DRVCTRL, CHOPCONF = 0xA0000, 0xD001F, 0x00000, 0x901B4
SETTINGS = ("REFERENCE_CONF", "SPI_OUT_CONF")
END = -60.3
STAGE: dict[str, object] = {
    "left_at_fullsteps": -3000,
    "right_at_fullsteps": 3000,
    "left_end_fullsteps": END,
    "right_end_fullsteps": 2000,
}


async def set_up(b: Bench, output: int = TO_STEPS) -> CoverCarrier:
    carrier = b.device.need(CoverCarrier)
    await b.device.registers.write("SPI_OUT_CONF", 0, output)
    control = (DRVCTRL,) if output == TO_STEPS else ()
    await carrier.cover(0, 20, (DRVCONF[output], SMARTEN, SGCSCONF, *control, CHOPCONF))
    await b.clock.advance(0.3)
    return carrier


async def condition(b: Bench) -> Condition:
    """Of the axis, judged as the service does."""
    state = await b.state()
    return judge(AxisObservation(0, "connected", state=state, signs=b.device.monitor.signs(0, state)))


async def test_a_datagram_s_answer_comes_back_with_it() -> None:
    async with bench(driver="tmc2660") as b:
        carrier = await set_up(b)
        chosen = DRVCONF[TO_STEPS] & ~0x30
        answers = await carrier.cover(0, 20, (chosen, chosen))
        assert answers[-1].known == 0xF_FFFF
        flags, place = answers[-1].word & 0xFF, answers[-1].word >> 10
        assert flags == 0x80, "it stands"
        assert place == b.wire.state().truth.field_fullsteps * 256 // 1 % 1024
        assert await carrier.cover(0, 20, ()) == []
        assert b.wire.state().driver_words["SGCSCONF"] == SGCSCONF


async def test_an_output_that_is_off_or_another_carries_nothing() -> None:
    async with bench(driver="tmc2660") as b:
        carrier = b.device.need(CoverCarrier)
        with pytest.raises(WrongState, match="its SPI output is off"):
            await carrier.cover(0, 20, (SMARTEN,))
        await b.device.registers.write("SPI_OUT_CONF", 0, 13 | TIMES)
        with pytest.raises(WrongState, match="40 bits to the driver of axis 0, not 20"):
            await carrier.cover(0, 20, (SMARTEN,))
        await b.device.registers.write("SPI_OUT_CONF", 0, 10 | 24 << 13 | TIMES)
        with pytest.raises(WrongState, match="24 bits"):
            await carrier.cover(0, 20, (SMARTEN,))
        assert b.wire.state().driver_words["SMARTEN"] >> 17 == 5
        assert b.wire.state().driver_words["SMARTEN"] & 0x1FFFF == 0


async def test_an_answer_is_read_only_when_it_must_have_come() -> None:
    async with bench(driver="tmc2660") as b:
        carrier = await set_up(b)
        await b.device.registers.write("SPI_OUT_CONF", 0, 11 | 15 << 20 | 15 << 24 | 15 << 28)
        b.port.frames.clear()
        await carrier.cover(0, 20, (SMARTEN,))
        covered = next(at for at, frame in enumerate(b.port.frames) if frame[0] == 0xEC)
        answer = next(at for at, frame in enumerate(b.port.frames) if frame[0] == 0x6E)
        assert (answer - covered - 1) * 160 >= 20 * 30 + 15, "a datagram of the host takes 160 clocks at least"


async def test_a_datagram_is_never_sent_twice() -> None:
    async with bench(driver="tmc2660") as b:
        carrier = await set_up(b)
        b.port.frames.clear()

        def hush(frame: bytes) -> None:
            if frame[0] == 0xEC:
                b.wire.patch(Tmc4361Patch(faults=FaultsChange(silence=True)))

        b.port.before_frame = hush
        with pytest.raises(LinkTimeout):
            await carrier.cover(0, 20, (SMARTEN,))
        assert b.port.written(0x6C) == [SMARTEN]


async def test_a_driver_s_own_link_leads_through_the_chip() -> None:
    async with bench(driver="tmc2660") as b:
        await set_up(b)
        port = CoverPort(b.manager.get, b.device.id, 0, "tmc2660", b.clock)
        await port.require_way()
        reply = await port.exchange(b"\x0a\x00\x00")
        assert int.from_bytes(reply, "big") >> 4 & 0xFF == 0x80, "it stands"
        await b.device.registers.write("SPI_OUT_CONF", 0, 0)
        with pytest.raises(LinkDown, match="SPI output is off"):
            await port.require_way()


@pytest.mark.parametrize("output", [TO_STEPS, TO_CURRENTS])
async def test_the_end_of_the_stage_is_found_by_stall_and_settings_are_as_before(output: int) -> None:
    async with bench(driver="tmc2660", stage=STAGE) as b:
        await set_up(b, output)
        before = [(await b.device.registers.read(name, 0)).value for name in SETTINGS]
        procedures = Procedures(b.clock)
        procedures.start_stall_search(b.device, 0, StallWanted(hits=2))
        state = await over(b, procedures)
        assert state.state == "done", state.message
        assert len(state.edges) == 2
        assert b.wire.state().stage.position_fullsteps == pytest.approx(END, abs=1.5)
        assert (await b.state()).position == 0
        assert [(await b.device.registers.read(name, 0)).value for name in SETTINGS] == before
        assert b.wire.state().driver_words["SGCSCONF"] == SGCSCONF


async def test_without_a_driver_that_measures_the_search_says_so() -> None:
    async with bench() as b:
        stall = b.device.need(StallStop)
        with pytest.raises(WrongState, match="names no TMC26x behind"):
            await stall.stall_threshold(0)
        await b.device.registers.write("SPI_OUT_CONF", 0, TO_STEPS)
        with pytest.raises(WrongState, match="none of it can be read"):
            await stall.stall_threshold(0)
        await b.device.registers.write("COVER_LOW", 0, SGCSCONF | 5 << 8)
        await b.device.registers.write("COVER_LOW", 0, DRVCONF[TO_STEPS])
        assert await stall.stall_threshold(0) == 5


async def test_a_hot_driver_is_a_fault_by_name() -> None:
    async with bench(driver="tmc2660") as b:
        await set_up(b)
        b.patch(Tmc4361Patch.model_validate({"motor": {"temperature_c": 160.0}}))
        await b.clock.advance(0.1)
        state = await b.state()
        assert state.flags["OT"]
        faults = b.device.monitor.signs(0, state).faults
        assert [sign.cause for sign in faults] == ["the motor driver is too hot and has switched off"]


async def driven(b: Bench) -> None:
    """A driver of its own name behind the axis, set up to follow steps."""
    await b.device.registers.write("SPI_OUT_CONF", 0, TO_STEPS)
    link = {"kind": "cover", "device": b.device.id, "axis": 0}
    driver = await b.manager.add(DeviceConfig("the feed", "tmc2660", link))
    for name, word in (
        ("DRVCONF", DRVCONF[TO_STEPS]),
        ("SMARTEN", SMARTEN),
        ("SGCSCONF", SGCSCONF),
        ("DRVCTRL", DRVCTRL),
        ("CHOPCONF", CHOPCONF),
    ):
        await driver.registers.write(name, 0, word & 0x1FFFF)
    await b.clock.advance(0.3)


@pytest.mark.parametrize(
    ("change", "kind", "cause", "flag"),
    [
        ({"motor": {"temperature_c": 120.0}}, "moving", "it moves; the feed warns that it is hot", "OTPW"),
        ({"motor": {"temperature_c": 160.0}}, "driver_fault", "the feed is too hot", "OT"),
        ({"motor": {"short_to_ground": "b"}}, "driver_fault", "the feed has switched off: a short in phase B", "S2GB"),
        ({"motor": {"connected": False}}, "driver_fault", "the feed finds no load at coils A and B", "OLA"),
        ({"blocked": True}, "stalled", "the feed tells of a stall", "SG"),
    ],
)
async def test_what_a_named_driver_tells_is_a_condition_by_its_name_and_what_the_motor_event_was(
    change: dict[str, object], kind: str, cause: str, flag: str
) -> None:
    async with bench(driver="tmc2660") as b:
        await driven(b)
        await b.device.registers.write("STEP_CONF", 0, fields={"OTPW": 1})
        await b.device.motion.rotate(0, 20_000.0)
        await b.clock.advance(1.5)
        assert (await condition(b)).kind == "moving"
        log = b.device.need(EventLog)  # type: ignore[type-abstract, unused-ignore]
        seen = log.events(0).next
        b.patch(Tmc4361Patch.model_validate(change))
        await b.clock.advance(0.5)
        found = await condition(b)
        assert (found.kind, found.cause[: len(cause)]) == (kind, cause)
        told = [entry.names for entry in log.events(0, seen).events]
        assert any("MOTOR_EV" in names and f"driver_{flag}" in names for names in told), told
        assert sum(f"driver_{flag}" in names for names in told) == 1, "once while it stays"


async def test_a_flag_that_makes_no_motor_event_is_no_event() -> None:
    async with bench(driver="tmc2660") as b:
        await driven(b)
        await b.device.registers.write("STEP_CONF", 0, fields={"OTPW": 0})
        b.patch(Tmc4361Patch.model_validate({"motor": {"temperature_c": 120.0}}))
        await b.clock.advance(1.5)
        assert (await b.state()).flags["OTPW"]
        log = b.device.need(EventLog)  # type: ignore[type-abstract, unused-ignore]
        assert not any("driver_OTPW" in entry.names for entry in log.events(0).events)


async def over(b: Bench, procedures: Procedures, within_s: float = 60.0) -> ReferenceSearchState:
    for _ in range(int(within_s / 0.02)):
        await b.clock.advance(0.02)
        state = procedures.search_state(b.device, 0)
        if state.state != "running":
            return state
    raise AssertionError(f"the search does not end: {procedures.search_state(b.device, 0)}")


@pytest.mark.parametrize("output", [TO_STEPS, TO_CURRENTS])
async def test_a_device_of_its_own_sets_the_driver_up_and_sees_its_load(output: int) -> None:
    async with bench(driver="tmc2660") as b:
        await b.device.registers.write("SPI_OUT_CONF", 0, output)
        link = {"kind": "cover", "device": b.device.id, "axis": 0}
        driver = await b.manager.add(DeviceConfig("driver", "tmc2660", link))
        assert driver.state == "connected", driver.problem
        assert [device for _, device in b.device.drivers_behind()] == [driver]
        put = driver.registers.write
        await put("DRVCONF", 0, DRVCONF[output] & 0x1FFFF)
        await put("SMARTEN", 0, SMARTEN & 0x1FFFF)
        await put("SGCSCONF", 0, SGCSCONF & 0x1FFFF)
        if output == TO_STEPS:
            await put("DRVCTRL", 0, 0)
        await put("CHOPCONF", 0, CHOPCONF & 0x1FFFF)
        await b.clock.advance(0.3)
        assert b.wire.state().truth.bridges == "regulated"
        begin = b.wire.state().truth.rotor_fullsteps
        await b.device.motion.move(0, 51_200)
        await b.clock.advance(1.0)
        load = await driver.registers.read("DRVSTATUS_SG", 0)
        assert load.fields["SG_RESULT"] > 200
        await b.at_rest()
        await b.clock.advance(0.3)
        assert b.wire.state().truth.rotor_fullsteps - begin == pytest.approx(200, abs=0.3)
        await put("SGCSCONF", 0, (SGCSCONF & 0x1FFE0) | 7)
        await b.clock.advance(0.1)
        truth = b.wire.state().truth
        assert (truth.current_a_a**2 + truth.current_b_a**2) ** 0.5 == pytest.approx(2.1 / 4, rel=0.03)
        await b.device.registers.write("SPI_OUT_CONF", 0, 0)
        with pytest.raises(LinkDown, match="SPI output is off"):
            await driver.registers.read("DRVSTATUS_SG", 0)


TMC23X, TMC24X = 8, 9
STALL_FLAG, LIMIT_1 = 1 << 7, 1 << 8


@pytest.mark.parametrize(
    ("conf", "change", "kind", "cause", "flag"),
    [
        (TMC23X, {"motor": {"temperature_c": 160.0}}, "driver_fault", "the motor driver is too hot", "OT"),
        (TMC23X, {"motor": {"temperature_c": 125.0}}, "moving", "it moves; the motor driver warns", "OTPW"),
        (TMC24X, {"motor": {"short_to_ground": "a"}}, "driver_fault", "the motor driver sees too much", "OCHS"),
        (TMC24X, {"supply_v": 2.0}, "driver_fault", "the motor driver has too little supply voltage", "UV_SF"),
        (TMC24X | STALL_FLAG | LIMIT_1, {"blocked": True}, "stalled", "the motor driver tells of a stall", "UV_SF"),
    ],
)
async def test_flags_of_a_tmc23x_and_tmc24x_have_their_own_names(
    conf: int, change: dict[str, object], kind: str, cause: str, flag: str
) -> None:
    async with bench() as b:
        await b.device.registers.write("SPI_OUT_CONF", 0, conf)
        await b.device.registers.write("STEP_CONF", 0, fields={"OTPW": 1})
        await b.device.motion.rotate(0, 20_000.0)
        await b.clock.advance(1.5)
        state = await b.state()
        assert {"UV_SF", "OCA", "OCB", "OCHS"} <= state.flags.keys()
        assert not {"SG", "S2GA", "S2GB", "STST"} & state.flags.keys()
        log = b.device.need(EventLog)  # type: ignore[type-abstract, unused-ignore]
        seen = log.events(0).next
        b.patch(Tmc4361Patch.model_validate(change))
        await b.clock.advance(0.5)
        found = await condition(b)
        assert (found.kind, found.cause[: len(cause)]) == (kind, cause)
        assert any(f"driver_{flag}" in entry.names for entry in log.events(0, seen).events)


async def test_datagrams_of_the_chips_own_are_told_once_not_over_and_over() -> None:
    async with bench(driver="tmc2660") as b:
        await driven(b)
        log = b.device.need(EventLog)  # type: ignore[type-abstract, unused-ignore]
        await b.device.motion.rotate(0, 20_000.0)
        await b.clock.advance(1.0)
        seen = log.events(0).next
        await b.clock.advance(3.0)
        assert not any("COVER_DONE" in entry.names for entry in log.events(0, seen).events)
        assert (await b.state()).flags["COVER_DONE"]


async def tmc2130_behind(b: Bench, form: int = 12) -> Device:
    await b.device.registers.write("SPI_OUT_CONF", 0, form)
    link = {"kind": "cover", "device": b.device.id, "axis": 0}
    return await b.manager.add(DeviceConfig("the feed", "tmc2130", link))


@pytest.mark.parametrize("form", [12, 13])
async def test_a_driver_of_40_bits_is_reached_behind_the_chip(form: int) -> None:
    async with bench() as b:
        driver = await tmc2130_behind(b, form)
        assert driver.state == "connected", driver.problem
        for name, word in (("IHOLD_IRUN", 0x061F0A), ("CHOPCONF", 0x0101_00C5), ("TCOOLTHRS", 0x12345)):
            await driver.registers.write(name, 0, word)
        assert (await driver.registers.read("CHOPCONF")).value == 0x0101_00C5
        words = b.wire.state().driver_words
        assert (words["IHOLD_IRUN"], words["TCOOLTHRS"]) == (0x061F0A, 0x12345)
        await b.device.motion.rotate(0, 20_000.0)
        await b.clock.advance(1.0)
        moving = await driver.monitor.axis_state(0)
        assert not moving.flags["stst"]
        b.patch(Tmc4361Patch.model_validate({"motor": {"temperature_c": 160.0}}))
        await b.clock.advance(0.1)
        assert (await driver.monitor.axis_state(0)).flags["ot"]
        found = await condition(b)
        assert (found.kind, found.cause) == ("driver_fault", "the feed is too hot and has switched off")


async def test_a_driver_of_40_bits_where_20_are_sent_says_what_to_write() -> None:
    async with bench() as b:
        driver = await tmc2130_behind(b, TO_STEPS)
        assert driver.state == "failed"
        assert "sends 20 bits to the driver of axis 0, not 40" in str(driver.problem)


async def test_a_tmc2130_behind_is_a_device_of_its_own_whose_settings_act_on_the_motor() -> None:
    async with bench(driver="tmc2130") as b:
        await b.device.registers.write("SPI_OUT_CONF", 0, 13 | TIMES)
        link = {"kind": "cover", "device": b.device.id, "axis": 0}
        driver = await b.manager.add(DeviceConfig("the feed", "tmc2130", link))
        assert driver.state == "connected", driver.problem
        await driver.registers.write("IHOLD_IRUN", 0, fields={"IRUN": 20, "IHOLD": 10})
        await driver.registers.write("CHOPCONF", 0, 0x101D5)
        await b.device.motion.move(0, 51_200)
        await b.clock.advance(3.0)
        behind = b.wire.state().driver
        assert behind is not None
        assert (behind.follows, behind.current_scale) == ("steps", 10)
        assert b.wire.state().truth.rotor_fullsteps == pytest.approx(200, abs=0.3)
        assert (await driver.registers.read("DRV_STATUS", 0)).fields["CS_ACTUAL"] == 10
