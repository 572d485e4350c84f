"""What can go wrong between us and a chip. A class exists where a caller would act differently.

BenchError
+-- LinkError               the wire or the adapter
|   +-- LinkDown            not open, refused, unplugged: reconnect first
|   +-- LinkTimeout         no reply in time: a read may be asked again, a write may have happened
|   +-- BadReply            a reply came and is wrong: length, checksum, echo
+-- StoreUnavailable        what has to be kept cannot be: disk full, no permission, file of a newer version
+-- UsageError              we were asked for what cannot be
    +-- UnknownThing        no such device, axis, register, channel
    +-- OutOfRange          a value outside what is allowed
    +-- SoftLimit           a value beyond what the user allows the axis: nothing was sent
    +-- WrongState          right request, wrong moment (mode, not connected, busy)
        +-- DownloadMode    a module stores commands instead of doing them: nobody asks it anything
        +-- OtherModel      another chip or module answers than the connection says: it is only read and stopped
        +-- UnknownParameter    the firmware of a module has no such parameter, port or type
        +-- CannotMove      an axis is not set up so that any command could move it: a start-up is the cure
        +-- WriteRefused    the chip did not take a write: the read-back differs
"""

from __future__ import annotations

from .number_text import plain


class BenchError(Exception):
    """Root of everything that stepscope raises on purpose. Text is for people, attributes for code."""


class LinkError(BenchError):
    """The wire or the adapter failed."""

    def __init__(self, link: str, message: str) -> None:
        super().__init__(f"{link}: {message}")
        self.link = link


class LinkDown(LinkError):
    """The port is not open, was refused, or went away."""


class LinkTimeout(LinkError):
    """No reply in time. What was asked may or may not have happened."""

    def __init__(self, link: str, waited_s: float, what: str) -> None:
        super().__init__(link, f"no reply to {what} in {waited_s:g} s")
        self.waited_s = waited_s
        self.what = what


class BadReply(LinkError):
    """A reply came and is wrong."""

    def __init__(self, link: str, message: str, reply: bytes) -> None:
        super().__init__(link, f"{message} (got {reply.hex(' ') or 'nothing'})")
        self.reply = reply


class StoreUnavailable(BenchError):
    """The database takes or gives nothing now. The bench works all the same."""

    def __init__(self, reason: str, way_out: str) -> None:
        super().__init__(reason)
        self.way_out = way_out


class UsageError(BenchError):
    """We were asked for what cannot be."""


class UnknownThing(UsageError):
    """No such device, axis, register or channel. `known` lists what there is, `more` says how there may be more."""

    def __init__(self, kind: str, name: str, known: list[str] | None = None, more: str = "") -> None:
        hint = f"; known: {', '.join(known[:12])}{', ...' if len(known) > 12 else ''}" if known else ""
        super().__init__(f"no {kind} is called {name!r}{hint}{'; ' + more if more else ''}")
        self.kind, self.name, self.known = kind, name, known or []


class UnreadableModel(UsageError):
    """A model that an installed package lists, and that cannot be read as one."""


class OutOfRange(UsageError):
    """A value outside what is allowed."""

    def __init__(self, name: str, value: object, minimum: float | None, maximum: float | None, hint: str = "") -> None:
        allowed = f"{_plain(minimum)}..{_plain(maximum)}"
        super().__init__(f"{name} is {value}, allowed is {allowed}{'; ' + hint if hint else ''}")
        self.name, self.value, self.minimum, self.maximum, self.hint = name, value, minimum, maximum, hint


def _plain(limit: float | None) -> str:
    """A limit as a user would type it: whole numbers in full."""
    if limit is None:
        return ""
    return str(limit) if isinstance(limit, int) else plain(limit, 10)


class SoftLimit(UsageError):
    """Beyond what the user allows an axis. Nothing of the request was sent.

    `quantity` is "position", "velocity", "acceleration" or "current"; `wanted` and `limit` are in `unit`.
    """

    def __init__(
        self, quantity: str, wanted: float, limit: float, axis: int, unit: str, what: str = "", way_out: str = ""
    ) -> None:
        by = f" ({what})" if what else ""
        super().__init__(
            f"{quantity} of axis {axis}{by} would be {_plain(wanted)} {unit}, its soft limit is {_plain(limit)} {unit}"
        )
        self.quantity, self.wanted, self.limit, self.axis, self.unit = quantity, wanted, limit, axis, unit
        self.what, self.way_out = what, way_out or "stay within it, or change the limits of this axis"


class WrongState(UsageError):
    """The request is right, the moment is not. `way_out` says what to do."""

    def __init__(self, message: str, way_out: str = "") -> None:
        super().__init__(f"{message}{'; ' + way_out if way_out else ''}")
        self.way_out = way_out


class DownloadMode(WrongState):
    """A TMCL module stores commands as its program instead of doing them."""

    def __init__(self, why: str) -> None:
        super().__init__(
            f"download mode: polling paused, because the module stores commands instead of doing them ({why})",
            "leave download mode (command 133) when the program is loaded; a stop does that by itself, and then stops",
        )


class OtherModel(WrongState):
    """Another chip or module answers than the connection says.

    model : of the connection. found : models that it may be, as far as known; the first one's stop stops it. foreign :
    its registers are others, so that a stop of the connection's model would write anything
    """

    def __init__(self, message: str, model: str, found: tuple[str, ...] = (), *, foreign: bool = False) -> None:
        change = f"change the model of this connection to {' or '.join(name.upper() for name in found)}"
        stopped = bool(found) or not foreign
        look = "choose the connection of another model, or check the wiring"
        super().__init__(
            f"{message}; it is only read{' and stopped' if stopped else ', and stepscope cannot stop it'}",
            change if found else look if stopped else f"to stop it, cut its power; then {look}",
        )
        self.model, self.found, self.foreign = model, found, foreign

    @property
    def same_stop(self) -> bool:
        """Whether a stop of the connection's model is the one to try: of a module that nobody knows, say."""
        return not (self.found or self.foreign)


class UnknownParameter(WrongState):
    """The firmware of a module has no such parameter, port or type."""


class CannotMove(WrongState):
    """An axis is not set up so that any command could move it, as after power-on: a start-up is the cure."""

    def __init__(self, message: str, way_out: str, axis: int) -> None:
        super().__init__(message, f"{way_out}, or start it up (POST .../start-up)")
        self.axis = axis


class WriteRefused(WrongState):
    """The chip did not take a write: the read-back differs. Values are raw register words."""

    def __init__(self, register: str, written: int, read_back: int, why: str = "") -> None:
        super().__init__(f"{register}: wrote {written:#x}, the chip holds {read_back:#x}", why)
        self.register, self.written, self.read_back = register, written, read_back
