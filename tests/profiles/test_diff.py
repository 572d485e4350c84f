"""What differs: both numbers as the chip has them and in people's units, by each side's own dividers and mechanics."""

from __future__ import annotations

from typing import Any

import pytest

from app.profiles.diff import compare, diff
from app.profiles.document import ProfileDocument, parse
from app.profiles.errors import ProfileMisfit
from app.registers.tmcl.modules import MODULES
from tests.profiles.harness import bench


def profile(model: str, registers: list[dict[str, Any]] | None = None, **more: Any) -> ProfileDocument:
    data = {"format": "stepscope-profile", "version": 1, "model": model, "clock_hz": 16_000_000}
    key = "parameters" if model in MODULES else "registers"
    return parse({**data, key: registers or [], **more})


DIVIDERS = {"name": "pulse_div_ramp_div_usrs", "axis": 0}


@pytest.mark.parametrize(
    ("model", "left", "right", "shown"),
    [
        # The same V_MAX behind another divider is another speed: DS-TMC428 8.14.
        (
            "tmc428",
            [{"name": "v_max", "axis": 0, "value": 1000}, {**DIVIDERS, "fields": {"pulse_div": 3, "ramp_div": 4}}],
            [{"name": "v_max", "axis": 0, "value": 1001}, {**DIVIDERS, "fields": {"pulse_div": 4, "ramp_div": 4}}],
            ("30517.6 pps", "15274 pps"),
        ),
        (
            "tmc5160",
            [{"name": "VMAX", "axis": 0, "value": 100_000}],
            [{"name": "VMAX", "axis": 0, "value": 200_000}],
            ("95367.4 pps", "190735 pps"),
        ),
        (
            "tmc4361",
            [{"name": "AMAX", "axis": 0, "value": 4000}, {"name": "GENERAL_CONF", "axis": 0, "value": 0}],
            [{"name": "AMAX", "axis": 0, "value": 4001}, {"name": "GENERAL_CONF", "axis": 0, "value": 2}],
            ("1000 pps^2", "7452443 pps^2"),
        ),
        (
            "pd42-1241",
            [{"name": "maximum_positioning_speed", "value": 1000}, {"name": "unit_mode", "value": 0}],
            [{"name": "maximum_positioning_speed", "value": 1001}, {"name": "unit_mode", "value": 1}],
            ("953.674 pps", "1001 pps"),
        ),
    ],
)
def test_each_side_counts_by_its_own_settings(
    model: str, left: list[dict[str, Any]], right: list[dict[str, Any]], shown: tuple[str, str]
) -> None:
    found = compare(profile(model, left), profile(model, right))
    difference = next(each for each in found.differences if each.name == left[0]["name"])
    assert (difference.left, difference.right) == (left[0]["value"], right[0]["value"])
    assert (difference.left_physical, difference.right_physical) == shown


def test_positions_are_told_as_travel_or_as_an_angle() -> None:
    axis = {"name": "x", "full_steps_per_rev": 200, "gear_ratio": 2.0}
    registers = [{"name": "CHOPCONF", "axis": 0, "fields": {"mres": 4}}]
    one = profile("tmc5160", [*registers, {"name": "X_COMPARE", "axis": 0, "value": 0}], axes=[axis])
    two = [*registers, {"name": "X_COMPARE", "axis": 0, "value": 3200}]
    (difference,) = compare(one, profile("tmc5160", two, axes=[axis])).differences
    assert difference.right_physical == "180 deg"
    travel = axis | {"travel_mm_per_rev": 5.0}
    found = compare(one, profile("tmc5160", two, axes=[travel]))
    assert [each.right_physical for each in found.differences if each.name == "X_COMPARE"] == ["2.5 mm"]
    assert [(each.kind, each.name) for each in found.differences if each.kind == "mechanics"] == [
        ("mechanics", "travel_mm_per_rev")
    ]


def test_fields_are_told_by_name_and_meaning() -> None:
    entry = {"name": "lp_ref_conf_rm", "axis": 1}
    left = profile("tmc428", [{**entry, "fields": {"rm": 0, "SOFT_STOP": 1}}])
    right = profile("tmc428", [{**entry, "fields": {"rm": 1, "SOFT_STOP": 1}}])
    (difference,) = compare(left, right).differences
    (part,) = difference.fields
    assert (part.name, part.left, part.right, part.right_meaning) == ("rm", 0, 1, "SOFT_MODE")


def test_what_only_one_side_speaks_of_is_told() -> None:
    entry = {"name": "v_min", "axis": 0, "value": 3}
    (gone,) = compare(profile("tmc428", [entry]), profile("tmc428")).differences
    assert (gone.left, gone.right, gone.written) == (3, None, False)
    (new,) = compare(profile("tmc428"), profile("tmc428", [entry])).differences
    assert (new.left, new.right) == (None, 3)


def test_profiles_of_two_models_are_not_compared() -> None:
    with pytest.raises(ProfileMisfit, match="TMC428"):
        compare(profile("tmc428"), profile("tmc4210"))


async def test_a_table_is_summed_up_and_its_words_are_there() -> None:
    async with bench("tmc428") as b:
        found = await diff(b.device, profile("tmc428", tables={"microstep": [0] * 64}))
        (table,) = found.tables
        assert (table.name, table.of, table.differing) == ("microstep", 32, len(found.differences))
        assert {each.kind for each in found.differences} == {"table"}
