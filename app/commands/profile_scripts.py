"""`stepscope profile script`: a profile as a program, tried on an emulator by the server."""

from __future__ import annotations

from dataclasses import asdict
from pathlib import Path
from typing import Annotated, Literal

import typer

from .profiles import Which, document_of
from .shared import AsJson, Token, Url, connected, print_json

HOW = {
    "run": "run as a program, against a server or by a module",
    "sent": "sent to a module command by command",
    "compiled": "compiled, its frames sent",
    "read": "read back, for there is nothing here to run it",
}


def script(
    which: Which,
    language: Annotated[
        Literal["python", "curl", "c", "tmcl"], typer.Option("--language", "-l", help="What it is written in.")
    ] = "python",
    out: Annotated[Path | None, typer.Option("--out", "-o", help="A file for it. [default: the terminal]")] = None,
    url: Url = None,
    token: Token = None,
    as_json: AsJson = False,
) -> None:
    """Make a profile a script for our client, curl, C or TMCL. The server tries it on an emulator first."""
    with connected(url, token) as bench:
        made = bench.profile_script(int(which) if which.isdecimal() else document_of(bench, which), language)
        if out is not None:
            out.write_text(made.text, encoding="utf-8", newline="\n")
        if as_json:
            print_json(asdict(made))
        elif out is None:
            typer.echo(made.text, nl=False)
        checked = made.checked
        tried = f"{HOW.get(checked['how'], checked['how'])}, {checked['registers']} registers, no difference"
        typer.secho(f"stepscope: tried on an emulated {checked['model']}: {tried}", err=True)
