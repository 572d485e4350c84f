"""What the shell completes: names of devices, registers, channels and recordings, asked of the bench where one answers.

Whoever presses Tab waits: the server gets half a second, and where none answers nothing is completed.
"""

from __future__ import annotations

import contextlib
from collections.abc import Callable, Iterable, Iterator
from typing import TYPE_CHECKING, Any

import typer

if TYPE_CHECKING:
    from ..client import Bench

WITHIN_S = 0.5


def complete_device(ctx: typer.Context, incomplete: str) -> list[str]:
    """Devices of the bench."""
    return list(_found(ctx, incomplete, lambda bench: (device.id for device in bench.devices())))


def complete_register(ctx: typer.Context, incomplete: str) -> list[str]:
    """Registers, parameters and their fields, of the device that is named before."""
    return list(_found(ctx, incomplete, lambda bench: _names(bench, ctx)))


def complete_assignment(ctx: typer.Context, incomplete: str) -> list[str]:
    """The same with the equals sign behind which the value goes; behind that, names of a field's values."""
    name, equals, _ = incomplete.partition("=")
    if not equals:
        return [f"{name}=" for name in complete_register(ctx, incomplete)]
    return list(_found(ctx, incomplete, lambda bench: (f"{name}={value}" for value in _values(bench, ctx, name))))


def complete_channel(ctx: typer.Context, incomplete: str) -> list[str]:
    """Telemetry channels of the device that is named before, without those that stand there already."""
    said = set(ctx.params.get("channels") or ())
    found = _found(ctx, incomplete, lambda bench: (each["name"] for each in _device(bench, ctx)["channels"]))
    return [name for name in found if name not in said]


def complete_profile(ctx: typer.Context, incomplete: str) -> list[str]:
    """Numbers of kept profiles, the latest first."""
    return list(_found(ctx, incomplete, lambda bench: (str(profile.id) for profile in bench.profiles())))


def _found(ctx: typer.Context, incomplete: str, ask: Callable[[Bench], Iterable[str]]) -> Iterator[str]:
    from ..client import Bench, ClientError

    # Anything else that goes wrong would be a traceback in the middle of the user's command line.
    with (
        contextlib.suppress(ClientError, ValueError, KeyError, OSError),
        Bench(ctx.params.get("url"), token=ctx.params.get("token"), timeout_s=WITHIN_S) as bench,
    ):
        wanted = incomplete.casefold()
        yield from (name for name in ask(bench) if name.casefold().startswith(wanted))


def _device(bench: Bench, ctx: typer.Context) -> Any:
    return bench.call("GET", f"devices/{ctx.params['device']}")


def _catalog(bench: Bench, ctx: typer.Context) -> list[Any]:
    rows: list[Any] = bench.call("GET", f"catalog/{_device(bench, ctx)['model']}")["rows"]
    return rows


def _names(bench: Bench, ctx: typer.Context) -> Iterable[str]:
    rows = _catalog(bench, ctx)
    parts = (f"{row['name']}.{part['name']}" for row in rows for part in row["fields"])
    return dict.fromkeys((*(row["name"] for row in rows), *parts))  # two axes have a row each; the sheet's order stays


def _values(bench: Bench, ctx: typer.Context, name: str) -> Iterable[str]:
    """Names of the values of REGISTER.FIELD."""
    register, _, wanted = name.casefold().partition(".")
    parts = (part for row in _catalog(bench, ctx) if row["name"].casefold() == register for part in row["fields"])
    return next((part["values"].values() for part in parts if part["name"].casefold() == wanted), ())
