"""The chip behind the link: whether it is the right one, and what the driver keeps in mind of it."""

from __future__ import annotations

from ...calc.units.mechanics import Mechanics
from ...clock import Clock
from ...errors import BenchError, OtherModel, WrongState
from ...links.port import FramePort
from ...registers.model import Register
from ...registers.tmc4361.general import RESET_CODE
from ..core.config import DeviceConfig
from ..core.planned_motion import PlannedMotion
from ..core.prediction import Prediction, PredictionBook
from ..core.results import DeviceState
from ..core.shadow_registers import NOTHING, KeepingChip
from ..recognition import models_found
from . import rows
from .cruise import Cruise
from .identity import is_one
from .setting import Setting

CLOCK_TOLERANCE = 0.005
"""By how much CLK_FREQ may differ from the clock before a move warns of it: a crystal's error and some rounding."""


class Chip(KeepingChip):
    """A TMC4361, without what it does."""

    def __init__(self, device_id: str, config: DeviceConfig, port: FramePort, clock: Clock) -> None:
        super().__init__(device_id, config, port, clock)
        self.cruise = Cruise()
        self._remembered = frozenset(register.address for register in rows.REMEMBERED)
        self._book: PredictionBook[PlannedMotion] = PredictionBook()
        self._fresh = False
        """Whether what nobody has written through here is as after a reset: so it is once a reset was seen."""

    # --- who it is ------------------------------------------------------------------------------

    async def probe(self) -> str:
        where = await self._on_board()
        async with self.queue.turn() as turn:
            version, clock_hz = await self.words(turn).read_many((rows.VERSION, rows.CLK_FREQ))
        if is_one(version, clock_hz):
            return f"a TMC4361 answers, version {version}, CLK_FREQ {clock_hz / 1e6:g} MHz{where}"
        found = await models_found(self.queue, self.access)
        if version == clock_hz and version in NOTHING and not found:
            raise WrongState(
                f"no TMC4361 answers here: all bits read {version & 1}", "check power, wiring and chip select"
            )
        raise OtherModel(
            f"this is no TMC4361: VERSION_NO reads {version:#010x} and CLK_FREQ {clock_hz:#010x}",
            self.model,
            found,
            foreign=True,
        )

    async def refresh(self) -> None:
        async with self.queue.turn() as turn:
            await self._remember(self.words(turn), rows.REMEMBERED)

    # --- what is kept in mind -------------------------------------------------------------------

    def _saw_word(self, register: Register, word: int) -> None:
        """The chip was seen to hold `word`. Rows that share an address are told apart by their access."""
        if register.address not in self._remembered or not register.access.readable:
            return
        self._known[register.address] = word
        if self.limiter is not None:
            self.limiter.saw(register.address, word)
        if register is rows.VMAX:
            self.cruise.saw_vmax(register.decode(word))
        elif register is rows.RAMPMODE:
            self.cruise.saw_mode(word)
        elif register is rows.STEP_CONF:
            self.axes[0].microsteps_per_full_step = self._microsteps(word)

    def _sent(self, register: Register, word: int) -> None:
        """`word` went out by somebody's hand."""
        if not register.access.readable:
            self._blind[register.address] = word
            self._known.pop(register.address, None)  # ENC_CONST follows from ENC_IN_RES
        if register is rows.RESET and rows.part(rows.RESET, "RESET_REG").unpack(word) == RESET_CODE:
            self._forget_setting()
        if register.address in rows.MOVING:
            self.commanded(rows.AXIS, register.name)

    def _forget_setting(self) -> None:
        """The chip was reset: what was known is true no more."""
        self._known.clear()
        self._blind.clear()
        if self.limiter is not None:
            self.limiter.reset()
        self._fresh = True
        self.cruise.forget()
        self._book.end(self.device_time_s(), "the chip was reset")

    def word_unread(self, register: Register) -> int | None:
        """What a register that cannot be read holds: as it was written through here, else as after the reset that was
        seen; None where nobody knows."""
        return self._blind.get(register.address, register.reset if self._fresh else None)

    def setting(self) -> Setting | None:
        """The ramp as last seen; None before everything of it was seen once."""
        if any(register.address not in self._known for register in rows.RAMP):
            return None
        return Setting(dict(self._known))

    @staticmethod
    def _microsteps(step_conf: int) -> int:
        """Microsteps per full step, of STEP_CONF: 0 stands for 256, 8 for full steps, and more has no meaning."""
        return 256 >> min(rows.MICROSTEPS.unpack(step_conf), 8)

    @property
    def microsteps(self) -> int:
        """Microsteps per full step; as after power-on while not seen."""
        return self._microsteps(self._known.get(rows.STEP_CONF.address, 0))

    def mechanics(self, axis: int) -> Mechanics:
        """Conversions of the axis; full steps and microsteps are the chip's own (STEP_CONF) where it knows them."""
        settings = self.axes[axis].settings
        full_steps = rows.FULL_STEPS.unpack(self._known.get(rows.STEP_CONF.address, 0)) or settings.full_steps_per_rev
        return Mechanics(full_steps, self.microsteps, settings.gear_ratio, travel_mm_per_rev=settings.travel_mm_per_rev)

    def cruise_pps(self, axis: int) -> float | None:
        """The speed limit of moves as the user has set it [pps]."""
        self.axis(axis)
        return self.cruise.speed / 256

    def clock_warnings(self) -> list[str]:
        """What to know where the chip reckons with another clock than it has."""
        told_hz = self._known.get(rows.CLK_FREQ.address)
        if told_hz is None or abs(told_hz / self.clock_hz - 1) <= CLOCK_TOLERANCE:
            return []
        told, real = f"{told_hz / 1e6:g} MHz", f"{self.clock_hz / 1e6:g} MHz"
        faster = f"{self.clock_hz / told_hz:.3g} times as fast as the registers say"
        return [f"CLK_FREQ says {told} and the clock is {real}: all is {faster}"]

    # --- predictions ----------------------------------------------------------------------------

    def prediction(self, axis: int) -> Prediction | None:
        self.axis(axis)
        return self._book.present()

    # --- the link -------------------------------------------------------------------------------

    def set_state(self, state: DeviceState, problem: BenchError | None = None) -> None:
        super().set_state(state, problem)
        if state == "failed":  # it may be another chip, or the same after a power-on, when it comes back
            self._known.clear()
            self._book.end(self.device_time_s(), "the link failed")
