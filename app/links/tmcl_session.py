"""Questions and answers of TMCL over a stream of bytes, and how both ends stay in step.

The wire has no sequence numbers, so an answer that comes late looks like the answer to the next
question. Hence a module is trusted only as long as everything went as it should. After anything else
(silence, half an answer, a wrong checksum, an answer to something else) the line is drained until it is
silent, and the module is asked something harmless. Modules answer in order: whatever comes before that
answer is old and thrown away. Answers bear the number of the command, so the harmless question is one
whose number no answer that is still owed can have: neither to what was asked before, nor to an earlier such
question. Only then comes the next question. This is called the fence.

A stop does not wait for a fence. It goes out at once, and the answer may be that to an earlier stop.

Bytes that nobody asked for, while all is well, mean that another master talks on the line; then no
answer can be trusted to be ours. What was asked fails and says so. Nothing is ever sent twice here.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence

from ..errors import BadReply, LinkTimeout
from ..registers.evaluation_board import BoardOpcode
from ..registers.tmcl.commands import CONTROL_FIRST, Opcode, Status
from .incidents import IncidentKind, Incidents
from .line_session import DRAIN_MAX_S, FOREIGN, HEARD_MAX, LineSession
from .port import Answer
from .streams import Stream
from .tmcl import FRAME_BYTES, Request, check_reply, has_plain_reply, is_event, sound, stops

FENCES = {
    Opcode.GET_VERSION: 1,
    Opcode.GET_STATUS: 0,
    Opcode.GIO: 0,
    Opcode.GGP: 0,
    Opcode.GAP: 1,
}
"""Commands that change nothing whatever the module, and their types: each a fence against answers to the others.
That a module does not know one of them is an answer too."""
_REGISTERS = frozenset({BoardOpcode.WRITE_MC, BoardOpcode.WRITE_DRV, BoardOpcode.READ_MC, BoardOpcode.READ_DRV})
"""Commands beyond the usual ones that are always answered plainly."""
PAD_WAIT_S = 0.05
"""How long a board has to say that padding made a frame full [s]."""


class TmclSession(LineSession):
    """One open line of TMCL modules. `tell_event` gets each event frame; `stores` tells whether the module at an
    address is in download mode, where every question but a control command would become part of its program."""

    frame_bytes = FRAME_BYTES

    def __init__(
        self,
        name: str,
        stream: Stream,
        incidents: Incidents,
        tell_event: Callable[[bytes], None],
        byte_s: float = 0.0,
        stores: Callable[[int], bool] = lambda _: False,
    ) -> None:
        super().__init__(name, stream, incidents, byte_s)
        self._tell_event = tell_event
        self._stores = stores
        self._trusted: set[int] = set()
        """Addresses that are in step. Nobody is at first: a module may owe an answer to whoever was here before."""
        self._owed: dict[int, dict[int, None]] = {}
        """Commands that each address has not answered and still may, the oldest first."""

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
        read, write, trusted, now = self._stream.read, self._stream.write, self._trusted, time.monotonic
        clear, send = self._stream.clear, self._stream.send
        always = answer is Answer.ALWAYS
        if self._heard:
            if frames and stops(frames[0]):
                self._throw_away()
            else:
                self._judge(self._listen(b""))
        for frame in frames:
            if replies and (preempted() or _was_stored(replies[-1])):
                break  # in download mode the next frame would be stored too: whoever asks has to be told first
            address, opcode = frame[0], frame[1]
            # The common case, as short as it can be: in step, a plain answer, in one piece, and right.
            if always and address in trusted and (opcode < Opcode.STOP_APPLICATION or opcode in _REGISTERS):
                if clear():
                    send(frame)
                else:
                    unasked = read(0)
                    if unasked and stops(frame):
                        self._throw_away()
                    elif unasked:
                        self._judge(self._listen(unasked))
                        if address not in trusted:
                            raise self._not_sent()
                    write(frame)
                reply = read(timeout_s)
                if (
                    len(reply) == FRAME_BYTES
                    and reply[3] == opcode
                    and reply[1] == address
                    and reply[2] != Status.WRONG_CHECKSUM
                    and reply[8] == sum(reply[:8]) & 0xFF
                ):
                    replies.append(reply)
                    answered_s.append(now())
                    continue
                # Nothing at all: then the time is up already.
                reply = self._sort_out(frame, reply, timeout_s if reply else 0.0, timeout_s, answer)
            else:
                if self._foreign and not stops(frame):
                    raise self._not_sent()
                if address not in trusted and not stops(frame):
                    self._get_in_step(frame, timeout_s)
                    if preempted():
                        break
                unasked = read(0)
                if unasked and stops(frame):
                    self._throw_away()
                elif unasked:
                    self._judge(self._listen(unasked))
                    if self._foreign:
                        raise self._not_sent()
                write(frame)
                reply = self._sort_out(
                    frame, b"", self.silence_s if answer is Answer.NEVER else timeout_s, timeout_s, answer
                )
            replies.append(reply)
            answered_s.append(now())
        self._end_of_asking()

    def _sort_out(self, frame: bytes, data: bytes, wait_s: float, timeout_s: float, answer: Answer) -> bytes:
        """Find the answer to `frame` in what has come (`data`) and what comes within `wait_s` [s] from now.

        b"" where there is none and need not be. `timeout_s` [s] is what errors tell.
        """
        read = self._stream.read
        until_s = time.monotonic() + wait_s
        stopping = frame[0] not in self._trusted and stops(frame)
        found: bytes | None = None
        heard = 0
        while True:
            while len(data) >= FRAME_BYTES and not (stopping and found is not None):
                head, rest = data[:FRAME_BYTES], data[FRAME_BYTES:]
                if is_event(head):
                    self._tell_event(head)
                elif self._is_old(head, frame):
                    self._incidents.add("late", f"an answer that came too late was thrown away: {head.hex(' ')}")
                elif found is None and self._is_answer(frame, head):
                    found = head
                elif stopping and found is None:
                    rest = data[1:]  # out of step, so frames may begin anywhere
                else:
                    raise self._wrong(frame, data, found)
                data = rest
            if found is not None and (stopping or not data):
                break
            left_s = until_s - time.monotonic()
            if left_s <= -DRAIN_MAX_S or heard > HEARD_MAX:
                break  # it has not fallen silent, and will not
            more = read(self.silence_s if found is not None else max(0.0, left_s))
            if not more:
                break
            heard += len(more)
            data += more
        if data and not stopping:
            raise self._wrong(frame, data, found)
        if found is not None:
            if found[2] == Status.WRONG_CHECKSUM and has_plain_reply(frame):
                self._mistrust()  # it has lost count of our bytes
                self._incidents.add("damaged", f"module {frame[0]} could not read what was sent: {frame.hex(' ')}")
            return found
        self._mistrust(frame[0])
        self._owes(frame[0], frame[1])
        if answer is not Answer.ALWAYS:
            return b""
        self._incidents.add("timeout", f"no answer to {frame.hex(' ')} in {timeout_s:g} s")
        raise LinkTimeout(self._name, timeout_s, f"frame {frame.hex(' ')}")

    def _is_answer(self, frame: bytes, head: bytes) -> bool:
        if frame[1] == Opcode.GET_VERSION and frame[2] == 0 and not (sound(head) and head[3] == frame[1]):
            return head[1:].isascii() and head[1:].decode("ascii").isprintable()
        try:
            check_reply(self._name, frame, head)
        except BadReply:
            return False
        return True

    def _is_owed(self, frame: bytes) -> bool:
        return self._is_old(frame)

    def _is_old(self, head: bytes, frame: bytes = b"") -> bool:
        """Whether `head` is an answer that was owed to us from before we asked `frame`."""
        owed = self._owed.get(head[1])
        if not owed or not sound(head):
            return False
        # A stop goes out past the fence: of answers to stops nobody can tell which is which.
        return head[3] in owed and head[3] != frame[1] if frame and head[1] == frame[0] else True

    def _wrong(self, frame: bytes, data: bytes, found: bytes | None) -> BadReply:
        """Note what is wrong with what came, and make the error of it. Everybody is out of step now."""
        kind, text = self._what_is_wrong(frame, data, found)
        self._mistrust()
        if found is None:  # what came may have been something else's answer, and ours is still to come
            self._owes(frame[0], frame[1])
        self._incidents.add(kind, f"{text} (got {data.hex(' ')} to {frame.hex(' ')})")
        return BadReply(self._name, text, data)

    def _what_is_wrong(self, frame: bytes, data: bytes, found: bytes | None) -> tuple[IncidentKind, str]:
        head = data[:FRAME_BYTES]
        if found is not None:
            return "foreign", f"{FOREIGN}: {len(data)} bytes more than the answer"
        if len(data) < FRAME_BYTES:
            return "short", f"{len(data)} bytes instead of {FRAME_BYTES}"
        if head == frame:
            return "mismatch", "our own command came back: switch off the echo of the adapter"
        if not sound(head):
            return "checksum", f"checksum {head[8]:#04x} instead of {sum(head[:8]) & 0xFF:#04x}"
        if head[1] != frame[0]:
            return "foreign", f"{FOREIGN}: module {head[1]} answered instead of {frame[0]}"
        text = f"an answer to command {head[3]} instead of {frame[1]}, which is late, or {FOREIGN}"
        return "mismatch", text

    # --- listening ------------------------------------------------------------------------------

    def _throw_away(self) -> None:
        """A stop waits for no judgement of what was heard: nobody is trusted any more, and it goes out."""
        self._heard = b""
        self._mistrust()

    def _in_step(self) -> bool:
        return bool(self._trusted)

    def _take_unasked(self) -> None:
        while is_event(head := self._heard[:FRAME_BYTES]):
            self._heard = self._heard[FRAME_BYTES:]
            self._tell_event(head)

    def _sift(self, data: bytes) -> bytes:
        """The events that are in it are kept."""
        while len(data) >= FRAME_BYTES:
            head = data[:FRAME_BYTES]
            data = data[FRAME_BYTES:] if sound(head) else data[1:]
            if is_event(head):
                self._tell_event(head)
            elif sound(head):
                self._incidents.add("late", f"thrown away: {head.hex(' ')}")
        return data

    # --- staying in step ------------------------------------------------------------------------

    def _mistrust_all(self) -> None:
        self._mistrust()

    def _mistrust(self, address: int | None = None) -> None:
        """Whatever comes next may be old: from one module, or, after garbage, from anybody."""
        self._to_drain = True
        if address is None:
            self._trusted.clear()
        else:
            self._trusted.discard(address)

    def _owes(self, address: int, opcode: int) -> None:
        """The answer to `opcode` may still come."""
        owed = self._owed.setdefault(address, {})
        owed.pop(opcode, None)
        owed[opcode] = None

    def _fence(self, address: int) -> Request:
        """A question whose answer cannot be that to an earlier one; where all are owed, the one asked longest ago."""
        owed = list(self._owed.get(address, ()))
        fences = [fence for fence in FENCES if fence >= CONTROL_FIRST] if self._stores(address) else FENCES
        opcode = min(fences, key=lambda fence: owed.index(fence) if fence in owed else -1)
        return Request(address, opcode, FENCES[opcode])

    def _get_in_step(self, frame: bytes, timeout_s: float) -> None:
        """Drain, then the fence. Raises LinkTimeout or BadReply; `frame` was not sent then."""
        address = frame[0]
        drained = self._to_drain
        if drained:
            self._drain()
        fence = self._fence(address)
        self._stream.write(fence.encode())
        until_s, data = time.monotonic() + timeout_s, b""
        passed = miscounted = False
        heard = 0
        while True:
            while len(data) >= FRAME_BYTES:
                head = data[:FRAME_BYTES]
                if is_event(head):
                    self._tell_event(head)
                elif sound(head) and head[2] == Status.WRONG_CHECKSUM:
                    # To an earlier question of ours, and then the fence's answer follows; or else to the fence.
                    miscounted = True
                    until_s = min(until_s, time.monotonic() + 2 * PAD_WAIT_S)
                elif sound(head) and head[1] == address and head[3] == fence.opcode:
                    passed = True
                else:
                    data = data[1:]  # old answers and garbage: frames may begin anywhere
                    continue
                data = data[FRAME_BYTES:]
            if passed and not data:
                break
            # Something behind the answer can only be the rest of an event, or another master.
            left_s = until_s - time.monotonic()
            if left_s <= -DRAIN_MAX_S or heard > HEARD_MAX:
                break
            more = self._stream.read(self.silence_s if passed else max(0.0, left_s))
            if not more:
                break
            heard += len(more)
            data += more
        if not passed:
            if miscounted:
                self._fill_up(fence.encode())
            self._to_drain = True
            self._owes(address, fence.opcode)
            self._incidents.add(
                "out of step", f"module {address} did not answer command {fence.opcode} in {timeout_s:g} s"
            )
            raise LinkTimeout(
                self._name,
                timeout_s,
                f"module {address}, asked command {fence.opcode} first; so frame {frame.hex(' ')} was not sent",
            )
        if data:
            raise self._wrong(frame, data, b"")
        self._trusted.add(address)
        self._owed.pop(address, None)
        if drained:
            self._incidents.add("resync", f"in step again with module {address}")

    def _fill_up(self, sent: bytes) -> None:
        """Bring a module that took the end of `sent` for the beginning of a frame to the end of that one.

        Modules forget half a frame by themselves; evaluation boards wait for the rest of it, and would never again
        be in step with us. The padding can make no frame with a right checksum out of any end of `sent`.
        """
        pad = next(
            byte
            for byte in range(0x55, 0x100)
            if all(sum(sent[FRAME_BYTES - kept :]) + byte * (8 - kept) - byte & 0xFF for kept in range(1, FRAME_BYTES))
        )
        for _ in range(FRAME_BYTES - 1):
            self._stream.write(bytes((pad,)))
            if self._stream.read(PAD_WAIT_S):
                return


def _was_stored(reply: bytes) -> bool:
    """Whether a module says that it has stored a command in its program instead of doing it."""
    return len(reply) == FRAME_BYTES and reply[2] == Status.STORED and sound(reply)
