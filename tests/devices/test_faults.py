"""A device that vanishes, falls silent or mumbles: a clear error each, and control regained afterwards."""

from __future__ import annotations

import asyncio

import pytest

from app.emulators.tmc428.options import EmulatorPatch
from app.errors import LinkDown, LinkTimeout, WriteRefused, WrongState
from app.links import datagram32
from app.registers.catalog import CHIPS_32
from tests.devices.harness import bench, state_of


@pytest.mark.parametrize("model", list(CHIPS_32))
async def test_a_device_that_vanishes_during_a_move_comes_back_under_control(model: str) -> None:
    async with bench(model) as b:
        await b.device.motion.move(0, 200_000)
        await b.clock.advance(0.5)
        b.fault(unplugged=True)
        with pytest.raises(LinkDown):
            await b.device.monitor.axis_state(0)
        assert state_of(b.device) == "failed"
        assert isinstance(b.device.problem, LinkDown)
        with pytest.raises(LinkDown):
            await b.device.stop(0)
        b.fault(unplugged=False)
        await b.clock.advance(5.0)
        assert state_of(b.device) == "connected"
        assert (await b.device.monitor.axis_state(0)).moving
        assert (await b.device.stop(0)).ok
        rest = await b.at_rest()
        assert 0 < rest < 200_000


async def test_a_cable_pulled_while_nobody_asks_is_noticed() -> None:
    async with bench() as b:
        b.fault(unplugged=True)
        await b.clock.advance(2.5)
        assert b.device.state == "failed"


async def test_a_read_is_asked_twice_and_a_write_once() -> None:
    async with bench() as b:
        b.fault(silence=True)
        before = b.device.session.queue.counts.frames[1]
        with pytest.raises(LinkTimeout):
            await b.device.registers.read("v_max", 0)
        assert b.device.session.queue.counts.frames[1] - before == 2
        b.fault(silence=False)
        sent: list[bytes] = []
        exchange = b.wire.exchange

        def deaf_to_writes(frame: bytes, at_s: float | None = None) -> bytes:
            sent.append(frame)
            reply = exchange(frame, at_s)
            if not frame[0] & 1:
                raise TimeoutError
            return reply

        b.wire.exchange = deaf_to_writes  # type: ignore[method-assign]
        with pytest.raises(LinkTimeout):
            await b.device.motion.move(0, 1000)
        assert [frame for frame in sent if not frame[0] & 1] == [datagram32.write(0x00, 1000)]


async def test_one_lost_answer_within_a_transaction_is_made_good() -> None:
    async with bench() as b:
        exchange = b.wire.exchange
        lost: list[bytes] = []

        def lose_one(frame: bytes, at_s: float | None = None) -> bytes:
            if frame == datagram32.read(0x01) and not lost:
                lost.append(frame)
                raise TimeoutError
            return exchange(frame, at_s)

        b.wire.exchange = lose_one  # type: ignore[method-assign]
        assert (await b.device.monitor.axis_state(0)).position == 0
        assert len(lost) == 1
        assert b.device.state == "connected"


async def test_a_flipped_bit_in_a_read_back_is_asked_about_again() -> None:
    async with bench() as b:
        exchange, wrote, flips = b.wire.exchange, [False], [1]

        def flip_once(frame: bytes, at_s: float | None = None) -> bytes:
            reply = exchange(frame, at_s)
            wrote[0] |= frame == datagram32.write(0x02, 9)
            if frame == datagram32.read(0x02) and wrote[0] and flips:
                flips.pop()
                return reply[:3] + bytes([reply[3] ^ 4])
            return reply

        b.wire.exchange = flip_once  # type: ignore[method-assign]
        written = await b.device.registers.write("v_min", 0, value=9)
        assert (written.value, written.verified) == (9, True)
        assert "second did not" in written.note


async def test_a_write_that_really_is_not_taken_is_reported_with_both_words() -> None:
    async with bench() as b:
        exchange = b.wire.exchange

        def stuck(frame: bytes, at_s: float | None = None) -> bytes:
            if frame == datagram32.write(0x02, 9):
                frame = datagram32.write(0x02, 8)
            return exchange(frame, at_s)

        b.wire.exchange = stuck  # type: ignore[method-assign]
        with pytest.raises(WriteRefused) as caught:
            await b.device.registers.write("v_min", 0, value=9)
        assert (caught.value.register, caught.value.written, caught.value.read_back) == ("v_min", 9, 8)


async def test_a_target_that_arrives_wrong_is_reported_and_not_sent_again() -> None:
    async with bench() as b:
        exchange, seen = b.wire.exchange, []

        def wrong(frame: bytes, at_s: float | None = None) -> bytes:
            if frame[0] == 0:
                seen.append(frame)
                frame = datagram32.write(0x00, 5000)
            return exchange(frame, at_s)

        b.wire.exchange = wrong  # type: ignore[method-assign]
        with pytest.raises(WriteRefused, match="stop it"):
            await b.device.motion.move(0, 1000)
        assert len(seen) == 1


async def test_bit_errors_never_pass_for_a_good_write() -> None:
    async with bench() as b:
        b.fault(errors=0.02)
        refused = 0
        for value in range(200):
            try:
                written = await b.device.registers.write("v_min", 0, value=value)
            except WriteRefused:
                refused += 1
            else:
                assert written.value == value
        b.fault(errors=0.0)
        assert refused > 5
        assert (await b.device.registers.read("v_min", 0)).value == 199


async def test_a_power_cycle_is_noticed_by_what_the_chip_holds() -> None:
    async with bench() as b:
        b.wire.patch(EmulatorPatch(power_cycle=True))
        with pytest.raises(WrongState, match="v_max is 0"):
            await b.device.motion.move(0, 1000)
        await b.clock.advance(3.0)
        assert (b.device.axes[0].pulse_div, b.device.axes[0].microsteps_per_full_step) == (0, 1)


async def test_many_at_once_each_get_their_own_answer() -> None:
    async with bench() as b:
        for axis in range(3):
            await b.device.registers.write("v_min", axis, value=axis + 1)
        readings = await asyncio.gather(*(b.device.registers.read("v_min", index % 3) for index in range(300)))
        assert [reading.value for reading in readings] == [index % 3 + 1 for index in range(300)]
