"""One watched axis: followed and moved, with its turn and its compare register."""

from __future__ import annotations

from collections.abc import Callable
from fractions import Fraction

from ..calc.positions.extended import Counter, checked_position, compare_count
from ..calc.positions.rotary import Way
from ..devices.core.device import Device
from ..errors import BenchError, UsageError, WrongState
from ..registers.model import to_signed
from ..store.positions import SavedPosition
from .mover import AGAIN_S, Mover
from .observer import Wake, link_text, tracker_of
from .state import CompareState, ExtendedState, HistoryState, Latched, TurnState
from .tracker import Tracker
from .turn import Turn

FRESH_S = 0.02
"""A look this young is good enough for whoever asks [s]."""
ENCODER_LOOKS_S = 5.0
"""How often an axis without an encoder is asked for one [s]: it may have been set up since."""


class WatchedAxis(Mover):
    """One axis of the service. Positions in requests and answers are the user's, those of a move the tracker's."""

    turn: Turn | None = None
    compare: int | None = None
    """The position that the compare register is for; None: the register is nobody's business here."""
    _compare_written: int | None = None
    _armed = False
    _asked_for_encoder_s = float("-inf")

    # --- beginning and end ----------------------------------------------------------------------

    @classmethod
    async def begun(
        cls,
        device: Device,
        axis: int,
        unix_s: Callable[[], float],
        wake: Wake,
        changed: Callable[[], None],
    ) -> WatchedAxis:
        """Watch from now on, at what the counter shows. Raises WrongState, LinkError."""
        bits = device.counter.counter_bits(axis)
        if bits is None:
            raise WrongState(
                f"the position counter of axis {axis} wraps elsewhere as it is set, so it cannot be followed",
                "switch circular movement off",
            )
        device.session.require_connected()
        look = await device.counter.poll(axis)
        tracker = Tracker(Counter(bits), look.count, look.asked_at_s, look.count)
        watched = cls(device, axis, tracker, unix_s, wake, changed)
        watched._note(None)
        return watched

    @classmethod
    def restored(
        cls,
        device: Device,
        saved: SavedPosition,
        unix_s: Callable[[], float],
        wake: Wake,
        changed: Callable[[], None],
    ) -> WatchedAxis:
        """As it was kept. Raises ValueError for what cannot be."""
        turn = None
        if saved.microsteps_per_turn is not None:
            turn = Turn(saved.microsteps_per_turn, saved.gear, checked_position(saved.zero))
        compare = None if saved.compare is None else checked_position(saved.compare)
        watched = cls(device, saved.axis, tracker_of(device, saved, unix_s()), unix_s, wake, changed)
        watched.turn, watched.compare = turn, compare
        watched.restore(saved)
        return watched

    def saved(self) -> SavedPosition:
        """What has to outlive this run."""
        turn, tracker = self.turn, self.tracker
        return SavedPosition(
            device=self.device.id,
            model=self.device.model,
            link=link_text(self.device),
            axis=self.axis,
            bits=tracker.counter.bits,
            count=tracker.count,
            position=tracker.position,
            seen_unix_s=self.seen_unix_s,
            lost="" if tracker.lost is None else tracker.lost.reason,
            microsteps_per_turn=None if turn is None else turn.microsteps_per_turn,
            gear=None if turn is None else turn.gear,
            zero=0 if turn is None else turn.zero,
            compare=self.compare,
        )

    # --- the service ----------------------------------------------------------------------------

    async def serve(self) -> float:
        """The regular service procedure (AN-001 2.1); when it is due again, in device time from now [s]."""
        async with self.lock:
            if not self.connected:
                return float("inf")  # when it is back, that wakes this
            if not await self.poll():
                return AGAIN_S if self.connected else float("inf")
            await self.go_on()
            await self._see_to_compare()
            return self.next_poll_s()

    async def _see_to_compare(self) -> None:
        """Arm the compare register while its position is within a piece, and keep it out of the way while not."""
        register = self.device.counter.compare_register(self.axis)
        if self.compare is None or register is None:
            return
        tracker, wanted = self.tracker, None
        if tracker.trusted:
            wanted = compare_count(tracker.counter, self.compare - tracker.origin, tracker.extended)
        self._armed = wanted is not None
        if wanted is None:
            # There is no switch to turn it off with: opposite the axis the counter gets to it last of all.
            written = self._compare_written
            if written is not None and abs(tracker.counter.way(written, tracker.count)) > tracker.counter.piece:
                return
            wanted = tracker.counter.shows(tracker.extended + tracker.counter.half)
        if wanted != self._compare_written:
            try:
                await self.device.registers.write(register, self.axis, value=wanted)
                self._compare_written = wanted
            except BenchError as error:
                self._compare_written, self._armed = None, False
                self.trouble = f"{register} could not be written: {error}"

    def _lost_sight(self, why: str) -> None:
        super()._lost_sight(why)
        self._compare_written, self._armed = None, False

    # --- requests -------------------------------------------------------------------------------

    async def fresh(self) -> None:
        """See to it that what is told is of now, as far as the link allows."""
        now_s = self.device.device_time_s()
        if not self.connected:
            return
        if self.encoder is not None or now_s - self._asked_for_encoder_s >= ENCODER_LOOKS_S:
            self._asked_for_encoder_s = now_s
            try:
                await self.device.monitor.axis_state(self.axis)  # tells the encoder along
            except BenchError as error:
                self.trouble = f"the encoder could not be read: {error}"
                return
        # What others have seen of the position does not tell of a reset: only a look of our own does.
        looked_s = float("-inf") if self._times is None else self._times[1]
        if self.tracker.away is not None or now_s - looked_s > FRESH_S or self.encoder is not None:
            await self.poll()

    async def require_trusted(self) -> None:
        """Look, and raise WrongState where the position is not known."""
        self.device.session.require_connected()
        await self._require_poll()
        lost = self.tracker.lost or self.tracker.away
        if lost is not None:
            raise WrongState(f"the position of axis {self.axis} is not known: {lost.reason}", lost.way_out)

    async def _require_poll(self) -> None:
        """Raises WrongState where no look succeeds."""
        if not await self.poll():
            raise WrongState(f"axis {self.axis} could not be looked at: {self.trouble}", "see to its link first")

    async def go_to(self, position: int) -> None:
        """Raises BenchError."""
        await self.require_trusted()
        await self.set_off(self._tracker_position(position))

    def _tracker_position(self, position: int) -> int:
        """The tracker's number of a position of the user's. Raises UsageError beyond 64 bits."""
        return _checked(position) - self.tracker.origin

    async def go_to_place(self, place: Fraction, way: Way) -> None:
        """To a place within the turn, that way. Raises BenchError."""
        rotary, origin = self._turn().rotary, self.tracker.origin
        await self.require_trusted()
        await self.set_off_from_rest(lambda at: rotary.target(at + origin, place, way) - origin)

    async def go_to_angle(self, angle_deg: float, way: Way) -> None:
        """The same by an angle [deg], which is the decimal number that was given, exactly. Raises BenchError."""
        await self.go_to_place(self._turn().rotary.place_at(Fraction(str(angle_deg))), way)

    async def go_turns(self, turns: int) -> None:
        """So many whole turns on, to the same place within the turn, to the nearest microstep. Raises BenchError."""
        turn = self._turn()
        await self.require_trusted()
        way = turns * turn.microsteps_per_turn
        _checked(self.tracker.position + int(way))
        await self.set_off_from_rest(lambda at: at + int((2 * way + 1) // 2))

    async def set_actual(self, position: int) -> None:
        """The axis stands at `position`. Raises WrongState while it moves, UsageError beyond 64 bits."""
        _checked(position)
        self.device.session.require_connected()
        if (await self.device.monitor.axis_state(self.axis)).moving:
            raise WrongState(f"axis {self.axis} moves: a position can only be set at rest", "stop it first")
        await self._require_poll()
        self.tracker.set_actual(position)
        self._set_anew()

    async def confirm(self) -> None:
        """What is shown is right. Raises WrongState."""
        self.device.session.require_connected()
        await self._require_poll()
        self.tracker.confirm()
        self._set_anew()

    def _set_anew(self) -> None:
        self._end("ended", "the position was set anew")
        self._compare_written, self._armed = None, False
        self._note(None)
        self._wake(self)

    def set_turn(self, turn: Turn | None) -> None:
        self.turn = turn
        self._changed()

    def set_zero(self, position: int) -> None:
        """Raises WrongState where no turn is set, UsageError beyond 64 bits."""
        self.set_turn(self._turn().with_zero(_checked(position)))

    def _turn(self) -> Turn:
        if self.turn is None:
            raise WrongState(f"axis {self.axis} has no turn", 'PUT {"microsteps_per_turn": n} or {"gear": ...} first')
        return self.turn

    def set_compare(self, position: int | None) -> None:
        """Raises WrongState where there is no compare register, UsageError beyond 64 bits."""
        if position is not None:
            if self.device.counter.compare_register(self.axis) is None:
                raise WrongState(f"axis {self.axis} of a {self.device.family.title} has no position compare")
            _checked(position)
        self.compare, self._compare_written, self._armed = position, None, False
        self._changed()
        self._wake(self)

    async def latched(self) -> Latched:
        """What the snapshot register holds, extended. Raises WrongState, LinkError."""
        register = self.device.counter.latch_register(self.axis)
        if register is None:
            raise WrongState(f"axis {self.axis} of a {self.device.family.title} has no position latch")
        await self.require_trusted()
        counter, tracker = self.tracker.counter, self.tracker
        raw = (await self.device.registers.read(register, self.axis)).value
        count = to_signed(raw & (counter.modulus - 1), counter.bits)
        return Latched(register, count, tracker.position + counter.way(count, tracker.count))

    # --- answers --------------------------------------------------------------------------------

    def state(self) -> ExtendedState:
        """As of the latest look."""
        tracker, move = self.tracker, self.move
        lost = tracker.away or tracker.lost
        target = None if move is None or move.target is None else move.target + tracker.origin
        register = self.device.counter.compare_register(self.axis)
        compare = None
        if self.compare is not None and register is not None:
            compare = CompareState(register, self.compare, self._armed)
        warnings = [*([] if move is None else move.warnings), *([self.trouble] if self.trouble else [])]
        return ExtendedState(
            watching=True,
            counter_bits=tracker.counter.bits,
            speed_limit_pps=self.speed_limit_pps,
            latch_register=self.device.counter.latch_register(self.axis),
            state="lost" if lost is not None else "idle" if self.going is None else "moving",
            trusted=lost is None,
            reason="" if lost is None else lost.reason,
            way_out="" if lost is None else lost.way_out,
            actual=tracker.position,
            target=target,
            message="" if move is None else move.message,
            counter=tracker.count,
            pieces=None if move is None else move.pieces(tracker.extended),
            progress=None if move is None else move.progress(tracker.extended),
            encoder_position=self.encoder,
            rotary=self._turn_state(),
            compare=compare,
            last_look_s=tracker.asked_s,
            look_age_s=max(0.0, self.device.device_time_s() - tracker.asked_s),
            service_period_s=self.period_s,
            allowed_s=self.allowed_s,
            warnings=warnings,
        )

    def _turn_state(self) -> TurnState | None:
        turn, tracker = self.turn, self.tracker
        if turn is None:
            return None
        rotary = turn.rotary
        turns, place = rotary.split(tracker.position)
        return TurnState(
            turn,
            turns,
            place,
            rotary.angle_deg(tracker.position),
            None if self.encoder is None else rotary.angle_deg(self.encoder),
            turn.displacement_const(tracker.counter.modulus),
            turn.offset(tracker.position, tracker.count, tracker.counter.modulus),
        )

    def history_of(self, seconds: float) -> HistoryState:
        """Those of the last `seconds` [s]."""
        points = self.history.since(self.device.device_time_s() - seconds)
        angle = (lambda _: None) if self.turn is None else self.turn.rotary.angle_deg
        return HistoryState(
            [point.time_s for point in points],
            [point.position for point in points],
            [angle(point.position) for point in points],
            [None if point.encoder is None else angle(point.encoder) for point in points],
        )


def _checked(position: int) -> int:
    """`position`, where it fits 64 bits. Raises UsageError."""
    try:
        return checked_position(position)
    except ValueError as error:
        raise UsageError(str(error)) from error
