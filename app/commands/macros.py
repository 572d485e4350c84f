"""Macros: `stepscope macro list | show | add | record | try | run | stop | python | delete`."""

from __future__ import annotations

import json
import time
from pathlib import Path
from typing import Annotated, Any

import typer

from ..number_text import plain
from .shared import AsJson, DeviceName, Token, Url, connected, print_json, print_table

macro = typer.Typer(
    name="macro",
    no_args_is_help=True,
    help="Small sequences of steps: made of what was done, tried, and run.",
)

Name = Annotated[str, typer.Argument(metavar="MACRO", help="Its id, as `list` shows it.")]
POLL_S = 0.1


def _warn(text: str, colour: str = "yellow") -> None:
    typer.secho(f"stepscope: {text}", fg=colour, err=True)


@macro.command("list")
def list_(url: Url = None, token: Token = None, as_json: AsJson = False) -> None:
    """List all kept macros."""
    with connected(url, token) as bench:
        found = bench.call("GET", "/macros")["macros"]
        if as_json:
            print_json(found)
            return
        rows = [
            (one["id"], one["name"], str(one["steps"]), str(one["revision"]), one["model"] or "any") for one in found
        ]
        print_table(("id", "name", "steps", "revision", "model"), rows)


@macro.command(no_args_is_help=True)
def show(name: Name, url: Url = None, token: Token = None, as_json: AsJson = False) -> None:
    """Say the steps of a macro; with --json the document, which `add` takes."""
    with connected(url, token) as bench:
        found = bench.call("GET", f"/macros/{name}")
        if as_json:
            print_json(found["document"])
            return
        typer.echo(f"{found['name']}, revision {found['revision']}")
        _steps(found["texts"])


def _steps(texts: list[str]) -> None:
    for number, text in enumerate(texts, 1):
        typer.echo(f"  {number:3} {text}")


@macro.command(no_args_is_help=True)
def add(
    file: Annotated[Path, typer.Argument(help="The document as JSON.", exists=True, dir_okay=False)],
    over: Annotated[str | None, typer.Option(help="Save it over this macro, as its next revision.")] = None,
    url: Url = None,
    token: Token = None,
) -> None:
    """Keep a macro out of a file."""
    document = json.loads(file.read_text(encoding="utf-8"))
    with connected(url, token) as bench:
        if over is None:
            kept = bench.call("POST", "/macros", {"document": document})
        else:
            based_on = bench.call("GET", f"/macros/{over}")["revision"]
            kept = bench.call("PUT", f"/macros/{over}", {"based_on": based_on, "document": document})
        typer.echo(f"{kept['id']}, revision {kept['revision']}")


@macro.command(no_args_is_help=True)
def record(
    device: DeviceName,
    name: Annotated[str | None, typer.Option(help="What it is to be called.")] = None,
    after: Annotated[int | None, typer.Option(help="Of what the audit log has behind this entry, at once.")] = None,
    longest_pause: Annotated[float, typer.Option(help="Longer pauses are waits for so long [s].", min=0)] = 5.0,
    url: Url = None,
    token: Token = None,
) -> None:
    """Make a macro of what is done to a device, from anywhere, until Enter."""
    with connected(url, token) as bench:
        if after is None:
            latest = bench.audit(limit=1)
            after = latest[0].id if latest else 0
            typer.prompt("Recording. Do it now, then press Enter", default="", show_default=False)
        path = f"/devices/{device}/macro-draft?after={after}&longest_pause_s={longest_pause}"
        draft = bench.call("GET", path)
        for line in draft["left_out"]:
            _warn(f"left out: {line}")
        document = {**draft["document"], **({} if name is None else {"name": name})}
        if not document["steps"]:
            _warn("nothing was done that a macro could do", "red")
            raise typer.Exit(1)
        _steps(draft["texts"])
        kept = bench.call("POST", "/macros", {"document": document})
        typer.echo(f"{kept['id']}, revision {kept['revision']}")


@macro.command("try", no_args_is_help=True)
def try_(name: Name, device: DeviceName, url: Url = None, token: Token = None, as_json: AsJson = False) -> None:
    """Try a macro on an emulated twin of a device; nothing moves."""
    with connected(url, token) as bench:
        tried = bench.call("POST", f"/devices/{device}/macro-trial", {"macro": name})
        if as_json:
            print_json(tried)
        else:
            _tell_trial(tried)
        if not tried["passed"]:
            raise typer.Exit(1)


def _tell_trial(tried: dict[str, Any]) -> None:
    if tried["why_not"]:
        _warn(f"not tried: {tried['why_not']}", "red")
        return
    _tell_run(tried["run"])
    for axis in tried["axes"]:
        typer.echo(
            f"  axis {axis['axis']}: {axis['start']} to {axis['end']}, between {axis['least']} and {axis['greatest']}, "
            f"at most {plain(axis['top_speed_pps'])} pps"
        )
    for line in tried["warnings"]:
        _warn(line)


def _tell_run(state: dict[str, Any]) -> None:
    for step in state["done"]:
        typer.echo(f"  {step['number']:3} {step['text']}{': ' if step['came'] else ''}{step['came']}")
    if state["state"] == "done":
        typer.echo(f"done in {plain(state['took_s'], 3)} s")
    else:
        _warn(f"{state['state']}: {state['message']}", "red")
        if state["way_out"]:
            _warn(state["way_out"])


@macro.command(no_args_is_help=True)
def run(
    name: Name,
    device: DeviceName,
    untried: Annotated[bool, typer.Option("--untried", help="Do not try it on a twin first.")] = False,
    url: Url = None,
    token: Token = None,
    as_json: AsJson = False,
) -> None:
    """Try a macro on a twin, then run it; Ctrl-C ends it and stops the motors that it moves."""
    with connected(url, token) as bench:
        kept = bench.call("GET", f"/macros/{name}")
        if not untried:
            tried = bench.call("POST", f"/devices/{device}/macro-trial", {"macro": name, "revision": kept["revision"]})
            if not tried["passed"]:
                _tell_trial(tried)
                _warn("it did not pass its trial; --untried runs it all the same", "red")
                raise typer.Exit(1)
        address = f"/devices/{device}/macro-run"
        state = bench.call("POST", address, {"macro": name, "revision": kept["revision"]})
        try:
            while state["state"] == "running":
                time.sleep(POLL_S)
                state = bench.call("GET", address)["run"]
        except KeyboardInterrupt:
            state = bench.call("DELETE", address)
        if as_json:
            print_json(state)
        else:
            _tell_run(state)
        if state["state"] != "done":
            raise typer.Exit(1)


@macro.command(no_args_is_help=True)
def stop(device: DeviceName, url: Url = None, token: Token = None) -> None:
    """End the macro that runs on a device, and stop what it moves."""
    with connected(url, token) as bench:
        _tell_run(bench.call("DELETE", f"/devices/{device}/macro-run"))


@macro.command(no_args_is_help=True)
def python(
    name: Name,
    device: Annotated[str, typer.Option(help="The device that it is for, unless told otherwise.")] = "bench",
    url: Url = None,
    token: Token = None,
) -> None:
    """Print a macro as a Python program for stepscope's client."""
    with connected(url, token) as bench:
        typer.echo(bench.call("GET", f"/macros/{name}/python?device={device}")["text"], nl=False)


@macro.command(no_args_is_help=True)
def delete(name: Name, url: Url = None, token: Token = None) -> None:
    """Forget a macro with its revisions."""
    with connected(url, token) as bench:
        bench.call("DELETE", f"/macros/{name}")
