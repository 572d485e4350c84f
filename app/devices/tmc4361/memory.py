"""What is kept in mind of the chip: words as last seen, and what cannot be read as it was written."""

from __future__ import annotations

from collections.abc import Callable

from ...calc.units.mechanics import Mechanics
from ...errors import BenchError
from ...registers.model import Register, to_raw
from ...registers.tmc4361.general import RESET_CODE
from ..core.register_io import Snapshot
from ..core.register_link import RegisterLink
from ..core.results import DeviceState
from . import roles
from .cruise import Cruise
from .ramp_parameters import RampParameters

CLOCK_TOLERANCE = 0.005
"""By how much CLK_FREQ may differ from the clock before a move warns of it: a crystal's error and some rounding."""


class ChipMemory:
    """The shadow of one TMC4361's registers. `cruise` hears of every VMAX and RAMPMODE that was seen."""

    def __init__(self, link: RegisterLink, cruise: Cruise) -> None:
        self.reset_hooks: list[Callable[[], None]] = []
        """Parts that act where the chip was reset, after it was forgotten here."""
        self._link = link
        self._session = link.session
        self._cruise = cruise
        self._remembered = frozenset(register.address for register in roles.REMEMBERED)
        self._words: dict[int, int] = {}
        """As last seen, by address, of registers that are remembered."""
        self._unread: dict[int, int] = {}
        """As last written since the chip's reset, by address, of registers that cannot be read."""
        self.covered: dict[int, int] = {}
        """Datagrams of 20 bits that were sent to the driver behind, the latest of each kind, by their bits 19..17."""
        self._fresh = False
        """Whether what nobody has written through here is as after a reset: so it is once a reset was seen."""
        self._session.state_hooks.append(self._state_set)

    # --- what was seen and sent -----------------------------------------------------------------

    def remembers(self, register: Register) -> bool:
        """Whether words at that address are kept."""
        return register.address in self._remembered

    def saw(self, register: Register, word: int) -> None:
        """The chip was seen to hold `word`. Rows that share an address are told apart by their access."""
        if register.address not in self._remembered or not register.access.readable:
            return
        self._words[register.address] = word
        if self._session.limiter is not None:
            self._session.limiter.saw(register.address, word)
        if register is roles.VMAX:
            self._cruise.saw_vmax(register.decode(word))
        elif register is roles.RAMPMODE:
            self._cruise.saw_mode(word)
        elif register is roles.STEP_CONF:
            self._session.axes[0].microsteps_per_full_step = _microsteps(word)

    def saw_all(self, held: Snapshot) -> None:
        """The chip was seen to hold these."""
        for register in held.registers:
            self.saw(register, held.word(register))

    def sent(self, register: Register, word: int) -> None:
        """`word` was sent by the user."""
        if not register.access.readable:
            self._unread[register.address] = word
            self._words.pop(register.address, None)  # ENC_CONST follows from ENC_IN_RES
        if register is roles.COVER_LOW:
            self.covered[word >> 17 & 7] = word & 0xF_FFFF
        if register is roles.RESET and roles.part(roles.RESET, "RESET_REG").unpack(word) == RESET_CODE:
            self.forget_at_reset()

    # --- what is true no more -------------------------------------------------------------------

    def forget_at_reset(self) -> None:
        """The chip was reset: what was known is true no more."""
        self._words.clear()
        self._unread.clear()
        self.covered.clear()
        if self._session.limiter is not None:
            self._session.limiter.reset()
        self._fresh = True
        self._cruise.forget()
        for hook in self.reset_hooks:
            hook()

    def reset_seen(self) -> None:
        """The chip has been reset at some time, and what nobody has written through here since is as after that."""
        self._fresh = True

    def forget_reset(self) -> None:
        """As behind a server that was started after the chip: nobody knows whether it is as after a reset."""
        self._fresh = False

    def _state_set(self, state: DeviceState, problem: BenchError | None) -> None:
        del problem
        if state == "failed":  # it may be another chip, or the same after a power-on, when it comes back
            self._words.clear()
            self.covered.clear()

    # --- words ----------------------------------------------------------------------------------

    def known(self, register: Register) -> int | None:
        """A remembered word; None where it was not seen yet."""
        return self._words.get(register.address)

    def remembered_word(self, address: int) -> int | None:
        """A word that was seen or written; None where nobody knows."""
        return self._words.get(address, self._unread.get(address))

    def kept_word(self, register: Register) -> int | None:
        """What a register that cannot be read holds as it was written through here; None where it was not."""
        return self._unread.get(register.address)

    def word_unread(self, register: Register) -> int | None:
        """What a register that cannot be read holds: as it was written through here, else as after the reset that was
        seen; None where nobody knows."""
        return self._unread.get(register.address, register.reset if self._fresh else None)

    def held_unread(self, register: Register) -> int:
        """What a register that cannot be read is taken to hold: as it was written, else as after a reset."""
        return self._unread.get(register.address, register.reset or 0)

    # --- what words mean ------------------------------------------------------------------------

    def as_set(self, register: Register, word: int) -> int:
        """`word`, read from `register`, as its user has set it: a stop or a rotation may have written over it."""
        if register is roles.VMAX:
            return to_raw(self._cruise.speed, register.width)
        if register is roles.RAMPMODE:
            return word & ~roles.SHAPE.mask | self._cruise.shape << roles.SHAPE.lsb
        return word

    def ramp(self) -> RampParameters | None:
        """The ramp as last seen; None before everything of it was seen once."""
        if any(register.address not in self._words for register in roles.RAMP):
            return None
        return RampParameters(dict(self._words))

    @property
    def microsteps(self) -> int:
        """Microsteps per full step; as after power-on while not seen."""
        return _microsteps(self._words.get(roles.STEP_CONF.address, 0))

    def mechanics(self, axis: int) -> Mechanics:
        """Conversions of the axis; full steps and microsteps are the chip's own (STEP_CONF) where it knows them."""
        settings = self._session.axes[axis].settings
        full_steps = roles.FULL_STEPS.unpack(self._words.get(roles.STEP_CONF.address, 0)) or settings.full_steps_per_rev
        return Mechanics(full_steps, self.microsteps, settings.gear_ratio, travel_mm_per_rev=settings.travel_mm_per_rev)

    def clock_warnings(self) -> list[str]:
        """What to know where the chip reckons with another clock than it has."""
        told_hz, clock_hz = self._words.get(roles.CLK_FREQ.address), self._session.clock_hz
        if told_hz is None or abs(told_hz / clock_hz - 1) <= CLOCK_TOLERANCE:
            return []
        told, real = f"{told_hz / 1e6:g} MHz", f"{clock_hz / 1e6:g} MHz"
        faster = f"{clock_hz / told_hz:.3g} times as fast as the registers say"
        return [f"CLK_FREQ says {told} and the clock is {real}: all is {faster}"]


def _microsteps(step_conf: int) -> int:
    """Microsteps per full step, of STEP_CONF: 0 stands for 256, 8 for full steps, and more has no meaning."""
    return 256 >> min(roles.MICROSTEPS.unpack(step_conf), 8)
