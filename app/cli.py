"""The command line: `stepscope serve | emulate | openapi`."""

from __future__ import annotations

import json
import os
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Annotated

import typer

from app import __version__
from app.links.errors import BenchError
from app.settings import LogLevel, Settings

# The server's own imports (FastAPI, numpy, numba) cost half a second: each command brings only what it needs.

cli = typer.Typer(
    no_args_is_help=True, add_completion=True, help="Configure, tune and watch stepper motion controllers."
)


def main() -> None:
    """Console script."""
    cli()


@contextmanager
def _told() -> Iterator[None]:
    """What somebody can put right is a line on the terminal and exit code 1, not a traceback."""
    try:
        yield
    except (OSError, BenchError, ValueError) as error:  # ValueError: pydantic's too, of options and variables
        typer.secho(f"stepscope: {error}", fg="red", err=True)
        raise typer.Exit(1) from error


def _version(wanted: bool) -> None:
    if wanted:
        typer.echo(f"stepscope {__version__}")
        raise typer.Exit


@cli.callback()
def _root(
    version: Annotated[
        bool, typer.Option("--version", callback=_version, is_eager=True, help="Print the version and end.")
    ] = False,
) -> None:
    del version


@cli.command()
def serve(
    host: Annotated[str | None, typer.Option(help="Address to listen on. [default: 127.0.0.1]")] = None,
    port: Annotated[
        int | None, typer.Option(help="Port; 0 picks a free one. [default: 8000]", min=0, max=65535)
    ] = None,
    data_dir: Annotated[Path | None, typer.Option(help="Where connections and profiles are kept.")] = None,
    demo: Annotated[
        bool | None, typer.Option("--demo/--no-demo", help="The demo bench. [default: while no connection is saved]")
    ] = None,
    log_level: Annotated[LogLevel | None, typer.Option(help="[default: info]")] = None,
    reload: Annotated[
        bool, typer.Option("--reload", help="Start again when the source changes (for developers).")
    ] = False,
) -> None:
    """Serve the dashboard and its API. Ctrl-C stops the motors that move, then the server.

    Every option is also a variable, e.g. STEPSCOPE_PORT=8001; options win.
    """
    said = {"host": host, "port": port, "data_dir": data_dir, "demo": demo, "log_level": log_level}
    with _told():
        settings = Settings(**{name: value for name, value in said.items() if value is not None})  # type: ignore[arg-type]  # checked by pydantic
        from app import serving

        if reload:
            serving.serve_with_reload(settings, os.environ)
        else:
            serving.serve(settings, announce=typer.echo)


@cli.command()
def emulate(
    model: Annotated[str, typer.Argument(help="tmc428 or tmc4210")],
    tcp: Annotated[str, typer.Option(metavar="HOST:PORT", help="Where to listen; port 0 picks a free one.")],
    seed: Annotated[int | None, typer.Option(help="Of everything random: RAM noise, bit errors.")] = None,
    clock_hz: Annotated[float | None, typer.Option(help="Clock of the chip [Hz].")] = None,
    time_scale: Annotated[float, typer.Option(help="How much faster than real time.", min=0.0, max=1000.0)] = 1.0,
    wiring: Annotated[str | None, typer.Option(help="How the reference switches are wired.")] = None,
) -> None:
    """Serve one emulated chip to any client: raw 4-byte frames, both ways (docs/tcp-link.md)."""
    options = {"seed": seed, "clock_hz": clock_hz, "wiring": wiring}
    with _told():
        from app import serving

        serving.emulate(
            model, tcp, {name: value for name, value in options.items() if value is not None}, time_scale, typer.echo
        )


@cli.command()
def openapi() -> None:
    """Print the OpenAPI schema of the REST API."""
    from app.main import create_app

    typer.echo(json.dumps(create_app(Settings()).openapi(), indent=1, ensure_ascii=False))
