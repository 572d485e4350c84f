"""Telemetry channels of a TMC4361: which registers they need and what the words mean.

Over SPI a row is one chain, so that its words are of one moment; the status byte comes with it for nothing and shows up
to eight events at the row's own time. EVENTS itself is never read for a sample: that would take two writes a row.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial

import numpy as np

from ...registers.model import Register
from ..core.motion_watch import MotionReading
from ..core.planned_motion import POSITION_BITS
from ..core.register_link import RegisterLink
from ..core.register_samples import Asked, field, number, residual, words_plan
from ..core.row_telemetry import RowTelemetry
from ..core.sample_plan import Decoder, FloatArray, IntArray, SamplePlan
from . import roles
from .events import Events
from .expected_motion import ExpectedMotion
from .memory import ChipMemory
from .switches import BY_LEVEL, BY_ZONE

MICROSTEPS = "microsteps"
DIRECT: dict[str, tuple[Register, str]] = {
    "position": (roles.XACTUAL, MICROSTEPS),
    "target_position": (roles.XTARGET, MICROSTEPS),
    "velocity": (roles.VACTUAL, "pps"),
    "acceleration": (roles.AACTUAL, "pps^2"),
    "encoder_position": (roles.ENC_POS, MICROSTEPS),
    "deviation": (roles.ENC_POS_DEV, MICROSTEPS),
    "encoder_velocity": (roles.V_ENC_MEAN, "pps"),
    "mscnt": (roles.MSCNT, "1/1024 turn"),
    "current_scale": (roles.SCALE, "1/256"),
    "status": (roles.STATUS, "bits"),
}
"""Channels that are one register."""
FROM_ENCODER = ("encoder_position", "deviation", "encoder_velocity")
FLAGS = {
    "switch_left": roles.part(roles.STATUS, "STOPL_ACTIVE_F"),
    "switch_right": roles.part(roles.STATUS, "STOPR_ACTIVE_F"),
    "position_reached": roles.part(roles.STATUS, "TARGET_REACHED_F"),
}
CURRENTS = {
    "current_a": roles.part(roles.CURRENTS, "CURRENTA"),
    "current_b": roles.part(roles.CURRENTS, "CURRENTB"),
}
FROM_PREDICTION = ("predicted_position", "predicted_velocity", "predicted_acceleration", "residual")
QUANTITIES = {
    "position": MICROSTEPS,
    "target_position": MICROSTEPS,
    "velocity": "pps",
    "target_velocity": "pps",
    "acceleration": "pps^2",
    "encoder_position": MICROSTEPS,
    "deviation": MICROSTEPS,
    "encoder_velocity": "pps",
    "load_angle": "deg",
    "mscnt": "1/1024 turn",
    "current_a": "1/256",
    "current_b": "1/256",
    "current_scale": "1/256",
    "switch_left": "0/1",
    "switch_right": "0/1",
    "switch_home": "0/1",
    "position_reached": "0/1",
    "events": "bits",
    "status": "bits",
    "predicted_position": MICROSTEPS,
    "predicted_velocity": "pps",
    "predicted_acceleration": "pps^2",
    "residual": MICROSTEPS,
}
"""Every channel quantity and its unit."""
HOME_ERROR = roles.part(roles.STATUS, "HOME_ERROR_F")
ARRIVAL = roles.part(roles.STATUS, "TARGET_REACHED_F")


class ChipTelemetry(RowTelemetry):
    """The channels of one TMC4361."""

    def __init__(self, link: RegisterLink, memory: ChipMemory, events: Events, expected: ExpectedMotion) -> None:
        super().__init__(link.session, [QUANTITIES])
        self._access = link.access
        self._memory = memory
        self._events = events
        self._expected = expected

    def sample_plan(self, channels: Sequence[str]) -> SamplePlan:
        chosen = self.chosen(channels)
        asked = Asked()
        if any(channel.quantity in FROM_PREDICTION for channel in chosen):
            asked.column(roles.VACTUAL)  # it tells where something stopped the motor that no command told of
        decoders = tuple(self._decoder(channel.quantity, asked) for channel in chosen)
        if not asked.registers:  # events alone: any register brings the status byte
            asked.column(roles.STATUS)
        return words_plan(self._access, asked, chosen, decoders, partial(self._saw_rows, tuple(asked.registers)))

    # --- channels -------------------------------------------------------------------------------

    def _decoder(self, quantity: str, asked: Asked) -> Decoder:
        if quantity in DIRECT:
            direct = number(asked.column(DIRECT[quantity][0]), DIRECT[quantity][0])
            return self._if_encoder(direct) if quantity in FROM_ENCODER else direct
        if quantity in FLAGS:
            return field(asked.column(roles.STATUS), FLAGS[quantity])
        if quantity in CURRENTS:
            return field(asked.column(roles.CURRENTS), CURRENTS[quantity])
        if quantity == "target_velocity":
            vmax = number(asked.column(roles.VMAX), roles.VMAX)
            return lambda times_s, words, status: vmax(times_s, words, status) / 256
        if quantity == "load_angle":
            return self._if_encoder(self._load_angles(asked))
        if quantity == "switch_home":
            return self._home_levels(asked)
        if quantity == "events":
            return lambda _, __, status: self._event_words(status)
        return self._predicted(quantity, asked)

    def _if_encoder(self, decode: Decoder) -> Decoder:
        """NaN while ENC_IN_RES is not set and so no count of an encoder counts."""

        def decoded(times_s: FloatArray, words: IntArray, status: IntArray) -> FloatArray:
            if self._memory.known(roles.ENC_CONST) == 0:
                return np.full(len(times_s), np.nan)
            return decode(times_s, words, status)

        return decoded

    def _load_angles(self, asked: Asked) -> Decoder:
        encoder = number(asked.column(roles.ENC_POS), roles.ENC_POS)
        deviation = number(asked.column(roles.ENC_POS_DEV), roles.ENC_POS_DEV)
        mscnt = number(asked.column(roles.MSCNT), roles.MSCNT)

        def decode(times_s: FloatArray, words: IntArray, status: IntArray) -> FloatArray:
            block = (times_s, words, status)
            if roles.REGULATION.unpack(self._memory.known(roles.ENC_IN_CONF) or 0) != 1:
                return -deviation(*block) * 90 / self._memory.microsteps
            way = -1 if roles.REVERSED.unpack(self._memory.known(roles.GENERAL_CONF) or 0) else 1
            offset = roles.CL_OFFSET.decode(self._memory.known(roles.CL_OFFSET) or 0)
            lead = way * (mscnt(*block) - way * encoder(*block) - offset)
            return np.asarray(((lead + 512) % 1024 - 512) * 360 / 1024)

        return decode

    def _home_levels(self, asked: Asked) -> Decoder:
        """As `switches.home_level`, a column at a time."""
        error = field(asked.column(roles.STATUS), HOME_ERROR)
        position = number(asked.column(roles.XACTUAL), roles.XACTUAL)

        def decode(times_s: FloatArray, words: IntArray, status: IntArray) -> FloatArray:
            code = roles.HOME_EVENT.unpack(self._memory.known(roles.REFERENCE_CONF) or 0)
            away = position(times_s, words, status) - roles.X_HOME.decode(self._memory.known(roles.X_HOME) or 0)
            wrong = error(times_s, words, status) > 0
            if code in BY_LEVEL:
                high = ((away > 0) == BY_LEVEL[code]) != wrong
            elif code in BY_ZONE:
                high = wrong == BY_ZONE[code]
            else:
                return np.full(len(times_s), np.nan)
            margin = self._memory.known(roles.HOME_SAFETY_MARGIN) or 0
            return np.where(np.abs(away) <= margin, np.nan, high.astype(np.float64))

        return decode

    def _event_words(self, status: IntArray) -> FloatArray:
        """EVENTS as the status bytes show it, and as it was read last."""
        shown = self._events.bits_of_status(0xFF)  # of these the rows know best
        words = np.full(len(status), self._events.present & ~shown, dtype=np.int64)
        for byte in np.unique(status):
            words[status == byte] |= self._events.bits_of_status(int(byte))
        return words.astype(np.float64)

    def _predicted(self, quantity: str, asked: Asked) -> Decoder:
        if quantity == "predicted_position":
            return lambda times_s, _, __: self._expected.book.at(times_s)[0]
        if quantity == "predicted_velocity":
            return lambda times_s, _, __: self._expected.book.at(times_s)[1]
        if quantity == "predicted_acceleration":
            return lambda times_s, _, __: self._expected.accelerations(times_s)
        position = number(asked.column(roles.XACTUAL), roles.XACTUAL)
        return residual(position, self._expected.book.at, POSITION_BITS)

    # --- what rows tell besides -----------------------------------------------------------------

    def _saw_rows(self, asked: Sequence[Register], times_s: FloatArray, words: IntArray, status: IntArray) -> None:
        """A block of samples of a plan that asks for these registers is about to be decoded."""
        for row in np.flatnonzero(np.diff(status, prepend=0)):
            self._events.saw_status(float(times_s[row]), int(status[row]))
        if roles.XACTUAL in asked:
            position = number(asked.index(roles.XACTUAL), roles.XACTUAL)(times_s, words, status)
            encoder = None
            if roles.ENC_POS in asked and self._memory.known(roles.ENC_CONST):
                encoder = int(number(asked.index(roles.ENC_POS), roles.ENC_POS)(times_s, words, status)[-1])
            self._session.saw_position(roles.AXIS, int(position[-1]), float(times_s[-1]), encoder)
        if roles.VACTUAL not in asked:
            return
        velocity = words[:, asked.index(roles.VACTUAL)]
        if self._expected.book.present() is not None:
            _, expected = self._expected.book.at(times_s)
            # NaN, where nothing is expected, compares false, and so does a speed that reads 0 itself.
            self._expected.book.observe(times_s, (velocity == 0) & (np.abs(expected) > 1))
        if roles.XACTUAL in asked and roles.STATUS in asked:
            state = words[:, asked.index(roles.STATUS)]
            moving = (state & (roles.VEL_STATE.mask | roles.RAMP_STATE.mask) != 0) | (velocity != 0)
            position = number(asked.index(roles.XACTUAL), roles.XACTUAL)(times_s, words, status)
            speed = number(asked.index(roles.VACTUAL), roles.VACTUAL)(times_s, words, status)
            wanted = moving if self._expected.watch.under_way is None else np.ones(len(times_s), dtype=np.bool_)
            for row in np.flatnonzero(wanted):
                reached = bool(ARRIVAL.unpack(int(state[row])))
                seen = float(speed[row]) or float(moving[row])
                self._expected.watch.update(MotionReading(float(times_s[row]), int(position[row]), seen, reached))
