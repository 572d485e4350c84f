"""Of which condition an axis is: a pure function of the evidence. Knows no model, asks nothing, remembers nothing."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, replace
from typing import Literal

from ..calc.positions.encoder_resolution import SLOPE_MIN, EncoderLine
from ..devices.core.results import AxisState, DeviceState, MotionEnd, StopReason
from ..devices.core.signs import NO_SIGNS, Evidence, Remedy, Sign, Signs, start_up

Kind = Literal[
    "not_connected",
    "unknown",
    "cannot_move",
    "ready",
    "moving",
    "on_target",
    "held",
    "stalled",
    "lost_steps",
    "following_error",
    "driver_fault",
]

CONNECT = Remedy("connect", "POST", "connect")
WARNED_BESIDE = frozenset({"moving", "held", "on_target", "ready", "stalled", "following_error", "lost_steps"})
"""Kinds whose cause a warning of the driver goes with."""
UNSEEN = "lost steps would not be seen"


@dataclass(frozen=True, slots=True)
class Condition:
    """What is so with an axis, why, by which evidence, and what helps; `since_s` is device time [s]."""

    kind: Kind
    cause: str
    evidence: tuple[Evidence, ...] = ()
    remedies: tuple[Remedy, ...] = ()
    since_s: float | None = None


@dataclass(frozen=True, slots=True)
class Thresholds:
    """From which deviation on steps count as lost at rest, and a motion as not followed [microsteps]."""

    lost_steps: float
    following_error: float


@dataclass(frozen=True, slots=True)
class WrongResolution:
    """The encoder's deviation is in proportion to the way: its resolution is set wrong.

    remedies : what sets it right, once the axis rests
    """

    line: EncoderLine
    remedies: tuple[Remedy, ...] = ()


@dataclass(frozen=True, slots=True)
class AxisObservation:
    """Everything that is known of an axis.

    link : what the connection does; `problem` why it does not work
    state : as last read; None where it was never read, or the latest reading failed with `problem`
    end : how the latest motion ended; None where none has, or another one was commanded since
    sent : the latest command here was to go to a target
    stopped : the latest command here was a stop
    limit : the soft limit of its range that stopped it
    reset_s : when the device was seen to have been reset, device time; None where nobody has, or it was seen to since
    held_back : why the driver leaves the device alone although it answers
    counts_position : it knows where the motor is; what is stepped from outside does not
    resolution : what is wrong with the encoder's, by the places where the axis was
    """

    axis: int
    link: DeviceState
    problem: str = ""
    state: AxisState | None = None
    signs: Signs = NO_SIGNS
    end: MotionEnd | None = None
    sent: bool = False
    stopped: bool = False
    reset_s: float | None = None
    limit: Sign | None = None
    held_back: Sign | None = None
    resolution: WrongResolution | None = None
    counts_position: bool = True
    thresholds: Thresholds = Thresholds(512, 1024)


def judge(seen: AxisObservation) -> Condition:
    """The condition of an axis; of several the one that its user has to know first. Warnings are told beside it."""
    found = _judge(seen)
    warned = _first(seen.signs.warnings) if found.kind in WARNED_BESIDE else None
    if warned is None:
        return found
    cause = f"{found.cause}; {warned.cause}"
    remedies = _once((*found.remedies, *warned.remedies))
    return replace(found, cause=cause, evidence=(*found.evidence, *warned.evidence), remedies=remedies)


def _judge(seen: AxisObservation) -> Condition:
    if seen.held_back is not None:
        return _of("cannot_move", seen.held_back)
    if seen.link != "connected":
        why = f": {seen.problem}" if seen.problem else ""
        said = {"connecting": "it is being connected", "disconnected": "it is not connected"}.get(
            seen.link, f"the link has failed{why}"
        )
        evidence = (Evidence("link", seen.link), *((Evidence("problem", seen.problem),) if seen.problem else ()))
        return Condition("not_connected", said, evidence, () if seen.link == "connecting" else (CONNECT,))
    state = seen.state
    if state is None:
        return Condition("unknown", seen.problem or "nobody has looked at this axis yet")
    worst: tuple[tuple[Kind, Sign | None], ...] = (
        ("driver_fault", _fault(seen, state)),
        ("cannot_move", _block(seen)),
        ("stalled", _stall(seen, state)),
    )
    for kind, found in worst:
        if found is not None:
            return _of(kind, found)
    off = _off(seen, state)
    if off is not None:
        return off
    if state.moving:
        return _moving(state)
    arrived = state.target_position is not None and state.position_reached
    held = _hold(seen, state)
    if held is not None and not arrived:
        return _of("held", held)
    untrusted = _untrusted(seen, state)
    if untrusted is not None:
        return _of("unknown", untrusted)
    return _at_rest(seen, state, arrived=arrived, held=held)


# --- what there may be ----------------------------------------------------------------------------


def _of(kind: Kind, sign: Sign) -> Condition:
    return Condition(kind, sign.cause, sign.evidence, sign.remedies)


def _first(signs: tuple[Sign, ...]) -> Sign | None:
    """Several of one kind as one: all of them say why, and what helps the first helps first."""
    if not signs:
        return None
    return Sign(
        "; ".join(dict.fromkeys(sign.cause for sign in signs)),
        tuple(piece for sign in signs for piece in sign.evidence),
        _once(remedy for sign in signs for remedy in sign.remedies),
    )


def _once(remedies: Iterable[Remedy]) -> tuple[Remedy, ...]:
    kept: list[Remedy] = []
    for remedy in remedies:
        if remedy not in kept:
            kept.append(remedy)
    return tuple(kept)


def _ended(end: MotionEnd, *remedies: Remedy) -> Sign:
    return Sign(end.detail, (Evidence("end of the latest motion", end.reason, end.time_s),), remedies)


def search(axis: int) -> Remedy:
    """Find the zero point again."""
    return Remedy("search reference again", "POST", f"axes/{axis}/reference-search", {}, moves=True)


def from_encoder(axis: int) -> Remedy:
    """Believe the encoder."""
    return Remedy("set position from encoder", "POST", f"axes/{axis}/position-from-encoder")


def _end(seen: AxisObservation, state: AxisState, *reasons: StopReason) -> MotionEnd | None:
    """How the latest motion ended, where it did for one of these reasons and nothing has moved since."""
    end = seen.end
    return end if end is not None and end.reason in reasons and not state.moving else None


def _fault(seen: AxisObservation, state: AxisState) -> Sign | None:
    found = _first(seen.signs.faults)
    end = _end(seen, state, "driver_error")
    return _ended(end) if found is None and end is not None else found


def _block(seen: AxisObservation) -> Sign | None:
    found, reset = _first(seen.signs.blocks), _reset(seen)
    if found is None:
        return None
    said = replace(found, cause=f"{found.cause}: no command can move this axis")
    if reset is None:
        return said
    cause = f"the device was reset, start it up again; {said.cause}"
    return Sign(cause, (*reset.evidence, *said.evidence), said.remedies)


def _reset(seen: AxisObservation) -> Sign | None:
    if seen.reset_s is None:
        return None
    evidence = (Evidence("reset", "seen", seen.reset_s),)
    if not seen.counts_position:
        return Sign("the device was reset, and is set as after power-on: start it up", evidence, (start_up(seen.axis),))
    return Sign(
        "the device was reset, and its position counter began again: start it up and search its reference",
        evidence,
        (start_up(seen.axis), search(seen.axis)),
    )


def _stall(seen: AxisObservation, state: AxisState) -> Sign | None:
    if seen.signs.stalling is not None:
        return seen.signs.stalling
    if seen.signs.stall is not None and not state.moving:
        return replace(seen.signs.stall, remedies=(*seen.signs.stall.remedies, search(seen.axis)))
    end = _end(seen, state, "stall")
    return None if end is None else _ended(end, search(seen.axis))


def _off(seen: AxisObservation, state: AxisState) -> Condition | None:
    """What the encoder says against the position counter; None where they agree, or nobody counts."""
    limits, end = seen.thresholds, _end(seen, state, "deviation")
    deviation = _deviation(state)
    if deviation is None:
        return None if end is None else _of("following_error", _ended(end, search(seen.axis)))
    # What the axis went between two readings that are not of one moment is no deviation.
    apart = abs(state.velocity_pps) * seen.signs.encoder_apart_s
    off = max(0.0, abs(deviation) - apart)
    way = "behind" if deviation * (state.velocity_pps or -deviation) < 0 else "ahead of"
    evidence: tuple[Evidence, ...] = (
        Evidence("encoder - position", f"{deviation:+,.0f} microsteps", state.time_s),
        Evidence("position", f"{state.position:,}", state.time_s),
    )
    if state.moving or seen.signs.regulated or end is not None:
        if off <= limits.following_error and end is None:
            return None
        told = Evidence("told from", f"{limits.following_error:,.0f} microsteps on")
        if seen.resolution is not None:
            return _wrong_resolution("following_error", seen.resolution, (*evidence, told), moving=state.moving)
        cause = f"the encoder is {abs(deviation):,.0f} microsteps {way} the position" if end is None else end.detail
        return Condition("following_error", cause, (*evidence, told), (search(seen.axis),))
    if off <= limits.lost_steps:
        return None
    evidence = (*evidence, Evidence("told from", f"{limits.lost_steps:,.0f} microsteps on"))
    if seen.resolution is not None:
        return _wrong_resolution("lost_steps", seen.resolution, evidence, moving=False)
    return Condition(
        "lost_steps",
        f"it stands {abs(deviation):,.0f} microsteps from where its position says, by the encoder: steps are lost",
        evidence,
        (*((from_encoder(seen.axis),) if seen.signs.takes_encoder else ()), search(seen.axis)),
    )


def _wrong_resolution(kind: Kind, found: WrongResolution, evidence: tuple[Evidence, ...], *, moving: bool) -> Condition:
    line = found.line
    much = 100 * (abs(1 + line.slope) - 1)
    said = []
    if line.slope < -1:
        said.append("counts the other way")
    if abs(much) >= 100 * SLOPE_MIN:
        rounded = float(f"{abs(much):.2g}")  # a cause that changes with every look would be news each time
        said.append(f"counts {rounded:g} % too {'few' if much < 0 else 'many'}")
    wrong = "resolution" if abs(much) >= 100 * SLOPE_MIN else "direction"
    return Condition(
        kind,
        f"the encoder {' and '.join(said)}: its {wrong} looks wrong, steps are not lost",
        (
            *evidence,
            Evidence("deviation over position", f"{line.slope:+.4f}, both ways"),
            Evidence("seen at", f"{line.places} places over {line.way:,} microsteps"),
        ),
        () if moving else found.remedies,
    )


def _deviation(state: AxisState) -> float | None:
    """The greatest that an encoder shows [microsteps]; None without one."""
    found = [value for value in (state.deviation, state.external_deviation) if value is not None]
    return max(found, key=abs) if found else None


def _moving(state: AxisState) -> Condition:
    to = "" if state.target_position is None else f" to {state.target_position:,}"
    evidence = (
        Evidence("velocity", f"{state.velocity_pps:,.0f} pps", state.time_s),
        Evidence("position", f"{state.position:,}", state.time_s),
    )
    return Condition("moving", f"it moves{to}", evidence)


def _hold(seen: AxisObservation, state: AxisState) -> Sign | None:
    found = _first((*seen.signs.holds, *(() if seen.limit is None else (seen.limit,))))
    end = _end(seen, state, "left_switch", "right_switch")
    return _ended(end) if found is None and end is not None else found


def _untrusted(seen: AxisObservation, state: AxisState) -> Sign | None:
    found = _first(seen.signs.untrusted) or _reset(seen)
    if found is not None:
        return found
    end = _end(seen, state, "unknown", "lost_link")
    return None if end is None else _ended(end)


def _at_rest(seen: AxisObservation, state: AxisState, *, arrived: bool, held: Sign | None) -> Condition:
    deviation = _deviation(state)
    proof = UNSEEN if deviation is None else f"the encoder agrees within {abs(deviation):,.0f} microsteps"
    beside = "" if held is None else f"; {held.cause}"
    evidence = [Evidence("position", f"{state.position:,}", state.time_s)]
    if deviation is not None:
        evidence.append(Evidence("encoder - position", f"{deviation:+,.0f} microsteps", state.time_s))
    if held is not None:
        evidence += held.evidence
    if arrived and (seen.sent or _end(seen, state, "target_reached") is not None):
        evidence.append(Evidence("target", f"{state.target_position:,}", state.time_s))
        return Condition("on_target", f"at its target; {proof}{beside}", tuple(evidence))
    stopped = seen.stopped or _end(seen, state, "stop_command") is not None
    return Condition("ready", f"{'stopped on command' if stopped else 'at rest'}; {proof}{beside}", tuple(evidence))
