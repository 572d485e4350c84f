"""Named tokens: `stepscope tokens add | list | revoke`. Written into the data directory, with a server or without."""

from __future__ import annotations

import contextlib
from collections.abc import Iterator
from dataclasses import asdict
from datetime import UTC, datetime
from pathlib import Path
from typing import Annotated

import typer

from ..errors import BenchError
from ..settings import Settings
from ..store.tokens import Role, TokenStore
from .shared import AsJson, print_json, print_table

tokens = typer.Typer(name="tokens", no_args_is_help=True, help="Who may come in, and what each may do.")

TokenName = Annotated[str, typer.Argument(metavar="NAME", help="Shown in the lease and in the audit log.")]
DataDir = Annotated[Path | None, typer.Option(help="The server's. [default: STEPSCOPE_DATA_DIR, or the usual one]")]


@contextlib.contextmanager
def _store(data_dir: Path | None) -> Iterator[TokenStore]:
    """The file; what goes wrong is told on a line, and by exit code 1."""
    try:
        yield TokenStore(Settings().data_dir if data_dir is None else data_dir)
    except (OSError, BenchError, ValueError) as error:
        way_out = getattr(error, "way_out", "")
        typer.secho(f"stepscope: {error}{f'; {way_out}' if way_out else ''}", fg="red", err=True)
        raise typer.Exit(1) from error


@tokens.command()
def add(
    name: TokenName,
    role: Annotated[Role, typer.Option(help="look: reads and stops. drive: all but tokens. administer: all.")],
    data_dir: DataDir = None,
) -> None:
    """Make a token and print it, the only time. A running server lets it in within a second."""
    with _store(data_dir) as store:
        typer.echo(store.add(name, role))
        typer.secho(f"for {name}, who may {role}; it is told once, and kept as a hash in {store.path}", err=True)


@tokens.command("list")
def list_(data_dir: DataDir = None, as_json: AsJson = False) -> None:
    """Show who may come in."""
    with _store(data_dir) as store:
        found = store.load()
        for warning in found.warnings:
            typer.secho(f"stepscope: {warning}", fg="yellow", err=True)
        if as_json:
            print_json([{key: value for key, value in asdict(each).items() if key != "hash"} for each in found.tokens])
            return
        made = [datetime.fromtimestamp(each.created_unix_s, UTC).astimezone() for each in found.tokens]
        rows = [(each.name, each.role, f"{at:%Y-%m-%d %H:%M}") for each, at in zip(found.tokens, made, strict=True)]
        print_table(("name", "role", "made"), rows)


@tokens.command()
def revoke(name: TokenName, data_dir: DataDir = None) -> None:
    """Let it in no longer. A running server ends its sessions and sockets within a second."""
    with _store(data_dir) as store:
        store.revoke(name)
        typer.echo(f"{name} is revoked")
