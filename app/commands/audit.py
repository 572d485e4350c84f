"""The audit log: `stepscope audit`."""

from __future__ import annotations

import csv
import re
import sys
from dataclasses import asdict, astuple, fields
from datetime import UTC, datetime, timedelta
from typing import TYPE_CHECKING, Annotated

import typer

from .shared import AsJson, Token, Url, connected, print_json, print_table

if TYPE_CHECKING:
    from ..client import AuditEntry

PAGE = 1000
"""Entries of one question."""
AGO = re.compile(r"(\d+(?:\.\d+)?)\s*(s|min|m|h|d|w)")
UNITS = {"s": 1, "min": 60, "m": 60, "h": 3600, "d": 86_400, "w": 604_800}


def moment(text: str) -> datetime:
    """`90min`, `2h`, `3d` ago; a time of ISO 8601, this machine's own where it names no zone. Raises BadParameter."""
    ago = AGO.fullmatch(text.strip())
    try:
        if ago:
            return datetime.now(UTC) - timedelta(seconds=float(ago[1]) * UNITS[ago[2]])
        return datetime.fromisoformat(text.strip()).astimezone()
    except (ValueError, OverflowError) as error:
        said = f"{text!r} is no time: say how long ago (90min, 2h, 3d), or when (2026-11-21T18:00)"
        raise typer.BadParameter(said) from error


def audit(
    q: Annotated[str, typer.Option(help="Words, all of which an entry has somewhere.")] = "",
    device: Annotated[str, typer.Option(help="Only what was done to this device.")] = "",
    who: Annotated[str, typer.Option(help="Only what they did.")] = "",
    action: Annotated[str, typer.Option(help="Only this: write, move, stop, edit device...")] = "",
    since: Annotated[str | None, typer.Option(help="How long ago (90min, 2h, 3d), or when (2026-11-21T18:00).")] = None,
    limit: Annotated[int, typer.Option(help="So many entries at the most, the newest.", min=1)] = 50,
    as_csv: Annotated[bool, typer.Option("--csv", help="Print CSV.")] = False,
    url: Url = None,
    token: Token = None,
    as_json: AsJson = False,
) -> None:
    """Show who did what, the newest first."""
    after = None if since is None else moment(since)
    found: list[AuditEntry] = []
    with connected(url, token) as bench:
        while len(found) < limit:
            wanted = min(PAGE, limit - len(found))
            before = found[-1].id if found else None
            page = bench.audit(q, device=device, who=who, action=action, since=after, limit=wanted, before=before)
            found += page
            if len(page) < wanted:
                break
    if as_json:
        print_json([asdict(entry) for entry in found])
    elif as_csv:
        from ..client import AuditEntry

        writer = csv.writer(sys.stdout)
        writer.writerow([column.name for column in fields(AuditEntry)])
        writer.writerows([astuple(entry) for entry in found])
    else:
        print_table(("time", "who", "device", "action", "what", "outcome"), [_row(entry) for entry in found])


def _row(entry: AuditEntry) -> tuple[str, ...]:
    when = datetime.fromisoformat(entry.time).astimezone()
    where = "" if entry.device is None else entry.device
    what = entry.subject
    if entry.old is not None or entry.new is not None:
        what += f" {'' if entry.old is None else f'{entry.old} '}-> {'nothing' if entry.new is None else entry.new}"
    if entry.detail:
        what += f" ({entry.detail})"
    return (
        f"{when:%Y-%m-%d %H:%M:%S}",
        entry.who,
        where if entry.axis is None else f"{where}.{entry.axis}",
        entry.action,
        what.strip(),
        entry.outcome,
    )
