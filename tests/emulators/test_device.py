"""The emulated device as a whole: time, faults, patches, state; and the TCP server."""

from __future__ import annotations

import asyncio
import socket
import threading
import time

import pytest
from pydantic import ValidationError

from app.clock import VirtualClock
from app.emulators.build import build_emulator, warm_up
from app.emulators.server import serve_tcp
from app.emulators.tmc428.device import EmulatedDevice
from app.emulators.tmc428.family import FAMILY
from app.emulators.tmc428.options import EmulatorOptions, EmulatorPatch
from app.errors import OutOfRange, UnknownThing
from app.links.datagram32 import Reply, read, write
from tests.emulators.harness import HOLD, V_ACTUAL, V_TARGET, VELOCITY, X_ACTUAL, X_TARGET, Bench, free_bench


def test_build_refuses_what_it_cannot_make() -> None:
    with pytest.raises(UnknownThing, match="tmc999"):
        build_emulator("tmc999", VirtualClock())
    with pytest.raises(OutOfRange, match="clock_hz"):
        build_emulator("tmc428", VirtualClock(), EmulatorOptions(clock_hz=32e6))
    assert build_emulator("tmc4210", VirtualClock(), EmulatorOptions(clock_hz=32e6)).model == "tmc4210"
    warm_up()


@pytest.mark.parametrize(
    "options",
    [
        {"seed": -1},
        {"clock_hz": float("nan")},
        {"wiring": "none"},
        {"driver_microsteps": 0},
        {"colour": "red"},
        {"stages": [{"left_at_fullsteps": 5.0, "right_at_fullsteps": 5.0}]},
        {"stages": [{"ref_from_fullsteps": 5.0, "ref_to_fullsteps": 4.0}]},
        {"stages": [{}] * 4},
    ],
)
def test_wrong_options_are_refused(options: dict[str, object]) -> None:
    with pytest.raises(ValidationError):
        EmulatorOptions.model_validate(options)


def test_silence_answers_nothing_but_the_chip_has_heard() -> None:
    bench = Bench()
    bench.patch(faults={"silence": True})
    with pytest.raises(TimeoutError):
        bench.write(0x03, 77)
    bench.patch(faults={"silence": False})
    assert bench.read(0x03) == 77


def test_unplugged_hears_nothing() -> None:
    bench = Bench()
    bench.patch(faults={"unplugged": True})
    with pytest.raises(ConnectionError):
        bench.write(0x03, 77)
    bench.patch(faults={"unplugged": False})
    assert bench.read(0x03) == 0


def test_bit_errors_come_at_their_rate_and_by_seed() -> None:
    def errors(seed: int) -> list[int]:
        bench = Bench(options={"seed": seed})
        bench.patch(faults={"bit_error_rate": 0.01})
        replies = [bench.device.exchange(read(0x39)) for _ in range(2000)]
        return [(int.from_bytes(reply, "big") ^ 0x15000000).bit_count() for reply in replies]

    first = errors(1)
    assert sum(first) == pytest.approx(2000 * 32 * 0.01, rel=0.2)
    assert first == errors(1) != errors(2)


def test_power_cycle_resets_the_chip_and_leaves_the_carriage() -> None:
    bench = free_bench()
    bench.ramp()
    bench.write(X_TARGET, 640)
    bench.seconds(0.1)
    carriage = bench.place()
    bench.switch(1, left=True)
    state = bench.patch(power_cycle=True)
    assert state.axes[0].position_fullsteps == carriage
    assert state.axes[1].switches.left.forced is True
    assert (bench.x, bench.read(0x03)) == (0, 0)
    bench.ramp(mode=VELOCITY)
    bench.write(V_TARGET, 100)
    bench.seconds(0.1)
    assert bench.x > 0


def test_time_scale_runs_the_chip_faster_and_never_jumps() -> None:
    bench = free_bench()
    bench.ramp(mode=HOLD, dividers=0x4006)
    bench.write(V_ACTUAL, 1024)
    bench.seconds(0.1)
    once = bench.x
    bench.patch(time_scale=10.0)
    assert bench.x == once
    bench.seconds(0.1)
    assert bench.x == pytest.approx(11 * once, rel=0.001)
    bench.patch(time_scale=0.0)
    held = bench.x
    bench.seconds(5.0)
    assert bench.x == held


def test_samples_may_be_asked_for_in_the_past_but_never_before_the_last() -> None:
    bench = free_bench()
    bench.ramp(mode=HOLD, dividers=0x4006)
    bench.write(V_ACTUAL, 2047)
    bench.seconds(1.0)
    position = [Reply.decode(bench.device.exchange(read(X_ACTUAL), at_s)).data for at_s in (0.25, 0.5, 0.4, 0.5)]
    assert position[0] == pytest.approx(position[1] / 2, abs=1)
    assert position[2] == position[3] == position[1]


def test_catching_up_in_one_go_or_in_pieces_is_the_same() -> None:
    def run(pieces: int) -> list[int]:
        bench = free_bench()
        bench.three_drivers()
        for axis in range(3):
            bench.ramp(axis, dividers=0x3406)
            bench.write(axis << 4 | X_TARGET, 30_000 * (axis - 1))
        for _ in range(pieces):
            bench.seconds(1.0 / pieces)
            bench.read(0)
        return [*(bench.read(axis << 4 | X_ACTUAL) for axis in range(3)), bench.chain().datagrams_sent]

    assert run(1) == run(64) == run(512)


def test_ten_minutes_away_are_caught_up_in_no_time() -> None:
    bench = free_bench()
    bench.three_drivers()
    for axis in range(3):
        bench.ramp(axis, mode=VELOCITY, dividers=0x3406)
        bench.write(axis << 4 | V_TARGET, 1500)
    bench.read(0)
    bench.seconds(600.0)
    began = time.process_time()
    bench.read(0)
    assert time.process_time() - began < 6.0  # 100 times real time


def test_the_carriage_and_the_switches_can_be_moved_by_hand() -> None:
    bench = Bench(options={"wiring": "left-only"})
    state = bench.patch(stages=[{"axis": 0, "position_fullsteps": 300.0}])
    assert state.axes[0].switches.reference.active
    assert bench.read(0x3E) == 0b10
    state = bench.patch(stages=[{"axis": 0, "ref_from_fullsteps": 310.0}])
    assert not state.axes[0].switches.reference.active
    assert state.axes[0].stage.ref_from_fullsteps == 310
    with pytest.raises(OutOfRange, match="left_at"):
        bench.patch(stages=[{"axis": 0, "left_at_fullsteps": 8000.0}])
    with pytest.raises(OutOfRange, match="ref_from"):
        bench.patch(stages=[{"axis": 0, "ref_to_fullsteps": 0.0}])


def test_default_stage_has_300_mm_at_8_mm_a_turn() -> None:
    state = Bench().device.state()
    for axis in state.axes:
        span = axis.stage.right_at_fullsteps - axis.stage.left_at_fullsteps
        assert span / 200 * 8 == 300
        assert axis.position_fullsteps == axis.stage.left_at_fullsteps + span / 2
        assert not any(switch.active for switch in (axis.switches.left, axis.switches.right, axis.switches.reference))


def test_forced_switches_and_back_to_auto() -> None:
    bench = Bench()
    state = bench.patch(switches=[{"axis": 2, "right": True, "reference": False}])
    assert state.axes[2].switches.right.model_dump() == {"active": True, "forced": True}
    assert state.axes[2].switches.reference.forced is False
    state = bench.patch(switches=[{"axis": 2, "right": "auto"}])
    assert state.axes[2].switches.right.model_dump() == {"active": False, "forced": None}


@pytest.mark.parametrize(
    "change",
    [{"switches": [{"axis": 1, "left": True}]}, {"stages": [{"axis": 2}]}, {"drivers": [{"axis": 0, "status": 1}]}],
)
def test_a_patch_for_what_a_tmc4210_has_not_is_refused_whole(change: dict[str, object]) -> None:
    bench = Bench("tmc4210")
    with pytest.raises(OutOfRange):
        bench.patch(time_scale=5.0, **change)
    assert bench.device.state().time_scale == 1.0


def test_state_is_plain_json() -> None:
    for model in ("tmc428", "tmc4210"):
        state = Bench(model).device.state()
        assert type(state).model_validate_json(state.model_dump_json()) == state
    with pytest.raises(ValidationError):
        EmulatorPatch.model_validate({"switches": [{"axis": 0, "left": 1}]})


def test_a_register_read_is_cheap() -> None:
    """8000 reads a second are expected of it: 10 us each with nothing else running, 100 us at worst here."""
    bench = free_bench()
    bench.three_drivers()
    bench.ramp(dividers=0x3406)
    bench.write(X_TARGET, 100_000)
    frame = read(X_ACTUAL)
    bench.device.exchange(frame)
    began = time.process_time()
    for _ in range(4000):
        bench.seconds(0.000125)
        bench.device.exchange(frame)
    assert (time.process_time() - began) / 4000 < 100e-6


def test_threads_may_share_a_device() -> None:
    device = FAMILY.make("tmc428", VirtualClock())
    wrong: list[bytes] = []

    def client(address: int) -> None:
        for value in range(400):
            device.exchange(write(address, value))
            reply = Reply.decode(device.exchange(read(address)))
            if reply.data != value:
                wrong.append(reply.encode())

    threads = [threading.Thread(target=client, args=(address,)) for address in (0x03, 0x13, 0x23)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert wrong == []


async def _serve(device: EmulatedDevice, half_frame_s: float = 0.05) -> tuple[asyncio.Server, int]:
    server = await serve_tcp(device, "127.0.0.1", 0, half_frame_s)
    port: int = server.sockets[0].getsockname()[1]
    return server, port


async def test_server_answers_several_clients_frame_by_frame() -> None:
    server, port = await _serve(FAMILY.make("tmc428", VirtualClock()))
    async with server:
        clients = [await asyncio.open_connection("127.0.0.1", port) for _ in range(4)]

        async def talk(index: int) -> None:
            reader, writer = clients[index]
            for value in range(50):
                for frame, expected in ((write(index << 4 & 0x30 | 3, value), 0), (read(index << 4 & 0x30 | 3), value)):
                    writer.write(frame)
                    reply = Reply.decode(await reader.readexactly(4))
                    assert reply.data == expected

        await asyncio.gather(*(talk(index) for index in range(3)))
        # Frames sent in one go come back in one order, however the bytes were cut.
        reader, writer = clients[3]
        writer.write(write(0x02, 5) + read(0x02)[:3])
        writer.write(read(0x02)[3:])
        assert (await reader.readexactly(8))[4:] == bytes([0x15, 0, 0, 5])
        for _, open_writer in clients:
            open_writer.close()
            await open_writer.wait_closed()


async def test_half_a_frame_is_forgotten_and_silence_is_no_answer() -> None:
    device = FAMILY.make("tmc428", VirtualClock())
    server, port = await _serve(device)
    async with server:
        reader, writer = await asyncio.open_connection("127.0.0.1", port)
        writer.write(b"\x06\x00")
        await asyncio.sleep(0.2)
        writer.write(write(0x03, 9))
        assert await reader.readexactly(4) == bytes([0x15, 0, 0, 0])
        device.patch(EmulatorPatch.model_validate({"faults": {"silence": True}}))
        writer.write(read(0x03))
        with pytest.raises(TimeoutError):
            await asyncio.wait_for(reader.readexactly(4), 0.1)
        device.patch(EmulatorPatch.model_validate({"faults": {"silence": False}}))
        writer.write(read(0x03))
        assert await reader.readexactly(4) == bytes([0x15, 0, 0, 9])
        device.patch(EmulatorPatch.model_validate({"faults": {"unplugged": True}}))
        writer.write(read(0x03))
        assert await reader.read(4) == b""
        writer.close()
        await writer.wait_closed()


async def test_the_server_keeps_the_chip_up_to_date_while_nobody_asks() -> None:
    bench = free_bench()
    bench.ramp(mode=VELOCITY)
    bench.write(V_TARGET, 1000)
    server, _ = await _serve(bench.device)
    async with server:
        bench.seconds(3.0)
        for _ in range(3000):
            if bench.device.caught_up():
                break
            await asyncio.sleep(0.01)
        assert bench.device.caught_up()


def test_catching_up_goes_in_slices() -> None:
    bench = free_bench()
    bench.read(0)
    bench.seconds(2.5)
    assert not bench.device.caught_up()
    assert [bench.device.catch_up(1.0) for _ in range(3)] == [False, False, True]
    assert bench.device.caught_up()


async def test_server_outlives_clients_that_vanish() -> None:
    server, port = await _serve(FAMILY.make("tmc4210", VirtualClock()))
    async with server:
        for cut in range(4):
            _, writer = await asyncio.open_connection("127.0.0.1", port)
            writer.write(bytes(cut))
            sock: socket.socket = writer.get_extra_info("socket")
            assert sock is not None
            writer.transport.abort()
            await asyncio.sleep(0)
        reader, writer = await asyncio.open_connection("127.0.0.1", port)
        writer.write(read(0x39))
        assert (await reader.readexactly(4))[1:] == bytes.fromhex("429101")
        writer.close()
        await writer.wait_closed()
