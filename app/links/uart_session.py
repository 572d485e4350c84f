"""Questions and answers of chips on a single wire, and how both ends stay in step.

An answer bears the register and no node, so an answer that comes late (out of an adapter's buffer: the chips themselves
answer within milliseconds or never) looks like the answer to the next question for the same register. Hence, as with
TMCL, the line is trusted only as long as everything went as it should. After anything else it is drained until it is
silent, which is also what a chip needs that holds half a datagram (TMC5160A data sheet 1.14, 5.1.1: a pause of 63 bit
times ends it, then 12 of idle line), and the chip is asked for a register that nobody still owes: the fence.

A chip does not answer a write; it counts it in IFCNT. So each write is followed by a reading of IFCNT, which has to
have gone on by one; that reading stands for the answer. A write that did not count has not happened.

On a single wire everything that is sent comes back. With that echo it is taken off and compared with what was sent;
whether there is one, the first fence finds out.

A stop does not wait for a fence. It goes out at once, and whether it counted shows only if the count was known.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from typing import Literal

from ..errors import BadReply, LinkTimeout
from .datagram_uart import IFCNT, WRITE_BIT, UartForm, is_sound
from .incidents import IncidentKind, Incidents
from .line_session import DRAIN_MAX_S, FOREIGN, HEARD_MAX, LineSession
from .port import Answer
from .streams import Stream

Echo = Literal["auto", "on", "off"]
FENCES = (IFCNT, 0x00, 0x04, 0x20, 0x22, 0x2D, 0x6A, 0x6C)
"""Registers that every chip answers and that reading does not change: IFCNT, GCONF, the inputs, RAMPMODE, VACTUAL,
XTARGET, MSCNT, CHOPCONF."""
STOPPING = (0x27 | WRITE_BIT, 0x47 | WRITE_BIT, 0x22 | WRITE_BIT)
"""VMAX of either axis, and VACTUAL of a driver that can be told it: zero in it ends a motion."""
NOBODY = -1
"""Stands for the node of a chip that has none."""


class UartSession(LineSession):
    """One open line of chips whose datagrams are of `form`, whatever its node."""

    def __init__(
        self, name: str, stream: Stream, incidents: Incidents, form: UartForm, echo: Echo, byte_s: float = 0.0
    ) -> None:
        super().__init__(name, stream, incidents, byte_s)
        self.frame_bytes = form.reply_bytes
        self._form = form
        self._with_nodes = form.node is not None
        self._place = form.read_bytes - 2
        """Where a datagram to the chip has its register."""
        self._head = form.reply(0, 0)[:-6]
        self._heads = [self._head + bytes((register,)) for register in range(WRITE_BIT)]
        """What answers begin with, by register."""
        self._echo: bool | None = {"auto": None, "on": True, "off": False}[echo]
        self._echo_given = echo != "auto"
        self._trusted = False
        self._owed: dict[int, None] = {}
        """Registers whose answers have not come and still may, the oldest first; none while in step."""
        self._counts: dict[int, int] = {}
        """IFCNT as last seen, by node."""

    # --- asking ---------------------------------------------------------------------------------

    def ask_all(
        self,
        frames: Sequence[bytes],
        preempted: Callable[[], bool],
        timeout_s: float,
        answer: Answer,
        replies: list[bytes],
        answered_s: list[float],
    ) -> None:
        del answer  # a chip always answers, or is made to
        read, now, place = self._stream.read, time.monotonic, self._place
        clear, send, is_answer = self._stream.clear, self._stream.send, self._is_answer
        is_clear = False
        if self._heard:
            if frames and self._stops(frames[0]):
                self._heard = b""
                self._mistrust_all()
            else:
                self._judge(self._listen(b""))
        for frame in frames:
            if replies and preempted():
                break
            # The common case, as short as it can be: in step, and a reading. Right behind a good answer the line is as
            # clear as it was: whatever came since would spoil the next answer, and is found there.
            if self._trusted and frame[place] < WRITE_BIT and (is_clear or clear()):
                send(frame)
                latest = came = reply = read(timeout_s)
                if self._echo:
                    if came == frame:
                        latest = read(timeout_s)
                        came += latest
                    reply = came[len(frame) :] if came.startswith(frame) else b""
                if not is_answer(frame, reply):
                    # Nothing at all: then the time is up already.
                    reply = self._sort_out(frame, came, timeout_s if latest else 0.0, timeout_s)
                is_clear = True
            else:
                is_clear = False
                stopping = self._stops(frame)
                if self._foreign and not stopping:
                    raise self._not_sent()
                if not self._trusted and not stopping:
                    self._get_in_step(frame, timeout_s)
                    if preempted():
                        break
                reply = self._write(frame, timeout_s) if frame[place] & WRITE_BIT else self._read(frame, timeout_s)
            replies.append(reply)
            answered_s.append(now())
        self._end_of_asking()

    def _read(self, frame: bytes, timeout_s: float) -> bytes:
        self._send(frame)
        return self._sort_out(frame, b"", timeout_s, timeout_s)

    def _write(self, frame: bytes, timeout_s: float) -> bytes:
        """Send `frame` and have it counted: the reading of IFCNT. Raises BadReply where it was not."""
        node = frame[1] if self._with_nodes else NOBODY
        counting = self._question(frame, IFCNT)
        if self._trusted:
            if node not in self._counts:
                self._counts[node] = self._read(counting, timeout_s)[-2]
            before: int | None = self._counts.pop(node)  # unknown again, should anything go wrong on the way
            self._send(frame)
            if self._echo:
                self._take_echo(frame, timeout_s)
        else:  # a stop: it goes before anything else
            before = None
            self._stream.write(frame)
            self._get_in_step(frame, timeout_s, sent=True)
        reply = self._read(counting, timeout_s)
        after = self._counts[node] = reply[-2]
        if before is not None and after != before + 1 & 0xFF:
            raise self._miscounted(frame, reply, after - before & 0xFF)
        return reply

    def _miscounted(self, frame: bytes, reply: bytes, counted: int) -> BadReply:
        why = "it was reset, or another master writes to it" if counted else "what was sent has not arrived"
        text = f"the chip counted {counted} writes instead of 1: {why}"
        self._incidents.add("foreign" if counted else "damaged", f"{text} ({frame.hex(' ')})")
        return BadReply(self._name, text, reply)

    def _send(self, frame: bytes) -> None:
        """Raises BadReply where another master has said something meanwhile; then nothing was sent."""
        unasked = self._stream.read(0)
        if unasked:
            self._judge(self._listen(unasked))
            raise self._not_sent()
        self._stream.write(frame)

    def _take_echo(self, frame: bytes, timeout_s: float) -> None:
        """What comes back of a write. Raises LinkTimeout, BadReply."""
        came = self._gather(b"", len(frame), timeout_s)
        if came != frame:
            raise self._not_the_echo(frame, came, timeout_s)

    def _not_the_echo(self, frame: bytes, came: bytes, timeout_s: float) -> LinkTimeout | BadReply:
        self._mistrust_all()
        self._owed[frame[self._place] & ~WRITE_BIT] = None
        if not came:
            self._incidents.add("timeout", f"no echo of {frame.hex(' ')} in {timeout_s:g} s")
            return LinkTimeout(self._name, timeout_s, f"frame {frame.hex(' ')}, not even its echo")
        text = "the echo differs from what was sent: the wire is disturbed, or two talk at once"
        self._incidents.add("mismatch", f"{text} (got {came.hex(' ')} to {frame.hex(' ')})")
        return BadReply(self._name, text, came)

    def _gather(self, data: bytes, due: int, wait_s: float) -> bytes:
        """`data` and what comes until there are `due` bytes, at the latest in `wait_s` [s]."""
        until_s = time.monotonic() + wait_s
        while len(data) < due:
            more = self._stream.read(max(0.0, until_s - time.monotonic()))
            if not more:
                break
            data += more
        return data

    def _sort_out(self, frame: bytes, data: bytes, wait_s: float, timeout_s: float) -> bytes:
        """The answer to `frame`, which reads, of what has come (`data`) and what comes within `wait_s` [s] from now."""
        echo = len(frame) if self._echo else 0
        data = self._gather(data, echo + self.frame_bytes, wait_s)
        if echo:
            if data[:echo] != frame:
                raise self._not_the_echo(frame, data, timeout_s)
            data = data[echo:]
        if self._is_answer(frame, data):
            return data
        self._mistrust_all()
        self._owed[frame[self._place]] = None  # what came may have been something else's answer, and ours is to come
        if not data:
            self._incidents.add("timeout", f"no answer to {frame.hex(' ')} in {timeout_s:g} s")
            raise LinkTimeout(self._name, timeout_s, f"frame {frame.hex(' ')}")
        kind, text = self._what_is_wrong(frame, data)
        self._incidents.add(kind, f"{text} (got {data.hex(' ')} to {frame.hex(' ')})")
        raise BadReply(self._name, text, data)

    def _is_answer(self, frame: bytes, data: bytes) -> bool:
        """Whether `data` is the whole answer to `frame` and nothing else, undamaged."""
        return data.startswith(self._heads[frame[self._place]]) and len(data) == self.frame_bytes and is_sound(data)

    def _what_is_wrong(self, frame: bytes, data: bytes) -> tuple[IncidentKind, str]:
        if data.startswith(frame):
            return "mismatch", "our own datagram came back: this line has an echo now"
        if len(data) > self.frame_bytes:
            return "foreign", f"{FOREIGN}: {len(data)} bytes instead of {self.frame_bytes}"
        kind: IncidentKind = "mismatch"
        if not self._sound(data):
            kind = "short" if len(data) < self.frame_bytes else "checksum"
        try:
            self._form.data_of(frame[self._place], data)
        except ValueError as error:
            return kind, str(error)
        return kind, "no answer to what was asked"

    def _sound(self, data: bytes) -> bool:
        """Whether `data` is one answer of a chip to the host, undamaged."""
        return len(data) == self.frame_bytes and data.startswith(self._head) and is_sound(data)

    def _question(self, frame: bytes, register: int) -> bytes:
        """A reading of `register` of the chip that `frame` is for."""
        return UartForm(frame[1] if self._with_nodes else None).read(register)

    def _stops(self, frame: bytes) -> bool:
        """Whether `frame` ends a motion."""
        return frame[self._place] in STOPPING and not any(frame[-5:-1])

    # --- listening ------------------------------------------------------------------------------

    def _in_step(self) -> bool:
        return self._trusted

    def _mistrust_all(self) -> None:
        self._trusted = False
        self._to_drain = True

    def _take_unasked(self) -> None:
        """No chip says anything unasked."""

    def _is_owed(self, frame: bytes) -> bool:
        del frame
        return False  # while in step nobody owes anything

    def _sift(self, data: bytes) -> bytes:
        return data[-self.frame_bytes :]

    # --- staying in step ------------------------------------------------------------------------

    def _get_in_step(self, frame: bytes, timeout_s: float, *, sent: bool = False) -> None:
        """Drain, then the fence. Raises LinkTimeout or BadReply; unless `sent` says so, `frame` was not sent then."""
        drained = self._to_drain
        if not sent:
            self._drain()
        owed = list(self._owed)
        register = min(FENCES, key=lambda fence: owed.index(fence) if fence in owed else -1)
        fence = self._question(frame, register)
        self._stream.write(fence)
        until_s, data, came = time.monotonic() + timeout_s, b"", b""
        passed = False
        while True:
            while len(data) >= self.frame_bytes:
                if self._sound(head := data[: self.frame_bytes]):
                    passed = passed or head[-6] == register
                    data = data[self.frame_bytes :]
                else:
                    data = data[1:]  # the echo, old answers and garbage: frames may begin anywhere
            if passed and not data:
                break
            left_s = until_s - time.monotonic()
            if left_s <= -DRAIN_MAX_S or len(came) > HEARD_MAX:
                break
            more = self._stream.read(self.silence_s if passed else max(0.0, left_s))
            if not more:
                break
            came += more
            data += more
        echo = fence in came
        if not passed:
            self._mistrust_all()
            self._owed[register] = None
            who = f"the chip at node {frame[1]}" if self._with_nodes else "the chip"
            text = f"{who} did not answer for register {register:#04x} in {timeout_s:g} s"
            self._incidents.add("out of step", f"{text}{'; only the echo came' if echo else ''}")
            what = f"{who}, asked for register {register:#04x} first; {'only its echo came; ' if echo else ''}"
            raise LinkTimeout(self._name, timeout_s, f"{what}frame {frame.hex(' ')} was {'' if sent else 'not '}sent")
        if data:
            self._mistrust_all()
            self._incidents.add("foreign", f"{FOREIGN}: {data.hex(' ')}")
            raise BadReply(self._name, f"{FOREIGN}: {len(data)} bytes more than the answer", data)
        self._settle_echo(echo, came)
        self._trusted = True
        self._to_drain = False
        self._owed.clear()
        self._counts.clear()  # writes that went wrong may have counted
        if drained:
            self._incidents.add("resync", "in step again")

    def _settle_echo(self, echo: bool, came: bytes) -> None:
        """Raises BadReply where there is none although it was said that there is one, or the other way round."""
        if self._echo_given and echo is not self._echo:
            text = "what is sent comes back: set echo to auto" if echo else "no echo came: set echo to auto"
            self._incidents.add("mismatch", text)
            self._mistrust_all()
            raise BadReply(self._name, text, came)
        self._echo = echo
