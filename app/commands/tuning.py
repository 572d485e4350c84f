"""Studies: `stepscope tune plan | start | list | show | stop | take | keep | report`."""

from __future__ import annotations

import json
import time
from pathlib import Path
from typing import Annotated, Any

import typer

from ..number_text import plain
from .shared import AsJson, DeviceName, Token, Url, connected, json_object, print_json, print_table, progress

tune = typer.Typer(
    name="tune", no_args_is_help=True, help="Studies: find an axis's setting, prove it, and put it back if no better."
)

KindName = Annotated[
    str, typer.Argument(metavar="STUDY", help="Which, as GET /studies lists them: first_look, fastest_move ...")
]
Options = Annotated[
    list[str] | None,
    typer.Argument(metavar="NAME=VALUE...", help="Of the study: distance=51200 margin=0.1 twin=null budget.trials=40"),
]
AxisNumber = Annotated[int, typer.Option(help="Which axis.", min=0)]
Name = Annotated[str, typer.Argument(metavar="STUDY", help="Its id, as `list` shows it.")]
POLL_S = 0.5
OF_THE_DOCUMENT = ("name", "seed", "budget")


def _document(kind: str, device: str, axis: int, values: list[str] | None) -> dict[str, Any]:
    given = json_object(values or [])
    outer = {name: given.pop(name) for name in OF_THE_DOCUMENT if name in given}
    return {"device": device, "axis": axis, "study": {"kind": kind, **given}, **outer}


def _tell_plan(plan: dict[str, Any]) -> None:
    for line in plan["steps"]:
        typer.echo(f"  {line}")
    if plan["position_from"] is not None:
        typer.echo(f"  between {plan['position_from']} and {plan['position_to']}, about {plain(plan['time_s'], 3)} s")
    if plan["no_twin"]:
        typer.echo(f"  not tried on an emulated twin first: {plan['no_twin']}")
    typer.echo(f"  cut off and resumed, it {'goes on with the rest' if plan['goes_on'] else 'begins again'}")
    for line in plan["warnings"]:
        typer.secho(f"stepscope: {line}", fg="yellow", err=True)
    for line in plan["missing"]:
        typer.secho(f"stepscope: missing: {line}", fg="red", err=True)


@tune.command(no_args_is_help=True)
def plan(
    kind: KindName,
    device: DeviceName,
    values: Options = None,
    axis: AxisNumber = 0,
    url: Url = None,
    token: Token = None,
    as_json: AsJson = False,
) -> None:
    """Say what a study would do to the machine; nothing moves."""
    with connected(url, token) as bench:
        told = bench.call("POST", "/studies/plan", _document(kind, device, axis, values))
        if as_json:
            print_json(told)
        else:
            _tell_plan(told)
        if told["missing"]:
            raise typer.Exit(1)


@tune.command(no_args_is_help=True)
def start(
    kind: KindName,
    device: DeviceName,
    values: Options = None,
    axis: AxisNumber = 0,
    yes: Annotated[bool, typer.Option("--yes", help="Do not ask before it moves.")] = False,
    take_it: Annotated[bool, typer.Option("--take", help="Set the axis to what was found, if better.")] = False,
    url: Url = None,
    token: Token = None,
    as_json: AsJson = False,
) -> None:
    """Begin a study and watch it; Ctrl-C ends it, and the axis is as before."""
    with connected(url, token) as bench:
        document = _document(kind, device, axis, values)
        told = bench.call("POST", "/studies/plan", document)
        if not as_json:
            _tell_plan(told)
        if told["missing"]:
            raise typer.Exit(1)
        if not yes and not typer.confirm("The motor will move. Begin?"):
            raise typer.Exit(1)
        found = bench.call("POST", "/studies", document)
        study = found["id"]
        try:
            with progress() as bar:
                task = bar.add_task(study, total=1.0)
                while found["state"] == "running":
                    time.sleep(POLL_S)
                    found = bench.call("GET", f"/studies/{study}")
                    bar.update(task, completed=found["progress"], description=found["message"][:60])
        except KeyboardInterrupt:
            found = bench.call("POST", f"/studies/{study}/stop")
        if take_it and found["improved"]:
            found = bench.call("POST", f"/studies/{study}/take", {"which": "best"})
        _tell(found, as_json=as_json)
        if found["state"] != "done":
            raise typer.Exit(1)


def _tell(found: dict[str, Any], *, as_json: bool) -> None:
    if as_json:
        print_json(found)
        return
    typer.echo(f"{found['id']}: {found['verdict'] or found['message'] or found['state']}")
    for one in found["findings"]:
        value = "" if one["value"] is None else f"{plain(one['value'], 4)} {one['unit']}".rstrip() + ", "
        typer.echo(f"  {one['name']}: {value}{one['text']}")
        if one["remedy"] is not None:
            call = one["remedy"]
            body = json.dumps(call["body"])
            typer.echo(f"    cure: {call['method']} devices/{found['document']['device']}/{call['path']} {body}")
    if found["no_twin"]:
        typer.echo(f"  not tried on an emulated twin first: {found['no_twin']}")
    for line in found["left"]:
        typer.secho(f"stepscope: {line}", fg="red", err=True)


@tune.command("list")
def list_(url: Url = None, token: Token = None, as_json: AsJson = False) -> None:
    """List all studies, the latest first."""
    with connected(url, token) as bench:
        found = bench.call("GET", "/studies")["studies"]
        if as_json:
            print_json(found)
            return
        rows = [
            (one["id"], one["title"], one["device"], str(one["axis"]), one["state"], one["verdict"] or one["message"])
            for one in found
        ]
        print_table(("id", "study", "device", "axis", "state", "what came of it"), rows)


@tune.command(no_args_is_help=True)
def show(study: Name, url: Url = None, token: Token = None, as_json: AsJson = False) -> None:
    """Say what came of a study, or how far it is."""
    with connected(url, token) as bench:
        _tell(bench.call("GET", f"/studies/{study}"), as_json=as_json)


@tune.command(no_args_is_help=True)
def stop(study: Name, url: Url = None, token: Token = None, as_json: AsJson = False) -> None:
    """End a study at once; the axis is as before."""
    with connected(url, token) as bench:
        _tell(bench.call("POST", f"/studies/{study}/stop"), as_json=as_json)


@tune.command(no_args_is_help=True)
def resume(study: Name, url: Url = None, token: Token = None, as_json: AsJson = False) -> None:
    """Go on with a study that was cut off, or begin it again: its plan says which of both its kind does."""
    with connected(url, token) as bench:
        _tell(bench.call("POST", f"/studies/{study}/resume"), as_json=as_json)


@tune.command(no_args_is_help=True)
def take(
    study: Name,
    undo: Annotated[bool, typer.Option("--undo", help="What was set before the study instead.")] = False,
    trial: Annotated[int | None, typer.Option(help="A trial of its front (not proved), or own of a speed.")] = None,
    url: Url = None,
    token: Token = None,
    as_json: AsJson = False,
) -> None:
    """Set the axis to what a study found."""
    if undo and trial is not None:
        raise typer.BadParameter("either what was before, or a trial")
    with connected(url, token) as bench:
        body: dict[str, Any] = {"which": "baseline" if undo else "best"}
        if trial is not None:
            body = {"which": "trial", "trial": trial}
        _tell(bench.call("POST", f"/studies/{study}/take", body), as_json=as_json)


@tune.command(no_args_is_help=True)
def keep(study: Name, url: Url = None, token: Token = None, as_json: AsJson = False) -> None:
    """Keep the setting before and the best one as profiles."""
    with connected(url, token) as bench:
        kept = bench.call("POST", f"/studies/{study}/profiles")["profiles"]
        if as_json:
            print_json(kept)
            return
        for one in kept:
            typer.echo(f"{one['id']}: {one['name']}")


@tune.command(no_args_is_help=True)
def report(
    study: Name,
    out: Annotated[Path, typer.Option(help="The file: .html, or .json for the record.")],
    url: Url = None,
    token: Token = None,
) -> None:
    """Write the report of a study to a file that needs nothing else."""
    with connected(url, token) as bench:
        if out.suffix == ".json":
            whole = bench.call("GET", f"/studies/{study}")
            out.write_text(json.dumps(whole, indent=1, ensure_ascii=False) + "\n", encoding="utf-8")
        else:
            out.write_bytes(bench.study_report(study))
