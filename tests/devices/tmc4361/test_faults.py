"""Silence, flipped bits and pulled cables: nothing that moves is sent twice, and a stop gets through."""

from __future__ import annotations

import pytest

from app.emulators.tmc4361.options import FaultsChange, Tmc4361Patch
from app.errors import BenchError, LinkDown, LinkTimeout
from tests.devices.tmc4361.harness import Bench, bench

XTARGET, VMAX, RAMPMODE = 0x37, 0x24, 0x20


async def test_a_move_without_an_answer_is_not_sent_again() -> None:
    async with bench() as b:
        _silent_from(b, XTARGET)
        b.port.frames.clear()
        with pytest.raises(LinkTimeout):
            await b.device.motion.move(0, 5_000)
        assert b.port.written(XTARGET) == [5_000]
        assert b.device.motion.prediction(0) is None


async def test_a_rotation_without_an_answer_is_not_sent_again() -> None:
    async with bench() as b:
        _silent_from(b, VMAX)
        b.port.frames.clear()
        with pytest.raises(LinkTimeout):
            await b.device.motion.rotate(0, 1_000)
        assert b.port.written(VMAX) == [256_000]


async def test_a_write_without_an_answer_is_not_sent_again() -> None:
    async with bench() as b:
        _silent_from(b, 0x28)
        b.port.frames.clear()
        with pytest.raises(LinkTimeout):
            await b.device.registers.write("AMAX", 0, 1_000)
        assert b.port.written(0x28) == [1_000]


async def test_a_stop_whose_first_answer_is_lost_is_sent_again() -> None:
    async with bench() as b:
        await b.device.motion.rotate(0, 30_000)
        await b.clock.advance(0.5)
        _silent_from(b, VMAX, times=1)
        b.port.frames.clear()
        outcome = (await b.device.stop_axes([0]))[0]
        assert outcome.ok, outcome.problem
        assert b.port.written(VMAX)[-1] == 0
        assert len(b.port.written(VMAX)) > 2
        b.fault(silence=False)
        assert (await b.at_rest()).velocity_pps == 0


async def test_a_stop_goes_out_though_nothing_is_answered() -> None:
    async with bench() as b:
        await b.device.motion.move(0, 51_200)
        await b.clock.advance(0.5)
        b.fault(silence=True)
        outcome = (await b.device.stop_axes([0]))[0]
        assert isinstance(outcome.problem, LinkTimeout)
        await b.clock.advance(1.0)
        b.fault(silence=False)  # an emulator that is silent obeys all the same
        await b.clock.advance(1.0)
        assert (await b.state()).velocity_pps == 0
        assert (await b.state()).position < 51_200


async def test_a_pulled_cable_ends_the_motion_in_the_books() -> None:
    async with bench() as b:
        await b.device.motion.move(0, 51_200)
        await b.clock.advance(0.5)
        b.fault(unplugged=True)
        outcome = (await b.device.stop_axes([0]))[0]
        assert isinstance(outcome.problem, LinkDown)
        assert b.device.state == "failed"
        assert b.device.monitor.motion_ends(0)[-1].reason == "lost_link"
        assert b.device.motion.prediction(0) is None
        b.fault(unplugged=False)
        await b.clock.advance(3)
        assert _state(b) == "connected"
        await b.device.motion.move(0, 0)


async def test_with_flipped_bits_a_stop_stops() -> None:
    async with bench() as b:
        for _ in range(5):
            b.fault(errors=0.0)
            await b.device.motion.rotate(0, 20_000)
            await b.clock.advance(0.3)
            b.fault(errors=0.002)
            for _ in range(4):  # whoever stops and hears that it went wrong stops again
                if (await b.device.stop_axes([0]))[0].ok:
                    break
            b.fault(errors=0.0)
            await b.clock.advance(1)
            assert b.wire.state().ramp.velocity_pps == 0


async def test_flipped_bits_never_become_a_motion() -> None:
    async with bench() as b:
        b.fault(errors=0.01)
        for _ in range(30):
            try:
                await b.device.monitor.axis_state(0)
                await b.device.identity.refresh()
                await b.clock.advance(0.3)
            except BenchError:
                continue
        b.fault(errors=0.0)
        assert b.wire.state().step_output.steps_sent == 0


async def test_a_stop_overtakes_a_command_that_waits() -> None:
    async with bench() as b:
        await b.device.motion.rotate(0, 10_000)
        guard = b.device.session.stop_guard([0])
        await b.device.stop(0)
        with pytest.raises(BenchError, match="overtook"):
            guard()


def _silent_from(b: Bench, address: int, times: int = 10**6) -> None:
    """The chip goes silent as soon as `address` is written, for so many exchanges of it."""
    left = [times]

    def silence(frame: bytes) -> None:
        if frame[0] == address | 0x80 and left[0]:
            left[0] -= 1
            b.wire.patch(_faults(silence=True))
        elif not left[0] and frame[0] == address | 0x80:
            b.wire.patch(_faults(silence=False))

    b.port.before_frame = silence


def _faults(*, silence: bool) -> Tmc4361Patch:
    return Tmc4361Patch(faults=FaultsChange(silence=silence))


def _state(b: Bench) -> str:
    """Its state, as a type checker that remembers earlier comparisons must not narrow it."""
    return b.device.state
