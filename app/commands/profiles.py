"""Profiles: `stepscope profile capture | diff | apply | save | list | show | export | import | delete ...`.

A profile on the command line is a file, or the number of a kept one.
"""

from __future__ import annotations

import json
import sys
import threading
from collections.abc import Mapping
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from .completion import complete_profile
from .shared import AsJson, DeviceName, Token, Url, connected, print_json, print_table, progress

if TYPE_CHECKING:
    from ..client import Bench, SavedProfile

POLL_PERIOD_S = 0.2
"""How often the bar asks how far it is [s]."""
DIFFERENT = 1
"""Exit code of `diff` where there is a difference, as of diff(1)."""

profile = typer.Typer(
    name="profile", no_args_is_help=True, help="A device's whole configuration: keep it, compare it, bring it back."
)

Which = Annotated[
    str,
    typer.Argument(metavar="PROFILE", help="A file, or the number of a kept profile.", autocompletion=complete_profile),
]
Number = Annotated[
    int,
    typer.Argument(
        metavar="NUMBER", help="Of a kept profile, as `list` shows it.", min=1, autocompletion=complete_profile
    ),
]
Name = Annotated[str | None, typer.Option(help="What to call it.")]
Note = Annotated[str | None, typer.Option(help="What to remember of it.")]
Out = Annotated[Path | None, typer.Option(help="A file for it. [default: the terminal]")]


@profile.command(no_args_is_help=True)
def capture(
    device: DeviceName,
    out: Out = None,
    name: Name = None,
    url: Url = None,
    token: Token = None,
    as_json: AsJson = False,
) -> None:
    """Read a device's whole configuration, as a document: one register a line, or with --json every key in full."""
    with connected(url, token) as bench:
        document = dict(bench.profile(device))
        if name is not None:
            document["name"] = name
        _put_out(document, out, as_json=as_json)


@profile.command(no_args_is_help=True)
def save(
    device: DeviceName,
    name: Name = None,
    note: Note = None,
    url: Url = None,
    token: Token = None,
    as_json: AsJson = False,
) -> None:
    """Capture a device's configuration and keep it in the server."""
    with connected(url, token) as bench:
        _print_saved(bench.save_profile(device=device, name=name, note=note), as_json=as_json)


@profile.command(name="import", no_args_is_help=True)
def import_(
    file: Annotated[Path, typer.Argument(help="A document that was exported or captured.")],
    name: Name = None,
    note: Note = None,
    url: Url = None,
    token: Token = None,
    as_json: AsJson = False,
) -> None:
    """Keep a file's profile in the server."""
    with connected(url, token) as bench:
        _print_saved(bench.save_profile(_read(file), name=name, note=note), as_json=as_json)


@profile.command(no_args_is_help=True)
def export(number: Number, out: Out = None, url: Url = None, token: Token = None, as_json: AsJson = False) -> None:
    """Write a kept profile to a file, one register a line, or with --json every key in full."""
    with connected(url, token) as bench:
        _put_out(bench.saved_profile(number), out, as_json=as_json)


@profile.command(name="list")
def list_(
    search: Annotated[str, typer.Argument(help="Words of name, note, model or device.")] = "",
    model: Annotated[str, typer.Option(help="Only those of this model.")] = "",
    url: Url = None,
    token: Token = None,
    as_json: AsJson = False,
) -> None:
    """List kept profiles, the latest first."""
    with connected(url, token) as bench:
        found = bench.profiles(search, model)
        if as_json:
            print_json([asdict(each) for each in found])
            return
        print_table(
            ("number", "name", "model", "device", "registers", "note"),
            [
                (str(each.id), each.name, each.model, each.device, str(each.registers), _first_line(each.note))
                for each in found
            ],
        )


@profile.command(no_args_is_help=True)
def show(which: Which, url: Url = None, token: Token = None, as_json: AsJson = False) -> None:
    """Show what a profile says."""
    with connected(url, token) as bench:
        document = document_of(bench, which)
        if as_json:
            print_json(document)
            return
        typer.echo(f"{document.get('name', '')}  {document['model']}, {document['clock_hz'] / 1e6:g} MHz".strip())
        if document.get("note"):
            typer.echo(str(document["note"]))
        entries = [*(document.get("registers") or ()), *(document.get("parameters") or ())]
        rows = [
            (
                str(entry["name"]),
                "" if entry.get("axis") is None else str(entry["axis"]),
                "" if entry.get("value") is None else str(entry["value"]),
                str(entry.get("unit") or ""),
                " ".join(f"{name}={value}" for name, value in (entry.get("fields") or {}).items()),
            )
            for entry in entries
        ]
        print_table(("register", "axis", "value", "unit", "fields"), rows)
        tables = [name for name, table in (document.get("tables") or {}).items() if table]
        if tables:
            typer.echo(f"tables: {', '.join(tables)}")
        program = document.get("program")
        if program:
            typer.echo("\n".join(("", "program", *(str(line) for line in program["source"]))))


@profile.command(no_args_is_help=True)
def diff(
    device_or_profile: Annotated[str, typer.Argument(metavar="DEVICE|PROFILE", help="A device, or a first profile.")],
    which: Which,
    url: Url = None,
    token: Token = None,
    as_json: AsJson = False,
) -> None:
    """Show what a profile would change in a device, or what differs between two; ends with 1 where anything does."""
    with connected(url, token) as bench:
        document = document_of(bench, which)
        if _is_profile(device_or_profile):
            found = bench.compare_profiles(document_of(bench, device_or_profile), document)
        else:
            found = bench.apply_profile(device_or_profile, document, dry_run=True)
        _print_diff(found, as_json=as_json)
    if found["differences"] or found["program"] is not None:
        raise typer.Exit(DIFFERENT)


@profile.command(no_args_is_help=True)
def apply(
    device: DeviceName,
    which: Which,
    dry_run: Annotated[bool, typer.Option("--dry-run", help="Only show what would change.")] = False,
    limits: Annotated[bool, typer.Option("--limits", help="Its soft limits too.")] = False,
    url: Url = None,
    token: Token = None,
    as_json: AsJson = False,
) -> None:
    """Bring a device to what a profile says: all of it, or as it was before."""
    with connected(url, token) as bench:
        document = document_of(bench, which)
        if dry_run:
            _print_diff(bench.apply_profile(device, document, dry_run=True), as_json=as_json)
            return
        done = _with_a_bar(bench, device, document, limits=limits)
        if as_json:
            print_json(done)
            return
        for line in done["prepared"]:
            typer.secho(f"stepscope: {line}", fg="yellow", err=True)
        changed = len(done["written"]), len(done["settings"])
        stored = done["stored_commands"]
        same = changed == (0, 0) and stored is None
        what = "unchanged: it is as the profile says" if same else f"{changed[0]} registers written"
        what += f", {changed[1]} settings changed" if changed[1] else ""
        typer.echo(what + ("" if stored is None else f", a program of {stored} commands stored"))


@profile.command(name="try", no_args_is_help=True)
def try_(device: DeviceName, url: Url = None, token: Token = None, as_json: AsJson = False) -> None:
    """Find out what of a device can be set, by writing what it holds: where its list of parameters does not tell."""
    with connected(url, token) as bench:
        tried = bench.call("POST", f"devices/{device}/profile/try")
        if as_json:
            print_json(tried)
            return
        refused = ", ".join(each["name"] for each in tried["refused"])
        typer.echo(f"{tried['settable']} parameters can be set{f'; not {refused}' if refused else ''}")


@profile.command(name="way-back", no_args_is_help=True)
def way_back(device: DeviceName, url: Url = None, token: Token = None, as_json: AsJson = False) -> None:
    """Bring back what a profile has written that was cut off, or whose own rollback failed."""
    with connected(url, token) as bench:
        done = bench.take_profile_back(device)
        if as_json:
            print_json(done)
        else:
            typer.echo(f"{len(done['registers'])} registers are as they were before")


@profile.command(no_args_is_help=True)
def edit(
    number: Number,
    name: Name = None,
    note: Note = None,
    url: Url = None,
    token: Token = None,
    as_json: AsJson = False,
) -> None:
    """Give a kept profile another name or note."""
    with connected(url, token) as bench:
        _print_saved(bench.edit_profile(number, name, note), as_json=as_json)


@profile.command(no_args_is_help=True)
def delete(number: Number, url: Url = None, token: Token = None) -> None:
    """Delete a kept profile for good."""
    with connected(url, token) as bench:
        bench.delete_profile(number)


# --- helpers ----------------------------------------------------------------------------------------


def _is_profile(text: str) -> bool:
    return text.isdecimal() or text.endswith(".json") or Path(text).is_file()


def document_of(bench: Bench, which: str) -> Mapping[str, Any]:
    """The profile that `which` names. Raises OSError, ValueError for a file that is none."""
    return bench.saved_profile(int(which)) if which.isdecimal() else _read(Path(which))


def _read(file: Path) -> Mapping[str, Any]:
    data = json.loads(file.read_text(encoding="utf-8"))
    if not isinstance(data, dict):
        raise ValueError(f"{file} is no profile: a profile is a JSON object")  # noqa: TRY004 (told as a line, code 2)
    return data


def _put_out(document: Mapping[str, Any], out: Path | None, *, as_json: bool) -> None:
    from ..profiles.document import parse, text_of

    text = json.dumps(document, indent=1) + "\n" if as_json else text_of(parse(document))
    if out is None:
        sys.stdout.write(text)
    else:
        out.write_text(text, encoding="utf-8")


def _first_line(note: str) -> str:
    return note.partition("\n")[0][:60]


def _print_saved(saved: SavedProfile, *, as_json: bool) -> None:
    if as_json:
        print_json(asdict(saved))
    else:
        typer.echo(f"{saved.id}: {saved.name}, {saved.registers} registers of a {saved.model}")


def _print_diff(found: Mapping[str, Any], *, as_json: bool) -> None:
    if as_json:
        print_json(found)
        return
    for warning in found["warnings"]:
        typer.secho(f"stepscope: {warning}", fg="yellow", err=True)
    tables = {(table["name"], table["axis"]) for table in found["tables"]}
    rows = [
        (
            entry["name"],
            "" if entry["axis"] is None else str(entry["axis"]),
            _side(entry["left"], entry["left_physical"]),
            _side(entry["right"], entry["right_physical"]),
            " ".join(f"{part['name']}:{part['left']}->{part['right']}" for part in entry["fields"])
            or ("" if entry["written"] else f"not written: {entry['why']}"),
        )
        for entry in found["differences"]
        if entry["table"] is None
    ]
    if rows:
        print_table(("", "axis", found["left"], found["right"], ""), rows)
    for table in found["tables"]:
        where = "" if table["axis"] is None else f" of axis {table['axis']}"
        typer.echo(f"{table['name']}{where}: {table['differing']} of {table['of']} words differ")
    program = found["program"]
    if program is not None:
        commands = f"{program['left_commands']} commands and {program['right_commands']}"
        typer.echo(f"program: {program['differing']} differ, of {commands}")
        sides = [(str(each["address"]), each["left"], each["right"]) for each in program["commands"]]
        print_table(("address", found["left"], found["right"]), sides)
    if not rows and not tables and program is None:
        typer.echo(f"no difference in {found['same']} registers")


def _side(value: object, physical: str | None) -> str:
    shown = "?" if value is None else str(value)
    return f"{shown} ({physical})" if physical else shown


def _with_a_bar(bench: Bench, device: str, document: Mapping[str, Any], *, limits: bool) -> Mapping[str, Any]:
    """Apply it; another thread asks meanwhile how far it is. What a failed rollback has left is told line by line."""
    from ..client import ClientError, Refused

    over = threading.Event()
    with progress() as bar:
        task = bar.add_task(device, total=None)

        def poll() -> None:
            while not over.wait(POLL_PERIOD_S):
                try:
                    now = bench.profile_progress(device)
                except ClientError:
                    return
                said = f"{now['phase']} {now['register_name']}".strip() if now["phase"] else device
                bar.update(task, completed=now["done"], total=now["total"] or None, description=said)

        poller = threading.Thread(target=poll, name="how far a profile is")
        poller.start()
        try:
            return bench.apply_profile(device, document, limits=limits)
        except Refused as error:
            left = error.facts.get("left")
            for each in left if isinstance(left, list) else ():
                was, now = ("?" if each[key] is None else each[key] for key in ("was", "now"))
                where = each["name"] if each["axis"] is None else f"{each['name']} of axis {each['axis']}"
                text = f"{where} was {was}, is {now}, was to be {each['wanted']}: {each['why']}"
                typer.secho(f"stepscope: {text}", fg="red", err=True)
            raise
        finally:
            over.set()
            poller.join()
