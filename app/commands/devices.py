"""Commands about connections and their registers: `devices`, `read`, `write`."""

from __future__ import annotations

from dataclasses import asdict
from typing import Annotated

import typer

from .completion import complete_assignment, complete_register
from .shared import AnyAxis, AsJson, DeviceName, Token, Url, connected, print_json, print_table


def devices(url: Url = None, token: Token = None, as_json: AsJson = False) -> None:
    """List what is connected."""
    with connected(url, token) as bench:
        found = bench.devices()
        if as_json:
            print_json([asdict(device) for device in found])
            return
        print_table(
            ("id", "model", "axes", "state", "link", "conditions"),
            [
                (
                    each.id,
                    each.title,
                    str(len(each.axes)),
                    each.state,
                    str(each.link.get("kind", "")),
                    ", ".join(axis["condition"]["kind"] for axis in each.axes),
                )
                for each in found
            ],
        )
        for each in found:
            for note in each.notes:
                typer.secho(f"stepscope: {each.id}: {note}", fg="yellow", err=True)


def conditions(url: Url = None, token: Token = None, as_json: AsJson = False) -> None:
    """Say of every axis what is so, why, and what helps."""
    with connected(url, token) as bench:
        found = bench.conditions()
        if as_json:
            print_json([asdict(each) for each in found])
            return
        print_table(
            ("device", "axis", "condition", "cause", "referenced", "remedy"),
            [
                (
                    each.device,
                    str(each.axis),
                    each.condition.kind,
                    each.condition.cause,
                    {True: "yes", False: "no", None: "not known"}[each.referenced],
                    ", ".join(remedy["label"] for remedy in each.condition.remedies),
                )
                for each in found
            ],
        )


def read(
    device: DeviceName,
    registers: Annotated[
        list[str] | None,
        typer.Argument(
            metavar="REGISTER...", help="Registers or fields; none: all of them.", autocompletion=complete_register
        ),
    ] = None,
    axis: AnyAxis = None,
    group: Annotated[list[str] | None, typer.Option(help="Without names: only these groups of registers.")] = None,
    url: Url = None,
    token: Token = None,
    as_json: AsJson = False,
) -> None:
    """Read registers, parameters or fields from the device itself."""
    with connected(url, token) as bench:
        if registers:
            found = [bench.read(device, name, axis) for name in registers]
        else:
            found = bench.read_all(device, axis, group or ())
        if as_json:
            print_json([asdict(reading) for reading in found])
            return
        print_table(
            ("register", "axis", "value", "unit", "fields"),
            [
                (
                    each.name,
                    "" if each.axis is None else str(each.axis),
                    str(each.value),
                    each.unit,
                    " ".join(f"{name}={value}" for name, value in each.fields.items()),
                )
                for each in found
            ],
        )


def write(
    device: DeviceName,
    assignments: Annotated[
        list[str],
        typer.Argument(
            metavar="NAME=VALUE...",
            help="REGISTER=1200, FIELD=3, REGISTER.FIELD=name; 0x... is hex.",
            autocompletion=complete_assignment,
        ),
    ],
    axis: AnyAxis = None,
    url: Url = None,
    token: Token = None,
    as_json: AsJson = False,
) -> None:
    """Write registers in the order given; each is read back. The first that fails ends it."""
    with connected(url, token) as bench:
        writes = [_assignment(text) for text in assignments]  # all are understood before the first is sent
        done = []
        for name, value in writes:
            register, _, part = name.partition(".")
            done.append(bench.write(device, register, {part: value} if part else _whole(name, value), axis))
            if not as_json:
                each = done[-1]
                check = {True: "verified", False: "NOT VERIFIED", None: "not verifiable"}[each.verified]
                note = f": {each.note}" if each.note else ""
                typer.echo(f"{each.name} = {each.value} {each.unit}".rstrip() + f"  ({check}{note})")
        if as_json:
            print_json([asdict(each) for each in done])


def _assignment(text: str) -> tuple[str, int | str]:
    """NAME=VALUE. Raises ValueError."""
    name, equals, value = text.partition("=")
    if not equals or not name.strip() or not value.strip():
        raise ValueError(f"what to write is NAME=VALUE, not {text!r}")
    try:
        return name.strip(), int(value, 0)
    except ValueError:
        return name.strip(), value.strip()


def _whole(name: str, value: int | str) -> int:
    if isinstance(value, str):
        raise ValueError(f"{name} is a number; names of values go to a field: {name}.FIELD={value}")  # noqa: TRY004
    return value
