"""Between the service of extended positions and the shapes of the contract, where numbers are text too."""

from __future__ import annotations

from ...positions.state import ExtendedState, HistoryState, Latched, TurnState
from .schemas import CompareOut, ExtendedHistory, ExtendedPosition, Gear, LatchedPosition, Pieces, RotaryOut


def extended_out(state: ExtendedState, device_time_s: float) -> ExtendedPosition:
    """One axis, at `device_time_s` [s]."""
    rotary, compare, pieces = state.rotary, state.compare, state.pieces
    return ExtendedPosition(
        watching=state.watching,
        trusted=state.trusted,
        reason=state.reason,
        way_out=state.way_out,
        actual=state.actual,
        actual_text=_text(state.actual),
        target=state.target,
        target_text=_text(state.target),
        state=state.state,
        message=state.message,
        counter=state.counter,
        counter_bits=state.counter_bits,
        pieces=None if pieces is None else Pieces(total=pieces.total, done=pieces.done, length=pieces.length),
        progress=state.progress,
        position_in_turn=None if rotary is None else float(rotary.place),
        position_in_turn_text=None if rotary is None else str(rotary.place),
        turns=None if rotary is None else rotary.turns,
        angle_deg=None if rotary is None else rotary.angle_deg,
        encoder_position=state.encoder_position,
        encoder_position_text=_text(state.encoder_position),
        encoder_angle_deg=None if rotary is None else rotary.encoder_angle_deg,
        rotary=None if rotary is None else _rotary(rotary),
        compare=None
        if compare is None
        else CompareOut(
            register_name=compare.register,
            position=compare.position,
            position_text=str(compare.position),
            armed=compare.armed,
        ),
        latch_register=state.latch_register,
        last_look_s=state.last_look_s,
        look_age_s=state.look_age_s,
        device_time_s=device_time_s,
        service_period_s=state.service_period_s,
        allowed_s=state.allowed_s,
        speed_limit_pps=state.speed_limit_pps,
        warnings=state.warnings,
    )


def _rotary(state: TurnState) -> RotaryOut:
    turn = state.turn
    gear = None
    if turn.gear is not None:
        per_turn, motor, driven = turn.gear
        gear = Gear(microsteps_per_motor_turn=per_turn, motor_teeth=motor, driven_teeth=driven)
    return RotaryOut(
        microsteps_per_turn=str(turn.microsteps_per_turn),
        microsteps_per_turn_value=float(turn.microsteps_per_turn),
        gear=gear,
        zero=turn.zero,
        zero_text=str(turn.zero),
        displacement_const=str(state.displacement_const),
        offset=str(state.offset),
    )


def latched_out(latched: Latched) -> LatchedPosition:
    """What a snapshot register held."""
    return LatchedPosition(
        register_name=latched.register,
        count=latched.count,
        position=latched.position,
        position_text=str(latched.position),
    )


def history_out(history: HistoryState) -> ExtendedHistory:
    """Polls, oldest first."""
    return ExtendedHistory(
        time_s=history.time_s,
        position=history.position,
        position_text=[str(position) for position in history.position],
        angle_deg=history.angle_deg,
        encoder_angle_deg=history.encoder_angle_deg,
    )


def _text(number: int | None) -> str | None:
    return None if number is None else str(number)
