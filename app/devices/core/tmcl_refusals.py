"""From a module's status codes to errors that say what was wrong, what is allowed and what to do."""

from __future__ import annotations

from ...errors import (
    BadReply,
    BenchError,
    DownloadMode,
    LinkError,
    LinkTimeout,
    OutOfRange,
    UnknownParameter,
    WrongState,
)
from ...links.tmcl import Reply, Request
from ...registers.model import Register
from ...registers.tmcl.commands import Status
from .tmcl_frames import spelled


def limits(register: Register, unit_mode: int | None) -> tuple[int, int]:
    """What is allowed while unit mode (AP 255) is as given; None, not known, counts as pps."""
    if unit_mode == 0 and register.internal_range is not None:
        return register.internal_range
    return register.minimum, register.maximum


def unit_of(register: Register, unit_mode: int | None) -> str:
    """The unit that the register's numbers count in."""
    return "driver chip units" if unit_mode == 0 and register.internal_range is not None else register.unit


def refusal(
    request: Request, reply: Reply, register: Register | None = None, unit_mode: int | None = None
) -> BenchError:
    """The error for an answer whose status is one. `register` is the row that `request` is about, if there is one."""
    what = spelled(request) if register is None else f"{register.name} ({register.alias})"
    match reply.status:
        case Status.STORED:
            return DownloadMode(f"it answered {what} with status {Status.STORED}: stored, not done")
        case Status.INVALID_COMMAND:
            return WrongState(f"the module does not know {spelled(request)}", "its firmware may be another version")
        case Status.WRONG_TYPE:
            return UnknownParameter(
                f"the module refused {what}: it has no such parameter, port or type",
                "its firmware may be another version: see command 136",
            )
        case Status.INVALID_VALUE if register is not None:
            low, high = limits(register, unit_mode)
            hint = register.write_note or register.help
            unit = unit_of(register, unit_mode)
            return OutOfRange(register.name, request.value, low, high, f"{unit + '; ' if unit else ''}{hint}")
        case Status.INVALID_VALUE:
            return OutOfRange(f"value of {what}", request.value, None, None, "the module refused value or motor")
        case Status.EEPROM_LOCKED:
            return WrongState(f"{what}: the module's EEPROM is locked", "unlock the configuration first (GP 0, 73)")
        case Status.NOT_AVAILABLE:
            return WrongState(
                f"{what} is not available now", "a program or a download may be under way: see GP 0, 128 and 129"
            )
        case _:
            return WrongState(f"{what} was answered with status {reply.status} ({reply.status_text})")


def uncertain(error: LinkError, what: str) -> LinkError:
    """`error` on the way of a command that moves a motor: nobody knows whether it was done, and it is not repeated."""
    warning = f"{what} may or may not have been done and is not sent again: look at the axis, or stop it"
    if isinstance(error, LinkTimeout):
        return LinkTimeout(error.link, error.waited_s, f"{error.what}; {warning}")
    message = str(error).removeprefix(f"{error.link}: ")
    if isinstance(error, BadReply):
        return BadReply(error.link, f"{message}; {warning}", error.reply)
    return type(error)(error.link, f"{message}; {warning}")
