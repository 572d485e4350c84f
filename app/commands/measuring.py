"""Commands that measure: `watch`, `record`, `recordings`, `replay`, `compare`."""

from __future__ import annotations

import contextlib
import csv
import sys
import time
from collections.abc import Mapping
from dataclasses import asdict
from pathlib import Path
from typing import Annotated, Any

import typer

from .shared import AsJson, Channels, DeviceName, Token, Url, connected, print_json, print_table, progress

RecordingName = Annotated[str, typer.Argument(metavar="RECORDING", help="Its id, as `stepscope recordings` lists it.")]
POLL_PERIOD_S = 0.2
"""How often a progress bar asks [s]."""


def watch(
    device: DeviceName,
    channels: Channels,
    seconds: Annotated[float, typer.Option(help="How long [s].", min=0.001, max=86_400)] = 5.0,
    rate_hz: Annotated[float, typer.Option("--rate", help="Samples a second.", min=0.1, max=10_000)] = 100.0,
    out: Annotated[Path | None, typer.Option(help="A file for the CSV. [default: the terminal]")] = None,
    url: Url = None,
    token: Token = None,
) -> None:
    """Collect telemetry as CSV: device time in seconds, then a column a channel; a missing sample is an empty cell."""
    with connected(url, token) as bench, progress() as bar:
        task = bar.add_task(f"{device}", total=seconds)
        samples = bench.watch(device, channels, seconds, rate_hz, lambda done_s: bar.update(task, completed=done_s))
        bar.update(task, completed=seconds)
        heads = ["time_s", *(f"{name} [{unit}]" for name, unit in zip(samples.channels, samples.units, strict=True))]
        with contextlib.ExitStack() as stack:
            file = stack.enter_context(out.open("w", newline="")) if out is not None else sys.stdout
            rows = csv.writer(file)
            rows.writerow(heads)
            for at, values in zip(samples.time_s, samples.values.T, strict=True):
                rows.writerow(
                    [
                        repr(float(at)),
                        *("" if value != value else repr(float(value)).removesuffix(".0") for value in values),
                    ]
                )
        if samples.rate_hz < rate_hz:
            typer.secho(f"stepscope: the link carries {samples.rate_hz:g} samples a second", fg="yellow", err=True)
        if samples.dropped:
            typer.secho(f"stepscope: {samples.dropped} rows were dropped", fg="yellow", err=True)


def record(
    device: DeviceName,
    channels: Channels,
    seconds: Annotated[float | None, typer.Option(help="How long. [default: until Ctrl-C]", min=0.001)] = None,
    rate_hz: Annotated[float, typer.Option("--rate", help="Samples a second.", min=1, max=1000)] = 200.0,
    on_move: Annotated[int | None, typer.Option(metavar="AXIS", help="Wait until this axis is sent somewhere.")] = None,
    pre_s: Annotated[float, typer.Option(help="With --on-move: seconds kept of before.", min=0, max=60)] = 0.5,
    name: Annotated[str, typer.Option(help="What to call it.")] = "",
    out: Annotated[
        Path | None, typer.Option(help="Also as a file: .csv or .parquet. [default: it stays in the server]")
    ] = None,
    url: Url = None,
    token: Token = None,
    as_json: AsJson = False,
) -> None:
    """Record in the server; Ctrl-C ends it and keeps what is there."""
    with connected(url, token) as bench:
        kind = "csv" if out is None else out.suffix.removeprefix(".")
        if kind not in ("csv", "parquet"):
            raise ValueError(f"a file ends in .csv or .parquet, not {out}")
        trigger = None if on_move is None else {"kind": "move", "axis": on_move, "pre_s": pre_s}
        done = bench.record(device, channels, rate_hz, seconds=seconds, trigger=trigger, name=name)
        try:
            with progress() as bar:
                task = bar.add_task(done.id, total=None if seconds is None else seconds)
                while done.state in ("waiting", "recording"):
                    time.sleep(POLL_PERIOD_S)
                    done = bench.recording_info(done.id)
                    said = "waits for its trigger" if done.state == "waiting" else f"{done.rows} rows"
                    shown_s = (done.rows or 0) / (done.rate_hz or rate_hz)
                    bar.update(task, completed=shown_s, description=said)
        except KeyboardInterrupt:
            done = bench.stop_recording(done.id)
        if out is not None:
            out.write_bytes(bench.recording_file(done.id, kind))
        if as_json:
            print_json(asdict(done))
        else:
            typer.echo(f"{done.id}: {done.rows} rows{f', {done.message}' if done.message else ''}")


def recordings(
    search: Annotated[str, typer.Argument(help="Words of name, note, device or model.")] = "",
    url: Url = None,
    token: Token = None,
    as_json: AsJson = False,
) -> None:
    """List what was recorded, the latest first."""
    with connected(url, token) as bench:
        found = bench.recordings(search)
        if as_json:
            print_json([asdict(each) for each in found])
            return
        heads = ("id", "name", "device", "state", "size")
        rows = [
            (each.id, each.name, each.device or "", each.state, f"{each.size_bytes / 1e6:.2f} MB") for each in found
        ]
        print_table(heads, rows)


def replay(
    recording: RecordingName,
    device: Annotated[
        str | None, typer.Option(help="An emulated device whose motor and stage it gets.", metavar="DEVICE")
    ] = None,
    url: Url = None,
    token: Token = None,
    as_json: AsJson = False,
) -> None:
    """Live through a recording once more on an emulator of its own, and record that; nothing on the bench moves."""
    with connected(url, token) as bench:
        done = bench.replay(recording, device)
        with progress() as bar:
            task = bar.add_task(recording, total=done["duration_s"])
            while done["state"] == "running":
                time.sleep(POLL_PERIOD_S)
                done = bench.replay_progress(recording)
                bar.update(task, completed=done["done_s"])
        if as_json:
            print_json(dict(done))
        else:
            typer.echo(f"{done['recording']}: {done['played']} of {done['commands']} commands and writes")
            for line in done["left_out"]:
                typer.secho(f"stepscope: {line}", fg="yellow", err=True)
        if done["state"] == "failed":
            typer.secho(f"stepscope: {done['message']}", fg="red", err=True)
            raise typer.Exit(1)


def compare(
    recordings: Annotated[
        list[str], typer.Argument(metavar="RECORDING...", help="The first is what the others differ from.")
    ],
    channel: Annotated[list[str] | None, typer.Option(help="Only these. [default: all that two of them have]")] = None,
    align: Annotated[str, typer.Option(help="trigger, start or move.")] = "trigger",
    url: Url = None,
    token: Token = None,
    as_json: AsJson = False,
) -> None:
    """Lay recordings on each other: how far each is from the first, at its times."""
    with connected(url, token) as bench:
        found = bench.compare(recordings, channel or (), align)
        if as_json:
            print_json(dict(found))
            return
        for note in found["notes"]:
            typer.secho(f"stepscope: {note}", fg="yellow", err=True)
        names = {each["id"]: each["name"] for each in found["recordings"]}
        rows = [
            (names[each["recording"]], compared["channel"], compared["unit"], *map(_figure, _told(each["figures"])))
            for compared in found["channels"]
            for each in compared["differences"]
        ]
        print_table(("recording", "channel", "unit", "peak", "at [s]", "mean", "rms"), rows)


def _told(figures: Mapping[str, Any]) -> list[Any]:
    return [figures[name] for name in ("peak", "peak_at_s", "mean", "rms")]


def _figure(value: float | None) -> str:
    return "" if value is None else f"{value:.6g}"
