"""Whole ranges of a TMC4361's ramp registers, for hypothesis."""

from __future__ import annotations

import math

from hypothesis import strategies as st

from app.calc.ramps.sramp import SRamp


def decades(low: float, high: float) -> st.SearchStrategy[float]:
    """Numbers of any size between two above 0."""
    return st.floats(math.log(low), math.log(high)).map(lambda x: min(max(math.exp(x), low), high))


def or_nothing(numbers: st.SearchStrategy[float]) -> st.SearchStrategy[float]:
    return st.one_of(st.just(0.0), numbers)


velocities = decades(1 / 256, 8_388_607.0)
accelerations = decades(0.25, 4_194_303.75)
bows = decades(1.0, 16_777_215.0)


def signed(numbers: st.SearchStrategy[float]) -> st.SearchStrategy[float]:
    return st.tuples(st.sampled_from((-1.0, 0.0, 1.0)), numbers).map(lambda x: x[0] * x[1])


@st.composite
def distances(draw: st.DrawFn, p: SRamp) -> float:
    """Microsteps that take no longer than a day."""
    longest = min(2.0**31, p.vmax * 86_400)
    return draw(st.sampled_from((-1.0, 1.0))) * draw(decades(1e-3, longest))


@st.composite
def plain_ramps(draw: st.DrawFn) -> SRamp:
    """Four different bows, AMAX unlike DMAX, nothing else."""
    return SRamp(
        draw(velocities),
        draw(accelerations),
        draw(accelerations),
        draw(bows),
        draw(bows),
        draw(bows),
        draw(bows),
    )


@st.composite
def ramps(draw: st.DrawFn) -> SRamp:
    """With start and stop values, or some of them."""
    return SRamp(
        draw(velocities),
        draw(accelerations),
        draw(accelerations),
        draw(bows),
        draw(bows),
        draw(bows),
        draw(bows),
        vstart=draw(or_nothing(velocities)),
        vstop=draw(or_nothing(velocities)),
        astart=draw(or_nothing(accelerations)),
        dfinal=draw(or_nothing(accelerations)),
        use_astart_and_vstart=draw(st.booleans()),
    )


@st.composite
def states(draw: st.DrawFn, p: SRamp) -> tuple[float, float]:
    """Velocity [pps] and acceleration [pps^2] of a motor under way, some of them 0, others beyond the limits of `p`.

    The bows can let go of the acceleration within the chip's range of velocities, and within 100 times VMAX: the way
    back would take days.
    """
    fastest = min(100 * p.vmax, 8_388_607.0)
    highest = math.sqrt(2 * min(p.bow2, p.bow4) * fastest)
    v = draw(signed(decades(1 / 256, fastest)))
    a = draw(signed(st.one_of(st.just(min(p.amax, highest)), decades(1e-6, 1.0).map(lambda part: part * highest))))
    return v, a
