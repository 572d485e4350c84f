"""What a driver knows of an axis beside its state, sorted by what it means: what `app.conditions` judges by."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Literal


@dataclass(frozen=True, slots=True)
class Evidence:
    """What was seen: `what` names the register or figure, `seen_s` is device time [s], None where nobody knows."""

    what: str
    value: str
    seen_s: float | None = None


@dataclass(frozen=True, slots=True)
class Remedy:
    """A call of the REST API that mends something; `path` is behind the device's own address.

    moves : it may set the motor in motion
    """

    label: str
    method: Literal["POST", "PUT", "PATCH"]
    path: str
    body: Mapping[str, object] | None = None
    moves: bool = False


@dataclass(frozen=True, slots=True)
class Sign:
    """One thing that is so: in a plain sentence, by which evidence, and what helps."""

    cause: str
    evidence: tuple[Evidence, ...] = ()
    remedies: tuple[Remedy, ...] = ()


@dataclass(frozen=True, slots=True)
class Signs:
    """Everything that a driver tells of one axis beside its state.

    faults : the motor driver, or the chip, has shut down
    warnings : what it warns of and goes on all the same: told beside whatever the axis does
    blocks : what keeps every command from moving the motor
    stall : a stall stopped it, and holds it
    stalling : its driver tells of a stall right now, and it is stepped on all the same
    holds : what keeps it from going one way
    untrusted : why what the position counter shows may not be true
    resets : how often a reset of the device was seen, that of its power-on included; None where it cannot tell
    takes_encoder : the position can be set to what the encoder shows (`PositionFromEncoder`)
    encoder_apart_s : how long after the position the encoder was read, of the state [s]
    regulated : the motor follows the encoder, so that a deviation is no lost step
    """

    faults: tuple[Sign, ...] = ()
    warnings: tuple[Sign, ...] = ()
    blocks: tuple[Sign, ...] = ()
    stall: Sign | None = None
    stalling: Sign | None = None
    holds: tuple[Sign, ...] = ()
    untrusted: tuple[Sign, ...] = ()
    resets: int | None = None
    takes_encoder: bool = False
    encoder_apart_s: float = 0.0
    regulated: bool = False


NO_SIGNS = Signs()


@dataclass(frozen=True, slots=True)
class EncoderSeen:
    """How an encoder counted against the motor.

    ratio : microsteps that it told a microstep of the motor; below 0 it counts against it
    way : over how far that was seen [microsteps]
    slack : by how much the encoder may be wrong over that way [microsteps]
    external : it is the second one (`AxisState.external_deviation`)
    """

    ratio: float
    way: int
    slack: float
    external: bool = False


def hot(flags: Mapping[str, bool], warned: str, off: str, told: Evidence, who: str = "the driver") -> tuple[Sign, ...]:
    """That a driver warns that it is hot, by the flag `warned`. Not where it is `off` already: then both are set."""
    if not flags.get(warned) or flags.get(off):
        return ()
    return (Sign(f"{who} warns that it is hot: it switches off when it gets much hotter", (told,)),)


def start_up(axis: int) -> Remedy:
    """Set everything that the axis needs to move."""
    return Remedy("start up", "POST", "start-up", {"axes": [axis]})


def clear_flags(axis: int, *, moves: bool = False) -> Remedy:
    """Take notice of what the flag registers keep."""
    return Remedy("clear the flag", "POST", f"axes/{axis}/clear-flags", None, moves)


def write(register: str, axis: int | None, value: int, field: str = "") -> Remedy:
    """Write a register, or one field of it; an axis that waits for it may set off."""
    name = f"{register}.{field}" if field else register
    body: dict[str, object] = {"fields": {field: value}} if field else {"value": value}
    query = "" if axis is None else f"?axis={axis}"
    return Remedy(f"write {name} {value:,}", "PUT", f"registers/{register}{query}", body, moves=True)


def write_all(label: str, writes: Sequence[tuple[str, int | Mapping[str, int]]], axis: int | None) -> Remedy:
    """Write several registers in this order: a whole value, or fields."""
    items = [
        {"name": name, "axis": axis, "value" if isinstance(what, int) else "fields": what} for name, what in writes
    ]
    return Remedy(label, "POST", "registers", {"writes": items}, moves=True)


def zero(register: str, axis: int, value: int | None, seen_s: float | None = None) -> Sign:
    """A register that keeps an axis from moving while it is 0; with `value` it can. None where writing it alone would
    make it turn on and on."""
    helps = (start_up(axis),) if value is None else (start_up(axis), write(register, axis, value))
    return Sign(f"{register} is 0", (Evidence(register, "0", seen_s),), helps)
