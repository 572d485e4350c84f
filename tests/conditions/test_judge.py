"""The judge alone: which of several conditions it names, and in which words."""

from __future__ import annotations

from dataclasses import replace

import pytest

from app.calc.positions.encoder_resolution import EncoderLine
from app.conditions.judge import AxisObservation, Thresholds, WrongResolution, judge
from app.devices.core.results import AxisState, MotionEnd, StopReason, Switches
from app.devices.core.signs import Evidence, Remedy, Sign, Signs, hot, zero

STATE = AxisState(
    position=1000,
    target_position=1000,
    velocity_pps=0.0,
    target_velocity_pps=None,
    acceleration_pps2=None,
    position_reached=True,
    moving=False,
    mode="position",
    switches=Switches(False, False, None),
    flags={},
    time_s=5.0,
)
SENT = AxisObservation(0, "connected", state=STATE, sent=True, thresholds=Thresholds(512, 1024))
FAULT = Signs(faults=(Sign("the driver is too hot", (Evidence("DRV_STATUS.ot", "1", 5.0),)),))
HELD = Signs(holds=(Sign("the left switch is active", (Evidence("left switch", "active", 5.0),)),))


def end(reason: StopReason, detail: str = "it ended") -> MotionEnd:
    return MotionEnd(0, reason, 4.5, 0.0, 1000, detail)


def test_where_nothing_can_tell_an_arrival_does_not_claim_that_no_step_was_lost() -> None:
    found = judge(SENT)
    assert (found.kind, found.cause) == ("on_target", "at its target; lost steps would not be seen")
    seen = judge(replace(SENT, state=replace(STATE, encoder_position=998, deviation=-2.0)))
    assert (seen.kind, seen.cause) == ("on_target", "at its target; the encoder agrees within 2 microsteps")


def test_a_target_that_nobody_sent_it_to_is_no_arrival() -> None:
    assert judge(replace(SENT, sent=False)).kind == "ready"
    assert judge(replace(SENT, sent=False, end=end("target_reached"))).kind == "on_target"
    assert judge(replace(SENT, sent=False, stopped=True)).cause == "stopped on command; lost steps would not be seen"


@pytest.mark.parametrize(("deviation", "kind"), [(-512.0, "on_target"), (-513.0, "lost_steps"), (513.0, "lost_steps")])
def test_steps_count_as_lost_beyond_the_threshold(deviation: float, kind: str) -> None:
    assert judge(replace(SENT, state=replace(STATE, deviation=deviation))).kind == kind


def test_a_motion_that_is_not_followed_is_told_while_it_goes_on() -> None:
    moving = replace(STATE, moving=True, position_reached=False, velocity_pps=10_000.0, deviation=-1500.0)
    found = judge(replace(SENT, state=moving))
    assert (found.kind, found.cause) == ("following_error", "the encoder is 1,500 microsteps behind the position")
    # Read 0.1 s one after the other, at 10,000 pps, 1,000 of them prove nothing.
    assert judge(replace(SENT, state=moving, signs=Signs(encoder_apart_s=0.1))).kind == "moving"


@pytest.mark.parametrize(
    ("changed", "kind"),
    [
        ({"signs": FAULT}, "driver_fault"),
        ({"signs": replace(FAULT, stall=Sign("a stall"), blocks=(zero("VMAX", 0, 5),))}, "driver_fault"),
        ({"signs": Signs(blocks=(zero("VMAX", 0, 5),), stall=Sign("a stall"))}, "cannot_move"),
        ({"end": end("stall")}, "stalled"),
        ({"end": end("deviation")}, "following_error"),
        ({"end": end("driver_error")}, "driver_fault"),
        ({"end": end("lost_link")}, "unknown"),
        ({"state": replace(STATE, position_reached=False), "signs": HELD}, "held"),
        ({"state": replace(STATE, position_reached=False), "end": end("right_switch")}, "held"),
        ({"signs": HELD}, "on_target"),
        ({"state": None}, "unknown"),
        ({"link": "failed", "problem": "no reply"}, "not_connected"),
        ({"link": "disconnected"}, "not_connected"),
    ],
)
def test_of_several_the_one_that_has_to_be_known_first(changed: dict[str, object], kind: str) -> None:
    found = judge(replace(SENT, **changed))  # type: ignore[arg-type]
    assert found.kind == kind
    assert found.cause


@pytest.mark.parametrize(
    ("changed", "kind", "cause"),
    [
        (
            {"state": replace(STATE, moving=True, target_position=None)},
            "moving",
            "it moves; the driver warns that it is",
        ),
        ({}, "on_target", "at its target; lost steps would not be seen; the driver warns that it is hot"),
        (
            {"state": replace(STATE, position_reached=False)},
            "ready",
            "at rest; lost steps would not be seen; the driver",
        ),
        ({"end": end("stall", "a stall")}, "stalled", "a stall; the driver warns that it is hot"),
        ({"link": "disconnected"}, "not_connected", "it is not connected"),
    ],
)
def test_a_warning_of_the_driver_is_told_beside_what_the_axis_does(
    changed: dict[str, object], kind: str, cause: str
) -> None:
    warned = hot({"otpw": True, "ot": False}, "otpw", "ot", Evidence("DRV_STATUS.otpw", "1", 5.0))
    found = judge(replace(SENT, **{"signs": Signs(warnings=warned), **changed}))  # type: ignore[arg-type]
    assert (found.kind, found.cause[: len(cause)]) == (kind, cause)
    assert any(piece.what == "DRV_STATUS.otpw" for piece in found.evidence) == (kind != "not_connected")


def test_zeros_come_with_their_cure() -> None:
    found = judge(replace(SENT, signs=Signs(blocks=(zero("VMAX", 1, 200_000), zero("AMAX", 1, 500)))))
    assert found.cause == "VMAX is 0; AMAX is 0: no command can move this axis"
    assert [remedy.label for remedy in found.remedies] == ["start up", "write VMAX 200,000", "write AMAX 500"]
    assert found.remedies[0].body == {"axes": [1]}
    assert (found.remedies[1].path, found.remedies[1].body) == ("registers/VMAX?axis=1", {"value": 200_000})


def test_what_cannot_be_known_is_unknown_with_its_cause() -> None:
    never = judge(AxisObservation(0, "connected"))
    assert (never.kind, never.cause) == ("unknown", "nobody has looked at this axis yet")
    failing = judge(AxisObservation(0, "connected", problem="no reply within 0.1 s"))
    assert (failing.kind, failing.cause) == ("unknown", "no reply within 0.1 s")
    untrusted = judge(replace(SENT, signs=Signs(untrusted=(Sign("its counter is not to be believed"),))))
    assert (untrusted.kind, untrusted.cause) == ("unknown", "its counter is not to be believed")
    reset = judge(replace(SENT, reset_s=3.0))
    assert (reset.kind, [remedy.label for remedy in reset.remedies]) == (
        "unknown",
        ["start up", "search reference again"],
    )
    puzzling = judge(replace(SENT, end=end("unknown", "nothing says why it stands")))
    assert (puzzling.kind, puzzling.cause) == ("unknown", "nothing says why it stands")
    # What is known to be wrong comes before what is unknown, and a motion too.
    assert judge(replace(SENT, reset_s=3.0, signs=FAULT)).kind == "driver_fault"
    assert judge(replace(SENT, reset_s=3.0, state=replace(STATE, moving=True))).kind == "moving"


RIGHT = Remedy("set the encoder to 4,000 counts a turn", "POST", "registers", {"writes": []})


@pytest.mark.parametrize(
    ("slope", "cause"),
    [
        (-0.2, "the encoder counts 20 % too few: its resolution looks wrong, steps are not lost"),
        (1.0, "the encoder counts 100 % too many: its resolution looks wrong, steps are not lost"),
        (-2.0, "the encoder counts the other way: its direction looks wrong, steps are not lost"),
        (
            -1.5,
            "the encoder counts the other way and counts 50 % too few: its resolution looks wrong, steps are not lost",
        ),
    ],
)
def test_a_deviation_in_proportion_to_the_way_is_a_wrong_resolution(slope: float, cause: str) -> None:
    found = WrongResolution(EncoderLine(slope, 12, 102_400, 20.0), (RIGHT,))
    seen = replace(SENT, resolution=found, state=replace(STATE, deviation=-2000.0))
    rests = judge(seen)
    assert (rests.kind, rests.cause, rests.remedies) == ("lost_steps", cause, (RIGHT,))
    assert Evidence("deviation over position", f"{slope:+.4f}, both ways") in rests.evidence
    assert Evidence("seen at", "12 places over 102,400 microsteps") in rests.evidence
    moves = judge(replace(seen, state=replace(STATE, deviation=-2000.0, moving=True, velocity_pps=1000.0)))
    assert (moves.kind, moves.cause, moves.remedies) == ("following_error", cause, ())
    assert judge(replace(seen, end=end("deviation"))).cause == cause
    # What agrees within the thresholds is no fault, and another fault comes first.
    assert judge(replace(seen, state=replace(STATE, deviation=2.0))).kind == "on_target"
    assert judge(replace(seen, signs=FAULT)).kind == "driver_fault"
