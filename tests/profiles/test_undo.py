"""Undo from the audit log, over every family's emulator: the device as before, or told what cannot be."""

from __future__ import annotations

import pytest

from app.profiles.undo import Before
from app.registers.catalog import MODELS
from tests.profiles.harness import FAMILIES
from tests.profiles.sequences import ANN, DOINGS, undo_of, undoing

ONE_OF_EACH = (*FAMILIES, *(name for name in ("tmc2209", "tmc2660") if name in MODELS))


@pytest.mark.parametrize("model", ONE_OF_EACH)
@pytest.mark.parametrize("seed", [11, 12])
async def test_a_random_sequence_is_undone_or_told(model: str, seed: int) -> None:
    report = await undo_of(model, seed)
    assert not report.wrong, f"{report.doings}: {report.wrong[:5]}"
    assert len(report.doings) == 6
    assert set(report.doings) <= DOINGS.keys()


async def test_a_ramp_shape_is_put_back_though_the_driver_remembers_one_of_its_own() -> None:
    async with undoing("tmc4361") as u:
        before = (await u.device.registers.read("RAMPMODE", 0)).value
        first = await u.next_entry()
        with u.by(ANN):
            await u.device.registers.write("RAMPMODE", 0, None, {"RAMP_PROFILE": 1})
        preview = await u.put_all_back(Before(first))
        assert [(each.name, each.state) for each in preview.registers] == [("RAMPMODE", "ready")]
        assert (await u.device.registers.read("RAMPMODE", 0)).value == before


async def test_a_position_that_reads_back_as_another_is_put_back_as_it_was_set() -> None:
    """DS-TMC428 9.2: cover_pos reads as one more than was written."""
    async with undoing("tmc428") as u:
        await u.device.registers.write("cover_pos_cover_len", None, None, {"cover_pos": 5, "cover_len": 3})
        before = u.bench.truth()
        first = await u.next_entry()
        with u.by(ANN):
            await u.device.registers.write("cover_pos_cover_len", None, None, {"cover_pos": 9, "cover_len": 4})
        preview = await u.put_all_back(Before(first))
        assert [(each.name, each.state) for each in preview.registers] == [("cover_pos_cover_len", "ready")]
        assert u.bench.truth() == before


async def test_speeds_of_a_module_in_units_of_another_mode_are_told_not_guessed() -> None:
    async with undoing("pd42-1241") as u:
        first = await u.next_entry()
        with u.by(ANN):
            mode = (await u.device.registers.read("unit_mode", 0)).value
            await u.device.registers.write("unit_mode", 0, 1 - mode)
            await u.device.registers.write("maximum_positioning_speed", 0, 1000)
        preview = await u.put_all_back(Before(first))
        told = {each.name: (each.state, each.why) for each in preview.registers}
        assert told["unit_mode"][0] == "ready"
        assert told["maximum_positioning_speed"][0] == "cannot"
        assert "units" in told["maximum_positioning_speed"][1]
        assert (await u.device.registers.read("unit_mode", 0)).value == mode
