"""Commands that pass a call on as it is: `calc`, `api`."""

from __future__ import annotations

from typing import Annotated

import typer

from .shared import Token, Url, connected, json_object, print_json


def calc(
    subject: Annotated[str, typer.Argument(help="pmul-pdiv, units, ramp, microstep-table, driver-chain, ...")],
    values: Annotated[list[str] | None, typer.Argument(metavar="NAME=VALUE...", help="JSON values, or words.")] = None,
    url: Url = None,
    token: Token = None,
) -> None:
    """Ask a calculator: `stepscope calc pmul-pdiv chip=tmc428 a_max=500 ramp_div=7 pulse_div=5`."""
    with connected(url, token) as bench:
        print_json(bench.calc(subject, **json_object(values or [])))


def api(
    method: Annotated[str, typer.Argument(help="GET, POST, PUT, PATCH or DELETE")],
    path: Annotated[str, typer.Argument(help="Behind /api/v1, e.g. devices/bench/profile")],
    values: Annotated[list[str] | None, typer.Argument(metavar="NAME=VALUE...", help="JSON values, or words.")] = None,
    url: Url = None,
    token: Token = None,
) -> None:
    """Make any call of the REST API and print its answer."""
    with connected(url, token) as bench:
        print_json(bench.call(method, path, json_object(values) if values else None))
