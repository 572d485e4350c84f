"""Commands that move, and that show where an axis is: `axis`, `move`, `rotate`, `home`, `stop`."""

from __future__ import annotations

from dataclasses import asdict
from typing import Annotated

import typer

from ..number_text import plain
from .completion import complete_device
from .shared import AsJson, AxisNumber, DeviceName, Token, Url, connected, print_json, print_table, progress, shown


def axis(
    device: DeviceName, axis: AxisNumber = 0, url: Url = None, token: Token = None, as_json: AsJson = False
) -> None:
    """Show where an axis is and what it does."""
    with connected(url, token) as bench:
        state = bench.axis(device, axis)
        if as_json:
            print_json(asdict(state))
            return
        active = [name for name, on in {**state.switches, **state.flags}.items() if on]
        condition = state.condition
        rows = [
            ("condition", f"{condition.kind}: {condition.cause}"),
            ("referenced", {True: "yes", False: "no", None: "not known"}[state.referenced]),
            ("remedy", ", ".join(remedy["label"] for remedy in condition.remedies)),
            ("really", (state.ground_truth or {}).get("summary", "")),
            ("position", f"{state.position} microsteps"),
            ("target", "" if state.target_position is None else f"{state.target_position} microsteps"),
            ("velocity", f"{plain(state.velocity_pps)} pps"),
            ("deviation", "" if state.deviation is None else f"{plain(state.deviation)} microsteps"),
            ("mode", state.mode),
            ("state", "moving" if state.moving else "arrived" if state.position_reached else "stands"),
            ("active", ", ".join(active)),
        ]
        print_table(("", ""), [row for row in rows if row[1]])


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
    with connected(url, token) as bench:
        started = bench.move(device, axis, target, relative=relative, unit=unit, wait=False)
        for warning in started.warnings:
            typer.secho(f"stepscope: {warning}", fg="yellow", err=True)
        state = None
        if wait:
            try:
                with progress() as bar:
                    task = bar.add_task(f"{device} axis {axis} to {started.target_position}", total=1.0)
                    state = bench.wait(device, started, shown(bar, task))
            except KeyboardInterrupt:
                bench.stop(device, axis)
                typer.secho("stepscope: stopped", fg="red", err=True)
                raise
        if as_json:
            print_json({**asdict(started), "state": None if state is None else asdict(state)})
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
    with connected(url, token) as bench:
        turning = bench.rotate(device, axis, velocity, unit=unit, hold_s=hold_s)
        if as_json:
            print_json(turning)
        else:
            typer.echo(f"turns at {plain(turning['velocity_pps'])} pps")


def home(
    device: DeviceName,
    side: Annotated[str, typer.Argument(help="left or right: the end of the stage to search.")] = "left",
    axis: AxisNumber = 0,
    velocity: Annotated[float | None, typer.Option(help="Search speed [pps].", min=1)] = None,
    threshold: Annotated[
        int | None, typer.Option(help="Of StallGuard; without one it is found.", min=-64, max=63)
    ] = None,
    current: Annotated[
        float | None, typer.Option(help="Run current meanwhile [% of full scale].", min=1, max=100)
    ] = None,
    hits: Annotated[int, typer.Option(help="How often it runs against the end.", min=1, max=10)] = 3,
    url: Url = None,
    token: Token = None,
    as_json: AsJson = False,
) -> None:
    """Search the end of the stage by stall, without a switch, and call it 0. Ctrl-C stops the axis."""
    with connected(url, token) as bench:
        try:
            state = bench.home_by_stall(
                device, axis, side, velocity=velocity, threshold=threshold, current_percent=current, hits=hits
            )
        except KeyboardInterrupt:
            bench.stop(device, axis)
            typer.secho("stepscope: stopped", fg="red", err=True)
            raise
        if as_json:
            print_json(state)
        else:
            typer.echo(state["message"])


def stop(
    device: Annotated[
        str | None, typer.Argument(metavar="[DEVICE]", help="None: everything.", autocompletion=complete_device)
    ] = None,
    axis: Annotated[int | None, typer.Option(help="Only this axis.", min=0)] = None,
    immediate: Annotated[bool, typer.Option("--immediate", help="Dead stop, steps may be lost.")] = False,
    url: Url = None,
    token: Token = None,
    as_json: AsJson = False,
) -> None:
    """Stop every axis of every device, or only those of DEVICE."""
    mode = "immediate" if immediate else "ramp"
    with connected(url, token) as bench:
        if device is None:
            results = bench.stop_all(mode)
        else:
            axes = range(len(bench.device(device).axes)) if axis is None else [axis]
            results = [bench.stop(device, each, mode) for each in axes]
        if as_json:
            print_json(results)
        failed = [result for result in results if not result["ok"]]
        for result in failed:
            problem = result["problem"] or {}
            text = f"{result['device']} axis {result['axis']} was NOT stopped: {problem.get('detail', '')}"
            typer.secho(f"stepscope: {text}", fg="red", err=True)
        if failed:
            raise typer.Exit(1)
        if not as_json:
            typer.echo(f"{len(results)} {'axis' if len(results) == 1 else 'axes'} told to stop")
