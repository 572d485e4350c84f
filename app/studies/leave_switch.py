"""The way out of a switch, of a study that was cut off in it and is to go on: slowly, away from it, and not far."""

from __future__ import annotations

from ..procedures.procedure import Failed
from .plan import axis_now
from .ramp_settings import SPEED
from .run import StudyRun
from .switch_edge import SLOW_FULLSTEPS
from .until_switch import Side, go_until_switch, is_pressed


async def leave_switch(run: StudyRun, side: Side | None) -> None:
    """Where a study that goes on stands in its switch: out of it by a turn at most, then the ramp as it was before.

    side : of the switch that sees its lost steps; None: it has none. One that begins stays where it is: its plan says
    what is missing. Raises Failed where it is pressed yet, BenchError.
    """
    device, axis, record = run.device, run.axis, run.record
    if side is None or record.start is None:
        return
    missing: list[str] = []
    now = await axis_now(device, axis, missing)
    if now is None or missing or not is_pressed(now.state, side):
        return
    run.tell("preconditions", 0.0, f"slowly out of the {side} switch, in which it was cut off")
    ramp, at = now.space.now(), now.state.position
    slow = {**ramp, SPEED: min(ramp[SPEED], SLOW_FULLSTEPS * now.full_step)}
    await run.apply(now.space.registers(slow), "slowly, out of the switch")
    target = at + (now.turn if side == "left" else -now.turn)
    met = await go_until_switch(device, axis, run.clock, side, target, pressed=False)
    record.way_fullsteps += abs((await device.monitor.axis_state(axis)).position - at) / now.full_step
    if met is None:
        raise Failed(f"the {side} switch is pressed yet, a turn away from where it was: see to it, and to the motor")
    await run.back()
