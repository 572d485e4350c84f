"""Between the shapes of sequences and the calculator behind them, app/calc/tmc4361/sequence.py."""

from __future__ import annotations

from ....calc.tmc4361.sequence import RampSet, Sequence, Shadow, motion
from ....calc.units.tmc4361 import Units
from ...devices.views import calculating
from .sequence_schemas import (
    SequenceMove,
    SequenceRamp,
    SequenceShadow,
    SequenceWord,
    TargetSequence,
    TargetSequenceResult,
)


def target_sequence(body: TargetSequence) -> TargetSequenceResult:
    with calculating():
        shadow = body.shadow
        found = motion(
            Sequence(
                position=body.position,
                targets=tuple(body.targets),
                ramp=_ramp(body.ramp),
                trigger=body.trigger,
                shadow=None if shadow is None else _shadow(shadow),
                units=Units(body.clock_hz, body.direct_acc_val_en, body.direct_bow_val_en),
                use_astart_and_vstart=body.use_astart_and_vstart,
                delay=body.delay,
                zero_wait=body.zero_wait,
                pulses_s=tuple(body.pulses_s),
                immediate=body.immediate,
                active_high=body.active_high,
                ring=body.ring,
                moves_most=body.moves_most,
            )
        )
        time_s, position, velocity_pps = found.curve(body.samples)
    return TargetSequenceResult(
        words=[SequenceWord(name=name, value=value) for name, value in found.words],
        moves=[
            SequenceMove(
                start_s=move.start_s,
                begin_s=move.begin_s,
                end_s=move.end_s,
                origin=move.origin,
                target=move.target,
                reached=move.reached,
                shape=move.ramp.shape,
                vmax_pps=move.ramp.get("vmax"),
            )
            for move in found.moves
        ],
        starts_s=list(found.starts_s),
        ends=found.ends,
        duration_s=found.duration_s,
        time_s=time_s.tolist(),
        position=position.tolist(),
        velocity_pps=velocity_pps.tolist(),
        findings=list(found.findings),
    )


def _ramp(body: SequenceRamp) -> RampSet:
    return RampSet(body.values, body.shape)


def _shadow(body: SequenceShadow) -> Shadow:
    return Shadow(body.option, tuple(map(_ramp, body.sets)), body.cyclic, body.misses)
