"""What commands have in common: their options, the server's client, and how answers are printed."""

from __future__ import annotations

import contextlib
import json
import os
import sys
from collections.abc import Callable, Iterator, Sequence
from typing import TYPE_CHECKING, Annotated, Any

import typer

from ..number_text import plain
from .completion import complete_channel, complete_device

if TYPE_CHECKING:
    from rich.progress import Progress

    from ..client import AxisState, Bench

# The client (httpx, numpy) is brought in by those commands that run, not by `--help`.


Url = Annotated[
    str | None, typer.Option(metavar="http://HOST:PORT", help="The server. [default: STEPSCOPE_URL, or this machine]")
]
Token = Annotated[str | None, typer.Option(help="What a server on a network asks for. [default: STEPSCOPE_TOKEN]")]
AsJson = Annotated[bool, typer.Option("--json", help="The answer as JSON.")]
DeviceName = Annotated[str, typer.Argument(metavar="DEVICE", autocompletion=complete_device)]
Channels = Annotated[
    list[str], typer.Argument(help="position.0 velocity.0 residual.0 ...", autocompletion=complete_channel)
]
AxisNumber = Annotated[int, typer.Option(help="Which axis.", min=0)]
AnyAxis = Annotated[int | None, typer.Option(help="Which axis. [default: the device's own registers]", min=0)]


@contextlib.contextmanager
def connected(url: str | None, token: str | None) -> Iterator[Bench]:
    """The server's client; what goes wrong is told on a line, and by the exit code."""
    from ..client import Bench, ClientError

    try:
        with Bench(url, token=token) as bench:
            yield bench
    except ClientError as error:
        typer.secho(f"stepscope: {error}", fg="red", err=True)
        raise typer.Exit(error.exit_code) from error
    except BrokenPipeError:  # `stepscope read bench | head`: who read it has seen enough
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        raise typer.Exit(0) from None
    except (OSError, ValueError) as error:
        typer.secho(f"stepscope: {error}", fg="red", err=True)
        raise typer.Exit(2) from error


def json_object(values: Sequence[str]) -> dict[str, Any]:
    """NAME=JSON pairs; a dot in the name goes one object deeper. What is no JSON is taken as a word."""
    body: dict[str, Any] = {}
    for text in values:
        name, equals, value = text.partition("=")
        if not equals:
            raise ValueError(f"what is asked is NAME=VALUE, not {text!r}")
        *outer, last = name.split(".")
        inner = body
        for part in outer:
            inner = inner.setdefault(part, {})
        try:
            inner[last] = json.loads(value)
        except ValueError:
            inner[last] = value
    return body


def print_json(answer: object) -> None:
    """For programs."""
    typer.echo(json.dumps(answer, indent=1, ensure_ascii=False))


def print_table(heads: Sequence[str], rows: Sequence[Sequence[str]]) -> None:
    """For people. Without any head only rows."""
    widths = [max(len(row[column]) for row in (heads, *rows)) for column in range(len(heads))]
    for row in (heads, *rows) if any(heads) else rows:
        typer.echo("  ".join(cell.ljust(width) for cell, width in zip(row, widths, strict=True)).rstrip())


def progress() -> Progress:
    """A bar on the terminal's error stream: the answer alone goes to a pipe."""
    from rich.console import Console
    from rich.progress import BarColumn, Progress, TaskProgressColumn, TextColumn, TimeElapsedColumn

    columns = (TextColumn("{task.description}"), BarColumn(), TaskProgressColumn(), TimeElapsedColumn())
    return Progress(*columns, console=Console(stderr=True), transient=True)


def shown(progress: Progress, task: Any) -> Callable[[float, AxisState], None]:
    """What a waiting move tells the bar."""

    def show(share: float, state: AxisState) -> None:
        progress.update(task, completed=share, description=f"at {state.position}, {plain(state.velocity_pps)} pps")

    return show
