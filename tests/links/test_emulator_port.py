"""Samples on the chip's own beat, and faults as link errors."""

from __future__ import annotations

import pytest

from app.clock import VirtualClock
from app.emulators.drive.documents import ChipFaultsChange
from app.emulators.tmc428.device import EmulatedDevice
from app.emulators.tmc428.family import FAMILY
from app.emulators.tmc428.options import EmulatorPatch
from app.errors import LinkDown, LinkTimeout
from app.links import datagram32
from app.links.emulator import CATCH_UP_S, EmulatorPort

X_ACTUAL = datagram32.read(0x01)


class Rig:
    """A TMC428 whose axis 0 turns at 7812.5 pps from chip time 0 on, and its port."""

    def __init__(self) -> None:
        self.clock = VirtualClock()
        self.wire: EmulatedDevice = FAMILY.make("tmc428", self.clock)
        self.port = EmulatorPort(self.wire)
        self.samples: list[tuple[float, int]] = []
        for address, word in ((0x0C, 0x4006), (0x0A, 0x0303), (0x05, 512)):  # pulse_div 4, HOLD_MODE, v_actual 512
            self.wire.exchange(datagram32.write(address, word))

    def sink(self, time_s: float, replies: bytes) -> None:
        self.samples.append((time_s, datagram32.Reply.decode(replies).data))


def position(chip_s: float) -> int:
    """What v_actual 512 and pulse_div 4 make: one step every 4 pulse ticks of 512 clocks."""
    return int(chip_s * 16e6) // 2048


async def test_late_samples_bear_the_time_and_position_they_were_due_at() -> None:
    rig = Rig()
    rig.port.start_sampling([X_ACTUAL], 0.001, rig.sink)
    rig.clock.set(0.0505)
    rig.port.run_due_samples()
    assert len(rig.samples) == 51
    for index, (time_s, x_actual) in enumerate(rig.samples):
        assert time_s == pytest.approx(index * 0.001, abs=1e-12)
        assert abs(x_actual - position(time_s)) <= 1


async def test_whoever_talks_to_the_chip_first_takes_what_is_due() -> None:
    rig = Rig()
    rig.port.start_sampling([X_ACTUAL], 0.001, rig.sink)
    rig.clock.set(0.01)
    await rig.port.exchange(datagram32.write(0x05, 0))  # stops it: samples due before must not see that
    rig.clock.set(0.02)
    rig.port.run_due_samples()
    assert [time_s for time_s, _ in rig.samples] == pytest.approx([index * 0.001 for index in range(21)])
    moving, standing = rig.samples[:11], rig.samples[11:]
    assert [x for _, x in moving] == sorted({x for _, x in moving})
    assert {x for _, x in standing} == {moving[-1][1]}


async def test_a_time_scale_stretches_chip_time_not_the_beat() -> None:
    rig = Rig()
    rig.port.start_sampling([X_ACTUAL], 0.01, rig.sink)
    rig.clock.set(0.1)
    rig.port.run_due_samples()
    rig.wire.patch(EmulatorPatch(time_scale=10.0))
    rig.clock.set(0.2)
    rig.port.run_due_samples()
    times = [time_s for time_s, _ in rig.samples]
    assert times[:11] == pytest.approx([index * 0.01 for index in range(11)])
    assert times[11:] == pytest.approx([0.1 + index * 0.1 for index in range(1, 11)])


async def test_two_samplings_interleave_in_time() -> None:
    rig = Rig()
    rig.port.start_sampling([X_ACTUAL], 0.003, rig.sink)
    rig.port.start_sampling([X_ACTUAL], 0.002, rig.sink)
    rig.clock.set(0.0125)
    rig.port.run_due_samples()
    times = [time_s for time_s, _ in rig.samples]
    assert times == sorted(times)
    assert len(times) == 5 + 7


async def test_looking_at_the_emulator_takes_what_is_due_first() -> None:
    """Else the chip would be ahead of its own samples, and they would bear a time before their position."""
    rig = Rig()
    rig.port.start_sampling([X_ACTUAL], 0.001, rig.sink)
    rig.clock.set(0.0105)
    state = rig.wire.state(rig.port.take_turn())
    assert state.chip_time_s == pytest.approx(0.0105)
    rig.port.run_due_samples()
    assert [time_s for time_s, _ in rig.samples] == pytest.approx([n / 1000 for n in range(11)])
    assert [at for _, at in rig.samples] == [position(n / 1000) for n in range(11)]


async def test_an_ended_sampling_takes_nothing_more() -> None:
    rig = Rig()
    end = rig.port.start_sampling([X_ACTUAL], 0.001, rig.sink)
    rig.clock.set(0.005)
    rig.port.run_due_samples()
    taken = len(rig.samples)
    end()
    rig.clock.set(0.01)
    rig.port.run_due_samples()
    assert len(rig.samples) == taken == 6


async def test_what_nobody_asked_for_in_time_is_given_up_and_counted() -> None:
    rig = Rig()
    rig.port.start_sampling([X_ACTUAL], 0.1, rig.sink)
    rig.clock.set(CATCH_UP_S + 5.05)
    rig.port.run_due_samples()
    assert rig.port.samples_missed + len(rig.samples) == int((CATCH_UP_S + 5.05) / 0.1) + 1
    assert rig.samples[0][0] >= 5.0


async def test_silence_and_a_pulled_cable_are_link_errors_and_lose_samples() -> None:
    rig = Rig()
    rig.port.start_sampling([X_ACTUAL], 0.001, rig.sink)
    rig.clock.set(0.0045)
    rig.port.run_due_samples()
    rig.wire.patch(EmulatorPatch(faults=ChipFaultsChange(unplugged=True)))
    rig.clock.set(0.0065)
    with pytest.raises(LinkDown):
        rig.port.run_due_samples()
    with pytest.raises(LinkDown):
        await rig.port.exchange(X_ACTUAL)
    rig.wire.patch(EmulatorPatch(faults=ChipFaultsChange(unplugged=False, silence=True)))
    with pytest.raises(LinkTimeout):
        await rig.port.exchange(X_ACTUAL)
    rig.wire.patch(EmulatorPatch(faults=ChipFaultsChange(silence=False)))
    rig.clock.set(0.0085)
    rig.port.run_due_samples()
    assert [time_s for time_s, _ in rig.samples] == pytest.approx([0, 0.001, 0.002, 0.003, 0.004, 0.007, 0.008])
    assert rig.port.samples_missed == 2


async def test_closing_ends_samplings_and_leaves_the_chip_on() -> None:
    rig = Rig()
    rig.port.start_sampling([X_ACTUAL], 0.001, rig.sink)
    await rig.port.aclose()
    await rig.port.aclose()
    rig.clock.set(1.0)
    reply = datagram32.Reply.decode(await rig.port.exchange(X_ACTUAL))
    assert abs(reply.data - position(1.0)) <= 1
    assert rig.samples == []


@pytest.mark.parametrize("frames", [[], [X_ACTUAL]])
async def test_a_sample_without_frames_or_beat_is_refused(frames: list[bytes]) -> None:
    rig = Rig()
    with pytest.raises(ValueError, match="a sample has frames"):
        rig.port.start_sampling(frames, 0.0 if frames else 0.001, rig.sink)
