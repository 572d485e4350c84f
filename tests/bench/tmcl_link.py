"""Our TMCL link: against PyTrinamic and a raw loop on the same pty, against the wire's own limit, and through faults.

The module is a process of its own everywhere, `stepscope emulate` as a user starts it.
"""

from __future__ import annotations

import asyncio
import contextlib
import os
import statistics
import tempfile
import threading
import time
from collections.abc import AsyncIterator, Iterator, Sequence
from contextlib import asynccontextmanager
from pathlib import Path

from app.clock import WallClock
from app.devices.core.config import DeviceConfig
from app.devices.core.device import Device
from app.devices.manager import DeviceManager
from app.emulator_server.fault import change
from app.errors import BenchError
from app.links.queue import LinkQueue
from app.links.registry import serial_factory
from app.links.serial_line import LinePort, serial_port
from app.links.streams import FdStream
from app.registers.tmcl.commands import Opcode
from app.telemetry.sampling import Sampling
from tests.bench.table import Row
from tests.bench.tmcl_peer import GAP_ACTUAL_POSITION, emulated_pty, pytrinamic_gaps_per_s, raw_gaps_per_s
from tests.peers.emulator_process import EmulatorProcess, emulator

PYTRINAMIC_RATIO = 2.0
RAW_RATIO = 0.8
WIRE_SHARE = 0.9
BAUD = 115200
CALLS_POSSIBLE = BAUD / 180
BATCH = 200
PATIENCE_S = 5.0
"""The emulator is a process, and this machine may have others to run."""
BACK_WITHIN_S = 3.0
QUANTITIES = ("position", "velocity", "target_position", "encoder_position", "load_value", "actual_current_scale")
CHANNELS = tuple(f"{quantity}.0" for quantity in QUANTITIES)


def measure(quick: bool) -> Sequence[Row]:
    return [*_calls(quick=quick), *asyncio.run(_telemetry(quick=quick)), asyncio.run(_replug(quick=quick))]


# --- calls a second ---------------------------------------------------------------------------


def _calls(*, quick: bool) -> list[Row]:
    seconds, rounds = (0.5, 3) if quick else (2.0, 9)
    ours, alone, raw, theirs = [], [], [], []
    with emulated_pty() as process:
        assert process.pty is not None
        # In turns, so that what else the machine does falls on all.
        for _ in range(rounds):
            raw.append(raw_gaps_per_s(process.pty, seconds))
            ours.append(asyncio.run(_our_gaps_per_s(process.pty, seconds, BATCH)))
            theirs.append(pytrinamic_gaps_per_s(process.pty, seconds))
            alone.append(asyncio.run(_our_gaps_per_s(process.pty, seconds, 1)))
    median = statistics.median
    to_peer = median(a / b for a, b in zip(ours, theirs, strict=True))
    to_raw = median(a / b for a, b in zip(ours, raw, strict=True))
    one = f"one awaited exchange at a time: {median(alone):,.0f}/s, {median(alone) / median(theirs):.2f} of PyTrinamic"
    return [
        Row(
            what="GAP over one pty, in batches",
            measured=f"{median(ours):,.0f}/s",
            peer=f"PyTrinamic {median(theirs):,.0f}/s",
            ratio=to_peer,
            required=f">= {PYTRINAMIC_RATIO:g}",
            ok=to_peer >= PYTRINAMIC_RATIO,
            notes=(one,),
        ),
        Row(
            what="the same against the system calls",
            measured=f"{median(ours):,.0f}/s",
            peer=f"os.write and os.read {median(raw):,.0f}/s",
            ratio=to_raw,
            required=f">= {RAW_RATIO:g}",
            ok=to_raw >= RAW_RATIO,
        ),
    ]


async def _our_gaps_per_s(path: Path, seconds: float, batch: int) -> float:
    port = serial_port(str(path), baud=BAUD, timeout_s=PATIENCE_S)
    queue = LinkQueue(port)
    frames = (GAP_ACTUAL_POSITION,) * batch
    await queue.exchange(GAP_ACTUAL_POSITION)
    count, start_s = 0, time.perf_counter()
    while (took_s := time.perf_counter() - start_s) < seconds:
        if batch == 1:
            for _ in range(50):  # between two looks at the clock, as the peers do
                await queue.exchange(GAP_ACTUAL_POSITION)
            count += 50
        else:
            await queue.exchange_many(frames)
            count += batch
    await port.aclose()
    return count / took_s


# --- the wire used up, and a stop on it -------------------------------------------------------


@asynccontextmanager
async def _device(path: Path, timeout_s: float) -> AsyncIterator[Device]:
    manager = DeviceManager({"serial": serial_factory}, WallClock())
    link = {"kind": "serial", "port": str(path), "baud": BAUD, "timeout_s": timeout_s}
    device = await manager.add(DeviceConfig("module", "pd42-1241", link))
    try:
        if device.state != "connected":
            raise RuntimeError(f"the module does not answer: {device.problem}")
        yield device
    finally:
        await manager.close()


class _Wire:
    """What goes over the wire and when, seen where the bytes leave this process."""

    def __init__(self) -> None:
        self.events: list[tuple[float, bytes]] = []
        """Time [s] and frame for what goes out, time and b"" for an answer."""

    @contextlib.contextmanager
    def watched(self) -> Iterator[None]:
        send, write, read, events = FdStream.send, FdStream.write, FdStream.read, self.events

        def noting_send(self: FdStream, data: bytes) -> None:
            events.append((time.perf_counter(), data))
            send(self, data)

        def noting_write(self: FdStream, data: bytes) -> None:
            events.append((time.perf_counter(), data))
            write(self, data)

        def noting_read(self: FdStream, timeout_s: float) -> bytes:
            data = read(self, timeout_s)
            if data:
                events.append((time.perf_counter(), b""))
            return data

        FdStream.send, FdStream.write, FdStream.read = noting_send, noting_write, noting_read  # type: ignore[method-assign]
        try:
            yield
        finally:
            FdStream.send, FdStream.write, FdStream.read = send, write, read  # type: ignore[method-assign]


async def _telemetry(*, quick: bool) -> list[Row]:
    seconds, stops = (3.0, 30) if quick else (20.0, 300)
    failures: list[BenchError] = []
    with emulated_pty("--baud", str(BAUD)) as process:
        assert process.pty is not None
        async with _device(process.pty, PATIENCE_S) as device:
            sampling = Sampling(device, CHANNELS, 10_000.0, WallClock(), failures.append)
            await asyncio.sleep(1.0)
            before, start_s = sum(device.session.queue.counts.frames), time.perf_counter()
            rows = 0
            while time.perf_counter() - start_s < seconds:
                await asyncio.sleep(0.05)
                rows += len(sampling.take().time_s)
            took_s = time.perf_counter() - start_s
            achieved = (sum(device.session.queue.counts.frames) - before) / took_s
            between, waited_ms = await _stops(device, stops)
            sampling.end()
            await sampling.cut_off()
    share = achieved / CALLS_POSSIBLE
    worst = max(between)
    stop_took = (
        f"on the wire after {statistics.median(waited_ms):.2f} ms, at most {max(waited_ms):.2f} ms;"
        f" a transaction takes {1e3 / CALLS_POSSIBLE:.2f} ms"
    )
    return [
        Row(
            what=f"telemetry at {BAUD:,} baud modelled",
            measured=f"{achieved:,.0f} calls/s",
            peer=f"wire {CALLS_POSSIBLE:,.0f}/s",
            ratio=share,
            required=f">= {WIRE_SHARE:g}",
            ok=share >= WIRE_SHARE and not failures,
            notes=(f"{rows / took_s:,.1f} rows/s of {sampling.questions} questions; {len(failures)} failures",),
        ),
        Row(
            what=f"stop while telemetry saturates that wire, {stops} times",
            measured=f"{worst} transactions before it",
            peer="at most 1",
            ratio=float(worst),
            required="<= 1",
            ok=worst <= 1,
            notes=(stop_took,),
        ),
    ]


async def _stops(device: Device, stops: int) -> tuple[list[int], list[float]]:
    """For each stop: transactions that ended between the call and its frame, and how long that took [ms]."""
    wire = _Wire()
    between, waited_ms = [], []
    with wire.watched():
        for number in range(stops):
            await asyncio.sleep(0.013 + 0.0001 * (number % 17))  # at no fixed place of a transaction
            first, called_s = len(wire.events), time.perf_counter()
            await device.stop(0)
            after = wire.events[first:]
            at = next(i for i, (_, frame) in enumerate(after) if frame[1:2] in (bytes([Opcode.MST]), b"\x0d"))
            between.append(sum(not frame for _, frame in after[:at]))
            waited_ms.append((after[at][0] - called_s) * 1e3)
    return between, waited_ms


# --- the cable --------------------------------------------------------------------------------


async def _replug(*, quick: bool) -> Row:
    """Pull and plug, with telemetry and five readers that never let go."""
    times = 10 if quick else 100
    took_s: list[float] = []
    with tempfile.TemporaryDirectory(prefix="stepscope-") as folder:
        pty = Path(folder) / "module"
        with emulator("--control", "127.0.0.1:0", pty=pty) as process:
            async with _device(pty, 0.25) as device:
                sampling = Sampling(device, CHANNELS, 1000.0, WallClock(), lambda _: None)
                load = [asyncio.create_task(_read_on(device)) for _ in range(5)]
                await asyncio.sleep(0.5)
                await _plug(process, unplugged=False)  # the thread that asks for it is there before we count
                before = _resources()
                missed = 0
                for _ in range(times):
                    await _plug(process, unplugged=True)
                    missed += not await _within(device, "failed", BACK_WITHIN_S)
                    plugged_s = time.monotonic()
                    await _plug(process, unplugged=False)
                    await _within(device, "connected", 2 * BACK_WITHIN_S)
                    took_s.append(time.monotonic() - plugged_s)
                await asyncio.sleep(0.5)
                leaked = [now - then for now, then in zip(_resources(), before, strict=True)]
                for task in load:
                    task.cancel()
                await asyncio.gather(*load, return_exceptions=True)
                sampling.end()
                await sampling.cut_off()
                assert isinstance(device.session.port, LinePort)
    left = [thread.name for thread in threading.enumerate() if thread.name.startswith("line ")]
    recovered = sum(took < BACK_WITHIN_S for took in took_s)
    found = (
        f"median {statistics.median(took_s):.2f} s, longest {max(took_s):.2f} s;"
        f" descriptors {leaked[0]:+d}, threads {leaked[1]:+d}; {missed} pulls not noticed"
    )
    return Row(
        what=f"pull and replug {times} times under load",
        measured=f"{recovered} recoveries under {BACK_WITHIN_S:g} s",
        peer=f"{times}",
        ratio=recovered / times,
        required="all, nothing leaked",
        ok=recovered == times and not missed and max(leaked) <= 0 and not left,
        notes=(found,),
    )


async def _read_on(device: Device) -> None:
    while True:
        with contextlib.suppress(BenchError):
            await device.registers.read("actual_position")
        await asyncio.sleep(0)


async def _plug(process: EmulatorProcess, *, unplugged: bool) -> None:
    word = "on" if unplugged else "off"
    await asyncio.to_thread(change, process.control, "unplugged", word, line=True)


async def _within(device: Device, state: str, seconds: float) -> bool:
    """Wait until the device is in `state`; whether it is within `seconds` [s]."""
    until_s = time.monotonic() + seconds
    while device.state != state:
        if time.monotonic() > until_s:
            return False
        await asyncio.sleep(0.002)
    return True


def _resources() -> tuple[int, int]:
    """Descriptors and threads, without those of the executor that asks the emulator."""
    threads = [thread for thread in threading.enumerate() if not thread.name.startswith("asyncio_")]
    return len(os.listdir("/proc/self/fd")), len(threads)


def main() -> None:
    from tests.bench.table import render

    print(render(measure(True)))


if __name__ == "__main__":
    main()
