"""The chip behind the link: whether it is the right one, and what the driver keeps in mind of it."""

from __future__ import annotations

from collections.abc import Sequence

from ...calc.units.mechanics import Mechanics
from ...clock import Clock
from ...errors import BenchError, OtherModel, WrongState
from ...links.port import FramePort
from ...registers.model import Register
from ..core.config import DeviceConfig
from ..core.planned_motion import PlannedMotion
from ..core.prediction import Prediction, PredictionBook
from ..core.register_io import Words
from ..core.results import DeviceState, RegisterWritten
from ..core.shadow_registers import NOTHING, KeepingChip
from ..recognition import models_found
from .identity import VERSIONS, models_of
from .ramp import Ramp
from .rows import RAMP, AxisRows, rows_of

TABLE_MICROSTEPS = 256


class Chip(KeepingChip):
    """A TMC5xxx, without what it does."""

    def __init__(self, device_id: str, config: DeviceConfig, port: FramePort, clock: Clock) -> None:
        super().__init__(device_id, config, port, clock)
        self.chip = rows_of(config.model)
        modes = [rows.encoder_mode for rows in self.chip.axes if rows.encoder_mode is not None]
        self._remembered = frozenset(register.address for register in (*self.chip.remembered, *modes))
        self._books: tuple[PredictionBook[PlannedMotion], ...] = tuple(PredictionBook() for _ in self.axes)
        self._fresh = False
        """Whether what nobody has written through here is as after a reset: so it is once a reset was seen."""
        self._overwritten: dict[int, int | None] = {}
        """VMAX and AMAX as the user wants them, by address, where a command has written something else over them."""
        self._guessed: Register | None = None
        """The write-only register of which fields are being written over others that nobody knows."""

    def rows(self, axis: int) -> AxisRows:
        return self.chip.axes[axis]

    # --- who it is ------------------------------------------------------------------------------

    async def probe(self) -> str:
        where = await self._on_board()
        inputs = self.chip.inputs
        async with self.queue.turn() as turn:
            word, gconf = await self.words(turn).read_many((inputs, self.chip.gconf))
        title = self.family.title
        if word == gconf and word in NOTHING:
            raise WrongState(
                f"no {title} answers here: all bits read {word & 1}", "check power, wiring and chip select"
            )
        version = inputs.unpack(word)["VERSION"]
        others = models_of(version)
        if others and self.model not in others:
            # A TMC5031 and a TMC5062 show what another family's chip may show there by chance.
            other = await models_found(self.queue, self.access)
            foreign = bool(other) and not set(other) <= VERSIONS.keys()
            seems = "" if foreign else f", which is that of a {' or '.join(model.upper() for model in others)}"
            raise OtherModel(
                f"this is no {title}: VERSION reads {version:#04x}{seems}",
                self.model,
                other or others,
                foreign=foreign,
            )
        if version in (0, 0xFF) or not others:
            other = await models_found(self.queue, self.access)
            if other or version in (0, 0xFF):
                raise OtherModel(f"this is no {title}: VERSION reads {version:#04x}", self.model, other, foreign=True)
        return f"a {title} answers, version {version:#04x}{where}"

    # --- what is kept in mind -------------------------------------------------------------------

    def _saw_word(self, register: Register, word: int) -> None:
        """The chip was seen to hold `word`."""
        if register.address not in self._remembered or not register.access.readable:
            return
        self._known[register.address] = word & register.mask
        if self.limiter is not None:
            self.limiter.saw(register.address, word)
        for rows in self.chip.axes:
            if register is rows.chopconf:
                self.axes[rows.axis].microsteps_per_full_step = self._microsteps(rows)

    def _sent(self, register: Register, word: int) -> None:
        """`word` went out by somebody's hand."""
        if not register.access.readable:
            self._blind[register.address] = word
            self._overwritten.pop(register.address, None)
        for rows in self.chip.axes:
            if register.address in rows.moving and register is self.table.at(register.address, write=True):
                self.commanded(rows.axis, register.name)

    def _overwrite(self, register: Register, word: int) -> None:
        """`word` goes out in the course of a command: what the user wants there comes back with the next move."""
        wanted = self._overwritten.setdefault(register.address, self.word(register))
        self._blind[register.address] = word
        if word == wanted:
            del self._overwritten[register.address]

    def wanted(self, register: Register) -> int | None:
        """VMAX or AMAX as the user wants it; None where nobody knows."""
        address = register.address
        return self._overwritten[address] if address in self._overwritten else self.word(register)

    def word(self, register: Register) -> int | None:
        """What the chip holds as far as is known: read, written through here, or as after the reset that was seen."""
        if register.access.readable:
            return self._known.get(register.address)
        return self._blind.get(register.address, register.reset if self._fresh else None)

    def remembered_word(self, address: int) -> int | None:
        row = self.table.at(address, write=True)
        return None if row is None else self.word(row)

    def kept_word(self, register: Register) -> int | None:
        """As the user wants it: what a rotation or a stop has written over it comes back with the next move."""
        return self.wanted(register)

    def ramp(self, axis: int) -> Ramp:
        """The ramp as the user wants it."""
        words = {name: self.wanted(row) for name, row in self.rows(axis).ramp.items()}
        assert set(words) == set(RAMP)
        return Ramp(words, self.clock_hz)

    def _forget_setting(self) -> None:
        """The chip was reset: what was known is true no more."""
        self._known.clear()
        self._blind.clear()
        self._overwritten.clear()
        if self.limiter is not None:
            self.limiter.reset()
        self._fresh = True
        for book in self._books:
            book.end(self.device_time_s(), "the chip was reset")

    # --- units ----------------------------------------------------------------------------------

    def _microsteps(self, rows: AxisRows) -> int:
        """Microsteps per full step, of CHOPCONF.mres; a TMC5031 has no such field, and always 256."""
        mres = rows.chopconf.field_named("mres")
        word = self._known.get(rows.chopconf.address)
        return TABLE_MICROSTEPS if mres is None or word is None else TABLE_MICROSTEPS >> min(mres.unpack(word), 8)

    def mechanics(self, axis: int) -> Mechanics:
        """Conversions of the axis, its microsteps by CHOPCONF."""
        return self.axes[axis].settings.mechanics(self._microsteps(self.rows(axis)))

    def counts_encoder(self, axis: int) -> bool:
        """Whether X_ENC counts what somebody wants it to: there is one, GCONF leaves it its pins, and ENC_CONST is not
        as after a reset."""
        row = self.rows(axis).enc_const
        if row is None or self.word(row) in (0, row.reset):
            return False
        if not self.chip.two_axes:
            return True
        return self._gconf("enc2_enable") if axis else not self._gconf("poscmp_enable")

    def has_right_switch(self) -> bool:
        """Whether the pins of the right switches are theirs: encoder 2 takes both."""
        return not self._gconf("enc2_enable")

    def _gconf(self, name: str) -> bool:
        """A bit of GCONF as last seen; False where the chip has none of that name."""
        part = self.chip.gconf.field_named(name)
        return part is not None and bool(part.unpack(self._known.get(self.chip.gconf.address, 0)))

    def cruise_pps(self, axis: int) -> float | None:
        """The speed limit of moves as the user has set it [pps]; None where nobody knows it."""
        return self.ramp(self.axis(axis).index).pps("VMAX")

    # --- write-only registers -------------------------------------------------------------------

    async def _held(self, words: Words, register: Register) -> int:
        if register.access.readable:
            return await words.read(register)
        held = self.word(register)
        self._guessed = register if held is None else None
        return (register.reset or 0) if held is None else held

    def _written_blind(self, register: Register, word: int, arrived: bool, notes: Sequence[str]) -> RegisterWritten:
        guessed, self._guessed = self._guessed, None
        if guessed is register:
            notes = [*notes, "its other fields were not known: they are as after a reset now"]
        return super()._written_blind(register, word, arrived, notes)

    # --- predictions ----------------------------------------------------------------------------

    def prediction(self, axis: int) -> Prediction | None:
        return self._books[self.axis(axis).index].present()

    # --- the link -------------------------------------------------------------------------------

    def set_state(self, state: DeviceState, problem: BenchError | None = None) -> None:
        super().set_state(state, problem)
        if state == "failed":
            # What can be read will be read again. What cannot stays in mind: GSTAT tells if the chip was reset.
            self._known.clear()
            for book in self._books:
                book.end(self.device_time_s(), "the link failed")
