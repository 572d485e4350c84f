"""Measures what the issues promised and prints a table; 1 when something is below it. `--quick` is for a look."""

from __future__ import annotations

import argparse
import os
import platform
import sys
from collections.abc import Callable, Sequence

from tests.bench import (
    any_model,
    audit_kills,
    batch,
    browser,
    calculators,
    chain_drives,
    churn,
    cold_start,
    collected,
    editor,
    emulation,
    emulation5xxx,
    emulation4361,
    extended_positions,
    first_page,
    first_run,
    fresh_clone,
    fuzz,
    growth,
    hostile,
    image_size,
    listed,
    long_run,
    lossy_download,
    motor,
    mslut,
    newcomer,
    palette,
    planner,
    profile_faults,
    recording_kills,
    recording_list,
    recording_view,
    scope,
    serving,
    stall_homing,
    stops,
    tmcl_link,
    tmcl_programs,
    together,
    twin,
    uart_link,
    undo,
    velocity_stream,
    views,
)
from tests.bench.studies import (
    aborts,
    broken,
    chopper,
    closed_loop,
    fastest_move,
    identification,
    least_current,
    microstep_calibration,
    nothing_to_gain,
    resonance_map,
    stallguard,
    stealthchop,
    torque_curve,
    twins,
)
from tests.bench.table import Row, render

MEASURES: dict[str, Callable[[bool], Sequence[Row]]] = {
    "emulation": lambda quick: [emulation.measure(quick=quick)],
    "chain-drives": chain_drives.measure,
    "tmc4361": emulation4361.measure,
    "tmc5xxx": emulation5xxx.measure,
    "cpu": lambda quick: [serving.measure_cpu(quick=quick)],
    "get": lambda quick: [serving.measure_get(quick=quick)],
    "telemetry": lambda quick: serving.measure_telemetry(quick=quick),
    "plots": lambda quick: [browser.measure(quick=quick)],
    "scope": lambda quick: scope.measure(quick=quick),
    "growth": growth.measure,
    "cold-start": cold_start.measure,
    "image": image_size.measure,
    "make run": fresh_clone.measure,
    "undo": undo.measure,
    "palette": lambda quick: [palette.measure(quick=quick)],
    "first page": lambda quick: [first_page.measure(quick=quick)],
    "views": lambda quick: [views.measure(quick=quick)],
    "newcomer": newcomer.measure,
    "first run": first_run.measure,
    "batch": batch.measure,
    "motor": lambda quick: [motor.measure(quick=quick)],
    "tmcl": tmcl_link.measure,
    "programs": tmcl_programs.measure,
    "editor": editor.measure,
    "homing": stall_homing.measure,
    "study chopper": chopper.measure,
    "study closed loop": closed_loop.measure,
    "study closed loop repeats": closed_loop.measure_repeats,
    "study fastest move": fastest_move.measure,
    "study identification": identification.measure,
    "study least current": least_current.measure,
    "study microstep calibration": microstep_calibration.measure,
    "study nothing to gain": nothing_to_gain.measure,
    "study resonance map": resonance_map.measure,
    "study stallguard": stallguard.measure,
    "study stealthchop": stealthchop.measure,
    "study twins": twins.measure,
    "study aborts": aborts.measure,
    "study torque": torque_curve.measure,
    "study broken plants": broken.measure,
    "lossy": lossy_download.measure,
    "uart": uart_link.measure,
    "velocity": velocity_stream.measure,
    "together": together.measure,
    "planner": planner.measure,
    "pmul": lambda quick: [calculators.measure(quick=quick)],
    "mslut": lambda quick: [mslut.measure(quick=quick)],
    "extended positions": extended_positions.measure,
    "listed": listed.measure,
    "any model": any_model.measure,
    "recordings": recording_kills.measure,
    "list": recording_list.measure,
    "audit": audit_kills.measure,
    "view": recording_view.measure,
    "profiles": profile_faults.measure,
    "twin": twin.measure,
    "hostile": hostile.measure,
    "fuzz": fuzz.measure,
    "stops": stops.measure,
    "churn": churn.measure,
    "day": long_run.measure,
}


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--quick", action="store_true", help="shorter runs: figures for a look, not for a claim")
    parser.add_argument("--only", action="append", choices=MEASURES, help="only this; may be repeated")
    parser.add_argument(
        "--resume", action="store_true", help="go on with what the same sources have judged in earlier runs, by plant"
    )
    parser.add_argument("--within", type=float, metavar="S", help="a row of plants begins no further one after this")
    arguments = parser.parse_args()
    if arguments.resume:
        collected.KEEPING.folder = collected.kept_results()
    if arguments.within is not None:
        collected.KEEPING.within_s = arguments.within
    rows: list[Row] = []
    for name in arguments.only or MEASURES:
        print(f"measuring {name} ...", file=sys.stderr, flush=True)
        rows += MEASURES[name](arguments.quick)
    print(f"{platform.machine()}, {os.cpu_count()} cores, Python {platform.python_version()}", end="")
    print(", quick\n" if arguments.quick else "\n")
    print(render(rows))
    return 0 if all(row.ok for row in rows) else 1
