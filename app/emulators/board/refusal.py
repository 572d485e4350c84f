"""How the board says no."""

from __future__ import annotations

from app.registers.landungsbruecke import BoardStatus
from app.registers.tmcl import Status


class Refusal(Exception):
    """An answer with another status than 100."""

    def __init__(self, status: Status | BoardStatus) -> None:
        super().__init__(status)
        self.status = int(status)


def wrong_type() -> Refusal:
    """An unknown type, motor, parameter."""
    return Refusal(Status.WRONG_TYPE)


def invalid_value() -> Refusal:
    """A value out of range."""
    return Refusal(Status.INVALID_VALUE)


def invalid_command() -> Refusal:
    """An unknown command, or one that the board in the slot does not have."""
    return Refusal(Status.INVALID_COMMAND)
