"""Silence, flipped bits, pulled cables and cut power: nothing that moves is sent twice, and a stop gets through."""

from __future__ import annotations

from dataclasses import replace

import pytest

from app.devices.core.results import AxisMove
from app.emulators.drive.documents import ChipFaultsChange
from app.emulators.tmc5xxx import EmulatedTmc5xxx, Tmc5xxxPatch
from app.errors import BadReply, BenchError, LinkDown, LinkTimeout
from tests.devices.tmc5xxx.harness import MODELS, Bench, bench


async def test_a_move_without_an_answer_is_not_sent_again() -> None:
    async with bench() as b:
        _silent_from(b, b.address("AMAX"))
        b.port.frames.clear()
        with pytest.raises(LinkTimeout):
            await b.device.motion.move(0, 5_000)
        assert b.port.written(b.address("AMAX")) == [1718]
        assert b.port.written(b.address("XTARGET")) == [0]  # where it stands, until all else has arrived
        assert b.device.motion.prediction(0) is None


async def test_a_rotation_without_an_answer_is_not_sent_again() -> None:
    async with bench() as b:
        _silent_from(b, b.address("VMAX"))
        b.port.frames.clear()
        with pytest.raises(LinkTimeout):
            await b.device.motion.rotate(0, 1_000)
        assert b.port.written(b.address("VMAX")) == [1049]


async def test_a_write_without_an_answer_is_not_sent_again() -> None:
    async with bench() as b:
        _silent_from(b, b.address("A1"))
        b.port.frames.clear()
        with pytest.raises(LinkTimeout):
            await b.device.registers.write("A1", 0, 1_000)
        assert b.port.written(b.address("A1")) == [1_000]


async def test_what_comes_back_otherwise_did_not_arrive_for_sure() -> None:
    """A write-only register shows itself in the reply to the next datagram (DS-TMC5031 page 17)."""
    async with bench() as b:
        b.fault(errors=0.05)
        told: list[str] = []
        for value in range(100, 130):
            try:
                await b.device.registers.write("A1", 0, value)
            except BadReply as error:
                told.append(str(error))
        assert told
        assert all("may have arrived otherwise" in text for text in told)


async def test_after_a_failed_move_the_next_writes_everything_again() -> None:
    async with bench() as b:
        _silent_from(b, b.address("VMAX"), times=1)
        with pytest.raises(LinkTimeout):
            await b.device.motion.move(0, 5_000)
        b.port.before_frame = lambda _: None
        b.fault(silence=False)
        b.port.frames.clear()
        await b.device.motion.move(0, 6_000)
        assert [len(b.port.written(b.address(name))) for name in ("VMAX", "AMAX")] == [1, 1]
        assert (await b.at_rest()).position == 6_000


async def test_a_stop_whose_first_answer_is_lost_is_sent_again() -> None:
    async with bench() as b:
        await b.device.motion.rotate(0, 30_000)
        await b.clock.advance(0.5)
        _silent_from(b, b.address("VMAX"), times=1)
        b.port.frames.clear()
        outcome = (await b.device.stop_axes([0]))[0]
        assert outcome.ok, outcome.problem
        assert b.port.written(b.address("VMAX")) == [0, 0]
        b.fault(silence=False)
        assert (await b.at_rest()).velocity_pps == 0


@pytest.mark.parametrize("model", MODELS)
async def test_a_stop_goes_out_though_nothing_is_answered(model: str) -> None:
    async with bench(model) as b:
        await b.device.motion.move(0, 51_200)
        await b.clock.advance(0.5)
        b.fault(silence=True)
        outcome = (await b.device.stop_axes([0]))[0]
        assert isinstance(outcome.problem, LinkTimeout)
        await b.clock.advance(1.0)
        b.fault(silence=False)  # an emulator that is silent obeys all the same
        await b.clock.advance(1.0)
        state = await b.state()
        assert (state.velocity_pps, state.moving) == (0, False)
        assert state.position < 51_200


async def test_a_pulled_cable_ends_the_motion_in_the_books() -> None:
    async with bench("tmc5072") as b:
        await b.device.motion.move_together([AxisMove(0, 51_200), AxisMove(1, 51_200)])
        await b.clock.advance(0.5)
        b.fault(unplugged=True)
        outcome = (await b.device.stop_axes([0]))[0]
        assert isinstance(outcome.problem, LinkDown)
        assert b.device.state == "failed"
        for axis in (0, 1):
            assert b.device.monitor.motion_ends(axis)[-1].reason == "lost_link"
            assert b.device.motion.prediction(axis) is None
        b.fault(unplugged=False)
        await b.clock.advance(3)
        assert _state(b) == "connected"
        # It was not reset, so what was written still holds.
        started = await b.device.motion.move(0, 0)
        assert started.predicted_duration_s is not None
        assert started.warnings == []


async def test_power_that_was_cut_while_unplugged_is_seen_afterwards() -> None:
    async with bench() as b:
        b.fault(unplugged=True)
        await b.clock.advance(2)
        b.patch(Tmc5xxxPatch(power_cycle=True, faults=ChipFaultsChange(unplugged=False)))
        await b.clock.advance(3)
        assert _state(b) == "connected"
        assert b.event_names().count("reset") == 2
        with pytest.raises(BenchError, match="VMAX is 0"):
            await b.device.motion.move(0, 100)


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
            assert (await b.state()).velocity_pps == 0


async def test_flipped_bits_never_become_a_motion() -> None:
    async with bench("tmc5062") as b:
        b.fault(errors=0.01)
        for _ in range(30):
            try:
                await b.device.monitor.axis_state(1)
                await b.device.identity.refresh()
                await b.clock.advance(0.3)
            except BenchError:
                continue
        b.fault(errors=0.0)
        assert [(await b.state(axis)).position for axis in (0, 1)] == [0, 0]


async def test_a_flipped_bit_is_no_reset() -> None:
    async with bench("tmc5130") as b:
        await b.clock.advance(1)
        flipped = b.port.wire = Flipping(b.wire, b.address("GSTAT"))
        for _ in range(3):
            await b.device.identity.refresh()
        assert flipped.flips >= 3
        assert b.event_names() == ["reset"]
        assert b.ramp(0).words["VMAX"] == 52_429


async def test_a_reset_after_which_somebody_else_set_the_chip_up_again_is_one() -> None:
    async with bench("tmc5130") as b:
        chopconf = (await b.device.registers.read("CHOPCONF", 0)).raw
        b.patch(Tmc5xxxPatch(power_cycle=True))
        b.wire.write(b.address("CHOPCONF"), chopconf)
        await b.device.identity.refresh()
        assert b.event_names() == ["reset", "reset"]
        assert b.ramp(0).words["VMAX"] == 0


async def test_another_chip_is_told_by_its_version() -> None:
    async with bench("tmc5160") as b:
        b.device.session.config = replace(b.device.config, model="tmc5130")
        with pytest.raises(BenchError, match="VERSION reads 0x30, which is that of a TMC5160"):
            await b.device.identity.probe()


async def test_a_bus_without_a_chip_says_so() -> None:
    async with bench() as b:
        b.port.wire = Nobody(b.wire)
        with pytest.raises(BenchError, match="no TMC5160 answers here: all bits read 1"):
            await b.device.identity.probe()


class Flipping:
    """A chip whose answers about one register have their lowest bit set on the way."""

    def __init__(self, wire: EmulatedTmc5xxx, address: int) -> None:
        self.clock = wire.clock
        self.model = wire.model
        self.flips = 0
        self._wire = wire
        self._address = address
        self._asked = -1

    def exchange(self, frame: bytes, at_s: float | None = None) -> bytes:
        reply = self._wire.exchange(frame, at_s)
        if self._asked == self._address:
            self.flips += 1
            reply = reply[:4] + bytes((reply[4] | 1,))
        self._asked = frame[0]
        return reply


class Nobody:
    """A bus on which nobody drives the line."""

    def __init__(self, wire: EmulatedTmc5xxx) -> None:
        self.clock = wire.clock
        self.model = "tmc5160"

    def exchange(self, frame: bytes, at_s: float | None = None) -> bytes:
        del at_s
        return b"\xff" * len(frame)


def _silent_from(b: Bench, address: int, times: int = 10**6) -> None:
    """The chip goes silent as soon as `address` is written, for so many exchanges of it."""
    left = [times]

    def silence(frame: bytes) -> None:
        if frame[0] == address | 0x80:
            b.wire.patch(Tmc5xxxPatch(faults=ChipFaultsChange(silence=bool(left[0]))))
            left[0] = max(left[0] - 1, 0)

    b.port.before_frame = silence


def _state(b: Bench) -> str:
    """Its state, as a type checker that remembers earlier comparisons must not narrow it."""
    return b.device.state
