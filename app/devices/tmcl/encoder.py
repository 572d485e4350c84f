"""The encoders of a TMCL module: the position from one, and what sets one right whose scale does not fit."""

from __future__ import annotations

from ...calc.positions.encoder_resolution import measured_encoder
from ...errors import WriteRefused, WrongState
from ...links.tmcl import Request
from ...registers.tmcl.commands import Opcode
from ..core.capabilities import NO_ENCODER, EncoderSetting, PositionFromEncoder
from ..core.results import AxisState
from ..core.session import Session
from ..core.signs import EncoderSeen, Remedy, write_all
from ..core.tmcl_frames import STATUS
from ..core.tmcl_link import TmclLink
from .ongoing import OngoingMotion
from .state import ModuleState

REGISTERS = frozenset(
    {
        "encoder_position",
        "external_encoder_position",
        "external_encoder_resolution",
        "encoder_prescaler",
        "motor_fullstep_resolution",
        "microstep_resolution",
        "reverse_shaft",
        "reverse_shaft_direction",
        "actual_position",
    }
)
"""A write to one of them gives an encoder, or the position, other numbers for the same place or way."""


class ModuleEncoders(EncoderSetting, PositionFromEncoder):
    """Of a module: the built-in encoder, and one outside."""

    ENCODER_REGISTERS = REGISTERS

    def __init__(self, session: Session, state: ModuleState, link: TmclLink, ongoing: OngoingMotion) -> None:
        self._session = session
        self._state = state
        self._link = link
        self._ongoing = ongoing

    async def position_from_encoder(self, axis: int) -> int:
        """Call the place where the motor stands what its built-in encoder shows (AP 209); the difference.

        The axis is stopped by MST first: in positioning the module would drive on to its target from its new place.
        Raises WrongState while it moves, and where the firmware has no such encoder.
        """
        axis, roles = self._session.axis(axis).index, self._state.roles
        self._session.require_connected()
        async with self._link.calls(axis) as calls:
            position, encoder, speed = await calls.ask_many((roles.actual_position, roles.encoder, roles.actual_speed))
            if encoder is None:
                raise WrongState(f"this module has no {roles.encoder.name} ({roles.encoder.alias})")
            if speed or (await calls.do(Request(self._link.address, Opcode.RFS, STATUS))).value:
                raise WrongState(f"axis {axis} moves", "stop it first")
            if self._session.limiter is not None:
                self._session.limiter.require_target(axis, encoder)
            await calls.do(Request(self._link.address, Opcode.MST))
            self._ongoing.driven = "velocity"
            self._session.commanded(axis, "set_position", position=encoder)
            self._ongoing.book.end(calls.time_s, "the position was set")
            await calls.do(Request(self._link.address, Opcode.SAP, roles.actual_position.address, 0, encoder))
            back = await calls.get(roles.actual_position)
        if back != encoder:
            raise WriteRefused(roles.actual_position.name, encoder, back, f"it was {position}")
        return calls.need(roles.actual_position, position) - encoder

    def require_encoder(self, axis: int) -> None:
        """Raises WrongState where the firmware has no built-in encoder."""
        self._session.axis(axis)
        if self._state.lacking.has(self._state.roles.encoder):
            what, instead = NO_ENCODER
            raise WrongState(f"a {self._session.family.title} {what}", instead)

    def encoder_remedies(self, axis: int, state: AxisState, seen: EncoderSeen) -> tuple[Remedy, ...]:
        """The resolution of the external encoder; of the built-in one, whose is fixed, the full steps of the motor, by
        which both are scaled. Then the counters from the position. Nothing sets the direction of one alone."""
        axis = self._session.axis(axis).index
        module, roles = self._state, self._state.roles
        full_steps = module.last(roles.full_steps)
        if not full_steps or seen.ratio <= 0:
            return ()
        if not seen.external:
            right = round(full_steps / seen.ratio)
            if not 0 < right <= roles.full_steps.maximum:
                return ()
            both = (
                (roles.encoder, state.encoder_position),
                (roles.external_encoder, state.external_encoder_position),
            )
            counters = [(row.name, state.position) for row, shown in both if shown is not None]
            writes = ((roles.full_steps.name, right), *counters)
            return (write_all(f"set the motor to {right:,} full steps a turn", writes, axis),)
        present = module.last(roles.external_resolution)
        if present is None:
            return ()
        turn = full_steps * module.mechanics(axis).microsteps_per_full_step
        # Without a resolution a count is a microstep.
        told = seen.ratio * seen.way * (present / turn if present else 1)
        found = measured_encoder(told, seen.way, turn, seen.slack)
        counts = found.counts
        if not counts or found.counts_per_turn < 0:  # no parameter turns it round
            return ()
        writes = ((roles.external_resolution.name, counts), (roles.external_encoder.name, state.position))
        return (write_all(f"set the external encoder to {counts:,} counts a turn", writes, axis),)
