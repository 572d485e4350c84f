"""What sets the encoder of a TMC4361 right whose ENC_IN_RES does not fit it."""

from __future__ import annotations

from collections.abc import Mapping

from ...calc.positions.encoder_resolution import constant_of, measured_encoder
from ..core.capabilities import EncoderIndex, EncoderSetting, Registers, UnsetEncoder
from ..core.results import AxisState
from ..core.session import Session
from ..core.signs import EncoderSeen, Remedy, write_all
from . import roles
from .memory import ChipMemory

INDEX_CONF = {
    "clear_on_n": 0,
    "clr_latch_cont_on_n": 1,
    "clr_latch_once_on_n": 0,
    "pol_n": 1,
    "n_chan_sensitivity": 1,
    "ignore_ab": 1,
    "latch_enc_on_n": 1,
    "latch_x_on_n": 0,
}
"""ENC_IN_CONF by which each N event latches ENC_POS and sets nothing."""


class Encoder(EncoderSetting, UnsetEncoder):
    """ENC_IN_RES by the way that was seen, and ENC_POS from the position; nothing where ENC_CONST is not known."""

    ENCODER_REGISTERS = frozenset(
        {"ENC_IN_RES", "ENC_CONST", "ENC_IN_CONF", "ENC_POS", "XACTUAL", "STEP_CONF", "GENERAL_CONF"}
    )

    def __init__(self, session: Session, memory: ChipMemory) -> None:
        self._session = session
        self._memory = memory

    def require_encoder(self, axis: int, /) -> None:
        self._session.axis(axis)

    def has_encoder(self, axis: int, /) -> bool:
        self._session.axis(axis)
        return True

    def provisional_encoder(self, axis: int, counts: int, /) -> Mapping[str, int | Mapping[str, int]]:
        """ENC_IN_RES, from which the chip finds ENC_CONST."""
        self._session.axis(axis)
        return {"ENC_IN_RES": {"ENC_IN_RES": counts, "MANUAL_ENC_CONST": 0}}

    def encoder_remedies(self, axis: int, state: AxisState, seen: EncoderSeen, /) -> tuple[Remedy, ...]:
        axis = self._session.axis(axis).index
        word, conf = self._memory.known(roles.ENC_CONST), self._memory.known(roles.ENC_IN_CONF)
        if not word or conf is None:
            return ()
        fields, mechanics = roles.ENC_IN_CONF.unpack(conf), self._memory.mechanics(axis)
        turn = mechanics.full_steps_per_rev * mechanics.microsteps_per_full_step
        constant = constant_of(word, decimal=bool(fields["enc_sel_decimal"]))
        found = measured_encoder(seen.ratio * seen.way / constant, seen.way, turn, seen.slack)
        counts = found.counts
        if counts == 0:
            return ()
        writes: list[tuple[str, int | dict[str, int]]] = [
            ("ENC_IN_RES", {"ENC_IN_RES": counts, "MANUAL_ENC_CONST": 0}),
            (roles.ENC_POS.name, state.position),
        ]
        back = ""
        if found.counts_per_turn < 0:
            writes.insert(1, (roles.ENC_IN_CONF.name, {"invert_enc_dir": 1 - fields["invert_enc_dir"]}))
            back = ", the other way"
        return (write_all(f"set the encoder to {counts:,} counts a turn{back}", writes, axis),)


class Index(EncoderIndex):
    """Latches ENC_POS at the N channel."""

    def __init__(self, session: Session, registers: Registers) -> None:
        self._session = session
        self._registers = registers

    def index_setting(self, axis: int, /) -> Mapping[str, int | Mapping[str, int]]:
        """ENC_IN_CONF: ENC_POS is latched at each edge of N to active, whatever A and B are then."""
        self._session.axis(axis)
        return {roles.ENC_IN_CONF.name: INDEX_CONF}

    async def index_met(self, axis: int, /) -> int | None:
        status = await self._registers.read(roles.STATUS.name, axis)
        if not status.fields["ENC_LATCH_F"]:
            return None
        return (await self._registers.read("ENC_LATCH", axis)).value  # which ends the flag
