"""The encoders of a TMCL module, and what sets one right whose scale does not fit."""

from __future__ import annotations

from ...calc.positions.encoder_resolution import measured_encoder
from ...errors import WrongState
from ..core.capabilities import NO_ENCODER, EncoderSetting
from ..core.results import AxisState
from ..core.session import Session
from ..core.signs import EncoderSeen, Remedy, write_all
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


class ModuleEncoders(EncoderSetting):
    """Of a module: the built-in encoder, and one outside."""

    ENCODER_REGISTERS = REGISTERS

    def __init__(self, session: Session, state: ModuleState) -> None:
        self._session = session
        self._state = state

    def require_encoder(self, axis: int) -> None:
        """Raises WrongState where the firmware has no built-in encoder."""
        if not self.has_encoder(axis):
            what, instead = NO_ENCODER
            raise WrongState(f"a {self._session.family.title} {what}", instead)

    def has_encoder(self, axis: int) -> bool:
        """Whether the firmware has a built-in one."""
        self._session.axis(axis)
        return not self._state.lacking.has(self._state.roles.encoder)

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
