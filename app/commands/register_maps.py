"""Register maps: `stepscope maps check | add | list | get | delete`."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from .shared import AsJson, Token, Url, connected, print_json, print_table

maps = typer.Typer(
    name="maps", no_args_is_help=True, help="Register maps: files that make a chip of your own a device."
)

File = Annotated[Path, typer.Argument(help="The map: .toml, or .csv for a table.", exists=True, dir_okay=False)]
Name = Annotated[str, typer.Argument(metavar="NAME", help="As `list` shows it.")]
ADDRESS = "/register-maps"


@maps.command(no_args_is_help=True)
def check(file: File) -> None:
    """Say what is wrong with a map, line by line; needs no server."""
    from ..registers.maps.files import read_file
    from ..registers.maps.findings import UnreadableMap

    try:
        found = read_file(file)
    except UnreadableMap as error:
        tell(file, error.findings, error.more)
        raise typer.Exit(1) from error
    typer.echo(f"{file}: {found.head.title}, {len(found.table)} registers, nothing wrong")


@maps.command(no_args_is_help=True)
def add(
    file: File,
    name: Annotated[str | None, typer.Option(help="What to call it, and the model. [default: as the file]")] = None,
    url: Url = None,
    token: Token = None,
    as_json: AsJson = False,
) -> None:
    """Keep a map in the server, instead of the one of that name; a table becomes a map."""
    from ..client import Refused

    with connected(url, token) as bench:
        text = file.read_text(encoding="utf-8-sig")
        body = {"text": text, "format": "csv" if _is_csv(file) else "toml"}
        try:
            kept = bench.call("PUT", f"{ADDRESS}/{name or _name(file)}", body)
        except Refused as error:
            findings = error.facts.get("findings")
            if not isinstance(findings, list):
                raise
            tell(file, findings, error.facts.get("more"))
            raise typer.Exit(1) from error
        if as_json:
            print_json(kept)
        else:
            typer.echo(f"{kept['name']}: {kept['title']}, {kept['registers']} registers")


@maps.command(name="list")
def list_(url: Url = None, token: Token = None, as_json: AsJson = False) -> None:
    """List the server's maps, and say which cannot be read."""
    with connected(url, token) as bench:
        found = bench.call("GET", ADDRESS)
        if as_json:
            print_json(found)
            return
        rows = [
            (
                each["name"],
                each["title"],
                str(each["registers"]),
                ", ".join(each["devices"]),
                each["behind"] or (f"line {each['findings'][0]['line']}: not usable" if each["findings"] else ""),
            )
            for each in found["maps"]
        ]
        print_table(("name", "title", "registers", "devices", ""), rows)
        for line in found["passed_over"]:
            typer.secho(f"stepscope: {line}", fg="yellow", err=True)


@maps.command(no_args_is_help=True)
def get(
    name: Name,
    out: Annotated[Path | None, typer.Option(help="A file for it. [default: the terminal]")] = None,
    url: Url = None,
    token: Token = None,
) -> None:
    """Fetch the file of a map."""
    with connected(url, token) as bench:
        text = bench.call("GET", f"{ADDRESS}/{name}")["text"]
        if out is None:
            typer.echo(text, nl=False)
        else:
            out.write_text(text, encoding="utf-8")


@maps.command(no_args_is_help=True)
def delete(name: Name, url: Url = None, token: Token = None) -> None:
    """Delete a map that no device is made of."""
    with connected(url, token) as bench:
        bench.call("DELETE", f"{ADDRESS}/{name}")


def tell(file: Path, findings: list[dict[str, object]], more: object) -> None:
    """As compilers do, so that editors find the place."""
    for each in findings:
        where = f"{each['where']}: " if each["where"] else ""
        typer.secho(f"{file}:{each['line']}: {where}{each['what']}", fg="red", err=True)
    if more:
        typer.secho(f"{file}: and {more} more", fg="red", err=True)


def _is_csv(file: Path) -> bool:
    return file.suffix.casefold() in (".csv", ".tsv")


def _name(file: Path) -> str:
    return file.stem.casefold().replace("_", "-").replace(" ", "-")
