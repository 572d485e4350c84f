"""Two readings of one law: the predicted ramp and the emulated chip agree at every sample, over the wire.

`app/calc` and `app/emulators` share no line of the ramp generator, so a slip in one does not hide in the other.
"""

from __future__ import annotations

from hypothesis import given, settings
from hypothesis import strategies as st

from app.calc.ramps.ticked import RampParameters, RampStart, exact_ramp
from app.clock import VirtualClock
from app.emulators.build import build_emulator
from app.links.datagram32 import Reply, read, write

X_TARGET, X_ACTUAL, V_MIN, V_MAX, V_TARGET, V_ACTUAL, A_MAX = range(7)
PMUL_PDIV, MODE, DIVIDERS = 9, 10, 12
SWITCHES_DO_NOT_STOP = 3 << 8
MODES = ("ramp", "soft", "velocity", "hold")


def signed(value: int, bits: int) -> int:
    return (value + (1 << bits - 1)) % (1 << bits) - (1 << bits - 1)


@settings(max_examples=60, deadline=None)
@given(data=st.data())
def test_the_prediction_is_what_the_chip_does(data: st.DataObject) -> None:
    draw = data.draw
    parameters = RampParameters(
        v_min=draw(st.integers(0, 60)),
        v_max=draw(st.integers(1, 2047)),
        a_max=draw(st.integers(1, 2047)),
        ramp_div=draw(st.integers(0, 8)),
        pulse_div=draw(st.integers(0, 8)),
        pmul=draw(st.integers(0, 127)),
        pdiv=draw(st.integers(0, 13)),
        ramp_mode=draw(st.sampled_from(("ramp", "soft", "velocity"))),
        v_target=draw(st.integers(-2047, 2047)),
    )
    distance = draw(st.integers(-20_000, 20_000))
    chip = build_emulator("tmc428", VirtualClock())
    begin = draw(st.integers(1, 10_000)) * 32  # clocks since power-on: the dividers stand anywhere
    mode = MODES.index(parameters.ramp_mode)
    for register, value in (
        (MODE, SWITCHES_DO_NOT_STOP),
        (DIVIDERS, parameters.pulse_div << 12 | parameters.ramp_div << 8),
        (PMUL_PDIV, 0x8000 | parameters.pmul << 8 | parameters.pdiv),
        (V_MIN, parameters.v_min),
        (V_MAX, parameters.v_max),
        (A_MAX, parameters.a_max),
        (MODE, SWITCHES_DO_NOT_STOP | mode),
    ):
        chip.exchange(write(register, value), begin / parameters.clock_hz)
    begun = (V_TARGET, (parameters.v_target or 0) & 0xFFF) if mode == 2 else (X_TARGET, distance & 0xFFFFFF)
    chip.exchange(write(*begun), begin / parameters.clock_hz)

    start = RampStart(
        clocks_to_ramp_tick=parameters.ramp_period_clocks - begin % parameters.ramp_period_clocks,
        clocks_to_pulse_tick=parameters.pulse_period_clocks - begin % parameters.pulse_period_clocks,
    )
    longest = 30_000 * min(parameters.ramp_period_clocks, parameters.pulse_period_clocks)
    duration_s = draw(st.integers(1, longest)) / parameters.clock_hz
    curve = exact_ramp(parameters, distance, samples=40, start=start, duration_s=duration_s)
    assert curve.velocity_256 is not None
    for time_s, position, velocity in zip(curve.time_s, curve.position, curve.velocity_256.tolist(), strict=True):
        at_s = begin / parameters.clock_hz + time_s
        x_actual = signed(Reply.decode(chip.exchange(read(X_ACTUAL), at_s)).data, 24)
        v_actual = signed(Reply.decode(chip.exchange(read(V_ACTUAL), at_s)).data, 12)
        assert (time_s, x_actual, v_actual) == (time_s, position, _whole(velocity))


def _whole(velocity_256: int) -> int:
    """The twelve bits that v_actual shows: the whole part of the magnitude, with the sign."""
    return abs(velocity_256) // 256 * (1 if velocity_256 >= 0 else -1)
