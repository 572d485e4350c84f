"""How a command says no."""

from __future__ import annotations

from ...registers.tmcl.commands import Status


class Refused(Exception):
    """A command that is answered with an error status (FM-PD42-1241 3.2.1) and has changed nothing."""

    def __init__(self, status: Status) -> None:
        super().__init__(status.name)
        self.status = status


def wrong_type() -> Refused:
    """No such parameter, port, coordinate or operation, or one that cannot be written."""
    return Refused(Status.WRONG_TYPE)


def invalid_value() -> Refused:
    """Motor or value out of range. Whether the module clips a value instead is open: here it is refused."""
    return Refused(Status.INVALID_VALUE)
