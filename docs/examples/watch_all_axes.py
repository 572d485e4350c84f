"""Watch every axis of the bench at once, with asyncio, and print where each has been.

python docs/examples/watch_all_axes.py --seconds 2
"""

from __future__ import annotations

import argparse
import asyncio

import numpy as np
from stepscope import AsyncBench, Device


async def watch(bench: AsyncBench, device: Device, axis: int, seconds: float) -> str:
    """A line about an axis."""
    samples = await bench.watch(device.id, [f"position.{axis}"], seconds, rate_hz=100)
    low, high = np.nanmin(samples.values), np.nanmax(samples.values)
    rate_hz = (len(samples.time_s) - 1) / (samples.time_s[-1] - samples.time_s[0])
    return f"{device.id} axis {axis}: {low:,.0f} to {high:,.0f} microsteps, {rate_hz:.0f} samples a second"


async def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--seconds", type=float, default=2.0)
    parser.add_argument("--url", help="default: STEPSCOPE_URL, or this machine")
    arguments = parser.parse_args()
    async with AsyncBench(arguments.url) as bench:
        connected = [device for device in await bench.devices() if device.state == "connected"]
        looks = [
            watch(bench, device, axis, arguments.seconds) for device in connected for axis in range(len(device.axes))
        ]
        for line in await asyncio.gather(*looks):
            print(line)


if __name__ == "__main__":
    asyncio.run(main())
