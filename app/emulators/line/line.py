"""One serial line with modules on it, as bytes and times: no file descriptor, no thread, no waiting.

Time here is the server's (`Clock`), not the modules': a wire does not get faster because a module's time is scaled.
"""

from __future__ import annotations

import heapq
import itertools
import random
from collections.abc import Hashable, Sequence
from typing import NamedTuple

from ...clock import Clock
from ...registers.tmcl.commands import Opcode, Status
from ..core.noise import cut, flip
from .can_message import CanMessage, CanModule
from .faults import LineFaults, LinePatch, LineState
from .framing import TMCL, Framing
from .module import LineModule

BITS_A_BYTE = 10
"""8N1: start bit, eight data bits, stop bit."""
EVENT_POLL_S = 0.002
"""How often modules are asked for events while one has been asked for [s]."""

SEED = 485
"""Of the noise on a line that is told none."""


class Delivery(NamedTuple):
    """Bytes for one client; the last of them has arrived at `due_s` [s]."""

    due_s: float
    client: Hashable
    data: bytes


class Line:
    """Modules by address on one line, and the clients who talk to them.

    A frame is on the wire for 90 bits at `baud`, a reply as long again, after the module's telegram
    pause; None takes no time. Transactions come one after the other, whoever asks: bytes that come in
    meanwhile wait for the end of the reply. A reply goes to the client that asked, an event to the
    client that asked for events last; with `shared_bus` everybody hears all of it, and the questions
    of the others too, and bytes of several clients get mixed up, as on RS485. With an `echo` whoever says something
    hears it too. Frames are those of TMCL, or what `framing` makes of the bytes.
    """

    def __init__(
        self,
        modules: Sequence[LineModule],
        clock: Clock,
        *,
        baud: int | None = None,
        shared_bus: bool = False,
        echo: bool = False,
        faults: LineFaults | None = None,
        addresses: Sequence[int] = (),
        seed: int = SEED,
        framing: Framing = TMCL,
    ) -> None:
        self.modules = tuple(modules)
        self.clock = clock
        self.baud = baud
        self.faults = faults or LineFaults()
        self._shared_bus = shared_bus
        self._addresses = list(addresses)
        self._echo = echo
        self._framing = framing
        self._noise = random.Random(seed)
        self._clients: dict[Hashable, _Assembly] = {}
        self._common = _Assembly()
        self._waiting: list[tuple[float, int, Hashable, bytes]] = []
        self._order = itertools.count()
        self._wire_free_s = 0.0
        self._said_s = 0.0
        """When the latest byte of a client was on the wire [s]."""
        self._answered_s: dict[int, float] = {}
        """When the latest answer of each module is on the wire [s]."""
        self._listeners: dict[int, _Listener] = {}
        self._polled_s = 0.0

    # --- clients ------------------------------------------------------------------------------------

    def join(self, client: Hashable) -> None:
        """`client` is on the line from now on."""
        self._clients[client] = self._common if self._shared_bus else _Assembly()

    def leave(self, client: Hashable) -> None:
        """`client` is gone, with what it had begun to say and what was on its way to it."""
        self._clients.pop(client, None)
        self._waiting = [entry for entry in self._waiting if entry[2] != client]
        heapq.heapify(self._waiting)
        self._listeners = {index: entry for index, entry in self._listeners.items() if entry.client != client}

    # --- bytes --------------------------------------------------------------------------------------

    def feed(self, client: Hashable, data: bytes, at_s: float) -> None:
        """`client` puts `data` on the wire at `at_s` [s]; what comes of it is for `collect`.

        Bytes of a client that has not joined, and bytes on a line that is not plugged, are lost.
        """
        assembly = self._clients.get(client)
        if assembly is None or not self.plugged:
            return
        if self.faults.bit_error_rate:
            data = flip(data, self.faults.bit_error_rate, self._noise)
        baud, framing = self.baud, self._framing
        byte_s = BITS_A_BYTE / baud if baud else 0.0
        position = 0
        while position < len(data):
            start_s = max(at_s, self._wire_free_s)
            if framing.half_duplex and self._spoils(at_s):
                start_s, assembly.deaf = max(at_s, self._said_s), True
            elif start_s - assembly.heard_s > framing.gap_s(baud):
                assembly.held, assembly.deaf = b"", False
            elif assembly.deaf and start_s - assembly.heard_s >= framing.idle_s(baud):
                assembly.deaf = False
            held = len(assembly.held)
            begun = assembly.held + data[position:] if held or position else data
            length = -1 if assembly.deaf else framing.length(begun)
            piece = begun[held:length] if length >= 0 else begun[held:]
            position += len(piece)
            heard_s = assembly.heard_s = self._said_s = start_s + len(piece) * byte_s
            if heard_s > self._wire_free_s:
                self._wire_free_s = heard_s
            if self._shared_bus or self._echo:
                self._tell(client, piece, heard_s)
            if length < 0:
                assembly.held, assembly.deaf = b"", True
            elif len(begun) < length:
                assembly.held = begun
            else:
                frame, assembly.held = begun[:length], b""
                if framing.is_sound(frame):
                    self._transact(client, frame, heard_s, byte_s)
                else:
                    assembly.deaf = True

    def hear_message(self, client: Hashable, message: CanMessage, at_s: float) -> None:
        """`client` says a message on a CAN bus at `at_s` [s]; answers are delivered as `CanMessage.packed`.

        The bus is not the serial wire: it takes no time here, and it checks and repeats its messages by itself, so that
        flipped bits and half frames do not show. Raises TypeError where a module of this line has no such interface.
        """
        if client not in self._clients or not self.plugged:
            return
        for index, module in enumerate(self.modules):
            if not isinstance(module, CanModule):
                raise TypeError(f"{type(module).__name__} has no CAN interface")
            if module.faults.unplugged:
                continue
            said = module.receive_message(message, module.clock.at(at_s))
            if said is None or module.faults.silence or self.faults.silence:
                continue
            if message.data[0] == Opcode.REQUEST_EVENT and said.data[1] == Status.OK:
                self._listen(index, _Listener(client, message.data[1] != 0, by_can=True), at_s)
            due_s = self._in_order([index], at_s + module.faults.late_reply_s + self.faults.late_reply_s)
            heapq.heappush(self._waiting, (due_s, next(self._order), client, said.packed()))

    def collect(self, at_s: float) -> list[Delivery]:
        """Everything that has arrived by `at_s` [s], in order of time."""
        if self._listeners and at_s >= self._polled_s + EVENT_POLL_S:
            self._polled_s = at_s
            self._fetch_events(at_s)
        waiting = self._waiting
        arrived = []
        while waiting and waiting[0][0] <= at_s:
            due_s, _, client, data = heapq.heappop(waiting)
            arrived.append(Delivery(due_s, client, data))
        return arrived

    def next_due_s(self) -> float | None:
        """When `collect` has something to do next [s]; None while there is nothing to wait for."""
        due_s = self._waiting[0][0] if self._waiting else None
        if self._listeners:
            poll_s = self._polled_s + EVENT_POLL_S
            return poll_s if due_s is None else min(poll_s, due_s)
        return due_s

    def keep_up(self, slice_s: float) -> bool:
        """Let every module live on by at most `slice_s` [s] of its time; True once all are up to date."""
        up_to_date = [module.catch_up(slice_s) for module in self.modules]  # every one of them, also after a False
        return all(up_to_date)

    # --- plant -------------------------------------------------------------------------------------

    @property
    def plugged(self) -> bool:
        """Whether there is a port at all. One module that is unplugged leaves a line with others on it alive."""
        return not (self.faults.unplugged or all(module.faults.unplugged for module in self.modules))

    def unplug(self) -> None:
        """Forget what was on the wire: the cable is out."""
        self._waiting.clear()
        self._wire_free_s = 0.0
        self._said_s = 0.0
        self._answered_s.clear()
        for assembly in (self._common, *self._clients.values()):
            assembly.held, assembly.deaf = b"", False

    def state(self) -> LineState:
        """What GET /line answers."""
        return LineState(
            baud=self.baud,
            shared_bus=self._shared_bus,
            addresses=self._addresses,
            plugged=self.plugged,
            faults=self.faults,
        )

    def patch(self, change: LinePatch) -> LineState:
        """Change the line as PATCH /line does."""
        if change.baud is not None:
            self.baud = change.baud
        self.faults = self.faults.model_copy(update=change.faults.model_dump(exclude_none=True))
        return self.state()

    # --- inside -------------------------------------------------------------------------------------

    def _transact(self, client: Hashable, frame: bytes, heard_s: float, byte_s: float) -> None:
        """Let every module hear `frame` at `heard_s` [s], and put what they say on the wire."""
        answer: bytes | None = None
        due_s = late_s = 0.0
        speakers: list[int] = []
        for index, module in enumerate(self.modules):
            faults = module.faults
            if faults.unplugged:
                continue
            said = module.receive(frame, module.clock.at(heard_s))
            if said is None or faults.silence or self.faults.silence:
                continue
            if self._framing.events and frame[1] == Opcode.REQUEST_EVENT and said[2] == Status.OK:
                self._listen(index, _Listener(client, frame[2] != 0), heard_s)
            due_s = max(due_s, heard_s + module.reply_pause_s + len(said) * byte_s)
            late_s = max(late_s, faults.late_reply_s)
            speakers.append(index)
            said = cut(flip(said, faults.bit_error_rate, self._noise), faults.half_frame_rate, self._noise)
            # Two modules of one address talk at once: where they differ, the wire shows neither.
            answer = said if answer is None else bytes(a & b for a, b in zip(answer, said, strict=False))
        if answer is None:
            return
        # A late answer leaves the wire free meanwhile: that is how it comes to meet the next question.
        self._wire_free_s = max(self._wire_free_s, due_s)
        self._send(client, answer, self._in_order(speakers, due_s + late_s + self.faults.late_reply_s))

    def _in_order(self, speakers: Sequence[int], due_s: float) -> float:
        """When an answer that is due by then comes [s]: who is late no more still answers in order."""
        due_s = max(due_s, *(self._answered_s.get(each, 0.0) for each in speakers))
        self._answered_s.update(dict.fromkeys(speakers, due_s))
        return due_s

    def _send(self, client: Hashable, data: bytes, due_s: float) -> None:
        faults = self.faults
        data = cut(flip(data, faults.bit_error_rate, self._noise), faults.half_frame_rate, self._noise)
        for hearer in self._clients if self._shared_bus else (client,):
            heapq.heappush(self._waiting, (due_s, next(self._order), hearer, data))

    def _tell(self, client: Hashable, data: bytes, heard_s: float) -> None:
        """Let those hear `data` who hear what `client` says."""
        for hearer in self._clients if self._shared_bus else (client,):
            if hearer != client or self._echo:
                heapq.heappush(self._waiting, (heard_s, next(self._order), hearer, data))

    def _spoils(self, at_s: float) -> bool:
        """Whether what is said at `at_s` [s] meets an answer on the wire. If so, nobody can read that any more."""
        if max(at_s, self._said_s) >= self._wire_free_s:
            return False
        self._waiting = [
            (due_s, order, hearer, bytes(len(data)) if due_s > at_s else data)
            for due_s, order, hearer, data in self._waiting
        ]
        return True

    def _listen(self, index: int, listener: _Listener, at_s: float) -> None:
        if index not in self._listeners:  # what came up while nobody listened is nobody's
            self.modules[index].unsolicited(self.modules[index].clock.at(at_s))
        self._listeners[index] = listener

    def _fetch_events(self, at_s: float) -> None:
        byte_s = BITS_A_BYTE / self.baud if self.baud else 0.0
        for index, listener in list(self._listeners.items()):
            module = self.modules[index]
            now_s = module.clock.at(at_s)
            for chip_s, frame in module.unsolicited(now_s):
                if not listener.again:
                    self._listeners.pop(index, None)
                if module.faults.unplugged or module.faults.silence or self.faults.silence or not self.plugged:
                    continue
                # By the module's clock the event is some time old: so it also is by ours.
                ago_s = (now_s - chip_s) / module.clock.scale if module.clock.scale else 0.0
                if listener.by_can and isinstance(module, CanModule):
                    said = module.as_message(frame).packed()
                    heapq.heappush(self._waiting, (at_s - ago_s, next(self._order), listener.client, said))
                    continue
                due_s = max(at_s - ago_s, self._wire_free_s) + len(frame) * byte_s
                self._wire_free_s = max(self._wire_free_s, due_s)
                self._send(listener.client, frame, due_s + self.faults.late_reply_s)


class _Listener(NamedTuple):
    """Who hears of a module's events: the next one only, or all (`again`)."""

    client: Hashable
    again: bool
    by_can: bool = False


class _Assembly:
    """The bytes of a frame so far, and when the last of them was heard [s]; `deaf` until the line is silent."""

    __slots__ = ("deaf", "heard_s", "held")

    def __init__(self) -> None:
        self.deaf = False
        self.held = b""
        self.heard_s = 0.0
