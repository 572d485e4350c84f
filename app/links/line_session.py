"""What talking over a stream of bytes has in common, whatever the frames: silence, bytes unasked, and their judgement.

A line is one thread's. In step means that whatever comes next is the answer to what is asked next. What was heard while
nobody asked is judged before the next question goes out: old answers are dropped, anything else is another master's.
"""

from __future__ import annotations

import time
from abc import ABC, abstractmethod
from collections.abc import Callable, Sequence

from ..errors import BadReply
from .incidents import Incidents
from .port import Answer
from .streams import Stream

SILENCE_BYTES = 20
"""So many byte times without a byte are silence: two frames, a bit more than any pause inside one."""
SILENCE_MIN_S = 0.003
DRAIN_MAX_S = 0.5
"""A line that does not fall silent for so long has another master on it [s]."""
HEARD_MAX = 16 * 1024
"""So many bytes of what nobody asked for are looked at [bytes]; a line that says more is not worth more time."""
FOREIGN = "another master talks on the line"


class LineSession(ABC):
    """One open line. For its thread only. `byte_s` is the time of a byte [s]; `frame_bytes` that of a whole answer."""

    frame_bytes: int

    def __init__(self, name: str, stream: Stream, incidents: Incidents, byte_s: float = 0.0) -> None:
        self.silence_s = max(SILENCE_MIN_S, SILENCE_BYTES * byte_s)
        self._name = name
        self._stream = stream
        self._incidents = incidents
        self._to_drain = False
        self._heard = b""
        """Came while nobody asked, and is not yet judged."""
        self._foreign = ""
        """What was heard that nobody can have asked for; the next question fails with it."""
        self.wanted: Callable[[], bool] = _never
        """Whether a caller waits to ask: then nothing more is listened to than is there."""

    @abstractmethod
    def ask_all(
        self,
        frames: Sequence[bytes],
        preempted: Callable[[], bool],
        timeout_s: float,
        answer: Answer,
        replies: list[bytes],
        answered_s: list[float],
    ) -> None:
        """Ask `frames` in a row until `preempted`, appending to `replies` and, in `time.monotonic`, to `answered_s`.

        Raises LinkTimeout, BadReply, and OSError where the line has gone.
        """

    # --- what a kind of frames knows ----------------------------------------------------------------

    @abstractmethod
    def _in_step(self) -> bool:
        """Whether anybody is trusted."""

    @abstractmethod
    def _mistrust_all(self) -> None:
        """Whatever comes next may be old, from anybody."""

    @abstractmethod
    def _is_owed(self, frame: bytes) -> bool:
        """Whether `frame`, heard unasked, is an answer that is owed to an earlier question."""

    @abstractmethod
    def _sift(self, data: bytes) -> bytes:
        """`data` that is thrown away as the line is drained, without the whole frames that it begins with."""

    @abstractmethod
    def _take_unasked(self) -> None:
        """Take out of what was heard the frames that may come unasked."""

    # --- listening ----------------------------------------------------------------------------------

    @property
    def hears_half(self) -> bool:
        """Whether something came that more may belong to."""
        return bool(self._heard)

    def hear(self, data: bytes) -> None:
        """Something came while nobody asked; b"" when nothing came for `silence_s` [s]."""
        self._heard = (self._heard + data)[-HEARD_MAX:]
        self._take_unasked()
        if self.wanted():
            return  # whoever asks next judges it
        if self._heard and (not data or len(self._heard) >= self.frame_bytes):
            self._judge(self._listen(b""))

    def _listen(self, data: bytes) -> bytes:
        """What was heard that may not come unasked, to its end."""
        self._heard += data
        self._take_unasked()
        until_s = time.monotonic() + DRAIN_MAX_S
        while self._heard and time.monotonic() < until_s:
            more = self._stream.read(self.silence_s)
            if not more:
                break
            self._heard = (self._heard + more)[-HEARD_MAX:]
            self._take_unasked()
        heard, self._heard = self._heard, b""
        return heard

    def _judge(self, heard: bytes) -> None:
        """Say what unasked bytes are: an old answer, noise on a line that is out of step anyway, or another master."""
        if not heard:
            return
        foreign = 0
        if self._in_step():
            for at in range(0, len(heard), self.frame_bytes):
                frame = heard[at : at + self.frame_bytes]
                foreign += 0 if self._is_owed(frame) else len(frame)
        if not foreign:
            self._to_drain = True
            self._incidents.add("late", f"thrown away: {heard[:64].hex(' ')}")
            return
        self._mistrust_all()
        self._foreign = f"{FOREIGN}: {foreign} bytes that nobody asked for"
        self._incidents.add("foreign", f"{self._foreign}: {heard[:64].hex(' ')}")

    def _not_sent(self) -> BadReply:
        text, self._foreign = self._foreign or FOREIGN, ""
        return BadReply(self._name, f"{text}; the command was not sent", b"")

    def _end_of_asking(self) -> None:
        """Look once more, right behind the last answer. Raises BadReply where another master is on the line."""
        unasked = self._stream.read(0)
        if unasked:
            self._judge(self._listen(unasked))
            if self._foreign:
                text, self._foreign = self._foreign, ""
                raise BadReply(self._name, text, unasked)

    def _drain(self) -> None:
        """Read until the line is silent. Raises BadReply where it never is."""
        until_s = time.monotonic() + DRAIN_MAX_S
        data, self._heard = self._heard, b""
        sifted = 0
        while more := self._stream.read(self.silence_s):
            sifted += len(more)
            data = self._sift(data + more) if sifted <= HEARD_MAX else b""
            if time.monotonic() > until_s:
                self._incidents.add("foreign", f"{FOREIGN}: it does not fall silent")
                raise BadReply(self._name, f"{FOREIGN}: it does not fall silent", data)
        self._to_drain = False


def _never() -> bool:
    return False
