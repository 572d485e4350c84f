"""Random moves of an emulated TMC4361, changed on the fly: what they were and how they ended."""

from __future__ import annotations

import math
import random
from dataclasses import dataclass, replace

from tests.emulators.tmc4361.rig import HOLD_POSITION, S_POSITION, TRAPEZOID_POSITION, Ramp, Rig

_SHAPES = (S_POSITION, S_POSITION, TRAPEZOID_POSITION, HOLD_POSITION)
_LONGEST_S = 60.0


@dataclass(frozen=True)
class Ending:
    """`changes` on the fly; the last target; where XACTUAL and the step output ended, and whether the flag was set."""

    mode: int
    ramp: Ramp
    changes: int
    target: int
    position: int
    sent: int
    reached: bool
    rests: bool
    seconds: float

    @property
    def exact(self) -> bool:
        return self.rests and self.reached and self.position == self.sent == self.target


def random_ramp(source: random.Random, mode: int) -> Ramp:
    """Parameters with which a move takes a second or two."""

    def between(low: float, high: float) -> float:
        return math.exp(source.uniform(math.log(low), math.log(high)))

    vmax = between(1e3, 4e5)
    ramp = Ramp(
        vmax=vmax,
        amax=vmax * between(2, 50),
        dmax=vmax * between(2, 50),
        vstart=source.choice((0, 0, 0, vmax * source.uniform(0, 0.1))),
        vstop=source.choice((0, 0, 0, vmax * source.uniform(0, 0.1))),
    )
    ramp = replace(
        ramp,
        **{f"bow{n}": min(between(3, 100) * (ramp.amax if n < 3 else ramp.dmax), 2**24 - 1) for n in (1, 2, 3, 4)},
        amax=min(ramp.amax, 2**22 - 1),
        dmax=min(ramp.dmax, 2**22 - 1),
        astart=source.choice((0, ramp.amax * 0.3)),
        dfinal=ramp.dmax * 0.5,
    )
    if mode == TRAPEZOID_POSITION and source.random() < 0.5:
        ramp = replace(ramp, vbreak=ramp.vstop + vmax * source.uniform(0.05, 0.5), astart=ramp.amax * 0.5)
    return ramp


def ending(source: random.Random) -> Ending:
    """Make one random move on a chip of its own, with up to three changes of target or speed, and wait for its end."""
    mode = source.choice(_SHAPES)
    ramp = random_ramp(source, mode)
    rig = Rig()
    rig.ramp(ramp, mode)
    reach = round(ramp.vmax * source.choice((0.01, 0.1, 0.5)))
    target = source.randint(-reach, reach)
    rig.write("XTARGET", target)
    changes = source.choice((0, 1, 2, 3))
    for _ in range(changes):
        rig.wait(source.uniform(0, 0.3))
        if source.random() < 0.7:
            target = source.randint(-reach, reach)
            rig.write("XTARGET", target)
        else:
            rig.write("VMAX", round(ramp.vmax * source.uniform(0.3, 1.0) * 256))
    begin_s = rig.now_s
    while rig.state().ramp.kind != "rest" and rig.now_s < begin_s + _LONGEST_S:
        rig.wait(0.05)
    state = rig.state()
    return Ending(
        mode=mode,
        ramp=ramp,
        changes=changes,
        target=target,
        position=rig.position,
        sent=state.step_output.microsteps_256,
        reached=rig.flag(0),
        rests=state.ramp.kind == "rest" and state.step_output.steps_held == 0,
        seconds=rig.now_s,
    )
