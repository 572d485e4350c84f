"""What sets the encoder of a TMC5xxx right whose ENC_CONST does not fit it."""

from __future__ import annotations

from collections.abc import Mapping
from fractions import Fraction

from ...calc.positions.encoder_resolution import measured_encoder
from ...errors import WrongState
from ..core.capabilities import NO_ENCODER, EncoderIndex, EncoderSetting, Registers, UnsetEncoder
from ..core.results import AxisState
from ..core.session import Session
from ..core.signs import EncoderSeen, Remedy, write_all
from .decoded_registers import DecodedRegisters
from .memory import ChipMemory
from .start_up import DECIMAL, encoder_constant

REGISTERS = frozenset({"ENC_CONST", "ENCMODE", "X_ENC", "XACTUAL", "CHOPCONF", "GCONF"})
"""A write to one of them gives the encoder, or the position, other numbers for the same place or way."""

INDEX_MODE = {"pol_N": 1, "ignore_AB": 1, "clr_cont": 1, "clr_once": 0, "pos_edge": 1, "neg_edge": 0, "clr_enc_x": 0}
"""ENCMODE by which each event latches X_ENC and clears nothing."""


class SixPointEncoders(EncoderSetting, UnsetEncoder):
    """Knows which ENC_CONST fits the way that was seen, and one for an encoder that nobody has set yet."""

    ENCODER_REGISTERS = REGISTERS

    def __init__(self, session: Session, memory: ChipMemory, decoded: DecodedRegisters) -> None:
        self._session = session
        self._memory = memory
        self._decoded = decoded

    def require_encoder(self, axis: int, /) -> None:
        if not self.has_encoder(axis):
            what, instead = NO_ENCODER
            raise WrongState(f"a {self._session.family.title} {what}", instead)
        if not self._decoded.counts_encoder(axis):
            raise WrongState(
                "nobody has set what a count of the encoder is", "write ENC_CONST, or start the axis up with it"
            )

    def has_encoder(self, axis: int, /) -> bool:
        return self._memory.rows(self._session.axis(axis).index).x_enc is not None

    def provisional_encoder(self, axis: int, counts: int, /) -> Mapping[str, int | Mapping[str, int]]:
        """ENC_CONST and how it counts. Raises WrongState where GCONF gives the pins of this encoder away."""
        axis = self._session.axis(axis).index
        if not self._decoded.has_encoder_pins(axis):
            if axis:
                raise WrongState(
                    "the pins of encoder 2 are those of both right switches (GCONF.enc2_enable is off)",
                    "start the axis up with its counts where an encoder is connected there",
                )
            raise WrongState("position compare has the pins of encoder 1", "switch GCONF.poscmp_enable off")
        rows, mechanics = self._memory.rows(axis), self._decoded.mechanics(axis)
        assert rows.enc_const is not None
        assert rows.encoder_mode is not None
        turn = mechanics.full_steps_per_rev * mechanics.microsteps_per_full_step
        decimal, word = encoder_constant(Fraction(turn, counts))
        return {rows.encoder_mode.name: {"enc_sel_decimal": int(decimal)}, rows.enc_const.name: word}

    def encoder_remedies(self, axis: int, state: AxisState, seen: EncoderSeen, /) -> tuple[Remedy, ...]:
        """ENC_CONST by the way that was seen, and X_ENC from the position; nothing where the present one is not
        known."""
        axis = self._session.axis(axis).index
        memory = self._memory
        rows, mechanics = memory.rows(axis), self._decoded.mechanics(axis)
        word = None if rows.enc_const is None else memory.word(rows.enc_const)
        if rows.enc_const is None or rows.x_enc is None or not word:
            return ()
        mode = rows.encoder_mode
        mode_word = None if mode is None else memory.known(mode)
        fraction = word & 0xFFFF
        if mode is None or (mode_word is None and 0 < fraction < DECIMAL):
            return ()  # it may be a decimal one
        decimal = bool(mode_word and mode.unpack(mode_word)["enc_sel_decimal"])
        constant = (rows.enc_const.decode(word) >> 16) + Fraction(fraction, DECIMAL if decimal else 1 << 16)
        turn = mechanics.full_steps_per_rev * mechanics.microsteps_per_full_step
        found = measured_encoder(seen.ratio * seen.way / float(constant), seen.way, turn, seen.slack)
        counts = found.counts
        if counts == 0:
            return ()
        ratio = Fraction(turn, counts)
        if not ratio < 1 << 15:
            return ()
        decimal, right = encoder_constant(-ratio if found.counts_per_turn < 0 else ratio)
        writes = (
            (mode.name, {"enc_sel_decimal": int(decimal)}),
            (rows.enc_const.name, right),
            (rows.x_enc.name, state.position),
        )
        back = ", the other way" if (found.counts_per_turn < 0) != (constant < 0) else ""
        return (write_all(f"set the encoder to {counts:,} counts a turn{back}", writes, axis),)


class SixPointEncoderIndex(EncoderIndex):
    """Latches X_ENC at the N channel."""

    def __init__(self, session: Session, registers: Registers) -> None:
        self._session = session
        self._registers = registers

    def index_setting(self, axis: int, /) -> Mapping[str, int | Mapping[str, int]]:
        """ENCMODE: X_ENC is latched at each rising edge of N, whatever A and B are then."""
        self._session.axis(axis)
        return {"ENCMODE": INDEX_MODE}

    async def index_met(self, axis: int, /) -> int | None:
        status = await self._registers.read("ENC_STATUS", axis)
        if not status.fields["n_event"]:
            return None
        if not self._registers.clears_when_read("ENC_STATUS", axis):
            await self._registers.write("ENC_STATUS", axis, fields={"n_event": 1})
        return (await self._registers.read("ENC_LATCH", axis)).value
