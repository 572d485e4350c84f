"""Move an axis, record it, and say how well the prediction held.

python docs/examples/move_and_measure.py bench --distance 20000
"""

from __future__ import annotations

import argparse

import numpy as np
from stepscope import Bench


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("device", help="its id, as `stepscope devices` lists it")
    parser.add_argument("--axis", type=int, default=0)
    parser.add_argument("--distance", type=int, default=20_000, help="microsteps")
    parser.add_argument("--url", help="default: STEPSCOPE_URL, or this machine")
    arguments = parser.parse_args()
    device, axis = arguments.device, arguments.axis
    with Bench(arguments.url) as bench:
        channels = [f"{quantity}.{axis}" for quantity in ("position", "velocity", "residual")]
        recording = bench.record(device, channels, rate_hz=500, name="move_and_measure")
        try:
            started = bench.move(device, axis, arguments.distance, relative=True)  # answers at the target
        finally:
            bench.stop_recording(recording.id)
        samples = bench.recorded(recording.id)
    residual = samples[channels[2]]
    print(f"from {started.from_position} to {started.target_position} microsteps, {len(samples.time_s)} samples")
    print(f"peak velocity {np.nanmax(np.abs(samples[channels[1]])):,.0f} pps")
    if np.isfinite(residual).any():
        print(f"off the prediction by at most {np.nanmax(np.abs(residual)):.1f} microsteps")
    print(f"recording {recording.id} is kept: stepscope recordings")


if __name__ == "__main__":
    main()
