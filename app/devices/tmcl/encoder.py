"""What sets the encoders of a TMCL module right whose scale to microsteps does not fit."""

from __future__ import annotations

from ...calc.positions.encoder_resolution import measured_encoder
from ..core.results import AxisState
from ..core.signs import EncoderSeen, Remedy, write_all
from . import rows
from .module import Module

REGISTERS = frozenset(
    row.name
    for row in (
        rows.ENCODER,
        rows.EXTERNAL_ENCODER,
        rows.EXTERNAL_RESOLUTION,
        rows.FULL_STEPS,
        rows.MICROSTEPS,
        rows.REVERSE_SHAFT,
        rows.ACTUAL_POSITION,
    )
)
"""A write to one of them gives an encoder, or the position, other numbers for the same place or way."""


def encoder_remedies(module: Module, axis: int, state: AxisState, seen: EncoderSeen) -> tuple[Remedy, ...]:
    """The resolution of the external encoder; of the built-in one, whose is fixed, the full steps of the motor, by
    which both are scaled. Then the counters from the position. Nothing sets the direction of one alone."""
    full_steps = module.remembered_word(rows.FULL_STEPS.address)
    if not full_steps or seen.ratio <= 0:
        return ()
    if not seen.external:
        right = round(full_steps / seen.ratio)
        if not 0 < right <= rows.FULL_STEPS.maximum:
            return ()
        both = ((rows.ENCODER, state.encoder_position), (rows.EXTERNAL_ENCODER, state.external_encoder_position))
        counters = [(row.name, state.position) for row, shown in both if shown is not None]
        writes = ((rows.FULL_STEPS.name, right), *counters)
        return (write_all(f"set the motor to {right:,} full steps a turn", writes, axis),)
    present = module.remembered_word(rows.EXTERNAL_RESOLUTION.address)
    if present is None:
        return ()
    turn = full_steps * module.mechanics(axis).microsteps_per_full_step
    # Without a resolution a count is a microstep.
    told = seen.ratio * seen.way * (present / turn if present else 1)
    found = measured_encoder(told, seen.way, turn, seen.slack)
    counts = found.counts
    if not counts or found.counts_per_turn < 0:  # no parameter turns it round
        return ()
    writes = ((rows.EXTERNAL_RESOLUTION.name, counts), (rows.EXTERNAL_ENCODER.name, state.position))
    return (write_all(f"set the external encoder to {counts:,} counts a turn", writes, axis),)
