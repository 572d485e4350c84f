"""The command line: `stepscope serve | emulate | fault | openapi`, and the commands that ask a running server."""

from __future__ import annotations

import gc
import json
import os
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Annotated

import typer

from . import __version__
from .allocator import give_back_large_buffers
from .byte_code import compile_ahead, keep_byte_code
from .commands import COMMANDS, GROUPS, WITHOUT_ARGUMENTS
from .errors import BenchError
from .settings import LogLevel, OnVanish, Settings

# The server's own imports (FastAPI, numpy, numba) cost half a second: each command brings only what it needs.

cli = typer.Typer(
    no_args_is_help=True, add_completion=True, help="Configure, tune and watch stepper motion controllers."
)


def main() -> None:
    """Console script."""
    cli()


@contextmanager
def _told() -> Iterator[None]:
    """What the user can put right is a line on the terminal and exit code 1, not a traceback."""
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
    keep_byte_code()  # of what the command brings, which is most of all


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
    token: Annotated[
        str | None,
        typer.Option(help="What clients have to know. [default: none on this machine, a new one for a network]"),
    ] = None,
    token_file: Annotated[
        Path | None, typer.Option(help="A file with that token; made with a new one at the first start.")
    ] = None,
    tls_cert: Annotated[Path | None, typer.Option(help="Certificate (PEM): serve https.")] = None,
    tls_key: Annotated[Path | None, typer.Option(help="Key of the certificate (PEM).")] = None,
    dask: Annotated[
        str | None,
        typer.Option(help="Dask scheduler (tcp://HOST:PORT) for twins of studies. [default: this machine]"),
    ] = None,
    on_vanish: Annotated[
        OnVanish | None,
        typer.Option(help="What happens to moving motors when who has the bench vanishes. [default: stop]"),
    ] = None,
    vanish_after_s: Annotated[
        float | None, typer.Option("--vanish-after", help="Without a sign for so long [s]. [default: 15]")
    ] = None,
    log_level: Annotated[LogLevel | None, typer.Option(help="[default: info]")] = None,
    reload: Annotated[
        bool, typer.Option("--reload", help="Start again when the source changes (for developers).")
    ] = False,
) -> None:
    """Serve the dashboard and its API. Ctrl-C stops the motors that move, then the server.

    Every option is also a variable, e.g. STEPSCOPE_PORT=8001; options win.
    """
    said = {
        "host": host,
        "port": port,
        "data_dir": data_dir,
        "demo": demo,
        "token": token,
        "token_file": token_file,
        "tls_cert": tls_cert,
        "tls_key": tls_key,
        "dask": dask,
        "on_vanish": on_vanish,
        "vanish_after_s": vanish_after_s,
        "log_level": log_level,
    }
    with _told():
        settings = Settings(**{name: value for name, value in said.items() if value is not None})  # type: ignore[arg-type]  # checked by pydantic
        compile_ahead()
        give_back_large_buffers()
        gc.disable()  # it looks through what modules make for 0.4 s, and finds nothing; a ready server has it on
        try:
            from . import serving

            if reload:
                serving.serve_with_reload(settings, os.environ)
            else:
                serving.serve(settings, announce=typer.echo)
        finally:
            gc.enable()


@cli.command()
def emulate(
    model: Annotated[str, typer.Argument(help="pd42-1241, landungsbruecke, a chip: tmc428, tmc5160 ..., or MAP.toml")],
    chip: Annotated[str | None, typer.Option(help="Landungsbruecke: the chip in its slot. [default: tmc4361]")] = None,
    pty: Annotated[
        Path | None, typer.Option(metavar="PATH", help="A serial port under this name (a symbolic link).")
    ] = None,
    tcp: Annotated[
        str | None, typer.Option(metavar="HOST:PORT", help="Where to listen; port 0 picks a free one.")
    ] = None,
    can: Annotated[
        str | None,
        typer.Option(
            metavar="CHANNEL", help="Module: a CAN bus, vcan0 of socketcan, or INTERFACE:CHANNEL of python-can."
        ),
    ] = None,
    address: Annotated[
        list[int] | None, typer.Option(help="Module: its address; more than one put several on the line. [default: 1]")
    ] = None,
    node: Annotated[
        list[int] | None,
        typer.Option(help="UART: the chip's node; more than one put several on the wire. [default: 0]", min=0, max=254),
    ] = None,
    echo: Annotated[bool, typer.Option("--echo", help="UART: what is sent comes back, as on a single wire.")] = False,
    uart: Annotated[bool, typer.Option("--uart", help="Chip: its UART at --tcp too, and no raw frames.")] = False,
    baud: Annotated[
        int | None,
        typer.Option(help="Of a serial port: model the time on the wire. [default: none]", min=300),
    ] = None,
    shared_bus: Annotated[
        bool, typer.Option("--shared-bus", help="Line: every TCP client hears everything, as on RS485.")
    ] = False,
    data_dir: Annotated[
        Path | None, typer.Option(help="Module: where its EEPROM is kept. [default: forgotten at the end]")
    ] = None,
    control: Annotated[
        str | None, typer.Option(metavar="HOST:PORT", help="Line: REST port for faults; see `stepscope fault`.")
    ] = None,
    seed: Annotated[int | None, typer.Option(help="Of everything random: RAM noise, bit errors.", min=0)] = None,
    clock_hz: Annotated[float | None, typer.Option(help="Chip: its clock [Hz].")] = None,
    time_scale: Annotated[float, typer.Option(help="How much faster than real time.", min=0.0, max=1000.0)] = 1.0,
    wiring: Annotated[str | None, typer.Option(help="Chip: how the reference switches are wired.")] = None,
    v_actual_writable: Annotated[
        str | None, typer.Option(help="Chip: hold-mode, or velocity-mode, where writing 0 then stops dead.")
    ] = None,
) -> None:
    """Serve an emulated chip (raw frames, or its UART at --pty), or a line of modules or with a board, to any client.

    Ctrl-C ends it.
    """
    of_modules: dict[str, object] = {"address": address, "can": can, "data_dir": data_dir}
    of_line: dict[str, object] = {"control": control, "shared_bus": shared_bus or None}
    of_uart: dict[str, object] = {"echo": echo or None, "node": node}
    with _told():
        from .emulator_server import serve as emulating

        model = _mapped(model)
        is_uart = emulating.shows_uart(model, asked=uart or pty is not None)
        is_board, is_line = model == emulating.BOARD, emulating.is_line(model) or is_uart
        _refuse({} if is_uart else {**of_uart, "uart": uart or None}, f"{model} here")
        _refuse({} if is_line else of_line, model)
        _refuse({} if emulating.is_module(model) else of_modules, model)
        _refuse({} if is_board else {"chip": chip}, model)
        _refuse({"clock_hz": clock_hz} if emulating.is_module(model) else {}, model)
        of_pulses: dict[str, object] = {"wiring": wiring, "v_actual_writable": v_actual_writable}
        _refuse(of_pulses if is_line else {}, model)
        if is_line:
            options = emulating.LineOptions(
                model=model,
                chip=chip or "",
                clock_hz=clock_hz,
                pty=pty,
                tcp=tcp,
                can=can,
                addresses=(node or (0,)) if is_uart else address or (1,),
                baud=baud,
                shared_bus=shared_bus,
                echo=echo,
                data_dir=data_dir,
                control=control,
                seed=emulating.LineOptions.seed if seed is None else seed,
                time_scale=time_scale,
            )
            emulating.emulate_line(options, typer.echo)
        else:
            of_chip = {"seed": seed, "clock_hz": clock_hz, **of_pulses}
            given = {name: value for name, value in of_chip.items() if value is not None}
            emulating.emulate(model, given, time_scale, typer.echo, tcp=tcp, pty=pty, baud=baud)


def _mapped(model: str) -> str:
    """`model`, or the one that the file of a register map makes; all that is wrong with that, line by line."""
    from .commands.register_maps import tell
    from .emulator_server.serve import named_or_mapped
    from .registers.maps.findings import UnreadableMap

    try:
        return named_or_mapped(model)
    except UnreadableMap as error:
        tell(Path(model), error.findings, error.more)
        raise typer.Exit(1) from error


def _refuse(options: dict[str, object], model: str) -> None:
    """Raises ValueError for an option that the user gave and `model` has no use for."""
    for name, value in options.items():
        if value is not None:
            raise ValueError(f"--{name.replace('_', '-')} is not for a {model}")


@cli.command(no_args_is_help=True)
def fault(
    url: Annotated[str, typer.Argument(help="Control port of `stepscope emulate`, e.g. http://127.0.0.1:9000")],
    name: Annotated[str, typer.Argument(help="silence, unplugged, late_reply_s, load_torque_nm, blocked, ...")],
    value: Annotated[str, typer.Argument(help="on, off, a number, auto")],
    address: Annotated[int | None, typer.Option(help="Which of several modules or chips.", min=0, max=255)] = None,
    line: Annotated[bool, typer.Option("--line", help="A fault of the cable, not of one module.")] = False,
    as_json: Annotated[bool, typer.Option("--json", help="Print the whole state afterwards.")] = False,
) -> None:
    """Cause a fault in an emulator that runs, or end it: `stepscope fault http://127.0.0.1:9000 silence on`.

    URL may also be an emulated device of a running dashboard: http://127.0.0.1:8000/api/v1/devices/NAME/emulator
    """
    with _told():
        from .emulator_server import fault as faults

        path, state = faults.change(url, name, value, address=address, line=line)
        typer.echo(json.dumps(state, indent=1) if as_json else f"{path} = {value}")


@cli.command()
def openapi() -> None:
    """Print the OpenAPI schema of the REST API."""
    from .main import create_app

    typer.echo(json.dumps(create_app(Settings()).openapi(), indent=1, ensure_ascii=False))


for _command in COMMANDS:
    cli.command(no_args_is_help=_command.__name__ not in WITHOUT_ARGUMENTS)(_command)
for _group in GROUPS:
    cli.add_typer(_group)


if __name__ == "__main__":
    main()
