"""`stepscope start-up`: set a device up after power-on, so that its axes can move."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Annotated, Any

import typer

from ..number_text import plain
from .shared import AsJson, DeviceName, Token, Url, connected, json_object, print_json, print_table


def start_up(
    device: DeviceName,
    figures: Annotated[
        list[str] | None,
        typer.Argument(
            metavar="[FIGURE=VALUE ...]",
            help="velocity_pps=20000 microsteps=64 motor.rated_current_a=1.2 motor.sense_resistor_ohm=0.11 ...",
        ),
    ] = None,
    axis: Annotated[list[int] | None, typer.Option(help="Only this axis; may be given several times.", min=0)] = None,
    dry_run: Annotated[bool, typer.Option("--dry-run", help="Only show what would be written.")] = False,
    url: Url = None,
    token: Token = None,
    as_json: AsJson = False,
) -> None:
    """Set axes up after power-on: currents, microsteps, switches, ramp; all of it, or as it was before."""
    with connected(url, token) as bench:
        done = bench.start_up(device, axis, dry_run=dry_run, **json_object(figures or ()))
        if as_json:
            print_json(done)
            return
        for line in (*done["prepared"], *done["warnings"]):
            typer.secho(f"stepscope: {line}", fg="yellow", err=True)
        rows = [_row(each) for each in done["writes"] if each["table"] is None]
        if rows:
            print_table(("axis", "register", "was", "shall be", "", "read back"), rows)
        for each in done["chosen"]:
            typer.echo(f"axis {each['axis']}: {each['name']} {plain(each['value'])} {each['unit']} ({each['why']})")
        words = len(done["writes"]) - len(rows)
        counted = f"{len(rows)} registers" + (f" and {words} words of tables" if words else "")
        told = {"dry run": f"{counted} would be written", "applied": f"{counted} written"}
        typer.echo(told.get(done["state"], "unchanged: it is set up already"))


def _row(write: Mapping[str, Any]) -> tuple[str, ...]:
    axis = "" if write["axis"] is None else str(write["axis"])
    was = "unknown" if write["left"] is None else str(write["left"])
    back = "" if write["verified"] is None and write["now"] is None else "yes" if write["verified"] else "no"
    return axis, write["name"], was, str(write["right"]), write["right_physical"] or "", back
