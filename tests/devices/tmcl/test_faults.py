"""Faults during moves and telemetry: nothing wrong shown as right, and nothing that moves sent twice."""

from __future__ import annotations

import numpy as np
import pytest

from app.devices.core.background_tasks import BackgroundTasks
from app.devices.core.config import DeviceConfig
from app.errors import BenchError, LinkDown, LinkError, WrongState
from app.links.tmcl import Reply, Request
from app.registers.tmcl.commands import Opcode
from app.telemetry.hub import TelemetryHub
from app.telemetry.reader import Reader
from tests.devices.tmcl.harness import MOVERS, Bench, bench, state_of

FAULTS = {
    "flipped bits": {"bit_error_rate": 0.003},
    "half frames": {"half_frame_rate": 0.05},
    "silence": {"silence": True},
    "unplugged": {"unplugged": True},
}
NO_FAULT = {"bit_error_rate": 0.0, "half_frame_rate": 0.0, "silence": False, "unplugged": False}


def _sent(b: Bench) -> list[tuple[int, int, int]]:
    return [
        (frame.opcode, frame.type, frame.value)
        for frame in b.tap.frames
        if frame.opcode in MOVERS and (frame.opcode, frame.type) != (Opcode.RFS, 2)
    ]


def _position(b: Bench) -> int:
    """The counter itself, past every fault of the line."""
    reply = b.module.receive(Request(1, Opcode.GAP, 1).encode())
    assert reply is not None
    return Reply.decode(reply).value


def _rows(reader: Reader, b: Bench) -> list[np.ndarray]:
    """What waits for a reader: arrays of time, position, encoder [3, rows]."""
    rows = []
    while (frame := reader.take(b.clock.now())) is not None:
        count = int.from_bytes(frame[8:12], "little")
        rows.append(np.frombuffer(frame, "<f8", offset=24).reshape(3, count))
    return rows


@pytest.mark.parametrize("fault", list(FAULTS))
async def test_moves_under_faults_are_sent_once_each_and_positions_are_true(fault: str) -> None:
    async with bench() as b:
        await b.device.registers.write("ap4", 0, 200_000)
        asked: list[int] = []
        b.patch(faults=FAULTS[fault])
        for turn in range(25):
            target = 100 * (turn + 1)
            sent = len(_sent(b))
            try:
                await b.device.motion.move(0, target)
            except BenchError:
                assert len(_sent(b)) - sent <= 1
            else:
                asked.append(target)
                assert len(_sent(b)) - sent == 1
            await b.clock.advance(0.1)
            truth = _position(b)
            try:
                shown = (await b.device.monitor.axis_state(0)).position
            except LinkError:
                continue
            assert shown == truth
        targets = [value for opcode, _, value in _sent(b) if opcode == Opcode.MVP]
        assert len(targets) == len(set(targets)), "a move went out twice"
        assert set(asked) <= set(targets)


@pytest.mark.parametrize("fault", list(FAULTS))
async def test_telemetry_under_faults_has_holes_and_no_wrong_numbers(fault: str) -> None:
    async with bench() as b:
        hub = TelemetryHub(b.clock, 1.0)
        hub.sync(b.manager.devices)
        joined = hub.join("bench", ("position.0", "encoder_position.0"), 200.0)
        await b.device.motion.rotate(0, 20_000)
        rows: list[np.ndarray] = []
        for faults, seconds in (({}, 0.4), (FAULTS[fault], 0.4), (NO_FAULT, 2.8)):
            b.patch(faults=faults)
            await b.clock.advance(seconds / 2)
            rows += _rows(joined.reader, b)
            await b.clock.advance(seconds / 2)
            rows += _rows(joined.reader, b)
        time_s, position, encoder = np.concatenate(rows, axis=1)
        assert np.isnan(position).any() or np.isnan(encoder).any()
        known = np.isfinite(position)
        # Ever to the right, and never farther than the speed allows: what a wrong number would break.
        speed = np.diff(position[known]) / np.diff(time_s[known])
        assert speed.min() >= 0
        assert speed.max() < 21_000
        both = known & np.isfinite(encoder)
        assert np.abs(encoder[both] - position[both]).max() < 400
        assert np.isfinite(position[-100:]).all(), "it came back by itself"
        await hub.close()


async def test_a_module_unplugged_on_the_way_is_unknown_until_it_is_back() -> None:
    async with bench() as b:
        await b.device.motion.move(0, 500_000)
        await b.clock.advance(1.0)
        b.patch(faults={"unplugged": True})
        with pytest.raises(LinkDown):
            await b.device.monitor.axis_state(0)
        assert state_of(b.device) == "failed"
        assert b.device.motion.prediction(0) is None
        b.patch(faults={"unplugged": False})
        await b.clock.advance(3.0)
        assert state_of(b.device) == "connected"
        assert (await b.device.monitor.axis_state(0)).moving
        assert len(_sent(b)) == 1


async def test_another_module_is_named() -> None:
    async with bench() as b:
        b.tap.spoil = lambda request, reply: (
            bytes.fromhex("02 01 64 88 04 D8 01 2C F8") if request.opcode == Opcode.GET_VERSION else reply
        )
        with pytest.raises(WrongState, match=r"module 1240, firmware 1\.44"):
            await b.device.identity.probe()


async def test_another_firmware_is_told_and_tried() -> None:
    async with bench() as b:
        b.tap.spoil = lambda request, reply: (
            bytes.fromhex("02 01 64 88 04 D9 01 2F FC") if request.opcode == Opcode.GET_VERSION else reply
        )
        assert "knows 1.44" in await b.device.identity.probe()


async def test_letting_go_stops_what_was_set_in_motion_and_leaves_no_task() -> None:
    async with bench() as b:
        await b.device.motion.rotate(0, 20_000)
        await b.clock.advance(0.5)
        await b.manager.remove(b.device.id)
        assert _sent(b)[-1][0] == Opcode.MST
        assert not b.part(BackgroundTasks)
        await b.manager.add(DeviceConfig("Again", "pd42-1241", {"kind": "emulator"}))
