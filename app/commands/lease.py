"""Who has the bench: `stepscope lease`, and `lease run`, `lease ask`.

Each command alone borrows the free bench for its own call. What belongs together, and must not be interrupted, is a
program that runs under one lease.
"""

from __future__ import annotations

import os
import subprocess
from dataclasses import asdict
from typing import TYPE_CHECKING, Annotated

import typer

from ..settings import OnVanish
from .shared import AsJson, Token, Url, connected, print_json, print_table

if TYPE_CHECKING:
    from ..client import LeaseState

lease = typer.Typer(
    name="lease", invoke_without_command=True, help="Show who has the bench, or have it for a program's time."
)


Name = Annotated[str | None, typer.Option(help="What others see. [default: user@machine]")]


@lease.callback()
def show(context: typer.Context, url: Url = None, token: Token = None, as_json: AsJson = False) -> None:
    """Show who has the bench."""
    if context.invoked_subcommand is not None:
        return
    with connected(url, token) as bench:
        state = bench.lease_state()
        if as_json:
            print_json(asdict(state))
        else:
            _print_state(state)


@lease.command(context_settings={"allow_interspersed_args": False}, no_args_is_help=True)
def run(
    command: Annotated[list[str], typer.Argument(metavar="COMMAND...", help="What to run, with its arguments.")],
    name: Name = None,
    wait_s: Annotated[float, typer.Option("--wait", help="Ask who has the bench, and wait so long [s].", min=0)] = 0.0,
    on_vanish: Annotated[
        OnVanish | None, typer.Option(help="What happens to moving motors when this command is killed.")
    ] = None,
    url: Url = None,
    token: Token = None,
) -> None:
    """Run a program that has the bench alone: `stepscope lease run -- ./tune.sh`.

    Every stepscope command and Python client in it uses that lease. Ends as the program does, with 6 when another
    session has the bench. Motors are left as the program left them.
    """
    from ..client.lease import SESSION_HEADER, SESSION_VARIABLE

    with connected(url, token) as bench:
        with bench.lease(name or _who(), wait_s=wait_s, on_vanish=on_vanish) as held:
            environment = {**os.environ, SESSION_VARIABLE: held.headers[SESSION_HEADER], "STEPSCOPE_URL": bench.url}
            if token:
                environment["STEPSCOPE_TOKEN"] = token
            ended = _run(command, environment)
        if held.lost is not None:
            typer.secho(f"stepscope: the lease ended before the program: {held.lost}", fg="yellow", err=True)
    raise typer.Exit(ended if ended >= 0 else 128 - ended)


@lease.command()
def ask(
    wait_s: Annotated[float, typer.Option("--wait", help="How long to ask [s].", min=0)] = 60.0,
    name: Name = None,
    url: Url = None,
    token: Token = None,
) -> None:
    """Ask who has the bench to hand it over, and return when it is free; ends with 6 when it is not in time."""
    with connected(url, token) as bench:
        with bench.lease(name or _who(), wait_s=wait_s):
            pass
        typer.echo("the bench is free")


def _run(command: list[str], environment: dict[str, str]) -> int:
    """Run it and wait; Ctrl-C is its to handle, as in a shell."""
    with subprocess.Popen(command, env=environment) as program:
        while True:
            try:
                return program.wait()
            except KeyboardInterrupt:
                continue


def _who() -> str:
    import getpass
    import socket

    try:
        user = getpass.getuser()
    except (OSError, KeyError):  # a container's user without a name
        user = "unknown"
    return f"{user}@{socket.gethostname()}"[:60]


def _print_state(state: LeaseState) -> None:
    if state.state == "free":
        typer.echo("the bench is free")
        return
    rows = [
        ("holder", str(state.holder)),
        ("since", f"{state.since_s or 0:.0f} s"),
        ("expires in", f"{state.expires_in_s or 0:.0f} s, unless kept"),
        ("on vanishing", state.on_vanish),
        ("asking", ", ".join(str(each["name"]) for each in state.asking)),
    ]
    print_table(("", ""), [row for row in rows if row[1]])
