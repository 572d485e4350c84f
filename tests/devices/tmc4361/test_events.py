"""Events: none is lost, each is told once, and looking changes nothing that anybody relies on."""

from __future__ import annotations

import pytest

from app.devices.core.results import ChipEvents
from app.devices.core.timeline import KEPT, Timeline
from app.devices.tmc4361 import roles
from app.emulators.tmc4361.options import FaultsChange, Tmc4361Patch
from app.registers.tmc4361.bits import EVENT_MASK, event_names
from tests.devices.tmc4361.harness import bench

EVENTS, CLEAR_CONF = 0x0E, 0x0C


@pytest.mark.sheet("DS-TMC4361", "7.2")
async def test_a_motion_is_told_event_by_event() -> None:
    async with bench() as b:
        await b.clock.advance(1)
        already = len(b.event_names())
        await b.device.motion.move(0, 51_200)
        await b.at_rest()
        await b.clock.advance(0.5)
        told = b.event_names()[already:]
        for name in ("VEL_STATE_01", "VEL_REACHED", "RAMP_STATE_10", "TARGET_REACHED", "VEL_STATE_00"):
            assert told.count(name) == 1, name
        assert told.index("RAMP_STATE_01") < told.index("VEL_REACHED") < told.index("TARGET_REACHED")


async def test_an_event_that_comes_again_is_told_again() -> None:
    async with bench() as b:
        for target in (1_000, 2_000, 3_000):
            await b.device.motion.move(0, target)
            await b.at_rest()
            await b.clock.advance(0.3)
        assert b.event_names().count("TARGET_REACHED") == 3


@pytest.mark.sheet("DS-TMC4361", "7.2")
async def test_no_reading_of_events_clears_what_was_not_told() -> None:
    """However an event falls between two datagrams: every reading that clears is told what it may clear."""
    async with bench() as b:
        b.port.frames.clear()
        await b.device.motion.move(0, 51_200)
        await b.at_rest()
        kept = 0
        for frame in b.port.frames:
            if frame[0] == CLEAR_CONF | 0x80:
                kept = int.from_bytes(frame[1:], "big")
            elif frame[0] == EVENTS:
                assert kept, "a reading that clears everything"
                assert not ~kept & roles.BLOCKING


async def test_an_event_between_peek_and_clear_is_told() -> None:
    async with bench() as b:
        await b.device.registers.write("POS_COMP", 0, 100)
        await b.clock.advance(1)
        began = len(b.event_names())
        fired: list[bytes] = []

        def come_between(frame: bytes) -> None:
            if frame[0] == CLEAR_CONF | 0x80 and frame[1:] not in (b"\xff" * 4, bytes(4)) and not fired:
                fired.append(frame)  # right before the clearing: one more event comes up
                b.wire.exchange(bytes([0xA1]) + (100).to_bytes(4, "big"))
                b.wire.exchange(bytes([0xB7]) + (100).to_bytes(4, "big"))

        b.port.before_frame = come_between
        await b.device.motion.move(0, 50)
        await b.clock.advance(2)
        assert fired
        assert "POS_COMP_REACHED" in b.event_names()[began:]


async def test_what_the_user_keeps_is_kept_and_what_he_reads_is_told() -> None:
    async with bench() as b:
        await b.device.registers.write("EVENT_CLEAR_CONF", 0, 1)  # TARGET_REACHED
        await b.device.motion.move(0, 500)
        await b.at_rest()
        await b.clock.advance(2)
        assert (await b.device.registers.read("EVENT_CLEAR_CONF", 0)).value == 1
        held = (await b.device.registers.read("EVENTS", 0)).fields
        assert held["TARGET_REACHED"] == 1  # still: nobody here may clear it
        assert held["VEL_STATE_01"] == 0  # seen and cleared
        assert b.event_names().count("TARGET_REACHED") == 1


async def test_what_makes_an_interrupt_is_left_to_whom_it_interrupts() -> None:
    async with bench() as b:
        await b.device.registers.write("INTR_CONF", 0, 1)
        await b.device.identity.refresh()
        await b.device.motion.move(0, 500)
        await b.at_rest()
        await b.clock.advance(1)
        assert b.wire.state().pins.intr is not None
        assert (await b.device.registers.read("EVENTS", 0)).fields["TARGET_REACHED"] == 1


async def test_reading_events_by_hand_tells_what_it_clears() -> None:
    async with bench() as b:
        await b.device.registers.write("EVENT_CLEAR_CONF", 0, 0)
        await b.device.registers.write("POS_COMP", 0, 7)
        await b.device.registers.write("XACTUAL", 0, 7)
        await b.clock.advance(0.001)
        held = (await b.device.registers.read("EVENTS", 0)).fields
        if held["POS_COMP_REACHED"]:
            assert "POS_COMP_REACHED" in b.event_names()
        assert (await b.device.registers.read("EVENTS", 0)).fields["POS_COMP_REACHED"] == 0


async def test_a_link_that_fails_in_between_leaves_no_other_choice_of_events() -> None:
    async with bench() as b:
        await b.device.registers.write("EVENT_CLEAR_CONF", 0, 0x8)
        pulled: list[bytes] = []

        def pull(frame: bytes) -> None:
            if frame[0] == EVENTS and not pulled:
                pulled.append(frame)
                b.wire.patch(Tmc4361Patch(faults=FaultsChange(unplugged=True)))

        b.port.before_frame = pull
        await b.clock.advance(1)
        assert pulled
        b.fault(unplugged=False)
        await b.clock.advance(3)
        assert (await b.device.registers.read("EVENT_CLEAR_CONF", 0)).value == 0x8


async def test_a_reset_is_noticed_and_forgets_what_was_written() -> None:
    async with bench() as b:
        await b.clock.advance(1)
        await b.device.registers.write("PID_P", 0, 99)
        await b.device.registers.write("RESET_CLK_GATING", 0, fields={"RESET_REG": 0x525354})
        await b.clock.advance(2)
        assert b.event_names().count("RST_EV") == 2  # of power-on, and now
        assert b.memory.kept_word(b.device.family.table.get("PID_P", 0)) is None


async def test_of_two_resets_between_two_polls_the_later_one_is_noticed_too() -> None:
    """A plug that bounces: what was written in between is gone as well."""
    async with bench() as b:
        resolution = b.device.family.table.get("ENC_IN_RES", 0)
        b.patch(Tmc4361Patch(power_cycle=True))
        await b.state()
        await b.device.registers.write("ENC_IN_RES", 0, 40_000)
        await b.state()
        assert b.memory.kept_word(resolution) == 40_000
        b.patch(Tmc4361Patch(power_cycle=True))
        await b.state()
        assert b.memory.kept_word(resolution) is None


async def test_a_reset_is_noticed_though_nothing_was_polled_since_it_is_connected() -> None:
    async with bench() as b:
        b.patch(Tmc4361Patch(power_cycle=True))
        await b.state()
        assert b.memory.kept_word(b.device.family.table.get("ENC_IN_RES", 0)) is None


async def test_events_are_told_to_listeners() -> None:
    async with bench() as b:
        await b.device.motion.move(0, 500)
        await b.at_rest()
        await b.clock.advance(0.5)
        told = [event for event in b.told if isinstance(event, ChipEvents)]
        assert [event.seq for event in told] == sorted(event.seq for event in told)
        assert any("TARGET_REACHED" in event.names for event in told)


def test_a_timeline_counts_on_and_says_what_it_lost() -> None:
    timeline = Timeline(0, EVENT_MASK, event_names)
    for index in range(KEPT + 5):
        assert timeline.read(1, 0, float(index)) is not None
    page = timeline.page(0, 10)
    assert (page.events[0].seq, page.next, page.lost) == (6, 15, 5)
    assert timeline.page(KEPT + 5, 10).events == ()
    assert timeline.page(10**9, 10).next == KEPT + 5  # of a server that was started anew


def test_a_bit_that_stays_is_told_once() -> None:
    timeline = Timeline(0, EVENT_MASK, event_names)
    assert timeline.read(0b101, 0b101, 1.0) is not None
    assert timeline.read(0b101, 0b001, 2.0) is None
    again = timeline.read(0b101, 0, 3.0)
    assert again is not None
    assert again.names == ("VEL_REACHED",)


def test_a_glimpse_of_before_the_latest_reading_is_old_news() -> None:
    timeline = Timeline(0, EVENT_MASK, event_names)
    assert timeline.read(1, 0, 2.0) is not None
    assert timeline.glimpsed(1, 1.9) is None
    assert timeline.glimpsed(1, 2.1) is not None
    assert timeline.read(1, 1, 2.2) is None
