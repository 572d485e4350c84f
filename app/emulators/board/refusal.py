"""How the board says no."""

from __future__ import annotations

from ...registers.tmcl.commands import Status


class Refusal(Exception):
    """An answer with another status than 100; `value` is what it bears, by default that of the command."""

    def __init__(self, status: int, value: int | None = None) -> None:
        super().__init__(status)
        self.status, self.value = int(status), value


def wrong_type() -> Refusal:
    """An unknown type, motor, parameter."""
    return Refusal(Status.WRONG_TYPE)


def invalid_value() -> Refusal:
    """A value out of range."""
    return Refusal(Status.INVALID_VALUE)


def invalid_command() -> Refusal:
    """An unknown command, or one that the board in the slot does not have."""
    return Refusal(Status.INVALID_COMMAND)
