"""What a bench does to a chip, and what it is told."""

from __future__ import annotations

import pytest
from pydantic import ValidationError

from app.clock import VirtualClock
from app.emulators.build import EMULATED, build_emulator, options_of
from app.emulators.tmc5xxx import MODELS, EmulatedTmc5xxx, Tmc5xxxModel, Tmc5xxxOptions, Tmc5xxxPatch
from app.emulators.tmc5xxx.family import FAMILY
from app.errors import OutOfRange, WrongState
from tests.emulators.tmc5xxx.rig import DUAL, FORWARD, PLACES, SINGLE, TURN, Bench, moving


@pytest.mark.parametrize("model", MODELS)
def test_the_factory_knows_it(model: Tmc5xxxModel) -> None:
    assert model in EMULATED
    assert options_of(model) is Tmc5xxxOptions
    chip = build_emulator(model, VirtualClock())
    assert isinstance(chip, EmulatedTmc5xxx)
    assert chip.model == chip.state().model == model


@pytest.mark.parametrize(("model", "axis"), PLACES)
def test_an_axis_has_a_plant_of_its_own(model: Tmc5xxxModel, axis: int) -> None:
    bench = Bench(model, rigid=False)
    bench.wait(1e-3)
    untouched = bench.state().axes
    state = bench.stage(
        axis,
        motor={"connected": False, "temperature_c": 55.0},
        load_torque_nm=0.1,
        blocked=True,
        friction=0.02,
        stage={"left_at_fullsteps": -10.0, "position_fullsteps": 12.0},
        switches={"left": True},
    )
    changed = state.axes[axis]
    assert (changed.motor.connected, changed.motor.temperature_c) == (False, 55.0)
    assert (changed.load_torque_nm, changed.blocked, changed.friction) == (0.1, True, 0.02)
    assert changed.stage.left_at_fullsteps == -10.0
    assert changed.stage.position_fullsteps == pytest.approx(12.0)
    assert (changed.switches.left.active, changed.switches.left.forced) == (True, True)
    for other in state.axes:
        if other.axis != axis:
            assert other == untouched[other.axis]
    freed = bench.stage(axis, switches={"left": "auto"}, stage={"position_fullsteps": -11.0})
    assert (freed.axes[axis].switches.left.active, freed.axes[axis].switches.left.forced) == (True, None)


def test_what_cannot_be_is_refused_and_changes_nothing() -> None:
    bench = Bench("tmc5130")
    before = bench.state()
    for change, error in (
        ({"axes": [{"axis": 1}]}, OutOfRange),
        ({"axes": [{"axis": 0, "stage": {"left_at_fullsteps": 4000.0}}]}, OutOfRange),
        ({"axes": [{"axis": 0, "load_torque_nm": 0.1}]}, WrongState),
        ({"axes": [{"axis": 0, "blocked": True}], "supply_v": 5.0}, WrongState),
    ):
        with pytest.raises(error):
            bench.patch(**change)
        assert bench.state() == before
    with pytest.raises(OutOfRange):
        Bench("tmc5031").stage(encoder={"slip_fullsteps": 1.0})


@pytest.mark.parametrize(
    "wrong",
    [
        {"clock_hz": 3e6},
        {"clock_hz": 19e6},
        {"motor": "soft"},
        {"encoder": {"lines": 0}},
        {"time_scale": -1},
        {"colour": "red"},
        {"motor": {"rotor_inertia_kgm2": 1e-8, "holding_torque_nm": 50.0}},
    ],
)
def test_options_that_cannot_be(wrong: dict[str, object]) -> None:
    with pytest.raises(ValidationError):
        Tmc5xxxOptions.model_validate(wrong)


def test_changes_that_cannot_be() -> None:
    changes: tuple[dict[str, object], ...] = (
        {"axes": [{"axis": 2}]},
        {"axes": [{}]},
        {"pins": {"drv_enn": 1}},
        {"faults": {"undervoltage": True}},
    )
    for wrong in changes:
        with pytest.raises(ValidationError):
            Tmc5xxxPatch.model_validate(wrong)


def test_its_time_can_be_faster_than_ours() -> None:
    clock = VirtualClock()
    chip = FAMILY.make("tmc5160", clock, Tmc5xxxOptions(motor="rigid", time_scale=2.0))
    clock.set(3.0)
    assert chip.state().chip_time_s == 6.0
    chip.patch(Tmc5xxxPatch(time_scale=0.0))
    clock.set(4.0)
    assert chip.state().chip_time_s == 6.0


@pytest.mark.parametrize("model", MODELS)
def test_it_makes_no_difference_how_often_somebody_looks(model: Tmc5xxxModel) -> None:
    ends = []
    for looks in (1, 7, 400):
        bench = moving(model, rigid=False)
        bench.put(XTARGET=TURN)
        for _ in range(looks):
            bench.wait(2.7 / looks)
            bench.chip.exchange(bytes((0x22, 0, 0, 0, 0)), bench.now_s)
        bench.now_s = 3.0
        ends.append(bench.state())
    assert ends[0] == ends[1] == ends[2]


@pytest.mark.parametrize("model", [*DUAL, *SINGLE])
@pytest.mark.sheet("AN-001", "2")
def test_a_rigid_motor_turns_for_a_year_and_the_counter_wraps(model: Tmc5xxxModel) -> None:
    """AN-001 2: at 1 turn a second and 51,200 microsteps a turn the 32-bit range is passed every 23.3 hours."""
    bench = moving(model)
    bench.put(VMAX=2**24 // 16, RAMPMODE=FORWARD)  # exactly 1,000,000 microsteps a second at 16 MHz
    bench.wait(60)
    start = bench.read("XACTUAL")
    year_s = 365 * 86_400
    bench.wait(year_s)
    wrapped = (start + year_s * 1_000_000 + 2**31) % 2**32 - 2**31
    assert bench.read("XACTUAL") == wrapped
