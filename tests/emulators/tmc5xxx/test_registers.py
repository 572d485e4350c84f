"""The register files: addresses, widths, resets, what can be read back. The tables are the drivers' and ours alike."""

from __future__ import annotations

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from app.emulators.tmc5xxx import MODELS, Tmc5xxxModel
from app.registers.model import Access, Register
from app.registers.tmc5xxx.table import TABLES
from tests.emulators.tmc5xxx.rig import DUAL, Bench

EVERY_ROW = [(model, row) for model in MODELS for row in TABLES[model] if not row.when]


@pytest.mark.parametrize("model", MODELS)
def test_after_power_on_each_register_reads_as_its_row_says(model: Tmc5xxxModel) -> None:
    bench = Bench(model)
    for row in TABLES[model]:
        word = bench.chip.read(row.address)
        if row.access is Access.RW and not row.when:
            assert word == (row.reset or 0), row.name
        if row.access is Access.W and TABLES[model].at(row.address) is row:
            assert word == 0, f"{row.name} can only be written: it reads as 0"


@pytest.mark.parametrize("model", MODELS)
def test_a_write_to_what_can_only_be_read_changes_nothing(model: Tmc5xxxModel) -> None:
    for row in TABLES[model]:
        if row.access is Access.R and TABLES[model].at(row.address, write=True) is row:
            bench = Bench(model)
            before = bench.chip.read(row.address)
            again = bench.chip.read(row.address)  # flags that a read clears are gone
            bench.chip.write(row.address, 0xFFFFFFFF)
            assert bench.chip.read(row.address) in (before, again), row.name


@pytest.mark.parametrize("model", MODELS)
def test_what_can_only_be_written_still_reads_as_zero_after_that(model: Tmc5xxxModel) -> None:
    bench = Bench(model)
    for row in TABLES[model]:
        if row.access is Access.W and TABLES[model].at(row.address) is row:
            bench.chip.write(row.address, 0xFFFFFFFF)
            assert bench.chip.read(row.address) == 0, row.name


@settings(max_examples=60, deadline=None)
@given(word=st.integers(0, 0xFFFFFFFF), entry=st.sampled_from([e for e in EVERY_ROW if e[1].access is Access.RW]))
def test_what_is_written_is_read_back_without_the_bits_that_there_are_not(
    word: int, entry: tuple[Tmc5xxxModel, Register]
) -> None:
    model, row = entry
    bench = Bench(model)
    bench.chip.write(row.address, word)
    assert bench.chip.read(row.address) == word & row.write_mask


@pytest.mark.parametrize("model", MODELS)
def test_addresses_that_no_row_has_read_as_zero_and_take_nothing(model: Tmc5xxxModel) -> None:
    bench = Bench(model)
    free = [address for address in range(128) if not TABLES[model].meanings(address)]
    assert free
    for address in free:
        bench.chip.write(address, 0xFFFFFFFF)
        assert bench.chip.read(address) == 0


@pytest.mark.parametrize("model", DUAL)
def test_the_two_axes_do_not_share_registers(model: Tmc5xxxModel) -> None:
    bench = Bench(model)
    for name in ("XACTUAL", "SW_MODE", "CHOPCONF"):
        bench.write(name, 5, axis=1)
        assert bench.read(name, 1) == 5
        assert bench.read(name, 0) == 0


@pytest.mark.parametrize(
    ("model", "version"),
    [("tmc5031", 0x01), ("tmc5062", 0x01), ("tmc5072", 0x10), ("tmc5130", 0x11), ("tmc5160", 0x30), ("tmc5240", 0x40)],
)
def test_the_version(model: Tmc5xxxModel, version: int) -> None:
    """The notes of IOIN and INPUT in the register facts."""
    assert Bench(model).chip.read(0x04) >> 24 == version


@pytest.mark.parametrize("model", DUAL)
def test_a_locked_gconf_is_locked_until_the_power_is_cut(model: Tmc5xxxModel) -> None:
    """GCONF.lock_gconf of the dual chips."""
    bench = Bench(model)
    bench.write("GCONF", 1 << 10 | 1 << 8)
    bench.write("GCONF", 0)
    assert bench.read("GCONF") == 1 << 10 | 1 << 8
    bench.patch(power_cycle=True)
    bench.write("GCONF", 1 << 9)
    assert bench.read("GCONF") == 1 << 9


@pytest.mark.parametrize("model", MODELS)
def test_levels_at_the_pins_can_be_read(model: Tmc5xxxModel) -> None:
    bench = Bench(model)
    row = next(row for row in bench.table.meanings(0x04) if row.access is Access.R)
    enable = next(part.name for part in row.fields if part.name.lower().startswith("drv_enn"))
    assert row.unpack(bench.chip.read(0x04))[enable] == 0
    bench.patch(pins={"drv_enn": True})
    assert row.unpack(bench.chip.read(0x04))[enable] == 1


@pytest.mark.parametrize("model", ["tmc5130", "tmc5160", "tmc5240"])
def test_switches_are_seen_at_ioin(model: Tmc5xxxModel) -> None:
    bench = Bench(model)
    bench.stage(switches={"left": True})
    assert (bench.field("IOIN", "REFL_STEP"), bench.field("IOIN", "REFR_DIR")) == (1, 0)


@pytest.mark.parametrize("model", ["tmc5062", "tmc5072"])
def test_an_io_pin_that_is_an_output_shows_its_own_level(model: Tmc5xxxModel) -> None:
    bench = Bench(model)
    bench.chip.write(0x04, 0b101 | 0b001 << 8)
    assert bench.chip.read(0x04) & 0xF == 0b001


def test_a_tmc5072_has_one_microstep_table_for_both_motors() -> None:
    bench = Bench("tmc5072")
    before = [bench.raw("MSCURACT", axis) for axis in (0, 1)]
    bench.write("MSLUTSTART", 0x00F70010)
    after = [bench.raw("MSCURACT", axis) for axis in (0, 1)]
    assert after[0] == after[1] != before[0] == before[1]


@pytest.mark.parametrize("model", ["tmc5031", "tmc5062"])
def test_a_tmc5031_and_a_tmc5062_have_one_for_each(model: Tmc5xxxModel) -> None:
    bench = Bench(model)
    before = [bench.raw("MSCURACT", axis) for axis in (0, 1)]
    bench.write("MSLUTSTART", 0x00F70010, axis=1)
    assert bench.raw("MSCURACT", 0) == before[0]
    assert bench.raw("MSCURACT", 1) != before[1]
