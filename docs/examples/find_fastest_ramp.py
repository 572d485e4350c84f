"""Raise the acceleration of a TMC428 until a move would take no less time, with a matching pmul and pdiv each time.

python docs/examples/find_fastest_ramp.py bench --distance 6400
"""

from __future__ import annotations

import argparse

from stepscope import Bench


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("device", help="a TMC428")
    parser.add_argument("--axis", type=int, default=0)
    parser.add_argument("--distance", type=int, default=6400, help="microsteps")
    parser.add_argument("--least-gain", type=float, default=0.05, help="share of the time that a step has to save")
    parser.add_argument("--url", help="default: STEPSCOPE_URL, or this machine")
    arguments = parser.parse_args()
    device, axis = arguments.device, arguments.axis
    # It writes and moves for a while: nobody else should in between.
    with Bench(arguments.url) as bench, bench.lease("find the fastest ramp", wait_s=60.0):
        ramp_div = bench.read(device, "ramp_div", axis).value
        pulse_div = bench.read(device, "pulse_div", axis).value
        best_s, a_max, way = float("inf"), 50, 1
        while a_max < 2048:
            pair = bench.calc("pmul-pdiv", chip="tmc428", a_max=a_max, ramp_div=ramp_div, pulse_div=pulse_div)
            bench.write(device, "a_max", a_max, axis)
            bench.write(device, "pmul_pdiv", {"pmul": pair["pmul"], "pdiv": pair["pdiv"]}, axis)
            started = bench.move(device, axis, way * arguments.distance, relative=True)
            took_s = started.predicted_duration_s or float("nan")
            print(f"a_max {a_max:4d}, pmul {pair['pmul']:3d}, pdiv {pair['pdiv']:2d}: {took_s:.3f} s")
            if took_s > best_s * (1 - arguments.least_gain):
                break
            best_s, a_max, way = took_s, 2 * a_max, -way
        print(f"{best_s:.3f} s is what this distance takes at best")


if __name__ == "__main__":
    main()
