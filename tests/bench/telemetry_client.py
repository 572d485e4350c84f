"""Ten readers of one device's telemetry, in a process of their own. Prints one JSON line with what they saw."""

from __future__ import annotations

import argparse
import asyncio
import json
import struct
import sys
import time
from dataclasses import asdict, dataclass

import numpy as np
from websockets.asyncio.client import connect

HEADER = struct.Struct("<4sIIIQ")


@dataclass
class Seen:
    """What one reader got: `latency_ms` is at its 99th percentile over all samples, from sampling to arrival."""

    rows: int = 0
    dropped: int = 0
    frames_missed: int = 0
    gaps: int = 0
    seconds: float = 0.0
    latency_p99_ms: float = 0.0
    latency_max_ms: float = 0.0


async def read(url: str, seconds: float) -> Seen:
    """Read for `seconds` [s] of samples and check them: no frame missing, no beat missing."""
    seen = Seen()
    latencies: list[np.ndarray[tuple[int], np.dtype[np.float64]]] = []
    async with connect(url, max_size=None, compression=None) as socket:
        hello = json.loads(await socket.recv())
        origin_s, period_s = float(hello["time_origin_unix_s"]), 1.0 / float(hello["rate_hz"])
        first_s = last_s = float("nan")
        sequence: int | None = None
        while not last_s - first_s >= seconds:
            message = await socket.recv()
            now_s = time.time()
            if isinstance(message, str):
                continue
            magic, number, rows, columns, dropped = HEADER.unpack_from(message)
            if magic != b"SSC1" or len(message) != HEADER.size + 8 * rows * (1 + columns):
                raise ValueError(f"no telemetry frame: {message[:24]!r}")
            seen.frames_missed += 0 if sequence is None else number - sequence - 1
            sequence, seen.dropped = number, dropped
            if not rows:
                continue
            times_s = np.frombuffer(message, "<f8", rows, HEADER.size)
            steps_s = np.diff(times_s, prepend=last_s) if last_s == last_s else np.diff(times_s)
            seen.gaps += int(np.count_nonzero(steps_s > 1.5 * period_s))
            if first_s != first_s:
                first_s = float(times_s[0])
            last_s = float(times_s[-1])
            seen.rows += rows
            latencies.append(now_s - (origin_s + times_s))
    every_ms = np.concatenate(latencies) * 1000
    seen.seconds = last_s - first_s
    seen.latency_p99_ms = float(np.percentile(every_ms, 99, method="higher"))
    seen.latency_max_ms = float(every_ms.max())
    return seen


async def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("url", help="ws://... with channels and rate")
    parser.add_argument("--readers", type=int, default=10)
    parser.add_argument("--seconds", type=float, default=60.0)
    arguments = parser.parse_args()
    seen = await asyncio.gather(*(read(arguments.url, arguments.seconds) for _ in range(arguments.readers)))
    json.dump([asdict(reader) for reader in seen], sys.stdout)


if __name__ == "__main__":
    asyncio.run(main())
