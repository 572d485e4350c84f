"""What was done to a device, and undo: `stepscope history`, `stepscope undo`."""

from __future__ import annotations

from collections.abc import Mapping
from datetime import datetime
from typing import Annotated, Any

import typer

from .audit import moment
from .shared import AsJson, DeviceName, Token, Url, connected, print_json, print_table

LEFT = 1
"""Exit code of `undo` where something is not as it was then."""


def history(
    device: DeviceName,
    limit: Annotated[int, typer.Option(help="So many changes at the most, the newest.", min=1, max=500)] = 20,
    url: Url = None,
    token: Token = None,
    as_json: AsJson = False,
) -> None:
    """Show what was done to a device, the newest first: the entries of one request together."""
    with connected(url, token) as bench:
        changes = bench.history(device, limit)["changes"]
    if as_json:
        print_json(changes)
        return
    print_table(("entry", "time", "who", "what", "writes"), [_line(change) for change in changes])


def undo(
    device: DeviceName,
    since: Annotated[str | None, typer.Option(help="As it was so long ago (10min, 2h), or then.")] = None,
    before: Annotated[int | None, typer.Option(help="As it was before that entry.", min=1)] = None,
    without: Annotated[
        int | None, typer.Option(help="Without that entry and all others of its request.", min=1)
    ] = None,
    dry_run: Annotated[bool, typer.Option("--dry-run", help="Only tell what would be put back.")] = False,
    others: Annotated[bool, typer.Option("--others", help="Also what others have written since.")] = False,
    url: Url = None,
    token: Token = None,
    as_json: AsJson = False,
) -> None:
    """Put a device's registers back to what they were, as one transaction; 1 where some stay as they are."""
    if sum(each is not None for each in (since, before, without)) != 1:
        raise typer.BadParameter("say exactly one of --since, --before and --without")
    then = None if since is None else moment(since)
    with connected(url, token) as bench:
        told = bench.undo(device, since=then, before=before, without=without, dry_run=True)
        wanted = ("ready", "ask") if others else ("ready",)
        chosen = [each for each in told["registers"] if each["state"] in wanted]
        if chosen and not dry_run:
            places = [(each["name"], each["axis"]) for each in chosen]
            told = bench.undo(device, since=then, before=before, without=without, registers=places, seen=told["seen"])
    if as_json:
        print_json(told)
    else:
        _print(told, dry_run=dry_run, wanted=wanted)
    if len(chosen) < len(told["registers"]):
        raise typer.Exit(LEFT)


def _print(told: Mapping[str, Any], *, dry_run: bool, wanted: tuple[str, ...]) -> None:
    done = "would be put back" if dry_run else "put back"
    rows = [
        (
            each["name"] if each["axis"] is None else f"{each['name']}.{each['axis']}",
            _text(each["now"]),
            _text(each["was"]),
            done if each["state"] in wanted else "stays",
            each["why"],
        )
        for each in told["registers"]
    ]
    if rows:
        print_table(("register", "is" if dry_run else "was", "then", "", "why"), rows)
    else:
        typer.echo("all that the log tells of is as it was")
    for each in told["rest"]:
        typer.echo(f"stays: {each['action']} {each['subject']} ({each['count']}): {each['why']}")
    if told["unseen"]:
        typer.echo(f"{len(told['unseen'])} registers that the log tells nothing of")


def _text(value: object) -> str:
    return "?" if value is None else str(value)


def _line(change: dict[str, Any]) -> tuple[str, ...]:
    entry = change["entry"]
    when = datetime.fromisoformat(entry["time"]).astimezone()
    what = f"{entry['action']} {entry['subject']}"
    if entry["new"] is not None:
        what += f" {'' if entry['old'] is None else entry['old']} -> {entry['new']}"
    return str(change["last"]), f"{when:%Y-%m-%d %H:%M:%S}", entry["who"], what, str(change["writes"])
