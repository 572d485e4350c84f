"""The ramp generator that TMC428 and TMC4210 share: its registers, what is remembered of them, its state."""

from __future__ import annotations

from abc import abstractmethod

from ...calc.units.mechanics import Mechanics
from ...calc.units.tmc428 import acceleration_hz_s, pulse_rate_hz
from ...clock import Clock
from ...errors import OutOfRange
from ...links.access32 import SPI32
from ...links.datagram32 import FRAME_BYTES, Request, status_flags
from ...links.port import FramePort
from ...links.queue import Priority
from ...registers.model import Access, Register
from ..core.changes import BY_HAND, register_changed
from ..core.config import DeviceConfig
from ..core.motion import Setting, distance
from ..core.prediction import Prediction
from ..core.register_chip import RegisterChip
from ..core.register_io import Words
from ..core.results import AxisState, RawExchange, Switches
from ..core.signs import Signs
from . import signs as ramp_signs
from .axis_rows import HOLD_MODE, POSITIONING_MODES, AxisRows
from .prediction import TickedBook


class RampChip(RegisterChip):
    """A chip of 32-bit datagrams whose axes are ramp generators of this kind."""

    status_names: tuple[str, ...]
    """Names of the status bits of each reply, bit 0 first, "" where unused."""

    def __init__(self, device_id: str, config: DeviceConfig, port: FramePort, clock: Clock) -> None:
        super().__init__(device_id, config, port, clock, SPI32)
        self.rows = tuple(self._axis_rows(axis) for axis in range(self.family.axes))
        self._books = tuple(TickedBook() for _ in self.rows)
        self._known: dict[int, int] = {}
        """What the chip was last seen to hold, by address, of the registers that decide a motion."""
        self._remembered = frozenset(
            register.address for rows in self.rows for register in (*Setting.rows(rows), rows.x_target, rows.v_target)
        )
        self._motion = {
            register.address: axis
            for axis, rows in enumerate(self.rows)
            for register in (
                *Setting.rows(rows),
                rows.x_target,
                rows.x_actual,
                rows.v_target,
                rows.v_actual,
                rows.tolerance,
            )
        }
        """Registers whose write may move or stop an axis."""
        self._before: dict[int, tuple[int, int, float]] = {}
        """Per axis: x_actual and v_actual just before a write, and when the write went out."""

    # --- what differs ---------------------------------------------------------------------------

    @abstractmethod
    def _axis_rows(self, axis: int) -> AxisRows:
        """The registers of `axis`."""

    @abstractmethod
    def _microsteps(self, axis: int) -> int | None:
        """Microsteps per full step as the chip is set; None where not known yet."""

    @abstractmethod
    async def _switches(self, words: Words, axis: int) -> tuple[bool | None, bool | None]:
        """Left and right switch; None where there is none."""

    @abstractmethod
    def _reached(self, status: int, axis: int) -> bool:
        """Whether the status bits say that `axis` is at its target (xEQt)."""

    async def _motion_warnings(self, words: Words) -> list[str]:
        """Why steps may not get to the motor although the ramp generator runs."""
        return []

    def switch_problem(self) -> tuple[str, str] | None:
        """Why switches cannot be trusted at rest, and the way out, by the registers last seen; None where they can."""
        return None

    def switch_latency_s(self) -> float:
        """How old the switch states of a chip at rest may be, device time [s]."""
        return 0.0

    # --- what is remembered ---------------------------------------------------------------------

    async def refresh(self) -> None:
        registers = [register for rows in self.rows for register in Setting.rows(rows)]
        for register in registers:
            async with self.queue.turn(Priority.COMMAND) as turn:
                self._saw_word(register, await Words(turn).read(register))

    def _saw_word(self, register: Register, word: int) -> None:
        if register.address not in self._remembered:
            return
        self._known[register.address] = word
        if self.limiter is not None:
            self.limiter.saw(register.address, word, register.width)
        axis = register.axis
        if axis is not None and register is self.rows[axis].dividers:
            rows, known = self.rows[axis], self.axes[axis]
            known.pulse_div = min(rows.pulse_div.unpack(word), 13)
            known.ramp_div = min(rows.ramp_div.unpack(word), 13)
            known.microsteps_per_full_step = self._microsteps(axis)

    def _sent(self, register: Register, word: int) -> None:
        axis = self._motion.get(register.address)
        if axis is not None:
            x_actual, v_actual, _ = self._before.get(axis, (0, 1, 0.0))
            self._before[axis] = (x_actual, v_actual, self.port.last_exchange_s)
            self.commanded(axis, register.name)

    def remembered_word(self, address: int) -> int | None:
        return self._known.get(address)

    def setting(self, axis: int) -> Setting | None:
        """The setting of an axis as last seen; None before everything of it was seen once."""
        rows = self.rows[axis]
        if any(register.address not in self._known for register in Setting.rows(rows)):
            return None
        return Setting.of(rows, self._known)

    def mechanics(self, axis: int) -> Mechanics:
        """Conversions of an axis as the chip is set now."""
        return self.axes[axis].settings.mechanics(self._microsteps(axis) or 1)

    # --- state ----------------------------------------------------------------------------------

    async def axis_state(self, axis: int, priority: Priority = Priority.COMMAND) -> AxisState:
        self.axis(axis)
        self.require_connected()
        rows = self.rows[axis]
        async with self.queue.turn(priority) as turn:
            words = Words(turn)
            setting = await self._read_setting(words, axis)
            interrupts = await words.read(rows.interrupts)
            left, right = await self._switches(words, axis)
            x_target = await words.value(rows.x_target)
            v_target = await words.value(rows.v_target)
            a_actual = await words.value(rows.a_actual)
            v_actual = await words.value(rows.v_actual)
            x_actual = await words.value(rows.x_actual)
            time_s, status = words.time_s, words.status
            asked_at_s = words.asked_s
        self.saw_position(axis, x_actual, asked_at_s)
        reached = self._reached(status, axis)
        flags = status_flags(status, self.status_names)
        flags |= {
            part.name: bool(part.unpack(interrupts)) for part in rows.interrupts.fields if part.access is Access.R_W1C
        }
        flags[rows.latch_waiting.name] = bool(rows.latch_waiting.unpack(setting.reference))
        to_go = distance(x_target, x_actual)
        moving = self._moving(rows, setting, v_actual, v_target, to_go, left, right)
        if not moving and (to_go if setting.mode in POSITIONING_MODES else v_target):
            self._books[axis].end(time_s, "the motor stands: a switch stopped it")
        home = right if rows.reference_right.unpack(setting.reference) else left
        return AxisState(
            position=x_actual,
            target_position=x_target,
            velocity_pps=pulse_rate_hz(v_actual, setting.pulse_div, self.clock_hz),
            target_velocity_pps=pulse_rate_hz(v_target, setting.pulse_div, self.clock_hz),
            acceleration_pps2=self._acceleration(a_actual, setting),
            position_reached=reached,
            moving=moving,
            mode=rows.mode.values[setting.mode],
            switches=Switches(left, right, home),
            flags=flags,
            time_s=time_s,
        )

    def signs(self, axis: int, state: AxisState) -> Signs:
        index = self.axis(axis).index
        return ramp_signs.signs(self.rows[index], index, self.setting(index), state)

    def _acceleration(self, a_actual: int, setting: Setting) -> float:
        # a_actual is drawn with 12 signed bits; its extreme -2048 is no value that a_max can make.
        return acceleration_hz_s(max(-2047, a_actual), setting.pulse_div, setting.ramp_div, self.clock_hz)

    @staticmethod
    def _moving(
        rows: AxisRows,
        setting: Setting,
        v_actual: int,
        v_target: int,
        to_go: int,
        left: bool | None,
        right: bool | None,
    ) -> bool:
        """v_actual reads 0 below one chip unit too, so 0 alone does not say that the motor rests (DS-TMC428 8.6)."""
        if v_actual:
            return True
        if not setting.v_max or not setting.a_max or setting.mode == HOLD_MODE:
            return False
        wanted = to_go if setting.mode in POSITIONING_MODES else v_target
        return bool(wanted) and not setting.blocked(rows, 1 if wanted > 0 else -1, left, right)

    async def _read_setting(self, words: Words, axis: int) -> Setting:
        rows = self.rows[axis]
        for register in Setting.rows(rows):
            self._saw_word(register, await words.read(register))
        return Setting.of(rows, self._known)

    # --- predictions ----------------------------------------------------------------------------

    def prediction(self, axis: int) -> Prediction | None:
        self.axis(axis)
        return self._books[axis].present()

    def predictions(self, axis: int) -> TickedBook:
        """For sample plans: what was expected at any recent time."""
        return self._books[axis]

    # --- raw ------------------------------------------------------------------------------------

    async def exchange(self, frame: bytes) -> RawExchange:
        if len(frame) != FRAME_BYTES:
            raise OutOfRange("frame length", len(frame), FRAME_BYTES, FRAME_BYTES, "bytes")
        self.require_connected()
        request = Request.decode(frame)
        register = self.table.at(request.address)
        async with self._command(register.axis if register and not request.read else None) as turn:
            reply = await turn.exchange(frame)
        status, data = reply[0], int.from_bytes(reply[1:], "big")
        if register is not None:
            if request.read:
                self._saw_word(register, data)
            else:
                old = self._known.get(register.address)
                self._sent(register, request.data)
                self._tell(register_changed(register, old, request.data, self.port.last_exchange_s, BY_HAND))
                await self._after_write(register)
        shown = data if request.read else request.data
        return RawExchange(
            reply,
            {
                "address": request.address,
                "register": register.name if register else None,
                "axis": register.axis if register else None,
                "rw": "read" if request.read else "write",
                "data": data,
                "value": register.decode(shown) if register else None,
                "fields": register.unpack(shown) if register else {},
                "status": status,
                "flags": status_flags(status, self.status_names),
            },
        )
