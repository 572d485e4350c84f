"""Commands for the programs of modules: `stepscope tmcl assemble | disassemble | download | run`."""

from __future__ import annotations

import contextlib
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from .shared import AsJson, DeviceName, Token, Url, connected, print_json

if TYPE_CHECKING:
    from ..calc.tmcl.assembler import Assembly, Problem
    from ..client import Bench
    from ..registers.tmcl.description import TmclModule

tmcl = typer.Typer(name="tmcl", no_args_is_help=True, help="Assemble TMCL programs, and run them in a module.")

BINARY = ".bin"
SourceFile = Annotated[Path, typer.Argument(metavar="FILE", help="A program as text, or a binary file (.bin).")]
OutFile = Annotated[Path | None, typer.Option("--out", "-o", help="A file for it.")]
ModelName = Annotated[
    str | None, typer.Option("--model", help="Whose parameters TMCLParam.tmc names. [default: the first known]")
]


@tmcl.command(no_args_is_help=True)
def assemble(
    file: SourceFile,
    out: OutFile = None,
    listing: Annotated[bool, typer.Option("--listing", help="Print addresses, bytes and labels.")] = False,
    model: ModelName = None,
) -> None:
    """Make the text of a program a binary file (eight bytes a command), or tell everything that is wrong with it."""
    from ..calc.tmcl import disassembler
    from ..calc.tmcl.binary import to_binary
    from ..links.tmcl_language import INSTRUCTIONS

    with _wrong_usage():
        made = _assembled(file, model)
        if out is not None:
            out.write_bytes(to_binary(made.commands))
        if listing:
            typer.echo(disassembler.listing(made, INSTRUCTIONS), nl=False)
    typer.secho(f"stepscope: {len(made.commands)} commands, {len(made.labels)} labels", err=True)


@tmcl.command(no_args_is_help=True)
def disassemble(file: SourceFile, out: OutFile = None) -> None:
    """Make a binary file a program as text, which assembles to the same bytes."""
    with _wrong_usage():
        text = _text_of(file)
        if out is not None:
            out.write_text(text, encoding="utf-8", newline="\n")
        else:
            typer.echo(text, nl=False)


@tmcl.command(no_args_is_help=True)
def download(
    device: DeviceName, file: SourceFile, url: Url = None, token: Token = None, as_json: AsJson = False
) -> None:
    """Store a program in a module, and read it back. A program that runs there is stopped."""
    with connected(url, token) as bench:
        stored = _stored(bench, device, file)
        if as_json:
            print_json(stored)
        else:
            typer.echo(f"{stored['commands']} commands stored and read back")


@tmcl.command(no_args_is_help=True)
def run(
    device: DeviceName,
    file: Annotated[
        Path | None, typer.Argument(metavar="[FILE]", help="Downloaded first. [default: what is there]")
    ] = None,
    label: Annotated[str | None, typer.Option(help="Where to begin: a label of FILE.")] = None,
    address: Annotated[
        int | None, typer.Option(help="Where to begin. [default: 0 with FILE, else where it stopped]", min=0)
    ] = None,
    url: Url = None,
    token: Token = None,
) -> None:
    """Run the program of a module. `stepscope api POST devices/DEVICE/program/stop` ends it."""
    if label is not None and (file is None or address is not None):
        typer.secho("stepscope: --label needs the FILE that has it, and no --address", fg="red", err=True)
        raise typer.Exit(2)
    with connected(url, token) as bench:
        labels: dict[str, int] = {}
        if file is not None:
            labels = _stored(bench, device, file)["labels"]
            address = 0 if address is None else address
        if label is not None:
            found = {name.upper(): at for name, at in labels.items()}
            if label.upper() not in found:
                raise ValueError(f"the program has no label {label}; it has {', '.join(labels) or 'none'}")
            address = found[label.upper()]
        bench.call("POST", f"devices/{device}/program/run", {"address": address})
        state = bench.call("GET", f"devices/{device}/program/state")
        typer.echo(f"{state['status']}, at address {state['counter']}")


def _stored(bench: Bench, device: str, file: Path) -> Any:
    text, files = _source(file)
    body = {"text": text, "name": file.name[:120], "files": files}
    return bench.call("PUT", f"devices/{device}/program", body)


def _source(file: Path) -> tuple[str, dict[str, str]]:
    """The text of a program, and of the files that it includes from its folder, as far as there are any."""
    from ..calc.tmcl.assembler import assemble as assemble_text
    from ..links.tmcl_language import INSTRUCTIONS

    text = _text_of(file)
    files: dict[str, str] = {}

    def found(name: str) -> str | None:
        beside = file.parent / name
        if not beside.is_file():
            return None
        files[name] = beside.read_text(encoding="utf-8")
        return files[name]

    assemble_text(text, INSTRUCTIONS, resolve=found)  # to learn what it includes
    return text, files


def _text_of(file: Path) -> str:
    from ..calc.tmcl.binary import from_binary
    from ..calc.tmcl.disassembler import disassemble as as_text
    from ..links.tmcl_language import INSTRUCTIONS

    if file.suffix.lower() == BINARY:
        return as_text(from_binary(file.read_bytes()), INSTRUCTIONS)
    return file.read_text(encoding="utf-8")


def _assembled(file: Path, model: str | None) -> Assembly:
    from ..calc.tmcl.assembler import assemble as assemble_text
    from ..links.tmcl_language import INSTRUCTIONS, standard_include

    module = _module(model)
    text, files = _source(file)
    made = assemble_text(
        text,
        INSTRUCTIONS,
        name=str(file),
        resolve=lambda name: files[name] if name in files else standard_include(module, name),
    )
    _tell(made.problems)
    return made


def _module(model: str | None) -> TmclModule:
    from ..registers.tmcl.modules import MODULES

    if model is None:
        return next(iter(MODULES.values()))
    if model not in MODULES:
        raise ValueError(f"no module is called {model!r}; known: {', '.join(MODULES)}")
    return MODULES[model]


def _tell(problems: list[Problem]) -> None:
    """All problems on lines of their own; the program is no good then."""
    if problems:
        for problem in problems:
            typer.secho(str(problem), fg="red", err=True)
        raise typer.Exit(1)


@contextlib.contextmanager
def _wrong_usage() -> Iterator[None]:
    """Files that are not there, or are no programs, are told on a line."""
    from ..errors import UsageError

    try:
        yield
    except (OSError, ValueError, UsageError) as error:
        typer.secho(f"stepscope: {error}", fg="red", err=True)
        raise typer.Exit(2) from error
