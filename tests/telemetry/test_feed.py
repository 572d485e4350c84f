"""The way of a sample from the emulated chip to a reader, on a clock of the test."""

from __future__ import annotations

import gc
import weakref
from typing import Any

import numpy as np
import pytest

from app.devices.core.config import DeviceConfig
from app.errors import OutOfRange, UnknownThing, WrongState
from app.telemetry.feed import CROWDED_S, LATE_S, Joined
from app.telemetry.frames import FloatArray, decode
from app.telemetry.history import REST_RATE_HZ
from app.telemetry.reader import Gap, MoveSeen, Reader, Status
from tests.telemetry.conftest import Rig


def taken(reader: Reader) -> tuple[FloatArray, FloatArray]:
    """All rows that wait: time [rows], samples [rows, columns]."""
    frames = []
    while (data := reader.take(0.0)) is not None:
        frames.append(decode(data))
    if not frames:
        return np.empty(0), np.empty((0, reader.columns))
    return np.concatenate([frame.time_s for frame in frames]), np.vstack([frame.columns.T for frame in frames])


async def run(rig: Rig, joined: Joined, seconds: float) -> tuple[FloatArray, FloatArray]:
    """Rows of `seconds` [s], read as a client would, often enough to lose none."""
    times, samples = [], []
    for _ in range(round(seconds / 0.5)):
        await rig.clock.advance(0.5)
        time_s, rows = taken(joined.reader)
        times.append(time_s)
        samples.append(rows)
    return np.concatenate(times), np.vstack(samples)


@pytest.mark.parametrize("rate_hz", [1.0, 60.0, 333.0, 1000.0])
async def test_samples_come_on_the_chips_own_beat(rig: Rig, rate_hz: float) -> None:
    joined = rig.hub.join("chip", ("position.0", "velocity.0"), rate_hz)
    time_s, _ = await run(rig, joined, 3.0)
    assert joined.chip_timed
    assert len(time_s) == pytest.approx(3.0 * rate_hz, abs=rate_hz / 30 + 1)
    np.testing.assert_allclose(np.diff(time_s), 1 / rate_hz, atol=1e-9)


async def test_a_move_is_seen_as_the_chip_makes_it(rig: Rig) -> None:
    joined = rig.hub.join("chip", ("position.0", "velocity.0", "residual.0"), 1000.0)
    await rig.device.motion.move(0, 4000)
    time_s, samples = await run(rig, joined, 3.0)
    position, velocity, residual = samples.T
    assert position[-1] == 4000
    assert velocity[-1] == 0
    # What the velocity says is what the position does, step for step within a sample.
    travelled = np.concatenate([[0.0], np.cumsum(velocity[:-1] * np.diff(time_s))])
    assert np.abs(travelled - (position - position[0])).max() < 30
    assert np.nanmax(np.abs(residual)) <= 1


async def test_readers_share_one_beat_and_each_gets_its_own_columns_and_rate(rig: Rig) -> None:
    fast = rig.hub.join("chip", ("position.0",), 1000.0)
    slow = rig.hub.join("chip", ("velocity.0", "position.0"), 100.0)
    await rig.device.motion.move(0, 4000)
    frames_before = rig.device.session.queue.counts.frames[:]
    for _ in range(4):
        await rig.clock.advance(0.25)
    fast_s, fast_rows = taken(fast.reader)
    slow_s, slow_rows = taken(slow.reader)
    assert len(fast_s) == pytest.approx(1000, abs=40)
    assert len(slow_s) == pytest.approx(100, abs=5)
    assert set(slow_s) <= set(fast_s)
    assert (
        dict(zip(fast_s, fast_rows[:, 0], strict=True)).items()
        >= dict(zip(slow_s, slow_rows[:, 1], strict=True)).items()
    )
    assert rig.device.session.queue.counts.frames[2] == frames_before[2], "an emulator samples itself"


async def test_a_reader_that_comes_or_goes_costs_the_others_no_sample(rig: Rig) -> None:
    first = rig.hub.join("chip", ("position.0",), 1000.0)
    times = []
    for number in range(6):
        await rig.clock.advance(0.1003)
        other = rig.hub.join("chip", (f"velocity.{number % 3}",), 500.0)
        await rig.clock.advance(0.0507)
        rig.hub.leave(other.reader)
        times.append(taken(first.reader)[0])
    await rig.clock.advance(0.1)
    times.append(taken(first.reader)[0])
    steps_s = np.diff(np.concatenate(times))
    assert steps_s.min() >= 0
    assert steps_s.max() <= 1e-3 + 1e-9


async def test_nobody_reads_and_nothing_but_the_history_is_sampled(rig: Rig) -> None:
    await rig.clock.advance(1.0)
    joined = rig.hub.join("chip", ("position.0",), 100.0)
    rig.hub.leave(joined.reader)
    rig.hub.leave(joined.reader)
    assert rig.hub.readers == 0
    await rig.clock.advance(1.0)
    assert taken(joined.reader)[0].size <= 2


async def test_a_page_that_is_reloaded_has_its_history(rig: Rig) -> None:
    await rig.device.motion.rotate(0, 1000)
    await rig.clock.advance(20.0)
    joined = rig.hub.join("chip", ("position.0", "velocity.1"), 1000.0, history_s=15.0)
    past_s, past = joined.history_time_s, joined.history
    assert len(past_s) == pytest.approx(15 * 50, abs=2)
    np.testing.assert_allclose(np.diff(past_s), 0.02, atol=1e-9)
    assert past[-1, 0] == pytest.approx((await rig.device.monitor.axis_state(0)).position, abs=25)
    assert past[-1, 1] == 0
    live_s, _ = await run(rig, joined, 1.0)
    assert live_s[0] >= past_s[-1], "the past and the present do not overlap"
    assert live_s[0] - past_s[-1] <= 0.021
    without = rig.hub.join("chip", ("position.0",), 1000.0)
    assert len(without.history_time_s) == 0


async def test_readers_want_only_so_many_different_things(rig: Rig, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("app.telemetry.hub.SUBSCRIPTIONS_MAX", 3)
    joined = [rig.hub.join("chip", ("position.0",), 100.0 + number) for number in range(3)]
    rig.hub.join("chip", ("position.0",), 102.0)  # as one that is there: it costs next to nothing
    with pytest.raises(WrongState, match="different ways"):
        rig.hub.join("chip", ("position.0",), 103.0)
    assert rig.hub.readers == 4
    rig.hub.leave(joined[0].reader)
    rig.hub.join("chip", ("position.0",), 103.0)


async def test_many_readers_get_rarer_frames_with_all_their_rows(rig: Rig, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("app.telemetry.hub.FRAMES_PER_S_MAX", 60.0)
    many = [rig.hub.join("chip", ("position.0",), 200.0, 20.0) for _ in range(12)]  # 240 frames a second wanted

    async def frames_and_rows() -> tuple[int, int]:
        frames = []
        await rig.clock.advance(2.0)
        for reader in [joined.reader for joined in many]:
            while (data := reader.take(rig.clock.now())) is not None:
                frames.append(len(decode(data).time_s))
        return len(frames), sum(frames)

    await frames_and_rows()
    frames, rows = await frames_and_rows()
    assert frames == pytest.approx(2 * 60, rel=0.2)
    assert rows == pytest.approx(12 * 2 * 200, rel=0.2)
    for joined in many[3:]:
        rig.hub.leave(joined.reader)
    del many[3:]
    await frames_and_rows()
    assert (await frames_and_rows())[0] == pytest.approx(2 * 60, rel=0.2)  # three get what they like: 20 a second


async def test_a_history_that_was_sent_is_forgotten_and_only_so_much_is_on_its_way(
    rig: Rig, monkeypatch: pytest.MonkeyPatch
) -> None:
    await rig.clock.advance(5.0)
    joined = rig.hub.join("chip", ("position.0",), 100.0, history_s=5.0)
    assert joined.history_bytes > 100
    monkeypatch.setattr("app.telemetry.hub.HISTORY_BYTES_MAX", 100)
    rig.hub.require_history_room()
    with rig.hub.handing_over(joined):
        with pytest.raises(WrongState, match="on their way"):
            rig.hub.require_history_room()
        assert len(joined.history_time_s)
    assert joined.history_bytes == 0
    rig.hub.require_history_room()


async def test_the_history_of_what_rests_is_thin_and_of_what_moves_is_not(rig: Rig) -> None:
    await rig.clock.advance(60.0)
    rest_s = rig.hub.join("chip", ("position.0",), 100.0, history_s=30.0).history_time_s
    assert len(rest_s) == pytest.approx(30 * REST_RATE_HZ, abs=1)
    began_s = rig.device.device_time_s()
    await rig.device.motion.move(0, 4000)
    await rig.clock.advance(30.0)
    joined = rig.hub.join("chip", ("position.0",), 100.0, history_s=30.0)
    time_s, position = joined.history_time_s, joined.history[:, 0]
    there_s = time_s[np.argmax(position == 4000)]
    assert np.diff(time_s[(began_s <= time_s) & (time_s <= there_s)]).max() <= 0.02 + 1e-9
    assert time_s[time_s >= began_s][0] - began_s <= 0.02
    assert there_s - began_s > 0.2
    assert len(time_s[time_s > there_s + 3.0]) < 30 * REST_RATE_HZ


async def test_a_history_comes_back_to_its_full_rate_where_nobody_here_commanded_it(rig: Rig) -> None:
    await rig.clock.advance(60.0)
    rig.emulator.exchange(bytes.fromhex("00 10 00 00"))  # x_target of axis 0, by another master
    await rig.clock.advance(3.0)
    joined = rig.hub.join("chip", ("position.0",), 100.0, history_s=1.0)
    assert len(joined.history_time_s) == pytest.approx(50, abs=2)


async def test_a_machine_with_too_much_to_do_gets_a_thin_history(rig: Rig) -> None:
    await rig.device.motion.rotate(0, 1000)
    await rig.clock.advance(10.0)
    rig.clock.set(rig.clock.now() + 2 * LATE_S)  # every timer is late
    await rig.clock.advance(1.0)
    began_s = rig.device.device_time_s()
    await rig.clock.advance(2.0)
    joined = rig.hub.join("chip", ("position.0",), 100.0, history_s=rig.device.device_time_s() - began_s)
    assert len(joined.history_time_s) == pytest.approx(2 * REST_RATE_HZ, abs=1)
    await rig.clock.advance(CROWDED_S + 2.0)
    joined = rig.hub.join("chip", ("position.0",), 100.0, history_s=1.0)
    assert len(joined.history_time_s) == pytest.approx(50, abs=2)


async def test_a_slow_reader_loses_the_oldest_and_knows_how_many(rig: Rig) -> None:
    joined = rig.hub.join("chip", ("position.0",), 1000.0)
    await rig.clock.advance(10.0)
    reader = joined.reader
    assert reader.dropped == pytest.approx(8000, abs=60)
    time_s, _ = taken(reader)
    assert len(time_s) + reader.dropped == pytest.approx(10_000, abs=60)
    np.testing.assert_allclose(np.diff(time_s), 1e-3, atol=1e-9)
    assert time_s[-1] == pytest.approx(rig.device.device_time_s(), abs=0.02)


async def test_an_unplugged_device_is_a_gap_and_comes_back_by_itself(rig: Rig) -> None:
    joined = rig.hub.join("chip", ("position.0",), 100.0)
    await rig.clock.advance(1.0)
    rig.unplug(unplugged=True)
    await rig.clock.advance(2.0)
    time_s, samples = taken(joined.reader)
    gaps = [event for event in joined.reader.take_events() if isinstance(event, Gap)]
    assert len(gaps) == 1
    assert "unplugged" in gaps[0].reason
    assert np.isnan(samples[-1, 0])
    assert np.isnan(samples).sum() == 1
    assert time_s[-1] == pytest.approx(1.0, abs=0.05)
    rig.unplug(unplugged=False)
    await rig.clock.advance(6.0)
    time_s, samples = taken(joined.reader)
    assert len(time_s) > 50
    assert not np.isnan(samples).any()
    history = rig.hub.join("chip", ("position.0",), 100.0, history_s=60.0).history
    assert np.isnan(history).sum() == 1


async def test_a_disconnected_device_gives_nothing_until_it_is_connected(rig: Rig) -> None:
    joined = rig.hub.join("chip", ("position.0",), 100.0)
    await rig.clock.advance(1.0)
    await rig.manager.disconnect("chip")
    taken(joined.reader)
    await rig.clock.advance(1.0)
    assert len(taken(joined.reader)[0]) <= 3
    await rig.manager.connect("chip")
    await rig.clock.advance(1.0)
    assert len(taken(joined.reader)[0]) > 80


async def test_a_move_is_told_to_all_readers(rig: Rig) -> None:
    readers = [rig.hub.join("chip", (name,), 100.0).reader for name in ("position.0", "velocity.1")]
    started = await rig.device.motion.move(0, 1000)
    for reader in readers:
        moves = [event for event in reader.take_events() if isinstance(event, MoveSeen)]
        assert moves == [MoveSeen(0, started.started_at_s)]


async def test_the_status_tells_the_rate_that_was_reached(rig: Rig) -> None:
    joined = rig.hub.join("chip", ("position.0",), 500.0)
    statuses = []
    for _ in range(12):
        await rig.clock.advance(0.25)
        taken(joined.reader)
        statuses += [event for event in joined.reader.take_events() if isinstance(event, Status)]
    assert len(statuses) == pytest.approx(3, abs=1)
    assert statuses[-1].achieved_rate_hz == pytest.approx(500, rel=0.02)
    assert statuses[-1].jitter_ms < 1e-3
    assert statuses[-1].dropped == 0


async def test_time_runs_faster_when_the_emulators_does(rig: Rig) -> None:
    rig.emulator.clock.scale = 10.0
    joined = rig.hub.join("chip", ("position.0",), 100.0)
    time_s, _ = await run(rig, joined, 2.0)
    assert len(time_s) == pytest.approx(200, abs=5)
    np.testing.assert_allclose(np.diff(time_s), 0.1, atol=1e-6)


async def test_a_device_that_is_removed_ends_its_readers(rig: Rig) -> None:
    joined = rig.hub.join("chip", ("position.0",), 100.0)
    await rig.manager.remove("chip")
    assert joined.reader.closed
    with pytest.raises(UnknownThing):
        rig.hub.join("chip", ("position.0",), 100.0)


@pytest.mark.parametrize("rate_hz", [0.0, 0.99, 1000.1, -1.0, float("nan"), float("inf")])
async def test_a_rate_out_of_range_is_refused_naming_the_range(rig: Rig, rate_hz: float) -> None:
    with pytest.raises(OutOfRange, match=r"1\.\.1000"):
        rig.hub.join("chip", ("position.0",), rate_hz)


async def test_an_unknown_channel_is_refused_and_changes_nothing(rig: Rig) -> None:
    joined = rig.hub.join("chip", ("position.0",), 100.0)
    with pytest.raises(UnknownThing, match=r"position\.7"):
        rig.hub.join("chip", ("position.0", "position.7"), 1000.0)
    time_s, _ = await run(rig, joined, 1.0)
    assert len(time_s) == pytest.approx(100, abs=3)


async def test_the_history_of_a_removed_device_needs_no_garbage_collector_to_go(
    rig: Rig, monkeypatch: pytest.MonkeyPatch
) -> None:
    memory: list[weakref.ref[FloatArray]] = []
    empty = np.empty

    def watched(*given: Any, **options: Any) -> FloatArray:
        made: FloatArray = empty(*given, **options)
        if made.nbytes > 10_000:
            memory.append(weakref.ref(made))
        return made

    monkeypatch.setattr(np, "empty", watched)
    gc.disable()
    try:
        await rig.manager.add(DeviceConfig("other", "tmc4210", {"kind": "emulator"}))
        await rig.clock.advance(1.0)
        assert [each for each in memory if each() is not None]
        await rig.manager.remove("other")
        await rig.clock.advance(1.0)
        assert not [each for each in memory if each() is not None]
    finally:
        gc.enable()
