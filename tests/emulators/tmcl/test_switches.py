"""Stop switches, ports and the step input."""

from __future__ import annotations

import pytest

from app.registers.tmcl.commands import ExtendedErrors, Opcode, Status
from tests.emulators.tmcl.harness import FULLSTEP, Bench

RIGHT_AT = 40
STAGE: dict[str, object] = {
    "stage": {
        "left_at_fullsteps": -40.0,
        "right_at_fullsteps": float(RIGHT_AT),
        "home_from_fullsteps": -12.0,
        "home_to_fullsteps": -8.0,
    }
}


def _running_right(**parameters: int) -> Bench:
    bench = Bench(STAGE)
    for name, value in parameters.items():
        bench.sap(int(name.removeprefix("ap")), value)
    bench.do(Opcode.ROR, 0, 0, 10_000)
    bench.run(0.05)
    return bench


def test_a_stop_switch_stops_at_once() -> None:
    bench = _running_right(ap5=200_000)
    bench.until(lambda: bench.gap(10) == 1, step_s=0.0005)
    assert bench.gap(3) == 0
    assert bench.gap(1) == pytest.approx(RIGHT_AT * FULLSTEP, abs=120)
    assert (bench.gap(9), bench.gap(11)) == (0, 0)
    bench.run(1.0)
    assert bench.gap(3) == 0
    bench.do(Opcode.ROL, 0, 0, 10_000)  # the other way is free
    bench.run(0.5)
    assert bench.gap(3) == -10_000
    assert bench.gap(10) == 0
    bench.until(lambda: bench.gap(11) == 1)
    assert bench.gap(3) == 0


def test_a_soft_stop_slows_down() -> None:
    bench = _running_right(ap5=200_000, ap26=1, ap17=20_000)
    bench.until(lambda: bench.gap(10) == 1, step_s=0.0005)
    assert bench.gap(3) > 9000
    bench.stand()
    assert bench.gap(1) > (RIGHT_AT + 5) * FULLSTEP


def test_a_disabled_switch_only_tells() -> None:
    bench = _running_right(ap12=1)
    bench.run(3.0)
    assert (bench.gap(10), bench.gap(3)) == (1, 10_000)
    bench.sap(12, 0)
    bench.run(0.01)
    assert bench.gap(3) == 0


def test_swapped_switches() -> None:
    bench = _running_right(ap14=1)
    bench.run(3.0)
    assert (bench.gap(10), bench.gap(11)) == (0, 1)
    assert bench.gap(3) == 10_000  # what is pressed counts as the left one, which does not stop this way


@pytest.mark.parametrize(("polarity", "state", "side"), [(24, 10, "right"), (25, 11, "left")])
def test_polarity(polarity: int, state: int, side: str) -> None:
    bench = Bench(STAGE)
    assert bench.gap(state) == 0
    bench.sap(polarity, 1)
    bench.run(0.001)
    assert bench.gap(state) == 1
    bench.patch(switches={side: True})
    bench.run(0.001)
    assert bench.gap(state) == 0


def test_forced_switches_and_the_stage_itself() -> None:
    bench = Bench(STAGE)
    state = bench.patch(switches={"left": True, "home": True})
    bench.run(0.001)
    assert (bench.gap(11), bench.gap(9)) == (1, 1)
    assert state.switches.left.forced is True
    bench.patch(switches={"left": "auto", "home": "auto", "right": False})
    bench.run(0.001)
    assert (bench.gap(11), bench.gap(9)) == (0, 0)
    state = bench.patch(stage={"position_fullsteps": -10.0})
    assert state.stage.position_fullsteps == pytest.approx(-10.0)
    assert state.switches.home.active
    assert state.switches.right.forced is False


# --- ports ----------------------------------------------------------------------------------------


@pytest.mark.sheet("FM-PD42-1241", "3.6.12")
@pytest.mark.sheet("FM-PD42-1241", "3.6.13")
@pytest.mark.sheet("FM-PD42-1241", "3.5.4")
def test_outputs_are_set_and_read_back() -> None:
    bench = Bench()
    assert [bench.do(Opcode.GIO, port, 2) for port in (0, 1)] == [0, 0]
    bench.do(Opcode.SIO, 0, 2, 1)
    assert [bench.do(Opcode.GIO, port, 2) for port in (0, 1)] == [1, 0]
    bench.do(Opcode.SIO, 255, 2, 2)
    assert bench.state.inputs.outputs == [0, 1]
    bench.do(Opcode.CALC, 9, 0, 3)
    bench.do(Opcode.SIO, 255, 2, -1)  # the accumulator
    assert bench.state.inputs.outputs == [1, 1]
    assert bench.ask(Opcode.SIO, 0, 2, 2).status == Status.INVALID_VALUE
    for opcode in (Opcode.SIO, Opcode.GIO):
        assert bench.ask(opcode, 2, 2).status == Status.WRONG_TYPE
    bench.power_cycle()
    assert bench.state.inputs.outputs == [0, 0]


@pytest.mark.sheet("FM-PD42-1241", "3.6.12")
def test_pull_ups_show_on_open_inputs() -> None:
    # Open: what an open input reads. Here 1 with its pull-up, which all have at first, and 0 without.
    bench = Bench()
    assert [bench.do(Opcode.GIO, port, 0) for port in range(4)] == [0, 1, 1, 0]
    bench.do(Opcode.SIO, 0, 0, 1)
    assert [bench.do(Opcode.GIO, port, 0) for port in range(4)] == [0, 0, 0, 0]
    bench.patch(inputs={"in2": True})
    assert bench.do(Opcode.GIO, 2, 0) == 1
    bench.patch(inputs={"in2": "open"})
    assert bench.do(Opcode.GIO, 2, 0) == 0
    assert bench.ask(Opcode.SIO, 0, 0, 4).status == Status.INVALID_VALUE
    assert bench.ask(Opcode.SIO, 1, 0, 1).status == Status.WRONG_TYPE


@pytest.mark.sheet("FM-PD42-1241", "3.6.13")
def test_inputs_one_by_one_and_all_at_once() -> None:
    bench = Bench()
    state = bench.patch(inputs={"in1": False, "in2": True, "analog": 3000}, switches={"home": True})
    assert [bench.do(Opcode.GIO, port, 0) for port in range(4)] == [1, 0, 1, 1]
    assert bench.do(Opcode.GIO, 255, 0) == 0b1101
    assert (state.inputs.in0, state.inputs.in1, state.inputs.in2, state.inputs.in3) == (True, False, True, True)
    assert bench.do(Opcode.GIO, 0, 1) == 3000
    bench.patch(inputs={"analog": 2047})
    assert bench.do(Opcode.GIO, 3, 0) == 0
    assert bench.ask(Opcode.GIO, 4, 0).status == Status.WRONG_TYPE
    assert bench.ask(Opcode.GIO, 1, 1).status == Status.WRONG_TYPE


def test_supply_and_temperature_are_told() -> None:
    bench = Bench()
    bench.patch(supply_v=21.5, motor={"temperature_c": 61.0})
    assert bench.do(Opcode.GIO, 8, 1) == 215
    assert bench.do(Opcode.GIO, 9, 1) == 61


# --- step/direction -------------------------------------------------------------------------------


@pytest.mark.sheet("FM-PD42-1241", "6.4")
def test_motion_commands_do_nothing_in_step_direction_mode() -> None:
    bench = Bench()
    bench.sap(254, 1)
    bench.do(Opcode.ROR, 0, 0, 10_000)
    bench.do(Opcode.ROL, 0, 0, 10_000)
    bench.do(Opcode.MVP, 0, 0, 10_000)
    bench.do(Opcode.MVP, 1, 0, 10_000)
    bench.do(Opcode.RFS, 0)
    bench.do(Opcode.MST)
    bench.run(1.0)
    assert (bench.gap(1), bench.gap(2), bench.gap(3)) == (0, 0, 0)
    assert bench.do(Opcode.RFS, 2) == 0


@pytest.mark.sheet("FM-PD42-1241", "6.4")
def test_pulses_move_the_motor_in_step_direction_mode() -> None:
    bench = Bench()
    bench.patch(step_dir={"pulses": 5000, "rate_hz": 10_000})
    bench.run(1.0)
    assert bench.gap(1) == 0  # nobody listens
    bench.sap(254, 1)
    bench.patch(step_dir={"pulses": 25_600, "rate_hz": 20_000})
    bench.run(0.64)
    assert bench.gap(1) == pytest.approx(12_800, rel=0.05)
    assert bench.gap(180) == 16  # the current goes up to the run current by itself
    bench.run(0.8)
    assert bench.gap(1) == 25_600
    bench.patch(step_dir={"pulses": -600, "rate_hz": 20_000})
    bench.run(2.5)
    assert bench.gap(1) == 25_000
    assert bench.state.truth.rotor_fullsteps == pytest.approx(25_000 / FULLSTEP, abs=0.5)
    bench.run(2.0)
    assert bench.gap(180) == 1  # and down again
    bench.sap(254, 0)
    bench.move(51_200)
    bench.run(0.5)
    assert bench.gap(3) == pytest.approx(25_600, rel=0.05)  # by the ramp again
    bench.arrive()


@pytest.mark.sheet("FM-PD42-1241", "6.4")
def test_with_double_edges_each_pulse_counts_twice() -> None:
    bench = Bench()
    bench.sap(254, 1)
    bench.sap(161, 1)
    bench.patch(step_dir={"pulses": 5000, "rate_hz": 10_000})
    bench.run(2.0)
    assert bench.gap(1) == 10_000


def test_a_deviation_does_not_end_step_direction_mode() -> None:
    bench = Bench()
    bench.sap(254, 1)
    bench.sap(212, 2000)
    bench.patch(encoder={"slip_fullsteps": 20.0})
    bench.run(0.01)
    assert bench.gap(207) == ExtendedErrors.DEVIATION
    bench.sap(212, 0)
    bench.patch(step_dir={"pulses": 1000, "rate_hz": 10_000})
    bench.run(1.0)
    assert bench.gap(1) == 1000


@pytest.mark.sheet("FM-PD42-1241", "6.4")
def test_a_running_motor_stops_when_the_mode_begins() -> None:
    bench = Bench()
    bench.do(Opcode.ROR, 0, 0, 10_000)
    bench.run(1.0)
    bench.sap(254, 1)
    bench.stand(limit_s=1)
    assert bench.gap(254) == 1
