"""A pseudo terminal whose far side bears a name of our choice: to its clients, a serial port."""

from __future__ import annotations

import contextlib
import os
import secrets
import termios
import tty
from pathlib import Path

from .ends import READ_BYTES, Watch
from .line import Line

BAUD_OF = {
    getattr(termios, name): int(name[1:]) for name in dir(termios) if name.startswith("B") and name[1:].isdecimal()
}
"""Speed codes of the terminal interface to bits a second; code 0 hangs up and stands for no speed."""


CODE_OF = {baud: code for code, baud in BAUD_OF.items()}


class PtyEnd:
    """`path` is a symbolic link to a pty while the line is plugged. A link that is there is replaced.

    We keep the far side open ourselves, so that it stays raw and readable between two clients. With a
    modelled baud rate the port starts at that speed; bytes that a client sends at another one are noise
    to the module, and lost.
    """

    def __init__(self, path: Path) -> None:
        self._path = path
        self._line: Line | None = None
        self._watch: Watch | None = None
        self._near = self._far = -1
        self._target = ""

    @property
    def name(self) -> str:
        return f"pty {self._path}"

    def plug(self, line: Line, watch: Watch) -> None:
        """Raises FileExistsError where something else than a link is at the path, OSError without a folder."""
        if self._path.exists() and not self._path.is_symlink():
            raise FileExistsError(f"{self._path} is there already and is no link; choose another path")
        self._near, self._far = os.openpty()
        try:
            tty.setraw(self._far)
            _set_speed(self._far, line.baud)
            os.set_blocking(self._near, False)
            self._target = os.ttyname(self._far)
            self._link()
        except OSError:
            self._shut()
            raise
        self._line, self._watch = line, watch
        line.join(self)
        watch(self._near, self._readable)

    def unplug(self) -> None:
        if self._line is None or self._watch is None:
            return
        self._watch(self._near, None)
        self._line.leave(self)
        self._line = self._watch = None
        # Only our own link: another emulator may have taken the path over.
        if self._path.is_symlink() and os.readlink(self._path) == self._target:
            self._path.unlink()
        self._shut()

    def close(self) -> None:
        self.unplug()

    def send(self, data: bytes) -> None:
        with contextlib.suppress(BlockingIOError):  # nobody has read the last four kilobytes
            os.write(self._near, data)

    def _readable(self, now_s: float) -> None:
        if self._line is None:
            return  # unplugged between the look at the descriptor and now
        try:
            data = os.read(self._near, READ_BYTES)
        except BlockingIOError:
            return
        if self._line.baud is not None and self._speed() not in (None, self._line.baud):
            return
        self._line.feed(self, data, now_s)

    def _speed(self) -> int | None:
        """Bits a second that the client has set; None for a speed without a code."""
        return BAUD_OF.get(termios.tcgetattr(self._far)[5])

    def _link(self) -> None:
        # Made aside and moved into place: whoever looks finds the old port or the new one, never nothing.
        aside = self._path.with_name(f".{self._path.name}.{secrets.token_hex(4)}")
        aside.symlink_to(self._target)
        try:
            aside.replace(self._path)
        except OSError:
            aside.unlink()
            raise

    def _shut(self) -> None:
        os.close(self._near)
        os.close(self._far)
        self._near = self._far = -1


def _set_speed(descriptor: int, baud: int | None) -> None:
    """For clients that take the port as it is."""
    if baud in CODE_OF:
        settings = termios.tcgetattr(descriptor)
        settings[4] = settings[5] = CODE_OF[baud]
        termios.tcsetattr(descriptor, termios.TCSANOW, settings)
