"""SixPoint ramps as registers: nearest numbers, limits, and what the data sheets warn of."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from app.calc.ramps.sixpoint import SixPoint
from app.calc.ramps.sixpoint_registers import REGISTERS, findings, from_raw, held, registers_of, to_raw, unit_of
from app.calc.units.tmc5xxx import VELOCITY_MAX, velocity_pps, velocity_unit_pps
from app.calc.units.tmc5xxx_registers import MODELS, formats
from app.registers.tmc5xxx.table import TABLES

GOOD = {
    "VSTART": 0,
    "A1": 2000,
    "V1": 100_000,
    "AMAX": 1000,
    "VMAX": 200_000,
    "DMAX": 1000,
    "D1": 2000,
    "VSTOP": 10,
    "TZEROWAIT": 0,
}
clocks = st.floats(4e6, 18e6)


@given(name=st.sampled_from(list(REGISTERS)), part=st.floats(0, 1), clock_hz=clocks)
def test_numbers_there_and_back(name: str, part: float, clock_hz: float) -> None:
    raw = round(part * REGISTERS[name].most)
    assert to_raw(name, from_raw(name, raw, clock_hz), clock_hz) == raw


@given(name=st.sampled_from(list(REGISTERS)), part=st.floats(0, 1), clock_hz=clocks)
def test_the_nearest_number_is_no_more_than_half_a_unit_away(name: str, part: float, clock_hz: float) -> None:
    unit = unit_of(name, clock_hz)
    value = part * REGISTERS[name].most * unit
    raw = to_raw(name, value, clock_hz)
    assert abs(raw * unit - value) <= unit / 2 * (1 + 1e-6) or (raw == 1 and value < unit)


@pytest.mark.parametrize("name", list(REGISTERS))
def test_what_a_register_cannot_hold(name: str) -> None:
    most = REGISTERS[name].most
    with pytest.raises(ValueError, match=f"{REGISTERS[name].parameter} is up to"):
        to_raw(name, (most + 1) * unit_of(name))
    with pytest.raises(ValueError, match=f"{name} is 0 to {most}"):
        from_raw(name, most + 1)
    with pytest.raises(ValueError, match="is up to"):
        to_raw(name, float("nan"))


@pytest.mark.parametrize("model", list(TABLES))
def test_the_calculators_hold_what_the_register_tables_hold(model: str) -> None:
    """Both know the widths: neither may import the other."""
    assert model in MODELS
    known = formats(model)
    for name, form in known.items():
        row, part = TABLES[model].find(name, 0) or (None, None)
        assert row is not None, name
        word = part or row
        if form.kind != "pps" or form.rising is None:
            top = form.to_raw(form.highest)
            assert top <= word.maximum
            assert word.maximum - top < 512, "nothing is given away but what the sheets do not allow"
            assert form.from_raw(top) == pytest.approx(form.highest)
        else:
            assert form.to_raw(0.0) == word.maximum
    held_by_chip = {row.name for row in TABLES[model] if row.unit.endswith(("pps", "pps^2", "tCLK"))}
    assert held_by_chip - {"VACTUAL", "AACTUAL", "TSTEP"} == set(known) - {"IHOLDDELAY"}


@given(
    v_max=st.floats(0.1, 1e7),
    a_max=st.floats(0.1, 7e6),
    v1=st.floats(0, 9e5),
    v_stop=st.floats(0, 2e5),
    wait_s=st.floats(0, 2),
)
def test_a_ramp_as_the_chip_holds_it(v_max: float, a_max: float, v1: float, v_stop: float, wait_s: float) -> None:
    wanted = SixPoint(
        v_max=v_max, a_max=a_max, d_max=a_max, v1=v1, a1=a_max, d1=a_max, v_stop=v_stop, t_zero_wait_s=wait_s
    )
    made = held(wanted)
    assert held(made) == made
    for name in ("v_max", "v1", "v_stop"):
        units = getattr(made, name) / velocity_unit_pps()
        assert units == round(units)
    assert made.a_max > 0  # else the motor would never move
    assert made.v_max <= velocity_pps(VELOCITY_MAX)
    assert made.t_zero_wait_s == pytest.approx(wait_s, abs=17e-6)
    if v_max < 7e6:
        assert made.v_max == pytest.approx(max(v_max, velocity_unit_pps()), abs=0.5)


def test_a_ramp_that_the_chip_cannot_hold() -> None:
    with pytest.raises(ValueError, match="v_stop is up to 249999 pps"):
        held(SixPoint(v_max=1e6, a_max=1e6, v_stop=3e5))
    with pytest.raises(ValueError, match="v1 is up to"):
        held(SixPoint(v_max=2e6, a_max=1e6, v1=1.1e6))
    with pytest.raises(ValueError, match="t_zero_wait_s is up to"):
        registers_of(SixPoint(v_max=2e6, a_max=1e6, t_zero_wait_s=3))


def test_a_common_ramp_in_registers() -> None:
    """The sheets' worked numbers: 51200 pps are 53687, and AMAX 1000 is 116415 pps^2, both at 16 MHz."""
    raw = registers_of(SixPoint(v_max=51_200, a_max=116_415.32, d_max=116_415.32))
    assert (raw["VMAX"], raw["AMAX"], raw["DMAX"], raw["TZEROWAIT"]) == (53_687, 1000, 1000, 0)
    assert not findings(GOOD)


@pytest.mark.parametrize(
    ("changes", "code"),
    [
        ({"VSTOP": 0}, "vstop_zero"),
        ({"VSTOP": 9}, "vstop_low"),
        ({"VSTART": 11}, "vstart_above_vstop"),
        ({"VSTART": 250_000, "VSTOP": 250_000, "VMAX": 249_999, "TZEROWAIT": 1}, "vstart_above_vmax"),
        ({"D1": 0}, "d1_zero"),
        ({"DMAX": 0}, "dmax_zero"),
        ({"A1": 0}, "a1_zero"),
        ({"V1": 0}, "v1_zero"),
        ({"V1": 200_000}, "v1_above_vmax"),
        ({"VMAX": VELOCITY_MAX}, "vmax_limit"),
        ({"VMAX": VELOCITY_MAX + 1}, "vmax_beyond"),
        ({"VSTOP": 1001}, "no_zero_wait"),
    ],
)
def test_what_the_sheets_warn_of(changes: dict[str, int], code: str) -> None:
    """DS-TMC5160 6.3.1: VSTOP, VSTART, D1, V1, VMAX, TZEROWAIT."""
    found = findings(GOOD | changes)
    assert [finding.code for finding in found] == [code]
    assert found[0].register in found[0].text or code == "no_zero_wait"


def test_a_trapezoid_is_not_warned_of() -> None:
    """V1 = 0 with A1 and D1 that say the same as AMAX and DMAX."""
    assert not findings(GOOD | {"V1": 0, "A1": 1000, "D1": 1000})
    assert not findings(GOOD | {"V1": 0, "A1": 0, "D1": 1000})


def test_velocity_modes_need_neither_stop_nor_deceleration() -> None:
    """DS-TMC5160, AMAX: acceleration and deceleration of velocity mode."""
    assert not findings(GOOD | {"VSTOP": 0, "D1": 0, "DMAX": 0, "V1": 0}, positioning=False)
