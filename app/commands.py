"""Commands that ask a running stepscope: `devices | axis | read | write | move | ... | api`.

Each is one call of `app.client` and a way to print its answer: a table for people, `--json` for programs. What went
wrong is one line on the terminal; exit codes are 1 refused, 2 wrong usage, 3 no server, 4 no answer, 5 not arrived.
"""

from __future__ import annotations

import contextlib
import csv
import json
import os
import sys
import time
from collections.abc import Callable, Iterator, Sequence
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

if TYPE_CHECKING:
    from rich.progress import Progress

    from app.client import AxisState, Bench

LOOK_EVERY_S = 0.2
"""How often a progress bar asks [s]."""

# The client (httpx, numpy) is brought in by those commands that run, not by `--help`.


def _complete_device(incomplete: str) -> list[str]:
    """For the shell: the devices of the bench, where one answers at once."""
    from app.client import Bench, ClientError

    try:
        with Bench(timeout_s=0.5) as bench:
            return [device.id for device in bench.devices() if device.id.startswith(incomplete)]
    except (ClientError, ValueError):
        return []


Url = Annotated[
    str | None, typer.Option(metavar="http://HOST:PORT", help="The server. [default: STEPSCOPE_URL, or this machine]")
]
Token = Annotated[str | None, typer.Option(help="What a server on a network asks for. [default: STEPSCOPE_TOKEN]")]
AsJson = Annotated[bool, typer.Option("--json", help="The answer as JSON.")]
DeviceName = Annotated[str, typer.Argument(metavar="DEVICE", autocompletion=_complete_device)]
AxisNumber = Annotated[int, typer.Option(help="Which axis.", min=0)]
AnyAxis = Annotated[int | None, typer.Option(help="Which axis. [default: the device's own registers]", min=0)]


@contextlib.contextmanager
def _bench(url: str | None, token: str | None) -> Iterator[Bench]:
    """The server's client; what goes wrong is told on a line, and by the exit code."""
    from app.client import Bench, ClientError

    try:
        with Bench(url, token=token) as bench:
            yield bench
    except ClientError as error:
        typer.secho(f"stepscope: {error}", fg="red", err=True)
        raise typer.Exit(error.exit_code) from error
    except BrokenPipeError:  # `stepscope read bench | head`: who read it has seen enough
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        raise typer.Exit(0) from None
    except (OSError, ValueError) as error:
        typer.secho(f"stepscope: {error}", fg="red", err=True)
        raise typer.Exit(2) from error


def devices(url: Url = None, token: Token = None, as_json: AsJson = False) -> None:
    """List what is connected."""
    with _bench(url, token) as bench:
        found = bench.devices()
        if as_json:
            _print_json([asdict(device) for device in found])
            return
        _print_table(
            ("id", "model", "axes", "state", "link"),
            [(each.id, each.title, str(len(each.axes)), each.state, str(each.link.get("kind", ""))) for each in found],
        )


def axis(
    device: DeviceName, axis: AxisNumber = 0, url: Url = None, token: Token = None, as_json: AsJson = False
) -> None:
    """Show where an axis is and what it does."""
    with _bench(url, token) as bench:
        state = bench.axis(device, axis)
        if as_json:
            _print_json(asdict(state))
            return
        active = [name for name, on in {**state.switches, **state.flags}.items() if on]
        rows = [
            ("position", f"{state.position} microsteps"),
            ("target", "" if state.target_position is None else f"{state.target_position} microsteps"),
            ("velocity", f"{state.velocity_pps:g} pps"),
            ("deviation", "" if state.deviation is None else f"{state.deviation:g} microsteps"),
            ("mode", state.mode),
            ("state", "moving" if state.moving else "arrived" if state.position_reached else "stands"),
            ("active", ", ".join(active)),
        ]
        _print_table(("", ""), [row for row in rows if row[1]])


def read(
    device: DeviceName,
    registers: Annotated[
        list[str] | None, typer.Argument(metavar="REGISTER...", help="Registers or fields; none: all of them.")
    ] = None,
    axis: AnyAxis = None,
    group: Annotated[list[str] | None, typer.Option(help="Without names: only these groups of registers.")] = None,
    url: Url = None,
    token: Token = None,
    as_json: AsJson = False,
) -> None:
    """Read registers, parameters or fields from the device itself."""
    with _bench(url, token) as bench:
        if registers:
            found = [bench.read(device, name, axis) for name in registers]
        else:
            found = bench.read_all(device, axis, group or ())
        if as_json:
            _print_json([asdict(reading) for reading in found])
            return
        _print_table(
            ("register", "axis", "value", "unit", "fields"),
            [
                (
                    each.name,
                    "" if each.axis is None else str(each.axis),
                    str(each.value),
                    each.unit,
                    " ".join(f"{name}={value}" for name, value in each.fields.items()),
                )
                for each in found
            ],
        )


def write(
    device: DeviceName,
    assignments: Annotated[
        list[str],
        typer.Argument(metavar="NAME=VALUE...", help="REGISTER=1200, FIELD=3, REGISTER.FIELD=name; 0x... is hex."),
    ],
    axis: AnyAxis = None,
    url: Url = None,
    token: Token = None,
    as_json: AsJson = False,
) -> None:
    """Write registers in the order given; each is read back. The first that fails ends it."""
    with _bench(url, token) as bench:
        writes = [_assignment(text) for text in assignments]  # all are understood before the first is sent
        done = []
        for name, value in writes:
            register, _, part = name.partition(".")
            done.append(bench.write(device, register, {part: value} if part else _whole(name, value), axis))
            if not as_json:
                each = done[-1]
                check = {True: "verified", False: "NOT VERIFIED", None: "not verifiable"}[each.verified]
                note = f": {each.note}" if each.note else ""
                typer.echo(f"{each.name} = {each.value} {each.unit}".rstrip() + f"  ({check}{note})")
        if as_json:
            _print_json([asdict(each) for each in done])


def move(
    device: DeviceName,
    target: Annotated[float, typer.Argument(help="Where to, or with --relative how far.")],
    axis: AxisNumber = 0,
    relative: Annotated[bool, typer.Option("--relative", help="By that much, from where it is.")] = False,
    unit: Annotated[str, typer.Option(help="microsteps, fullsteps, rev, deg, rad or mm.")] = "microsteps",
    wait: Annotated[bool, typer.Option(help="Return at the target; Ctrl-C stops the axis.")] = True,
    url: Url = None,
    token: Token = None,
    as_json: AsJson = False,
) -> None:
    """Move an axis. Negative targets: `stepscope move bench -- -2000`."""
    with _bench(url, token) as bench:
        started = bench.move(device, axis, target, relative=relative, unit=unit, wait=False)
        for warning in started.warnings:
            typer.secho(f"stepscope: {warning}", fg="yellow", err=True)
        state = None
        if wait:
            try:
                with _progress() as progress:
                    task = progress.add_task(f"{device} axis {axis} to {started.target_position}", total=1.0)
                    state = bench.wait(device, started, _shown(progress, task))
            except KeyboardInterrupt:
                bench.stop(device, axis)
                typer.secho("stepscope: stopped", fg="red", err=True)
                raise
        if as_json:
            _print_json({**asdict(started), "state": None if state is None else asdict(state)})
        else:
            typer.echo(f"at {state.position}" if state is not None else f"on its way to {started.target_position}")


def rotate(
    device: DeviceName,
    velocity: Annotated[float, typer.Argument(help="Negative ones behind `--`.")],
    axis: AxisNumber = 0,
    unit: Annotated[str, typer.Option(help="pps, chip, fullsteps_per_s, rps, rpm, rad_per_s or mm_per_s.")] = "pps",
    hold_s: Annotated[float | None, typer.Option(help="Stop by itself after so long [s].", min=0.1, max=10)] = None,
    url: Url = None,
    token: Token = None,
    as_json: AsJson = False,
) -> None:
    """Turn an axis on and on, until `stepscope stop`."""
    with _bench(url, token) as bench:
        turning = bench.rotate(device, axis, velocity, unit=unit, hold_s=hold_s)
        if as_json:
            _print_json(turning)
        else:
            typer.echo(f"turns at {turning['velocity_pps']:g} pps")


def stop(
    device: Annotated[
        str | None, typer.Argument(metavar="[DEVICE]", help="None: everything.", autocompletion=_complete_device)
    ] = None,
    axis: Annotated[int | None, typer.Option(help="Only this axis.", min=0)] = None,
    immediate: Annotated[bool, typer.Option("--immediate", help="Dead stop, steps may be lost.")] = False,
    url: Url = None,
    token: Token = None,
    as_json: AsJson = False,
) -> None:
    """Stop every axis of every device, or only those of DEVICE."""
    mode = "immediate" if immediate else "ramp"
    with _bench(url, token) as bench:
        if device is None:
            results = bench.stop_all(mode)
        else:
            axes = range(len(bench.device(device).axes)) if axis is None else [axis]
            results = [bench.stop(device, each, mode) for each in axes]
        if as_json:
            _print_json(results)
        failed = [result for result in results if not result["ok"]]
        for result in failed:
            problem = result["problem"] or {}
            text = f"{result['device']} axis {result['axis']} was NOT stopped: {problem.get('detail', '')}"
            typer.secho(f"stepscope: {text}", fg="red", err=True)
        if failed:
            raise typer.Exit(1)
        if not as_json:
            typer.echo(f"{len(results)} {'axis' if len(results) == 1 else 'axes'} told to stop")


def watch(
    device: DeviceName,
    channels: Annotated[list[str], typer.Argument(help="position.0 velocity.0 residual.0 ...")],
    seconds: Annotated[float, typer.Option(help="How long [s].", min=0.001, max=86_400)] = 5.0,
    rate_hz: Annotated[float, typer.Option("--rate", help="Samples a second.", min=0.1, max=10_000)] = 100.0,
    out: Annotated[Path | None, typer.Option(help="A file for the CSV. [default: the terminal]")] = None,
    url: Url = None,
    token: Token = None,
) -> None:
    """Collect telemetry as CSV: device time in seconds, then a column a channel; a missing sample is an empty cell."""
    with _bench(url, token) as bench, _progress() as progress:
        task = progress.add_task(f"{device}", total=seconds)
        samples = bench.watch(
            device, channels, seconds, rate_hz, lambda done_s: progress.update(task, completed=done_s)
        )
        progress.update(task, completed=seconds)
        heads = ["time_s", *(f"{name} [{unit}]" for name, unit in zip(samples.channels, samples.units, strict=True))]
        with contextlib.ExitStack() as stack:
            file = stack.enter_context(out.open("w", newline="")) if out is not None else sys.stdout
            rows = csv.writer(file)
            rows.writerow(heads)
            for at, values in zip(samples.time_s, samples.values.T, strict=True):
                rows.writerow([repr(float(at)), *("" if value != value else f"{value:.10g}" for value in values)])
        if samples.rate_hz < rate_hz:
            typer.secho(f"stepscope: the link carries {samples.rate_hz:g} samples a second", fg="yellow", err=True)
        if samples.dropped:
            typer.secho(f"stepscope: {samples.dropped} rows were dropped", fg="yellow", err=True)


def record(
    device: DeviceName,
    channels: Annotated[list[str], typer.Argument(help="position.0 velocity.0 residual.0 ...")],
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
    with _bench(url, token) as bench:
        kind = "csv" if out is None else out.suffix.removeprefix(".")
        if kind not in ("csv", "parquet"):
            raise ValueError(f"a file ends in .csv or .parquet, not {out}")
        trigger = None if on_move is None else {"kind": "move", "axis": on_move, "pre_s": pre_s}
        done = bench.record(device, channels, rate_hz, seconds=seconds, trigger=trigger, name=name)
        try:
            with _progress() as progress:
                task = progress.add_task(done.id, total=None if seconds is None else seconds)
                while done.state in ("waiting", "recording"):
                    time.sleep(LOOK_EVERY_S)
                    done = next(each for each in bench.recordings() if each.id == done.id)
                    said = "waits for its trigger" if done.state == "waiting" else f"{done.rows} rows"
                    shown_s = (done.rows or 0) / (done.rate_hz or rate_hz)
                    progress.update(task, completed=shown_s, description=said)
        except KeyboardInterrupt:
            done = bench.stop_recording(done.id)
        if out is not None:
            out.write_bytes(bench.recording_file(done.id, kind))
        if as_json:
            _print_json(asdict(done))
        else:
            typer.echo(f"{done.id}: {done.rows} rows{f', {done.message}' if done.message else ''}")


def recordings(
    search: Annotated[str, typer.Argument(help="Words of name, note, device or model.")] = "",
    url: Url = None,
    token: Token = None,
    as_json: AsJson = False,
) -> None:
    """List what was recorded, the latest first."""
    with _bench(url, token) as bench:
        found = bench.recordings(search)
        if as_json:
            _print_json([asdict(each) for each in found])
            return
        heads = ("id", "name", "device", "state", "size")
        rows = [
            (each.id, each.name, each.device or "", each.state, f"{each.size_bytes / 1e6:.2f} MB") for each in found
        ]
        _print_table(heads, rows)


def calc(
    subject: Annotated[str, typer.Argument(help="pmul-pdiv, units, ramp, microstep-table, driver-chain, ...")],
    values: Annotated[list[str] | None, typer.Argument(metavar="NAME=VALUE...", help="JSON values, or words.")] = None,
    url: Url = None,
    token: Token = None,
) -> None:
    """Ask a calculator: `stepscope calc pmul-pdiv chip=tmc428 a_max=500 ramp_div=7 pulse_div=5`."""
    with _bench(url, token) as bench:
        _print_json(bench.calc(subject, **_object(values or [])))


def api(
    method: Annotated[str, typer.Argument(help="GET, POST, PUT, PATCH or DELETE")],
    path: Annotated[str, typer.Argument(help="Behind /api/v1, e.g. devices/bench/profile")],
    values: Annotated[list[str] | None, typer.Argument(metavar="NAME=VALUE...", help="JSON values, or words.")] = None,
    url: Url = None,
    token: Token = None,
) -> None:
    """Make any call of the REST API and print its answer."""
    with _bench(url, token) as bench:
        _print_json(bench.call(method, path, _object(values) if values else None))


COMMANDS: Sequence[Callable[..., None]] = (
    devices,
    axis,
    read,
    write,
    move,
    rotate,
    stop,
    watch,
    record,
    recordings,
    calc,
    api,
)


def _assignment(text: str) -> tuple[str, int | str]:
    """NAME=VALUE. Raises ValueError."""
    name, equals, value = text.partition("=")
    if not equals or not name.strip() or not value.strip():
        raise ValueError(f"what to write is NAME=VALUE, not {text!r}")
    try:
        return name.strip(), int(value, 0)
    except ValueError:
        return name.strip(), value.strip()


def _whole(name: str, value: int | str) -> int:
    if isinstance(value, str):
        raise ValueError(f"{name} is a number; names of values go to a field: {name}.FIELD={value}")  # noqa: TRY004
    return value


def _object(values: Sequence[str]) -> dict[str, Any]:
    """NAME=JSON pairs; a dot in the name goes one object deeper. What is no JSON is taken as a word."""
    body: dict[str, Any] = {}
    for text in values:
        name, equals, value = text.partition("=")
        if not equals:
            raise ValueError(f"what is asked is NAME=VALUE, not {text!r}")
        *outer, last = name.split(".")
        inner = body
        for part in outer:
            inner = inner.setdefault(part, {})
        try:
            inner[last] = json.loads(value)
        except ValueError:
            inner[last] = value
    return body


def _print_json(answer: object) -> None:
    typer.echo(json.dumps(answer, indent=1, ensure_ascii=False))


def _print_table(heads: Sequence[str], rows: Sequence[Sequence[str]]) -> None:
    widths = [max(len(row[column]) for row in (heads, *rows)) for column in range(len(heads))]
    for row in (heads, *rows) if any(heads) else rows:
        typer.echo("  ".join(cell.ljust(width) for cell, width in zip(row, widths, strict=True)).rstrip())


def _progress() -> Progress:
    """A bar on the terminal's error stream: the answer alone goes to a pipe."""
    from rich.console import Console
    from rich.progress import BarColumn, Progress, TaskProgressColumn, TextColumn, TimeElapsedColumn

    columns = (TextColumn("{task.description}"), BarColumn(), TaskProgressColumn(), TimeElapsedColumn())
    return Progress(*columns, console=Console(stderr=True), transient=True)


def _shown(progress: Progress, task: Any) -> Callable[[float, AxisState], None]:
    def show(share: float, state: AxisState) -> None:
        progress.update(task, completed=share, description=f"at {state.position}, {state.velocity_pps:g} pps")

    return show
