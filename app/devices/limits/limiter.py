"""The one check: what is about to go out, against what the user allows the axes of a device.

Drivers ask it as soon as they know what they want, with everything of a move or a batch, so that nothing of it is sent.
`LinkQueue` asks it again with every frame that is no stop, right before it goes out: what nobody thought of asking for
does not get by. It keeps in mind what went out and was seen, so that a judgement costs no question on the line.

A word is refused where what it means is beyond a limit and more than it was. So what slows down always passes, also
from beyond a limit; and where a limit is set below what a chip holds already, that is told (`findings`), stays as it
is, and no motion begins by it.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence

from ...errors import SoftLimit, WrongState
from ...number_text import plain
from ..core.axis_limits import AxisLimits
from ..core.limit_rules.quantities import UNITS, Motion, Quantity, View, limit_of
from ..core.limit_rules.rules import SLACK, Rules

Writes = Iterable[tuple[int, int]]
OUTSIDE = "come back by a move to a position inside"


class Limiter:
    """The limits of one device. `rules` knows its family."""

    def __init__(self, rules: Rules) -> None:
        self.rules = rules
        self.positions: dict[int, int] = {}
        """What the counters showed last [microsteps]."""
        self.end_watch: Callable[[], None] = lambda: None
        """Ends what looks at the axes for it (`watch`)."""
        self._writes = rules.decoder()
        self._concerns = rules.concerns if rules.tells_more else None
        self._held: dict[int, int | None] = {}
        """Words as they went out or were seen, by address; None where a write may have arrived or not."""
        self._touched: dict[int, list[int]] = {}
        """Which axes a write to an address affects_limits to."""
        self._by_address: list[dict[int, list[Quantity]]] = []
        self._depends = {address for row in rules.quantities for one in row for address in (one.address, *one.others)}
        for axis, quantities in enumerate(rules.quantities):
            by_address: dict[int, list[Quantity]] = {}
            for quantity in quantities:
                if limit_of(self.limits[axis], quantity.kind) is not None:
                    for address in {quantity.address, *quantity.others}:
                        by_address.setdefault(address, []).append(quantity)
            self._by_address.append(by_address)
            places = {place.address for place in rules.positions[axis]}
            for address in {*by_address, *places, *rules.sources[axis]} if self.limits[axis].given else ():
                self._touched.setdefault(address, []).append(axis)
        self._position_registers = [{place.address: place for place in places} for places in rules.positions]

    @property
    def limits(self) -> tuple[AxisLimits, ...]:
        return self.rules.limits

    # --- what is known --------------------------------------------------------------------------

    def saw(self, address: int, word: int, width: int = 32) -> None:
        """For drivers: the register of `width` bits was read."""
        # Bits above it read 0. Where they do not, nobody drives the line, and a great number must excuse nothing.
        self._held[address] = None if word >> width > 0 else word

    def at(self, axis: int, position: int) -> None:
        """For drivers: the counter was read [microsteps]."""
        self.positions[axis] = position

    def forget(self) -> None:
        """It may be another chip, or the same after a reset: what can be read has to be read again.

        What cannot, the driver knows as far as anybody does; what may have arrived or not stays unknown.
        """
        unknown = {address for address, word in self._held.items() if word is None}
        self._held = dict.fromkeys(unknown | {address for address in self._depends if self.rules.readable(address)})
        self.positions.clear()

    def reset(self) -> None:
        """The chip was reset, and the driver knows it: what went out is true no more."""
        self._held.clear()
        self.positions.clear()

    def adopt(self, other: Limiter) -> None:
        """Go on from what another limiter of the same device knew."""
        self._held, self.positions = other._held, other.positions

    def view(self, pending: Mapping[int, int] | None = None) -> View:
        """What registers hold, `pending` above what went out."""
        held, remembered = self._held, self.rules.remembered

        def word(address: int) -> int | None:
            if pending is not None and address in pending:
                return pending[address]
            return held[address] if address in held else remembered(address)

        return word

    async def learn(self) -> None:
        """Read what decides and can be read. Raises BenchError."""
        await self.rules.learn()

    async def learn_for(self, command: int, type_: int, value: int) -> None:
        """For commands of a module: read what this one counts from. Raises BenchError."""
        await self.rules.learn_for(command, type_, value)

    # --- frames: what LinkQueue asks ------------------------------------------------------------

    def writes(self, frames: Sequence[bytes]) -> bool:
        """Whether one of the frames writes something that affects_limits here."""
        told, touched, concerns = self._writes, self._touched, self._concerns
        for frame in frames:  # plain loops: this is asked about every reading too
            for address, _ in told(frame):
                if address in touched:
                    return True
            if concerns is not None and concerns(frame):
                return True
        return False

    def check(self, frames: Sequence[bytes]) -> None:
        """Raises SoftLimit, or WrongState where a frame does not tell what it comes to. All of them are judged, in
        their order, before the first goes out."""
        pending: dict[int, int] = {}
        for frame in frames:
            told = self.rules.require_told(frame, self.view(pending))
            self._judge_all(self.rules.writes(frame) if told is None else told, pending)

    def sent(self, frames: Sequence[bytes], replies: Sequence[bytes]) -> None:
        """The frames went out and were answered."""
        rules = self.rules
        for frame, reply in zip(frames, replies, strict=True):
            if rules.accepted(frame, reply):
                self._held.update(rules.writes(frame))
                self._held.update(dict.fromkeys(rules.forgotten(frame)))

    def mark_unknown(self, frames: Sequence[bytes]) -> None:
        """The frames may have gone out, or some of them."""
        for frame in frames:
            for address, _ in self.rules.writes(frame):
                self._held[address] = None
            self._held.update(dict.fromkeys(self.rules.forgotten(frame)))

    # --- what drivers ask -----------------------------------------------------------------------

    def check_writes(self, writes: Writes) -> None:
        """Raises SoftLimit where one of these writes, made in this order, would go beyond a limit."""
        self._judge_all(writes, {})

    def affects_limits(self, address: int) -> bool:
        """Whether a write there can go beyond a limit."""
        return address in self._touched

    def require_target(self, axis: int, target: int, position: int | None = None, what: str = "") -> None:
        """Raises SoftLimit for a target outside the range, unless it is on the way back into it; `what` it is for."""
        limits = self.limits[axis]
        beyond = limits.beyond(target)
        if not beyond:
            return
        here = self.positions.get(axis) if position is None else position
        outside = 0 if here is None else limits.beyond(here)
        if beyond * outside > 0 and abs(beyond) <= abs(outside):
            return
        raise SoftLimit("position", target, target - beyond, axis, UNITS["position"], what)

    def require_way(self, axis: int, way: float, position: int | None = None) -> None:
        """Raises SoftLimit where the axis is at the end of its range and is to turn on that way."""
        limits = self.limits[axis]
        here = self.positions.get(axis) if position is None else position
        if here is None:
            return
        end = limits.position_max if way > 0 else limits.position_min
        if way and end is not None and (here - end) * way >= 0:
            what = "it is there already"
            raise SoftLimit("position", here, end, axis, UNITS["position"], what, OUTSIDE if here != end else "")

    def require_velocity(self, axis: int, velocity_pps: float) -> None:
        """Raises SoftLimit for a speed beyond the limit."""
        limit = self.limits[axis].velocity_max_pps
        if limit is not None and abs(velocity_pps) > limit * SLACK:
            raise SoftLimit("velocity", abs(velocity_pps), limit, axis, UNITS["velocity"])

    def rounded(self, axis: int, counts: int, unit_pps: float) -> int:
        """A velocity in the chip's counts that was allowed and rounded to the nearest: not above the limit by that."""
        limit = self.limits[axis].velocity_max_pps
        if limit is None or abs(counts) * unit_pps <= limit * SLACK:
            return counts
        fewer = math.floor(limit * SLACK / unit_pps)
        if fewer == 0:
            raise SoftLimit("velocity", unit_pps, limit, axis, UNITS["velocity"], "the least there is")
        return fewer if counts > 0 else -fewer

    def findings(self, axis: int) -> list[str]:
        """What the chip holds beyond the limits, and what to write."""
        limits, view = self.limits[axis], self.view()
        told = []
        for quantity in self.rules.quantities[axis]:
            limit, value = limit_of(limits, quantity.kind), quantity.value(view)
            if limit is not None and value is not None and value > limit * SLACK:
                unit = UNITS[quantity.kind]
                told.append(
                    f"{quantity.name} is {plain(value, 6)} {unit}, above the limit of {plain(limit, 6)} {unit}: "
                    f"{quantity.said(view, limit)}"
                )
        position = self.positions.get(axis)
        if position is not None and limits.beyond(position):
            told.append(f"the axis is at {position}, outside of its range: {OUTSIDE}")
        return told

    def require_as(self, rules: Rules) -> None:
        """Raises SoftLimit where by `rules`, of another clock, something is beyond a limit that is not by these."""
        view = self.view()
        for axis, (now, then) in enumerate(zip(self.rules.quantities, rules.quantities, strict=True)):
            for quantity, other in zip(now, then, strict=True):
                limit, wanted = limit_of(self.limits[axis], quantity.kind), other.value(view)
                if limit is None or wanted is None or wanted <= limit * SLACK:
                    continue
                if wanted > (quantity.value(view) or 0.0) * SLACK:
                    raise self._refused(axis, other, wanted, limit, view)

    # --- judging --------------------------------------------------------------------------------

    def _judge_all(self, writes: Writes, pending: dict[int, int]) -> None:
        for address, word in writes:
            for axis in self._touched.get(address, ()):
                self._judge(axis, address, word, pending)
            pending[address] = word

    def _judge(self, axis: int, address: int, word: int, pending: dict[int, int]) -> None:
        limits, rules = self.limits[axis], self.rules
        before, after = self.view(pending), self.view({**pending, address: word})
        lowers = False
        for quantity in self._by_address[axis].get(address, ()):
            limit = limit_of(limits, quantity.kind)
            assert limit is not None  # only those are in the table
            own = quantity.address == address
            wanted, held = quantity.worst(after), quantity.value(before) if own else quantity.worst(before)
            if own and held is not None and wanted <= held:
                lowers = True
            if wanted > limit * SLACK and not (held is not None and wanted <= held * SLACK):
                raise self._refused(axis, quantity, wanted, limit, after, word if own else None)
        place = self._position_registers[axis].get(address)
        if place is not None and limits.ranged:
            position = place.position(word, after)
            if position is not None:
                self.require_target(axis, position)
        if address in rules.sources[axis] and not lowers:
            self._judge_start(axis, address, before, after)

    def _judge_start(self, axis: int, address: int, before: View, after: View) -> None:
        """A write that may set the axis in motion: whatever it then goes by has to be within the limits."""
        limits, motion = self.limits[axis], self.rules.motion(axis, after, address)
        if motion is None or motion == self.rules.motion_before(axis, before, address):
            return
        for quantity in motion.quantities:
            limit = limit_of(limits, quantity.kind)
            if limit is None:
                continue
            value = quantity.value(after)
            if value is None:
                raise WrongState(
                    f"nobody knows {quantity.name} of axis {axis}, and a soft limit of {quantity.kind} is set",
                    f"write {quantity.name} first",
                )
            if value > limit * SLACK:
                raise self._refused(axis, quantity, value, limit, after)
        if motion.jumps and limits.acceleration_max_pps2 is not None:
            raise SoftLimit(
                "acceleration",
                math.inf,
                limits.acceleration_max_pps2,
                axis,
                UNITS["acceleration"],
                "the velocity would jump",
                "move on a ramp",
            )
        if motion.positioning and motion.target is not None:
            self.require_target(axis, motion.target)
        elif not motion.positioning:
            self.require_way(axis, motion.way)

    def _refused(
        self, axis: int, quantity: Quantity, wanted: float, limit: float, view: View, word: int | None = None
    ) -> SoftLimit:
        what = quantity.name if word is None else f"{quantity.name} {word}"
        return SoftLimit(quantity.kind, wanted, limit, axis, UNITS[quantity.kind], what, quantity.said(view, limit))

    def motion(self, axis: int) -> Motion | None:
        """What the axis does, as far as is known."""
        return self.rules.motion(axis, self.view())

    def ranged(self) -> Iterator[int]:
        """Axes whose position is limited."""
        return (axis for axis, limits in enumerate(self.limits) if limits.ranged)
