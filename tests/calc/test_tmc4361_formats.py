"""Fixed point, direct units and limits of the TMC4361's ramp registers."""

from __future__ import annotations

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from app.calc.units.tmc4361 import DIRECT_ACCELERATION_CAP, DIRECT_BOW_CAP, FORMATS, Quantity, Units
from app.registers.tmc4361.rows import ACCELERATION_UNIT, BOW_UNIT, VELOCITY_UNIT
from app.registers.tmc4361.table import CLOCK_HZ_MAX, CLOCK_HZ_MIN, TMC4361

DIRECT = Units(direct_acceleration=True, direct_bow=True)
VELOCITIES = [name for name, form in FORMATS.items() if form.quantity is Quantity.VELOCITY and name != "VACTUAL"]
ACCELERATIONS = ["AMAX", "DMAX", "ASTART", "DFINAL", "DSTOP"]
BOWS = ["BOW1", "BOW2", "BOW3", "BOW4"]
WRITTEN = [*VELOCITIES, *ACCELERATIONS, *BOWS, "DFREEZE"]


@pytest.mark.sheet("DS-TMC4361", "8")
@pytest.mark.sheet("DS-TMC4361", "8.2.3")
@pytest.mark.parametrize("name", FORMATS)
def test_formats_are_as_wide_as_their_registers(name: str) -> None:
    found = TMC4361.find(name, 0)
    assert found is not None
    register, part = found
    bits = part or register.field_named(name) or register
    form = FORMATS[name]
    assert bits.width == form.whole + form.decimals
    assert bits.signed == form.signed
    assert bits.maximum == form.raw_max
    if name not in ("VACTUAL", "AACTUAL", "DFREEZE"):
        assert (
            bits.unit
            == {"velocity": VELOCITY_UNIT, "acceleration": ACCELERATION_UNIT, "bow": BOW_UNIT}[form.quantity.value]
        )


@pytest.mark.sheet("DS-TMC4361", "8.2.3")
def test_smallest_and_greatest_values_of_the_data_sheets_table() -> None:
    """With its "mpps" read as thousandths in the row of minima of velocities, as millions in the row of maxima."""
    units = Units(clock_hz=32e6)
    for name in VELOCITIES:
        assert units.limits(name).least == 3.90625e-3
        assert units.limits(name).highest == pytest.approx(8.388607e6, abs=1)
    for name in ACCELERATIONS:
        assert units.limits(name).least == 0.25
        assert units.limits(name).highest == pytest.approx(4.194303e6, abs=1)
    for name in BOWS:
        assert units.limits(name).least == 1
        assert units.limits(name).highest == pytest.approx(16.777e6, rel=1e-4)


@pytest.mark.sheet("DS-TMC4361", "8.2.3")
def test_direct_units_of_the_data_sheets_example_at_16_mhz() -> None:
    """1.86 kpps^2 to 31.25 Gpps^2 and 454.75 kpps^3 to 7.63 Tpps^3; the minus signs there are lost "about"s."""
    for name in ACCELERATIONS:
        assert DIRECT.limits(name).least == pytest.approx(1862.645, abs=1e-3)
        assert DIRECT.limits(name).highest == pytest.approx(31.25e9, rel=1e-6)
    for name in BOWS:
        assert DIRECT.limits(name).least == pytest.approx(454.747e3, abs=1)
        assert DIRECT.limits(name).highest == pytest.approx(7.63e12, rel=1e-3)
    for name in VELOCITIES:
        assert DIRECT.limits(name) == Units().limits(name)


@pytest.mark.sheet("DS-TMC4361", "8.2.3")
def test_direct_units_by_hand() -> None:
    assert DIRECT.to_raw("AMAX", 10e6) == 5369
    assert DIRECT.to_raw("BOW1", 100e6) == 220
    assert Units().to_raw("DFREEZE", 1e6) == 537, "DFREEZE is direct always"
    assert [round(Units(clock, True, True).least("AMAX"), 2) for clock in (8e6, 12e6, 30e6)] == [
        465.66,
        1047.74,
        6548.36,
    ]
    assert [round(Units(clock, True, True).least("BOW4") / 1e3, 2) for clock in (8e6, 12e6)] == [56.84, 191.85]


@pytest.mark.sheet("DS-TMC4361", "1.4")
@pytest.mark.sheet("DS-TMC4361", "8.2.3")
@pytest.mark.parametrize("clock_hz", [CLOCK_HZ_MIN, 8e6, 16e6])
def test_half_a_pulse_per_clock_is_the_end(clock_hz: float) -> None:
    units = Units(clock_hz)
    assert units.to_raw("VMAX", clock_hz / 2) == clock_hz / 2 * 256
    assert units.to_raw("VMAX", -clock_hz / 2) == -clock_hz / 2 * 256
    for name in VELOCITIES:
        with pytest.raises(
            ValueError, match=rf"{name} is .* {clock_hz / 2:.0f} pps \(half a pulse per clock, fCLK/2\)"
        ):
            units.to_raw(name, math.nextafter(clock_hz / 2, math.inf))


@given(st.sampled_from(WRITTEN), st.booleans(), st.booleans(), st.floats(CLOCK_HZ_MIN, CLOCK_HZ_MAX), st.data())
def test_every_register_number_survives_the_way_there_and_back(
    name: str, direct_acceleration: bool, direct_bow: bool, clock_hz: float, data: st.DataObject
) -> None:
    units = Units(clock_hz, direct_acceleration, direct_bow)
    form = FORMATS[name]
    raw = data.draw(st.integers(-form.raw_max if form.signed else 0, form.raw_max))
    value = units.from_raw(name, raw)
    if abs(value) <= units.limits(name).highest:
        assert units.to_raw(name, value) == raw


@given(st.sampled_from(WRITTEN), st.booleans(), st.booleans(), st.floats(0, 1), st.floats(CLOCK_HZ_MIN, CLOCK_HZ_MAX))
def test_a_value_is_held_to_half_a_step(
    name: str, direct_acceleration: bool, direct_bow: bool, share: float, clock_hz: float
) -> None:
    units = Units(clock_hz, direct_acceleration, direct_bow)
    limits = units.limits(name)
    value = share * limits.highest
    if 0 < value < limits.least / 2:
        with pytest.raises(ValueError, match=f"{name} is 0 or at least"):
            units.to_raw(name, value)
    else:
        assert abs(units.held(name, value) - value) <= limits.least / 2 * (1 + 1e-9) + abs(value) * 1e-15


@pytest.mark.parametrize("name", WRITTEN)
def test_errors_name_the_register_and_its_limit(name: str) -> None:
    for units in (Units(), DIRECT, Units(clock_hz=32e6)):
        limits = units.limits(name)
        for value in (limits.highest * 1.001, math.nan, math.inf, -math.inf):
            with pytest.raises(ValueError, match=rf"^{name} is .*\({limits.why}\)".replace("+", r"\+")):
                units.to_raw(name, value)
        if not FORMATS[name].signed:
            with pytest.raises(ValueError, match=f"{name} is 0 to"):
                units.to_raw(name, -1.0)


@pytest.mark.sheet("DS-TMC4361", "8.2.3")
@pytest.mark.parametrize("clock_hz", [0.0, 4e6, 32.1e6, math.nan])
def test_a_clock_outside_of_the_data_sheets_is_refused(clock_hz: float) -> None:
    with pytest.raises(ValueError, match="CLK_FREQ is 4194304 to 32000000 Hz"):
        Units(clock_hz)


@pytest.mark.parametrize("name", FORMATS)
def test_a_number_wider_than_the_register_is_refused(name: str) -> None:
    form = FORMATS[name]
    for raw in (form.raw_max + 1, -form.raw_max - 2 if form.signed else -1):
        with pytest.raises(ValueError, match=f"{name} is "):
            Units().from_raw(name, raw)


def test_an_open_question_direct_values_above_the_lowest_cap_are_taken_and_warned_of() -> None:
    """DS-TMC4361 has 24 bits, the list of fields 2^20, revision 3.10 65535 and 4095 (NOTES-TMC4361-RAMPS 5)."""
    for name, cap in ((ACCELERATIONS[0], DIRECT_ACCELERATION_CAP), (BOWS[0], DIRECT_BOW_CAP)):
        at, above = (DIRECT.from_raw(name, raw) for raw in (cap, cap + 1))
        assert not DIRECT.warnings(name, at)
        assert len(DIRECT.warnings(name, above)) == 1
        assert str(cap) in DIRECT.warnings(name, above)[0]
        assert DIRECT.to_raw(name, above) == cap + 1
        assert len(DIRECT.warnings(name, DIRECT.from_raw(name, (1 << 20) + 1))) == 2
        assert not Units().warnings(name, 4e6), "no cap without direct units"


@pytest.mark.sheet("DS-TMC4361", "8.2")
def test_an_open_question_positioning_above_a_quarter_of_the_clock_is_warned_of() -> None:
    """DS-TMC4361 advises fCLK/4 for hold positioning, revision 3 for all positioning; above it stays allowed here."""
    units = Units()
    assert not units.warnings("VMAX", 4e6, positioning=True)
    assert not units.warnings("VMAX", 5e6, positioning=False)
    (warning,) = units.warnings("VMAX", -4_000_001, positioning=True)
    assert "fCLK/4, 4000000 pps" in warning
    assert units.to_raw("VMAX", 4_000_001) == 4_000_001 * 256


@pytest.mark.sheet("DS-TMC4361", "8.1")
def test_long_step_pulses_leave_fewer_steps() -> None:
    units = Units()
    assert [units.step_rate_max(add) for add in (0, 1, 3)] == [8e6, 4e6, 2e6]
    assert units.step_rate_max(6) == pytest.approx(1.143e6, rel=1e-3)
    assert "2000000 pps: pulses of 4 clocks" in units.warnings("VMAX", 2_000_001, step_length_add=3)[0]
    assert not units.warnings("VMAX", 2_000_000, step_length_add=3)
    with pytest.raises(ValueError, match="STP_LENGTH_ADD is 0 to 65535"):
        units.warnings("VMAX", 1, step_length_add=65_536)


@pytest.mark.sheet("DS-TMC4361", "8.2.3")
def test_the_table_of_limits_has_every_register_that_can_be_written() -> None:
    assert [limits.register for limits in Units().table()] == [name for name in FORMATS if not name.endswith("ACTUAL")]
