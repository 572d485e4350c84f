"""A tuning session over REST, from nothing to a report: connect, set up, try accelerations, keep the best.

For each device of bench.json: connect it by TCP as if it were hardware, write what it needs to run, then move there and
back with rising accelerations while telemetry runs; where the prediction did not hold, once more. Of the moves that
arrived, and whose prediction held, the quickest is kept in the device. What was found goes to the terminal, as
report.md and report.json into a folder, and into the dashboard: a recording of each device has its moves as a plot, a
mark for each acceleration, and its part of the report, all of which the page `REPORT` shows; what was kept is a
profile. At the end every axis goes slowly back and forth, until whoever comes stops it.
"""

from __future__ import annotations

import argparse
import json
import os
import sys
import threading
import time
from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass, field
from pathlib import Path

import numpy as np
from stepscope import Bench, ClientError, MoveEnded, NoServer, Samples

BENCH = Path(__file__).with_name("bench.json")
AXIS = 0
RATE_HZ = 200.0
LATE_MAX_S = 0.02
"""A move whose prediction is off by more, as time at full speed, was not understood: a wire has its delays [s]."""
SERVER_WITHIN_S = 120.0
SHOW_DWELL_S = 2.0
"""How long an axis stands at either end of the show [s]."""
RECORD_HZ = 200.0
REPORT = "/recordings/report?search=tuning%20session"
"""Page of the dashboard: the recordings that the session made, each with its plots and its part of the report."""
LEASE_WAIT_S = 60.0
"""Somebody may have the bench in a browser; they are asked for it so long [s]."""

Write = tuple[str, int | dict[str, int | str]]
Log = Callable[[str], None]


@dataclass(frozen=True)
class Plan:
    """How a family is set up, how its acceleration is set, and how far it moves [microsteps]."""

    setup: Sequence[Write]
    accelerate: Callable[[Bench, str, int], Sequence[Write]]
    accelerations: Sequence[int]
    distance: int


@dataclass
class Try:
    """A move there and back."""

    acceleration: int
    duration_s: float
    peak_pps: float
    residual_rms: float
    residual_peak: float
    deviation_peak: float | None
    ended: str = "arrived"

    @property
    def late(self) -> bool:
        """It arrived, but not as predicted: a busy machine now and then, an axis that is not understood each time."""
        return self.ended == "arrived" and self.residual_rms > LATE_MAX_S * self.peak_pps

    @property
    def good(self) -> bool:
        return self.ended == "arrived" and not self.late


@dataclass
class Outcome:
    """What became of a device."""

    device: str
    model: str
    tries: list[Try] = field(default_factory=list)
    kept: int | None = None
    trouble: str = ""
    id: str = ""
    """The device's, in this dashboard."""


def one_register(name: str) -> Callable[[Bench, str, int], Sequence[Write]]:
    """Families where the acceleration is one register."""

    def accelerate(bench: Bench, device: str, value: int) -> Sequence[Write]:
        del bench, device
        return [(name, value)]

    return accelerate


def both_slopes(bench: Bench, device: str, value: int) -> Sequence[Write]:
    """SixPoint: up and down alike."""
    del bench, device
    return [("AMAX", value), ("DMAX", value)]


def with_pair(chip: str, register: str, part: str) -> Callable[[Bench, str, int], Sequence[Write]]:
    """Chips whose deceleration hangs on pmul and pdiv: the calculator says which pair."""

    def accelerate(bench: Bench, device: str, value: int) -> Sequence[Write]:
        del device
        pair = bench.calc("pmul-pdiv", chip=chip, a_max=value, ramp_div=7, pulse_div=3)
        return [(register, value), ("pmul_pdiv", {"pmul": pair[part], "pdiv": pair["pdiv"]})]

    return accelerate


PLANS = {
    "tmc428": Plan(
        [
            ("stepper_motor_global_parameter_register", {"clk2_div": 7, "continuous_update": 1, "refmux": 1}),
            ("v_min", 1),
            ("v_max", 1500),
            ("pulse_div_ramp_div_usrs", {"pulse_div": 3, "ramp_div": 7, "usrs": 4}),
            ("lp_ref_conf_rm", {"rm": "RAMP_MODE", "disable_stop_l": 0, "disable_stop_r": 0}),
        ],
        with_pair("tmc428", "a_max", "pmul"),
        (100, 200, 400),
        6400,
    ),
    "tmc4210": Plan(
        [
            ("IF_CONFIGURATION_4210", {"en_sd": 1}),
            ("STEPPER_MOTOR_GLOBAL_PARAMETER_REGISTER", {"mot1r": 1, "STPDIV_4210": 2}),
            ("v_min", 1),
            ("v_max", 1500),
            ("PULSE_DIV_RAMP_DIV", {"pulse_div": 3, "ramp_div": 7}),
            ("lp_REF_CONF_RAMP_MODE", {"RAMP_MODE": "RAMP_MODE", "disable_stop_l": 0, "disable_stop_r": 0}),
        ],
        with_pair("tmc4210", "a_max", "p_mul"),
        (100, 200, 400),
        6400,
    ),
    "tmc4361": Plan(
        [
            ("VMAX", 0),
            ("CLK_FREQ", 16_000_000),
            ("STEP_CONF", {"mstep_per_fs": 0, "fs_per_rev": 200}),
            ("STP_LENGTH_ADD___DIR_SETUP_TIME", {"STP_LENGTH_ADD": 4, "DIR_SETUP_TIME": 4}),
            *((f"BOW{number}", 4_000_000) for number in (1, 2, 3, 4)),
            ("RAMPMODE", 6),
            ("VMAX", 100_000 << 8),
        ],
        lambda bench, device, value: [("AMAX", value << 2), ("DMAX", value << 2)],
        (200_000, 400_000, 800_000),
        51_200,
    ),
    "tmc5160": Plan(
        [
            ("CHOPCONF", 0x000100C3),
            ("IHOLD_IRUN", {"IHOLD": 8, "IRUN": 31, "IHOLDDELAY": 6}),
            ("VSTART", 1),
            ("A1", 1000),
            ("V1", 0),
            ("D1", 1400),
            ("VSTOP", 10),
            ("VMAX", 100_000),
            ("RAMPMODE", 0),
        ],
        both_slopes,
        (1000, 3000, 10_000),
        51_200,
    ),
    "pd42-1241": Plan([("ap4", 100_000)], one_register("ap5"), (100_000, 300_000, 600_000), 51_200),
}
"""Every axis is a 200-step motor in the middle of a stage of 300 mm with 8 mm a turn."""


def wait_for_server(bench: Bench, log: Log) -> None:
    """Until the dashboard answers. Raises NoServer after a while."""
    deadline = time.monotonic() + SERVER_WITHIN_S
    while True:
        try:
            log(f"stepscope {bench.health()['version']} at {bench.url}")
        except NoServer:
            if time.monotonic() > deadline:
                raise
            time.sleep(0.5)
        else:
            return


def connect(bench: Bench, entry: dict[str, str], host: str) -> str:
    """The device's id, connected: as it is already, or anew."""
    for device in bench.devices():
        if device.name == entry["name"]:
            return device.id
    link = {"kind": "tcp", "host": host, "port": entry["port"]}
    return bench.add(entry["name"], entry["model"], link).id


def set_up(bench: Bench, device: str, model: str, writes: Sequence[Write]) -> None:
    """Write everything in its order. Raises Refused at the first that the device did not take."""
    if model == "tmc428":
        # As long as its memory is noise, a datagram to the drivers may never end.
        bench.call("PUT", f"devices/{device}/driver-chain", {"drivers": ["tmc236"] * 3})
        table = bench.calc("microstep-table", chip="tmc428")
        bench.call("PUT", f"devices/{device}/microstep-table", {"values": table["values"]})
    for name, value in writes:
        bench.write(device, name, value, AXIS)


def channels_of(bench: Bench, device: str) -> list[str]:
    """What of the axis is looked at, as far as the device has it."""
    known = {channel["name"] for channel in bench.device(device).channels}
    wanted = [f"{name}.{AXIS}" for name in ("position", "velocity", "residual", "deviation")]
    return [name for name in wanted if name in known]


def try_move(bench: Bench, device: str, acceleration: int, distance: int) -> Try:
    """There and back, with telemetry of both ways."""
    channels = channels_of(bench, device)
    runs: list[Samples] = []
    duration_s = 0.0
    ended = "arrived"
    for way in (distance, -distance):
        started = bench.move(device, AXIS, way, relative=True, wait=False)
        seconds = (started.predicted_duration_s or 2.0) + 0.2
        listening = threading.Thread(target=lambda s=seconds: runs.append(bench.watch(device, channels, s, RATE_HZ)))
        listening.start()
        try:
            bench.wait(device, started)
        except MoveEnded as error:
            ended = str(error)
        listening.join()
        duration_s += started.predicted_duration_s or 0.0
    residual = joined(runs, f"residual.{AXIS}")
    deviation = joined(runs, f"deviation.{AXIS}")
    return Try(
        acceleration,
        round(duration_s, 4),
        float(np.max(np.abs(joined(runs, f"velocity.{AXIS}")), initial=0.0)),
        round(float(np.sqrt(np.mean(residual**2))), 2) if residual.size else 0.0,
        round(float(np.max(np.abs(residual), initial=0.0)), 2),
        float(np.max(np.abs(deviation))) if deviation.size else None,
        ended,
    )


def joined(runs: Sequence[Samples], channel: str) -> np.ndarray:
    """What was measured of a channel, without the samples that are missing."""
    parts = [run[channel] for run in runs if channel in run.channels]
    values = np.concatenate(parts) if parts else np.empty(0)
    return values[np.isfinite(values)]


def tune(bench: Bench, entry: dict[str, str], host: str, log: Log) -> Outcome:
    """One device from nothing to its best acceleration; trouble is told, and ends only this device."""
    outcome = Outcome(entry["name"], entry["model"])
    plan = PLANS[entry["model"]]
    device = ""
    try:
        outcome.id = device = connect(bench, entry, host)
        set_up(bench, device, entry["model"], plan.setup)
        recording = bench.record(device, channels_of(bench, device), RECORD_HZ, name=f"tuning session: {entry['name']}")
        for acceleration in plan.accelerations:
            for name, value in plan.accelerate(bench, device, acceleration):
                bench.write(device, name, value, AXIS)
            bench.call("POST", f"recordings/{recording.id}/marks", {"text": f"acceleration {acceleration}"})
            tried = try_move(bench, device, acceleration, plan.distance)
            if tried.late:
                tried = try_move(bench, device, acceleration, plan.distance)
            outcome.tries.append(tried)
            log(f"{entry['name']}: {acceleration} -> {tried.duration_s:.3f} s, residual {tried.residual_peak:g}")
        bench.stop_recording(recording.id)
        good = [tried for tried in outcome.tries if tried.good]
        if good:
            best = min(good, key=lambda tried: tried.duration_s)
            for name, value in plan.accelerate(bench, device, best.acceleration):
                bench.write(device, name, value, AXIS)
            outcome.kept = best.acceleration
            bench.call("POST", "profiles", {"device": device, "name": f"tuned: {entry['name']}", "note": told(outcome)})
        bench.call("PATCH", f"recordings/{recording.id}", {"note": told(outcome)})
    except ClientError as error:
        outcome.trouble = str(error)
        if device:
            bench.stop(device, AXIS)
    return outcome


def show(bench: Bench, outcomes: Sequence[Outcome]) -> None:
    """Send each axis that was tuned back and forth for ever, with rests; it ends as any shuttle does, by a stop."""
    for outcome in outcomes:
        if outcome.kept is not None:
            ends = {"first": PLANS[outcome.model].distance // 2, "second": 0, "dwell_s": SHOW_DWELL_S}
            bench.call("POST", f"devices/{outcome.id}/axes/{AXIS}/shuttle", ends)


def told(outcome: Outcome) -> str:
    """The report of one device, as a note beside its recording and its profile."""
    lines = [
        f"Tuning session: there and back by {PLANS[outcome.model].distance} microsteps, acceleration in chip units"
    ]
    for tried in outcome.tries:
        said = "kept" if tried.acceleration == outcome.kept else "good" if tried.good else f"left: {tried.ended}"
        lines.append(
            f"{tried.acceleration}: {tried.duration_s:.3f} s, peak {tried.peak_pps:.0f} pps, "
            f"residual {tried.residual_rms:g} rms, {tried.residual_peak:g} peak: {said}"
        )
    return "\n".join(lines)


def markdown(outcomes: Sequence[Outcome]) -> str:
    """The report for people."""
    lines = ["# Tuning session", ""]
    for outcome in outcomes:
        lines += [f"## {outcome.device} ({outcome.model})", ""]
        if outcome.trouble:
            lines += [f"**Trouble:** {outcome.trouble}", ""]
        if outcome.tries:
            lines += [
                (
                    "| acceleration (chip units) | there and back [s] | peak [pps] | residual rms / peak [microsteps] |"
                    " deviation peak [microsteps] | |"
                ),
                "|---|---|---|---|---|---|",
            ]
        for tried in outcome.tries:
            deviation = "" if tried.deviation_peak is None else f"{tried.deviation_peak:g}"
            said = "**kept**" if tried.acceleration == outcome.kept else "" if tried.good else f"left: {tried.ended}"
            lines.append(
                f"| {tried.acceleration} | {tried.duration_s:.3f} | {tried.peak_pps:.0f} | {tried.residual_rms:g} / "
                f"{tried.residual_peak:g} | {deviation} | {said} |"
            )
        lines.append("")
    return "\n".join(lines)


def main() -> int:
    """0 where every device ended with a kept acceleration."""
    arguments = argparse.ArgumentParser(description=__doc__)
    arguments.add_argument("--emulators", default="127.0.0.1", help="the machine with the devices")
    arguments.add_argument("--bench", type=Path, default=BENCH)
    arguments.add_argument("--report", type=Path, default=Path("."), help="a folder")
    given = arguments.parse_args()

    def log(text: str) -> None:
        print(text, flush=True)

    with Bench(os.environ.get("STEPSCOPE_URL")) as bench:
        wait_for_server(bench, log)
        entries = json.loads(given.bench.read_text())
        with bench.lease("tuning session", wait_s=LEASE_WAIT_S):
            outcomes = [tune(bench, entry, given.emulators, log) for entry in entries]
            show(bench, outcomes)
    given.report.mkdir(parents=True, exist_ok=True)
    (given.report / "report.json").write_text(json.dumps([asdict(outcome) for outcome in outcomes], indent=1))
    report = markdown(outcomes)
    (given.report / "report.md").write_text(report)
    log(report)
    log(f"With plots: page {REPORT} of the dashboard. The axes go on slowly until somebody stops them.")
    return 0 if all(outcome.kept is not None for outcome in outcomes) else 1


if __name__ == "__main__":
    sys.exit(main())
