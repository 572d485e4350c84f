"""A port to an emulated chip in the same process: bytes in, bytes out, no wait, no thread.

It also is the chip's sampler. A sample that fell due earlier is taken at its own chip time just
before anybody else talks to the chip, so samples bear exact times however late the timer was.
"""

from __future__ import annotations

import heapq
import time
from collections.abc import Callable, Sequence

from ..errors import BadReply, BenchError, LinkDown, LinkTimeout
from . import datagram_uart
from .datagram_uart import IFCNT, UartForm
from .port import PortTraits, SampleSink, Wire
from .spi_datagram import asks_anew, chained

SAMPLES_WITHIN_S = 0.03
"""How long samples that are due may keep everybody else waiting [s of processor time]; the rest are given up."""
CATCH_UP_S = 10.0
"""Samples further behind than this [s] are given up: nobody asked for so long that the past is not worth a stall."""


class _Sampling:
    """One reader's beat: sample number `taken` is due at `start_s` + `taken` * `period_s` of server time."""

    __slots__ = ("ended", "frames", "period_s", "sink", "start_s", "taken")

    def __init__(self, frames: tuple[bytes, ...], start_s: float, period_s: float, sink: SampleSink) -> None:
        self.frames = frames
        self.start_s = start_s
        self.period_s = period_s
        self.sink = sink
        self.taken = 0
        self.ended = False

    def due_s(self) -> float:
        # From the start, not from the last sample: sums of rounded periods would drift.
        return self.start_s + self.taken * self.period_s


class EmulatorPort:
    """`SamplingPort` and `ChainPort` over a `Wire`."""

    def __init__(self, wire: Wire, name: str = "", *, hurries: bool = False) -> None:
        """`hurries`: time goes on while we work, and others wait; else it waits for us, as a test's does."""
        self.wire = wire
        self._hurries = hurries
        self.samples_missed = 0
        self.paused: BenchError | None = None
        # kept questions would set the chip back to what it was when they were made
        sampling = None if asks_anew(wire.model) else self
        chains = chained(wire.model)
        self.traits = PortTraits(chains=self if chains else None, sampling=sampling, cuts=chains)
        self._name = name or f"emulated {wire.model}"
        self._server = wire.clock.base
        self._last_exchange_s = wire.clock.now()
        self._due: list[tuple[float, int, _Sampling]] = []
        self._order = 0
        self._uart_alone = datagram_uart.alone(wire.model)
        self._unsolicited: Callable[[float], list[tuple[float, bytes]]] | None = getattr(wire, "unsolicited", None)
        self._event_listeners: list[Callable[[bytes], None]] = []

    @property
    def name(self) -> str:
        return self._name

    @property
    def last_exchange_s(self) -> float:
        return self._last_exchange_s

    def device_time_s(self) -> float:
        return self.wire.clock.now()

    @property
    def time_scale(self) -> float:
        """How fast `device_time_s` runs against the server's clock."""
        return self.wire.clock.scale

    async def exchange(self, frame: bytes, timeout_s: float | None = None) -> bytes:
        """Answer at once. `timeout_s` has no meaning here: a silent emulator is known to be silent."""
        return self._answer(frame, self.take_turn())

    async def exchange_chain(self, frames: Sequence[bytes], timeout_s: float | None = None) -> list[bytes]:
        """As `ChainPort` says: all of them at one instant of the chip, so that no sample falls due between."""
        at_s = self.take_turn()
        return [self._answer(frame, at_s) for frame in frames]

    def _answer(self, frame: bytes, at_s: float) -> bytes:
        clock = self.wire.clock
        skipped_s = clock.skipped_s
        try:
            reply = self._exchanged()(frame, at_s)
        except TimeoutError as error:
            raise LinkTimeout(self._name, 0.0, f"frame {frame.hex(' ')}") from error
        except ConnectionError as error:
            raise LinkDown(self._name, str(error) or "unplugged") from error
        # What could not be worked out in time was skipped: then the answer is not of the time that was asked for.
        self._last_exchange_s = at_s if clock.skipped_s == skipped_s else min(at_s, clock.now())
        if self._event_listeners:
            self._tell_events(at_s)
        return reply

    def _exchanged(self) -> Callable[[bytes, float], bytes]:
        """What a frame goes through to the emulator."""
        return self._over_uart if self._uart_alone else self.wire.exchange

    def _over_uart(self, frame: bytes, at_s: float) -> bytes:
        """A datagram to a chip that has a UART alone. Behind a write it is asked for IFCNT, as over a line of its own.

        Raises TimeoutError where no answer comes, BadReply where one is damaged or a write was not counted.
        """
        form = UartForm(frame[1])
        if not form.is_write(frame):
            return self._asked(form, frame, at_s)
        counting = form.read(IFCNT)
        before = self._asked(form, counting, at_s)[-2]
        self.wire.exchange(frame, at_s)
        reply = self._asked(form, counting, at_s)
        counted = reply[-2] - before & 0xFF
        if counted != 1:
            raise BadReply(self._name, f"the chip counted {counted} writes instead of 1", reply)
        return reply

    def _asked(self, form: UartForm, frame: bytes, at_s: float) -> bytes:
        reply = self.wire.exchange(frame, at_s)
        if not reply:
            raise TimeoutError
        try:
            form.data_of(form.register_of(frame), reply)
        except ValueError as error:
            raise BadReply(self._name, str(error), reply) from error
        return reply

    def take_turn(self) -> float:
        """Take all samples that are due and return the chip's time [s] at which the caller may now act."""
        now_s = self._server.now()
        if self._due and self._due[0][0] <= now_s:
            self._take_due(now_s)
        return self.wire.clock.at(now_s)

    def on_event(self, listener: Callable[[bytes], None]) -> Callable[[], None]:
        """Hear of frames that the module sends unasked, as `BatchPort.on_event`; found out when it is talked to next.

        Returns the function that ends it.
        """
        self._event_listeners.append(listener)

        def end() -> None:
            if listener in self._event_listeners:
                self._event_listeners.remove(listener)

        return end

    def _tell_events(self, at_s: float) -> None:
        if self._unsolicited is not None:
            for _, frame in self._unsolicited(at_s):
                for listener in tuple(self._event_listeners):
                    listener(frame)

    async def aclose(self) -> None:
        """End all samplings. The chip lives on: closing a port does not cut a chip's power."""
        for _, _, sampling in self._due:
            sampling.ended = True
        self._due.clear()

    def start_sampling(self, frames: Sequence[bytes], period_s: float, sink: SampleSink) -> Callable[[], None]:
        """Ask `frames` every `period_s` [s] of server time, from now on. Raises ValueError for an empty sample."""
        if not frames or not period_s > 0:
            raise ValueError(f"a sample has frames and a period above 0 s, not {len(frames)} and {period_s}")
        now_s = self._server.now()
        self._take_due(now_s)
        sampling = _Sampling(tuple(frames), now_s, period_s, sink)
        self._push(sampling)

        def end() -> None:
            sampling.ended = True

        return end

    def run_due_samples(self) -> None:
        now_s = self._server.now()
        error = self._take_due(now_s)
        if self._event_listeners:
            self._tell_events(self.wire.clock.at(now_s))
        if error is not None:
            raise error

    @property
    def next_due_s(self) -> float:
        """When the next sample is due, on the server's clock [s]; infinite for never."""
        return self._due[0][0] if self._due else float("inf")

    def take_due(self, until_s: float, *, give_up: bool = False) -> None:
        """For emulators that are wired to this one and go on past `until_s` [s]: take what is due, or give it up."""
        self._take_due(until_s, give_up=give_up)

    def _push(self, sampling: _Sampling) -> None:
        self._order += 1
        heapq.heappush(self._due, (sampling.due_s(), self._order, sampling))

    def _take_due(self, now_s: float, *, give_up: bool = False) -> BenchError | None:
        """Take what is due by server time `now_s` [s], oldest first, or give it up; the latest failure is returned, not
        raised."""
        failure = self.paused
        due = self._due
        until_s = time.thread_time() + SAMPLES_WITHIN_S if self._hurries else float("inf")
        skipped_s = self.wire.clock.skipped_s
        while due and due[0][0] <= now_s:
            due_s, _, sampling = heapq.heappop(due)
            if sampling.ended:
                continue
            late = give_up or self.wire.clock.skipped_s != skipped_s or (self._hurries and time.thread_time() > until_s)
            if now_s - due_s > CATCH_UP_S or late or self.paused is not None:
                behind = int((now_s - due_s) / sampling.period_s) + (late or self.paused is not None)
                self.samples_missed += behind
                sampling.taken += behind
                self._push(sampling)
                continue
            failure = self._take(sampling, self.wire.clock.at(due_s))
            sampling.taken += 1
            self._push(sampling)
        return failure

    def _take(self, sampling: _Sampling, chip_s: float) -> BenchError | None:
        exchange, skipped_s = self._exchanged(), self.wire.clock.skipped_s
        try:
            replies = b"".join([exchange(frame, chip_s) for frame in sampling.frames])
        except TimeoutError:
            self.samples_missed += 1
            return LinkTimeout(self._name, 0.0, "a sample")
        except ConnectionError as error:
            self.samples_missed += 1
            return LinkDown(self._name, str(error) or "unplugged")
        except BadReply as error:
            self.samples_missed += 1
            return error
        if self.wire.clock.skipped_s != skipped_s:
            self.samples_missed += 1  # it was asked at another time than it was due
            return None
        sampling.sink(chip_s, replies)
        return None
