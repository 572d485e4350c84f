"""`stepscope tmcl`: assemble, disassemble, download, read, run, debug, try and look at programs of modules."""

from __future__ import annotations

import contextlib
import time
from collections.abc import Iterator
from enum import StrEnum
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from .shared import AsJson, DeviceName, Token, Url, connected, print_json

if TYPE_CHECKING:
    from ..calc.tmcl.assembler import Assembly, Problem
    from ..client import Bench
    from ..registers.tmcl.description import TmclModule

tmcl = typer.Typer(name="tmcl", no_args_is_help=True, help="Programs of TMCL modules: assemble, try, run, debug.")

BINARY = ".bin"
ASK_EVERY_S = 0.1
"""How often it is asked whether a run by single steps is over [s]."""
NOT_ARRIVED = 5
"""The exit code for what did not end in time."""
Variables = Annotated[
    list[int] | None,
    typer.Option("--variable", "-v", help="A user variable to tell; may be repeated.", min=0, max=255),
]


class StepMode(StrEnum):
    """How far a run by single steps goes."""

    RUN = "run"
    OVER = "over"
    OUT = "out"


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
def read(
    device: DeviceName,
    address: Annotated[int, typer.Option(help="Of the first command.", min=0)] = 0,
    count: Annotated[int, typer.Option(help="How many commands.", min=1)] = 64,
    out: OutFile = None,
    url: Url = None,
    token: Token = None,
    as_json: AsJson = False,
) -> None:
    """Read a stretch of a module's program memory, as text that assembles to the same commands."""
    with connected(url, token) as bench:
        stretch = bench.call("GET", f"devices/{device}/program?address={address}&count={count}")
        if out is not None:
            out.write_text(stretch["text"], encoding="utf-8", newline="\n")
        elif as_json:
            print_json(stretch)
        else:
            typer.echo(stretch["text"], nl=False)


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
    """Run the program of a module. `stepscope stop DEVICE` ends it."""
    if label is not None and (file is None or address is not None):
        typer.secho("stepscope: --label needs the FILE that has it, and no --address", fg="red", err=True)
        raise typer.Exit(2)
    with connected(url, token) as bench:
        labels: dict[str, int] = {}
        if file is not None:
            labels = _stored(bench, device, file)["labels"]
            address = 0 if address is None else address
        if label is not None:
            address = _address_of(label, labels)
        bench.call("POST", f"devices/{device}/program/run", {"address": address})
        state = bench.call("GET", f"devices/{device}/program/state")
        typer.echo(f"{state['status']}, at address {state['counter']}")


@tmcl.command(no_args_is_help=True)
def state(
    device: DeviceName, variables: Variables = None, url: Url = None, token: Token = None, as_json: AsJson = False
) -> None:
    """What the interpreter of a module does: counter, accumulator, X, and user variables."""
    with connected(url, token) as bench:
        told = _state(bench, device, variables)
        if as_json:
            print_json(told)
        else:
            _print_state(bench, device, told)


@tmcl.command(no_args_is_help=True)
def debug(
    device: DeviceName,
    file: Annotated[
        Path | None, typer.Argument(metavar="[FILE]", help="Downloaded first, and begun at its start. [default: none]")
    ] = None,
    breakpoints: Annotated[
        list[str] | None,
        typer.Option("--break", "-b", metavar="ADDRESS|LABEL", help="Halt there; may be repeated. Labels are FILE's."),
    ] = None,
    mode: Annotated[
        StepMode, typer.Option(help="run to a breakpoint, over one command or subroutine, out of a subroutine.")
    ] = StepMode.RUN,
    from_start: Annotated[bool, typer.Option("--from-start", help="Reset the program first.")] = False,
    timeout_s: Annotated[float, typer.Option("--timeout", help="Pause it after so long [s].", min=0.1)] = 60.0,
    variables: Variables = None,
    url: Url = None,
    token: Token = None,
    as_json: AsJson = False,
) -> None:
    """Run the program of a module by single steps until a breakpoint, its end, or Ctrl-C, and tell where it is.

    That is slower than the module by itself, and the motor does not wait: it goes on as it was told last.
    """
    with connected(url, token) as bench:
        labels: dict[str, int] = {}
        if file is not None:
            labels = _stored(bench, device, file)["labels"]
        halts = [_address_of(text, labels) for text in breakpoints or ()]
        wanted = {"mode": mode.value, "breakpoints": halts, "from_start": from_start or file is not None}
        run = bench.call("POST", f"devices/{device}/program/debug", wanted)
        run, in_time = _until_halted(bench, device, run, timeout_s)
        told = _state(bench, device, variables)
        if as_json:
            print_json({"debug": run, "state": told})
        else:
            typer.echo(f"{run['message'] or run['state']}, after {run['steps']} steps")
            _print_state(bench, device, told)
        if run["state"] == "failed":
            raise typer.Exit(1)
        if not in_time:
            typer.secho(f"stepscope: paused after {timeout_s:g} s", fg="red", err=True)
            raise typer.Exit(NOT_ARRIVED)


@tmcl.command(name="try", no_args_is_help=True)
def try_(
    device: DeviceName,
    file: SourceFile,
    label: Annotated[str | None, typer.Option(help="Where to begin: a label of FILE.")] = None,
    address: Annotated[int | None, typer.Option(help="Where to begin. [default: 0]", min=0)] = None,
    seconds: Annotated[float, typer.Option(help="How long, of the emulator's time [s].")] = 10.0,
    out: Annotated[
        Path | None, typer.Option("--out", "-o", help="A CSV file for time, position, velocity and counter.")
    ] = None,
    url: Url = None,
    token: Token = None,
    as_json: AsJson = False,
) -> None:
    """Run a program on an emulated module that is set as DEVICE is. DEVICE is only read; nothing on the bench moves."""
    if label is not None and address is not None:
        typer.secho("stepscope: --label or --address, not both", fg="red", err=True)
        raise typer.Exit(2)
    with connected(url, token) as bench:
        source = _body_of(file)
        if label is not None:
            assembled = bench.call("POST", f"devices/{device}/program/assemble", {**source, "listing": False})
            for problem in assembled["problems"]:
                typer.secho("{file}:{line}:{column}: {message}".format(**problem), fg="red", err=True)
            if assembled["problems"]:
                raise typer.Exit(1)
            address = _address_of(label, assembled["labels"])
        wanted = {**source, "address": address or 0, "duration_s": seconds}
        trial = bench.call("POST", f"devices/{device}/program/try", wanted)
        if out is not None:
            out.write_text(_csv(trial), encoding="utf-8", newline="\n")
        if as_json:
            print_json(trial)
        else:
            _print_trial(trial)


_ENDED = {
    "stopped": "it stopped by itself",
    "time": "it still ran when its time was over",
    "work": "it had taken too much of the processor",
}
_COLUMNS = ("time_s", "position", "velocity_pps", "counters")


def _print_trial(trial: Any) -> None:
    times, positions = trial["time_s"], trial["position"]
    lasted = f" after {times[-1]:g} s" if times else ""
    typer.echo(f"{_ENDED[trial['ended']]}{lasted}, at address {trial['counter']}")
    typer.echo(f"accumulator {trial['accumulator']}, X {trial['x']}, flags {' '.join(trial['flags']) or 'none'}")
    if positions:
        typer.echo(f"position {positions[-1]}, between {min(positions)} and {max(positions)}")
    for number, value in trial["variables"].items():
        typer.echo(f"variable {number}: {value}")
    if trial["error"]:
        typer.echo(f"the latest command that was refused: status {trial['error']}")


def _csv(trial: Any) -> str:
    rows = zip(*(trial[name] for name in _COLUMNS), strict=True)
    return "".join(f"{','.join(map(str, row))}\n" for row in (_COLUMNS, *rows))


def _until_halted(bench: Bench, device: str, run: Any, timeout_s: float) -> tuple[Any, bool]:
    """How a run by single steps ended, and whether by itself; after `timeout_s` [s], or by Ctrl-C, it is paused."""
    path, until_s = f"devices/{device}/program/debug", time.monotonic() + timeout_s
    try:
        while run["state"] == "running" and time.monotonic() < until_s:
            time.sleep(ASK_EVERY_S)
            run = bench.call("GET", path)
    except KeyboardInterrupt:
        return bench.call("DELETE", path), True
    if run["state"] == "running":
        return bench.call("DELETE", path), False
    return run, True


def _state(bench: Bench, device: str, variables: list[int] | None) -> Any:
    asked = "&".join(f"variable={number}" for number in variables or ())
    return bench.call("GET", f"devices/{device}/program/state{'?' if asked else ''}{asked}")


def _print_state(bench: Bench, device: str, told: Any) -> None:
    counter = told["counter"]
    typer.echo(f"{told['status']}, at address {counter}{_command_at(bench, device, counter)}")
    typer.echo(f"accumulator {told['accumulator']}, X {told['x']}")
    for number, value in told["variables"].items():
        typer.echo(f"variable {number}: {value}")
    if told["downloading"]:
        typer.echo("in download mode: what is sent is stored, not done")
    if told["error"]:
        typer.echo(f"the latest command that was refused: status {told['error']}")


def _command_at(bench: Bench, device: str, address: int) -> str:
    """`: MVP ABS, 0, 51200`; "" where the memory may not be read."""
    from ..client import ClientError

    try:
        text = bench.call("GET", f"devices/{device}/program?address={address}&count=1")["text"]
    except ClientError:
        return ""
    lines = [line.split("//")[0].strip() for line in text.splitlines()]
    return f": {next((line for line in reversed(lines) if line), '')}"


def _address_of(text: str, labels: dict[str, int]) -> int:
    """Of a number or a label. Raises ValueError."""
    if text.isascii() and text.isdecimal():
        return int(text)
    found = {name.upper(): at for name, at in labels.items()}
    if text.upper() not in found:
        raise ValueError(f"the program has no label {text}; it has {', '.join(labels) or 'none'}")
    return found[text.upper()]


def _stored(bench: Bench, device: str, file: Path) -> Any:
    return bench.call("PUT", f"devices/{device}/program", _body_of(file))


def _body_of(file: Path) -> dict[str, Any]:
    text, files = _source(file)
    return {"text": text, "name": file.name[:120], "files": files}


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
