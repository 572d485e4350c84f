"""Which TMCL modules of a line are in download mode: they store what they are told instead of doing it.

FM-PD42-1241 3.6.36. Command 132 begins it and 133 ends it; every command below 128 in between becomes a command of the
module's program and is answered with status 101. So whoever asks a module anything on his own has to be silent then, or
his questions overwrite its program and wear its EEPROM. `LinkQueue` asks here about every frame, right before it goes
out, and tells of every answer. Devices on one line share what is known: each of them can send a frame to any address.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from weakref import WeakSet

from ..errors import DownloadMode
from ..registers.tmcl.commands import CONTROL_FIRST, MAGIC, Opcode, Status
from .arbiter import Priority
from .tmcl import FRAME_BYTES, has_plain_reply, sound, stops

RESTARTS = frozenset({Opcode.FACTORY_DEFAULT, Opcode.RESET_MODULE})
"""Commands after which the module is as after power-on, so in no download mode."""


class Downloads:
    """The modules of one line that are in download mode, or may be, by address."""

    def __init__(self) -> None:
        self._why: dict[int, str] = {}
        self._asked: set[int] = set()
        """Modules that were just told to begin, and have not said yet whether they do."""
        self._holds: WeakSet[DownloadHold] = WeakSet()

    @property
    def any(self) -> bool:
        """Whether there is one."""
        return bool(self._why)

    def why(self, address: int) -> str:
        """How the module at `address` came into download mode; empty where it is in none as far as anybody knows."""
        return self._why.get(address, "")

    def stores(self, address: int) -> bool:
        """Whether that module stores commands. May be asked by any thread."""
        return address in self._why

    def asked(self, address: int) -> None:
        """It is about to be told to begin: an answer that is lost must not hide what that did."""
        if not self.stores(address):
            self._asked.add(address)
            self.begin(address, "command 132 was sent to the module")

    def confirmed(self, address: int) -> None:
        """It has begun, as far as anybody knows."""
        self._asked.discard(address)

    def refused(self, address: int) -> None:
        """It has not begun, and stays as it was."""
        if address in self._asked:
            self.end(address)

    def begin(self, address: int, why: str) -> None:
        """It is in download mode."""
        if address not in self._why:
            self._why[address] = why
            self._tell(address)

    def end(self, address: int) -> None:
        """It is in none."""
        self._asked.discard(address)
        if self._why.pop(address, None) is not None:
            self._tell(address)

    def begin_all(self, why: str) -> None:
        """Any module that this server talks to may be in download mode."""
        for hold in tuple(self._holds):
            self.begin(hold.address, why)

    def join(self, hold: DownloadHold) -> None:
        """From now on `hold` is told what becomes of its module."""
        self._holds.add(hold)

    def leave(self, hold: DownloadHold) -> None:
        """It is told nothing more."""
        self._holds.discard(hold)

    def _tell(self, address: int) -> None:
        for hold in tuple(self._holds):
            if hold.address == address:
                hold.on_change()


class DownloadHold:
    """`FrameHold` of one module: in download mode only what its user sends goes out, and what stops its motor.

    on_change : hears that the module at `address` came into download mode, or left it
    address_of : the address of the module that a frame reaches
    """

    def __init__(
        self, downloads: Downloads, address: int, address_of: Callable[[bytes], int], on_change: Callable[[], None]
    ) -> None:
        self.downloads = downloads
        self.address = address
        self.on_change = on_change
        self._address_of = address_of
        downloads.join(self)

    @property
    def problem(self) -> DownloadMode | None:
        """What to tell those who want to ask the module something; None where they may."""
        why = self.downloads.why(self.address)
        return DownloadMode(why) if why else None

    def refuse(self, frames: Sequence[bytes], priority: Priority, by_hand: bool) -> None:
        """Raises DownloadMode where one of `frames`, about to go out, would be stored or is nobody's wish."""
        for frame in frames:
            if len(frame) != FRAME_BYTES:
                continue
            if not by_hand and self.downloads.stores(address := self._address_of(frame)):
                if not (priority is Priority.STOP and stops(frame)):
                    raise DownloadMode(self.downloads.why(address))
            elif frame[1] == Opcode.ENTER_DOWNLOAD and sound(frame):
                self.downloads.asked(self._address_of(frame))

    def saw(self, frames: Sequence[bytes], replies: Sequence[bytes]) -> None:
        """The first of `frames` were answered by `replies`, b"" where there was no answer and need not be one."""
        for frame, reply in zip(frames, replies, strict=False):
            opcode = frame[1]
            if len(reply) == FRAME_BYTES and reply[2] == Status.STORED and reply[3] == opcode and sound(reply):
                if has_plain_reply(frame):
                    self.downloads.begin(
                        self._address_of(frame), f"it answered command {opcode} with status 101: stored, not done"
                    )
            elif opcode >= CONTROL_FIRST:
                if sound(frame):
                    self._saw_control(frame, reply)
            elif self.downloads.any and len(reply) == FRAME_BYTES and reply[2] == Status.OK and sound(reply):
                self.downloads.end(self._address_of(frame))  # it was done, so nothing is stored any more

    def _saw_control(self, frame: bytes, reply: bytes) -> None:
        opcode, address = frame[1], self._address_of(frame)
        done = not reply or reply[2] == Status.OK
        if opcode == Opcode.ENTER_DOWNLOAD:
            if not done:
                self.downloads.refused(address)
                return
            self.downloads.confirmed(address)
            if not reply:
                # Commands to a secondary address (parameter 87) are obeyed and never answered.
                self.downloads.begin_all(
                    f"command 132 was sent to address {address}, where nobody answered: "
                    "it may be the secondary address of this module"
                )
        elif (opcode == Opcode.EXIT_DOWNLOAD and done) or (
            opcode in RESTARTS and done and int.from_bytes(frame[4:8], "big") == MAGIC
        ):
            self.downloads.end(address)
