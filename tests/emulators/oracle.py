"""The chips again, plain and slow: every tick is a tick, nothing jumps.

Written from the law of `docs` and the data sheets, without a line of app.emulators: what both agree on in
randomised runs is the law and not somebody's shortcut. The only saving: base ticks on which no divider
of any axis fires are passed over, because nothing can happen on them.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from math import isqrt

FOREVER = 10**30


def signed(raw: int, width: int) -> int:
    return raw - (1 << width) if raw & 1 << (width - 1) else raw


@dataclass
class Axis:
    x: int = 0
    x_target: int = 0
    v_min: int = 0
    v_max: int = 0
    v_target: int = 0
    v8: int = 0
    """Velocity with eight fraction bits, signed."""
    a_max: int = 0
    accumulator: int = 0
    pmul: int = 0
    pdiv: int = 0
    mode: int = 0
    disable_left: int = 0
    disable_right: int = 0
    soft: int = 0
    ref_right: int = 0
    mask: int = 0
    flags: int = 0
    armed: int = 0
    latched: int = 0
    pulse_div: int = 0
    ramp_div: int = 0
    usrs: int = 0
    dx: int = 0
    a_threshold: int = 0
    is_v0: int = 0
    is_aleat: int = 0
    is_agtat: int = 0
    wave: int = 0
    accelerations: list[int] = field(default_factory=lambda: [0, 0, 0, 0])
    stopped_at: int = -FOREVER
    left: int = 0
    right: int = 0
    at_target: bool = True
    ref_wrong: bool = False
    ref_missing: bool = True
    compare_met: bool = False
    being_stopped: bool = False
    steps: int = 0
    steps_sent: int = 0
    direction: int = 1
    place: int = 0
    """Stage position in stage units."""
    left_at: int = 0
    right_at: int = 0
    ref_from: int = 0
    ref_to: int = 0
    forced: dict[str, int] = field(default_factory=dict)

    @property
    def speed(self) -> int:
        return abs(self.v8) >> 8

    def physical(self) -> tuple[int, int, int]:
        return (
            self.forced.get("left", int(self.place <= self.left_at)),
            self.forced.get("right", int(self.place >= self.right_at)),
            self.forced.get("reference", int(self.ref_from <= self.place <= self.ref_to)),
        )

    @property
    def stops(self) -> tuple[bool, bool]:
        tolerated = self.dx > 0 and abs(self.x) <= self.dx
        return (
            bool(self.left and not self.disable_left and not tolerated),
            bool(self.right and not self.disable_right and not tolerated),
        )


class Oracle:
    """A TMC428, or with `step_dir` a TMC4210. Time in clocks, from power-on."""

    def __init__(self, axes: int, wiring: str, ram: list[int], step_dir: bool = False) -> None:
        self.axes = [Axis() for _ in range(axes)]
        self.wiring = wiring
        self.ram = list(ram)
        self.step_dir = step_dir
        self.clock = 0
        self.tick = 0
        self.lsmd = self.ph = self.fd = self.dac = self.nscs = 0
        self.divider = 15
        self.continuous = self.refmux = self.mot1r = 0
        self.busy_until: int | None = None
        self.pending = False
        self.wanted = False
        self.datagrams = 0
        self.last_bits = ""
        self.inv_ref = self.half = self.inv_dir = self.en_sd = 0
        self.pos_comp = 0
        self.pos_comp_on = False
        self.comp_mask = self.comp_flag = 0
        self.pulse_end = 0
        self.pulses = self.merged = 0

    # --- registers ---------------------------------------------------------------------------------

    def write(self, address: int, data: int) -> None:
        """Write a register at the present clock; `run_to` first."""
        if address >= 0x40:
            cell = 2 * (address - 0x40)
            self.ram[cell : cell + 2] = [data & 0x3F, data >> 8 & 0x3F]
            self._revive_chain()
        elif address == 0x3F:
            self._write_global(data)
        elif address == 0x34 and self.step_dir:
            self.inv_ref, self.half = data & 1, data >> 2 & 1
            self.inv_dir, self.en_sd = data >> 4 & 1, data >> 5 & 1
            self.pos_comp_on = data >> 6 & 3 == 0
        elif address == 0x35 and self.step_dir:
            self.pos_comp = signed(data, 24)
        elif address == 0x36 and self.step_dir:
            self.comp_mask = data >> 8 & 1
            self.comp_flag = self.comp_flag & ~data & self.comp_mask
        else:
            self._write_axis(self.axes[address >> 4], address & 0xF, data)
        self.settle()

    def _write_global(self, data: int) -> None:
        self.mot1r = data >> 21 & 1
        self.divider = data >> 8 & 0xFF
        if self.step_dir:
            return
        self.lsmd, self.nscs = data & 3, data >> 2 & 1
        self.ph, self.fd, self.dac = data >> 4 & 1, data >> 5 & 1, data >> 6 & 1
        self.continuous, self.refmux = data >> 16 & 1, data >> 20 & 1
        self._revive_chain()

    def _write_axis(self, axis: Axis, register: int, data: int) -> None:
        match register:
            case 0x0:
                axis.x_target = signed(data & 0xFFFFFF, 24)
            case 0x1:
                axis.x = signed(data & 0xFFFFFF, 24)
            case 0x2:
                axis.v_min = data & 0x7FF
            case 0x3:
                axis.v_max = data & 0x7FF
            case 0x4:
                axis.v_target = signed(data & 0xFFF, 12)
            case 0x5 if axis.mode == 3:
                velocity = max(signed(data & 0xFFF, 12), -2047) * 256
                if velocity == 0 != axis.v8:
                    axis.stopped_at = self.tick
                axis.v8 = velocity
                axis.being_stopped = False
            case 0x6:
                axis.a_max = data & 0x7FF
            case 0x8 if not self.step_dir:
                axis.a_threshold = data & 0x7FF
                axis.is_v0, axis.is_aleat, axis.is_agtat = data >> 12 & 7, data >> 16 & 7, data >> 20 & 7
            case 0x9:
                axis.pdiv, axis.pmul = data & 0xF, data >> 8 & 0x7F
            case 0xA:
                axis.mode = data & 3
                axis.disable_left, axis.disable_right = data >> 8 & 1, data >> 9 & 1
                axis.soft, axis.ref_right = data >> 10 & 1, data >> 11 & 1
            case 0xB:
                axis.mask = data >> 8 & 0xFF
                axis.flags = axis.flags & ~(data & 0xFF) & axis.mask
            case 0xC:
                if not self.step_dir:
                    axis.usrs = data & 7
                axis.ramp_div = data >> 8 & 0xF
                before, axis.pulse_div = axis.pulse_div, data >> 12 & 0xF
                if before != axis.pulse_div and axis.mode >= 2 and axis.wave // self.width(axis) % 2:
                    self._turn(axis, axis.direction)
                    axis.steps += 1
                    self.wanted = True
                    self.pulses += self.en_sd
            case 0xD:
                axis.dx = data & 0xFFF
            case 0xE:
                axis.armed = 1
            case 0xF if self.step_dir:
                axis.wave = data & 0xFF

    def read(self, address: int) -> int:
        axis = self.axes[address >> 4] if address < 0x30 else self.axes[0]
        match address & 0xF:
            case _ if address == 0x3E:
                if self.step_dir:
                    return axis.right | axis.left << 1
                return sum((a.right | a.left << 1) << 2 * i for i, a in enumerate(self.axes))
            case 0x6 if address == 0x36:
                return self.comp_mask << 8 | self.comp_flag
            case 0x1:
                return axis.x & 0xFFFFFF
            case 0x4:
                return axis.v_target & 0xFFF
            case 0x5:
                return (axis.speed if axis.v8 > 0 else -axis.speed) & 0xFFF
            case 0x7:
                total = sum(axis.accelerations)
                return (abs(total) // 4 * (1 if total > 0 else -1)) & 0xFFF
            case 0xB:
                return axis.mask << 8 | axis.flags
            case 0xE:
                return axis.latched & 0xFFFFFF
            case 0xF:
                return axis.wave if self.step_dir else 0
        raise KeyError(address)

    def status(self) -> int:
        bits = 0
        for i, axis in enumerate(self.axes):
            bits |= (axis.x == axis.x_target) << 2 * i
            bits |= (axis.right if axis.ref_right and not self.step_dir else axis.left) << 2 * i + 1
        if self.step_dir and not self.mot1r:
            bits |= (self.axes[0].physical()[1] ^ self.inv_ref) << 5
        interrupt = any(axis.flags for axis in self.axes) or (self.comp_flag and self.comp_mask)
        return bits | bool(interrupt) << 7

    # --- time --------------------------------------------------------------------------------------

    def run_to(self, clock: int) -> None:
        stride = min(1 << min(axis.ramp_div, axis.pulse_div) for axis in self.axes)
        tick = self.tick - self.tick % stride + stride
        while tick * 32 <= clock:
            self._end_datagrams(tick * 32)
            self.tick = tick
            self._one_tick(tick)
            tick += stride
        self._end_datagrams(clock)
        self.tick = clock // 32
        self.clock = clock

    def _one_tick(self, tick: int) -> None:
        for axis in self.axes:
            if tick % (1 << axis.ramp_div) == 0:
                self._ramp_tick(axis)
            if tick % (1 << axis.pulse_div) == 0:
                axis.accumulator += axis.speed
                if axis.accumulator >= 2048:
                    axis.accumulator -= 2048
                    self._step(axis)
        if self.continuous:
            for axis, offset in zip(self.axes, (0, 341, 683), strict=False):
                if (tick - (offset << axis.ramp_div)) % (1024 << axis.ramp_div) == 0:
                    self.wanted = True
        if self.wanted:
            self._request(tick * 32)

    def _ramp_tick(self, axis: Axis) -> None:
        limits = axis.stops
        goal8 = axis.v8
        abrupt = False
        if axis.mode in (0, 1):
            distance = signed(axis.x_target - axis.x & 0xFFFFFF, 24)
            d = min(abs(distance), 2**19 - 1)
            p_mul, p_div = 128 + axis.pmul, 2 ** (3 + axis.pdiv)
            if d == 0:
                axis.v_target = 0
                abrupt = axis.speed <= axis.v_min
            else:
                wanted = isqrt(2048 * p_mul * d // p_div) if axis.mode == 0 else p_mul * d // p_div
                wanted = min(max(wanted, axis.v_min), axis.v_max)
                axis.v_target = wanted if distance > 0 else -wanted
            goal8 = axis.v_target * 256
        elif axis.mode == 2:
            goal8 = max(-axis.v_max, min(axis.v_max, axis.v_target)) * 256
        if (goal8 < 0 and limits[0]) or (goal8 > 0 and limits[1]):
            goal8 = 0
        before = axis.v8
        if abrupt:
            axis.v8 = 0
        elif axis.v8 < goal8:
            axis.v8 = min(goal8, axis.v8 + axis.a_max)
        elif axis.v8 > goal8:
            axis.v8 = max(goal8, axis.v8 - axis.a_max)
        axis.accelerations = [0 if abrupt else axis.v8 - before, *axis.accelerations[:3]]
        if axis.v8 == 0:
            axis.being_stopped = False
            if before != 0:
                axis.stopped_at = self.tick

    def _step(self, axis: Axis) -> None:
        direction = 1 if axis.v8 > 0 else -1
        axis.x = signed(axis.x + direction & 0xFFFFFF, 24)
        axis.steps += 1
        axis.direction = direction
        self.wanted = True
        missed = False
        if self.en_sd:
            missed = not self.half and self.tick * 32 < self.pulse_end
            self.pulses += not missed
            self.merged += missed
            self.pulse_end = self.tick * 32 + 16 * (1 + self.divider)
        self._turn(axis, direction, sent=not missed)
        self._sample_direct()
        self._conditions(axis)
        if axis.mode < 2 and axis.x == axis.x_target and axis.speed <= axis.v_min:
            self._stop(axis)

    def width(self, axis: Axis) -> int:
        return 1 if self.step_dir else {0: 64, 1: 32, 2: 16, 3: 8, 4: 4, 5: 2}.get(axis.usrs, 1)

    def _turn(self, axis: Axis, direction: int, sent: bool = True) -> None:
        axis.wave = (axis.wave + direction * self.width(axis)) % 256
        if self.step_dir:
            if self.en_sd and sent:
                axis.place += -direction if self.inv_dir else direction
        else:
            axis.place += direction * self.width(axis) * (-1 if self.ph else 1)

    def _stop(self, axis: Axis) -> None:
        if axis.v8:
            axis.stopped_at = self.tick
        axis.v8 = 0
        axis.being_stopped = False

    # --- switches and conditions ------------------------------------------------------------------------

    def settle(self) -> None:
        """After a write or a change of the plant: what is not clocked follows at once."""
        self._sample_direct()
        for axis in self.axes:
            self._conditions(axis)
        if self.wanted:
            self._request(self.clock)

    def _conditions(self, axis: Axis) -> None:
        reference = axis.right if axis.ref_right else axis.left
        compared = self.pos_comp_on and axis.x == self.pos_comp
        news = (
            (axis.x == axis.x_target) and not axis.at_target,
            bool(reference and abs(axis.x) > axis.dx) and not axis.ref_wrong,
            bool(not reference and axis.x == 0) and not axis.ref_missing,
        )
        axis.at_target = axis.x == axis.x_target
        axis.ref_wrong = bool(reference and abs(axis.x) > axis.dx)
        axis.ref_missing = bool(not reference and axis.x == 0)
        for bit, new in enumerate(news):
            if new and axis.mask >> bit & 1:
                axis.flags |= 1 << bit
        if compared and not axis.compare_met and self.comp_mask:
            self.comp_flag = 1
        axis.compare_met = compared
        left, right = axis.stops
        if (axis.v8 < 0 and left) or (axis.v8 > 0 and right):
            if not axis.being_stopped:
                axis.flags |= 8 & axis.mask
            axis.being_stopped = True
            if not axis.soft:
                self._stop(axis)
        else:
            axis.being_stopped = False

    def _pin(self, number: int, nscs: int) -> int:
        left, right, reference = self.axes[number].physical()
        if self.wiring == "two-one-null" and number == 2:
            return self.axes[0].physical()[1]
        if self.wiring == "multiplexed" and nscs == 0:
            return right
        return left | reference

    def _sample_direct(self) -> None:
        if self.step_dir:
            left, right, reference = self.axes[0].physical()
            self._see(0, (left | reference) ^ self.inv_ref, (right ^ self.inv_ref) if self.mot1r else 0)
        elif not self.refmux:
            rest = 1 - self.nscs
            pins = [self._pin(number, rest) for number in range(3)]
            for i, axis_pins in enumerate(
                ((pins[0], pins[2]), (pins[1], 0), (0, 0)) if self.mot1r else ((pin, 0) for pin in pins)
            ):
                self._see(i, *axis_pins)

    def _see(self, i: int, left: int, right: int) -> None:
        axis = self.axes[i]
        if (left, right) == (axis.left, axis.right):
            return
        events = 0
        if left != axis.left:
            events |= 1 << 6 if left else 1 << 4
        if right != axis.right:
            events |= 1 << 7 if right else 1 << 5
        axis.flags |= events & axis.mask
        reference_moved = right != axis.right if axis.ref_right else left != axis.left
        axis.left, axis.right = left, right
        if reference_moved and axis.armed and axis.speed:
            axis.latched, axis.armed = axis.x, 0
        self._conditions(axis)

    # --- driver chain --------------------------------------------------------------------------------------

    def _chain(self) -> list[tuple[int, int]] | None:
        """(motor, signal code) for every bit, or None for an unbounded datagram."""
        if not any(word & 0x20 for word in self.ram[:64]):
            return None
        bits, motor, cell = [], 0, 0
        while motor <= self.lsmd:
            bits.append((motor, self.ram[cell] & 0x1F))
            motor += self.ram[cell] >> 5
            cell = (cell + 1) % 64
        return bits

    def _duration(self) -> int:
        bits = self._chain()
        if bits is None:
            return FOREVER
        between = (bits[-1][0] + 1) * (3 if self.divider > 7 else 2)
        return (2 + 2 * len(bits) + 2 + between) * (max(self.divider, 7) + 1)

    def _revive_chain(self) -> None:
        if self.busy_until is not None and self.busy_until >= FOREVER and self._chain() is not None:
            self.busy_until = self.clock + self._duration()

    def _request(self, clock: int) -> None:
        self.wanted = False
        if self.step_dir:
            return
        if self.busy_until is not None:
            self.pending = True
        else:
            self._send(clock, self.tick)

    def _end_datagrams(self, until: int) -> None:
        while self.busy_until is not None and self.busy_until <= until:
            now, self.busy_until = self.busy_until, None
            if self.pending:
                self._send(now, -(-now // 32) - 1)

    def _send(self, clock: int, tick: int) -> None:
        self.datagrams += 1
        self.pending = False
        self.busy_until = clock + self._duration()
        self.last_bits = self._bits(tick)
        for axis in self.axes:
            axis.steps_sent = axis.steps
        if self.refmux:
            rest = 1 - self.nscs
            for i in range(3):
                self._see(i, self._pin(i, rest), self._pin(i, 1 - rest))

    def _bits(self, tick: int) -> str:
        drawn = [self._signals(axis, tick) for axis in self.axes] + [[0] * 16 + [0, 1, 0, 0]]
        return "".join(str(drawn[motor][code]) if code < 20 else "1" for motor, code in self._chain() or [])

    def _signals(self, axis: Axis, tick: int) -> list[int]:
        """The twenty primary signals of a motor, by their codes (DS-TMC428 Table 11-1)."""
        resting = axis.v8 == 0
        if resting and tick - axis.stopped_at >= 255 * 2**axis.ramp_div:
            scale = axis.is_v0
        elif not resting and axis.a_threshold <= 1023 and abs(axis.accelerations[0]) > axis.a_threshold:
            scale = axis.is_agtat
        else:
            scale = axis.is_aleat
        quadrant, part = divmod(axis.wave, 64)
        table = [*self.ram[64:], self.ram[127]]
        if axis.usrs == 0:
            sine = cosine = 63
        elif quadrant % 2 == 0:
            sine, cosine = table[part], table[64 - part]
        else:
            sine, cosine = table[64 - part], table[part]
        signals: list[int] = []
        for amplitude, phase, decay in (
            (sine, quadrant < 2, quadrant % 2 == 1),
            (cosine, quadrant in (0, 3), quadrant % 2 == 0),
        ):
            value = amplitude * (scale or 8) // 8
            signals += [value >> bit & 1 ^ self.dac for bit in range(6)]
            signals += [phase ^ self.ph, decay ^ self.fd]
        return [*signals, 0, 1, int(axis.direction < 0), int(axis.steps != axis.steps_sent)]
