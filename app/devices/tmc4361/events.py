"""EVENTS without losing one: peeked at, told as a timeline, and cleared only bit by bit after they were told.

Reading EVENTS clears it, and an event that comes around that reading may be lost (DS-TMC4361 7.2). So every reading
here is between two writes of EVENT_CLEAR_CONF, as Trinamic's firmware does it: with all its bits set a reading clears
nothing, and with all but some it clears those. After each the register holds again what its user wants it to hold.

What holds the motor (a stop, a freeze, a stall) is never cleared by looking: an axis that is going to a target would
set off again as soon as the switch is released. Neither is what the user keeps (EVENT_CLEAR_CONF) or what makes an
interrupt (INTR_CONF): other hardware may wait for it. COVER_DONE is told once where datagrams that the chip sends by
itself bring it again at once.
"""

from __future__ import annotations

from collections.abc import Sequence

from ...errors import BenchError
from ...registers.model import Register
from ...registers.tmc4361.bits import EVENT_BITS, EVENT_MASK, event_names, selected_events
from ..core.capabilities import EventLog, LatchedFlags
from ..core.register_io import RegisterIO, Snapshot, Write
from ..core.register_link import RegisterLink
from ..core.results import ChipEvents, DeviceState, EventPage
from ..core.timeline import Timeline
from . import roles
from .memory import ChipMemory

ALL = 0xFFFF_FFFF
RESET = "RST_EV"
COVER_DONE = roles.event("COVER_DONE")
DRIVER_LSB = 32
"""Of the words of a timeline: behind the events the flags of the motor driver, STATUS 31:24."""
DRIVER = 0xFF << DRIVER_LSB
SELECTION_LSB = 16
"""Where STEP_CONF has those that make a MOTOR_EV."""


class Events(EventLog, LatchedFlags):
    """The events of one TMC4361. `memory` hears of what is read along, and of resets."""

    def __init__(self, link: RegisterLink, memory: ChipMemory) -> None:
        self.present = 0
        """EVENTS as last seen."""
        self.resets = 0
        """How often a reset was seen, that of the power-on included where nobody had taken notice of it."""
        self._link = link
        self._session = link.session
        self._memory = memory
        self._timeline = Timeline(roles.AXIS, EVENT_MASK | DRIVER, self._names)
        self._kept: int | None = None
        """EVENT_CLEAR_CONF as its user wants it; None where not seen yet."""
        self._owed: tuple[int, int] | None = None
        """What was written over EVENT_CLEAR_CONF and what is its user's, while that is not put back."""
        self._acquainted = False
        """Whether EVENTS was read since the device is connected: the first RST_EV is that of its power-on."""
        self._session.state_hooks.append(self._state_set)

    def events(self, axis: int, after: int = 0, limit: int = 1000, /) -> EventPage:
        """The oldest `limit` entries of the timeline behind number `after`. Raises UnknownThing for the axis."""
        self._session.axis(axis)
        return self._timeline.page(after, limit)

    async def clear_flags(self, axis: int, /) -> None:
        """Take notice of EVENTS, as reading it does: an axis that an event holds goes on to its target."""
        self._session.axis(axis)
        self._session.require_connected()
        await self.read_by_name()

    def has(self, *names: str) -> bool:
        """Whether one of these events is set, as last seen."""
        return bool(self.present & roles.event(*names))

    # --- reading without losing one -------------------------------------------------------------

    async def peek(self, io: RegisterIO, registers: Sequence[Register] = ()) -> Snapshot:
        """`registers`, and EVENTS of the same moment told to the timeline; nothing is cleared but RST_EV: what is
        written from now on is lost with the next reset, which has to be seen too."""
        held = await self._look(io, registers)
        if self.has(RESET):
            await self.clear(io, roles.event(RESET) & await self._clearable(io))
        return held

    async def _look(self, io: RegisterIO, registers: Sequence[Register]) -> Snapshot:
        kept = await self._user_keeps(io)
        asked = (*registers, roles.EVENTS)
        if kept == ALL:
            steps = [await io.read_many(asked)]
        else:
            steps = await self._read_keeping(io, ALL, asked, kept)
        *others, events = steps[0]
        held = Snapshot(registers, others)
        self._saw_events(events, events, io.time_s, held.word(roles.STATUS) if roles.STATUS in registers else None)
        self._memory.saw_all(held)
        return held

    async def clear(self, io: RegisterIO, bits: int) -> None:
        """Clear these bits of EVENTS; what came meanwhile is told, and stays."""
        if not bits:
            return
        kept = await self._user_keeps(io)
        steps = await self._read_keeping(io, ALL & ~bits, (roles.EVENTS,), kept)
        events = steps[0][0]
        self._saw_events(events, events & ~bits, io.time_s)

    async def take(self, io: RegisterIO, registers: Sequence[Register] = ()) -> Snapshot:
        """`peek`, and clear what was seen and may be cleared, so that it can be seen to come again."""
        held = await self._look(io, registers)
        await self.clear(io, self.present & await self._clearable(io))
        return held

    async def _clearable(self, io: RegisterIO) -> int:
        """Events that nobody waits for."""
        interrupts = self._memory.known(roles.INTR_CONF) or 0
        stays = roles.BLOCKING | (COVER_DONE if self._datagrams_of_its_own() else 0)
        return EVENT_MASK & ~(stays | (await self._user_keeps(io)) | interrupts)

    def _datagrams_of_its_own(self) -> bool:
        """Whether COVER_DONE comes with each datagram that the chip sends by itself, and so over and over."""
        conf = self._memory.known(roles.SPI_OUT_CONF) or 0
        return roles.OUTPUT_FORMAT.unpack(conf) in roles.TALKATIVE_FORMS and not roles.COVERS_ONLY.unpack(conf)

    async def read_by_name(self) -> int:
        """EVENTS for a caller that wants to read it, and so to clear it. Never asked twice: the answer may be all that
        was lost."""
        async with self._link.turn() as turn:
            io = self._link.io(turn)
            kept = await self._user_keeps(io)
            replies = await turn.exchange_many(self._link.access.read_frames((roles.EVENTS.address,)))
            word = self._link.access.words(replies)[0]
            self._saw_events(word, word & kept, io.time_s)
        return word

    async def _read_keeping(
        self, io: RegisterIO, meanwhile: int, registers: Sequence[Register], kept: int
    ) -> list[list[int]]:
        """Read while EVENT_CLEAR_CONF is `meanwhile`; afterwards it is `kept` again."""
        self._owed = (meanwhile, kept)
        before, after = Write(roles.EVENT_CLEAR_CONF, meanwhile), Write(roles.EVENT_CLEAR_CONF, kept)
        steps = await io.chain(before, registers, after, again=True)
        self._owed = None
        return steps

    async def _user_keeps(self, io: RegisterIO) -> int:
        if self._kept is None:
            kept = await io.read(roles.EVENT_CLEAR_CONF)
            if self._owed is not None and kept == self._owed[0]:
                kept = self._owed[1]  # the link failed before this was put back
            self._kept = kept
            return kept
        return self._kept

    # --- what was seen --------------------------------------------------------------------------

    def saw(self, register: Register, word: int) -> None:
        """A word was seen in the chip, or was sent to it by the user."""
        if register is roles.EVENT_CLEAR_CONF:
            self._kept = word

    def saw_status(self, time_s: float, status: int) -> None:
        """A status byte of that time: it shows up to eight events without reading EVENTS."""
        bits = self.bits_of_status(status)
        entry = self._timeline.glimpsed(bits, time_s) if bits else None
        if entry is not None:
            self.present |= bits
            self._tell(entry)

    def bits_of_status(self, status: int) -> int:
        """Events that a status byte shows; none before SPI_STATUS_SELECTION was seen."""
        selection = self._memory.known(roles.SPI_STATUS_SELECTION)
        if selection is None or not status:
            return 0
        return sum(1 << bit for place, bit in enumerate(selected_events(selection)) if status >> place & 1)

    def _saw_events(self, word: int, left: int, time_s: float, status: int | None = None) -> None:
        """EVENTS was read and is now `left`. With the STATUS of that time a MOTOR_EV is told with what it was: the
        selected flags of the driver that have come since they were seen last."""
        self.present = left
        mask, driver = EVENT_MASK, 0
        if status is not None:
            mask |= DRIVER
            driver = (status >> roles.DRIVER_LSB & self._selected()) << DRIVER_LSB
        told = driver if word >> EVENT_BITS["MOTOR_EV"] & 1 else 0
        entry = self._timeline.read(word | told, left | driver, time_s, mask)
        if entry is not None:
            self._tell(entry)
        self._acquainted = True

    def _selected(self) -> int:
        """Flags of the driver that make a MOTOR_EV; all where nobody knows."""
        steps = self._memory.known(roles.STEP_CONF)
        return 0xFF if steps is None else steps >> SELECTION_LSB & 0xFF

    def _names(self, word: int) -> tuple[str, ...]:
        """Names of the events, and behind MOTOR_EV those of the driver's flags."""
        flags = roles.driver_flags(self._memory.known(roles.SPI_OUT_CONF) or 0)
        driver = (f"driver_{name}" for bit, name in flags.items() if word >> DRIVER_LSB + bit & 1)
        return (*event_names(word & EVENT_MASK), *driver)

    def _tell(self, entry: ChipEvents) -> None:
        """Tell of events once, however they were seen first; of a reset the memory hears before anybody else."""
        if RESET in entry.names:
            if self._acquainted:
                self._memory.forget_at_reset()  # it has been reset while we knew it
            self.resets += 1
            self._memory.reset_seen()
        self._session.tell(entry)

    def _state_set(self, state: DeviceState, problem: BenchError | None) -> None:
        del problem
        if state == "failed":
            self._kept = None
            self.present = 0
            self._acquainted = False
            self._timeline.forget()
