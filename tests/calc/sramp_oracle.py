"""An S-ramp by small steps, without a formula for a slope: what the planner has to agree with.

Each step tries to push the acceleration toward the velocity wanted, then to keep it, and lets go of it if neither may
be: it may not if letting go from then on, step by step, would pass that velocity, or have the motor accelerate with
more than AMAX. A move follows VMAX for a number of steps and brakes; the number is found by halving.
"""

from __future__ import annotations

from app.calc.ramps.sramp import SRamp

MOST_STEPS = 20_000


def _let_go(p: SRamp, v: float, a: float, dt: float) -> tuple[float, float]:
    bow = p.bow2 if v * a > 0 else p.bow4
    time_s = min(dt, abs(a) / bow)  # the last step ends where the acceleration does
    end = (abs(a) - bow * time_s) * (1 if a > 0 else -1)
    return v + (a + end) / 2 * time_s, end if time_s == dt else 0.0


def _coasts_to(p: SRamp, v: float, a: float, dt: float) -> float:
    while a:
        v, a = _let_go(p, v, a, dt)
    return v


def _may(p: SRamp, v: float, a: float, target: float, way: float, dt: float) -> bool:
    if way * (target - _coasts_to(p, v, a, dt)) < 0:
        return False
    while v * a < 0 and abs(a) > p.amax:  # it brakes harder than it may accelerate beyond velocity 0
        v, a = _let_go(p, v, a, dt)
    return not (v * a > 0 and abs(a) > p.amax * (1 + 1e-9))


def step(p: SRamp, v: float, a: float, target: float, dt: float) -> tuple[float, float]:
    """State one step later, on the way to velocity `target`."""
    way = 1.0 if target > _coasts_to(p, v, a, dt) else -1.0
    if way * a >= 0:
        accelerates = way * v >= 0
        limit, bow = (p.amax, p.bow1) if accelerates else (p.dmax, p.bow3)
        if abs(a) <= limit:
            for size in (min(abs(a) + bow * dt, limit), abs(a)):
                after = v + (a + way * size) / 2 * dt
                if _may(p, after, way * size, target, way, dt):
                    return after, way * size
    return _let_go(p, v, a, dt)


def velocity_time(p: SRamp, target: float, v: float, a: float, dt: float) -> float:
    """How long a change of velocity takes [s]."""
    for count in range(MOST_STEPS):
        if abs(v - target) <= 2 * p.bow2 * dt * dt + 2 * abs(a) * dt and abs(a) <= 3 * max(p.bow2, p.bow4) * dt:
            return count * dt
        v, a = step(p, v, a, target, dt)
    raise AssertionError("it takes for ever")


def _follow(p: SRamp, way: float, steps: int, v: float, a: float, dt: float) -> tuple[float, float, float]:
    x = 0.0
    for _ in range(steps):
        before = v
        v, a = step(p, v, a, way * p.vmax, dt)
        x += (before + v) / 2 * dt
    return x, v, a


def _brake(p: SRamp, v: float, a: float, dt: float) -> tuple[float, int]:
    x = 0.0
    for count in range(MOST_STEPS):
        if abs(v) <= 2 * p.bow4 * dt * dt + 2 * abs(a) * dt and abs(a) <= 3 * max(p.bow2, p.bow4) * dt:
            return x, count
        before = v
        v, a = step(p, v, a, 0.0, dt)
        x += (before + v) / 2 * dt
    raise AssertionError("it never stands")


def move_time(p: SRamp, distance: float, v: float, a: float, dt: float) -> float:
    """How long a move takes [s]: the steps to follow VMAX by halving, the steps to brake by counting."""
    way = 1.0 if distance > _brake(p, v, a, dt)[0] else -1.0
    low, high = 0, 1
    while way * (distance - _ends_at(p, way, high, v, a, dt)[0]) > 0:
        low, high = high, 2 * high
    while high - low > 1:
        middle = (low + high) // 2
        if way * (distance - _ends_at(p, way, middle, v, a, dt)[0]) > 0:
            low = middle
        else:
            high = middle
    return _ends_at(p, way, high, v, a, dt)[1] * dt


def _ends_at(p: SRamp, way: float, steps: int, v: float, a: float, dt: float) -> tuple[float, int]:
    x, v, a = _follow(p, way, steps, v, a, dt)
    stopping, count = _brake(p, v, a, dt)
    return x + stopping, steps + count
