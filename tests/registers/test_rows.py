"""What must hold for every register row of every chip."""

from __future__ import annotations

import re
from itertools import product

import pytest
from hypothesis import given
from hypothesis import strategies as st

from app.registers.catalog import MODELS
from app.registers.model import Access, Field, Register, RegisterTable, Space

SOURCE = re.compile(
    r"(DS-TMC(4210|428|429|4361)|FM-PD42-1241|FM-TMCM-1161) |(TMC4361A|STEPPYR|TOM4361|PyTrinamic TMCM1161)\b"
    r"|DS-TMC(5031|5062|5072|5130|5160|2209|2660) (p\. )?[0-9]|FIELDS-TMC5240; |API; PY\b"
)
"""Begins with a data sheet and its section; what DS-TMC4361 does not tell, with one of the later public sources."""

# A test a table: one a row costs pytest more than what it asserts. A failure shows the row among the arguments.
every_table = pytest.mark.parametrize("table", [pytest.param(model.table, id=model.title) for model in MODELS.values()])


@every_table
def test_every_row_is_complete_and_consistent(table: RegisterTable) -> None:
    for register in table:
        check_row(table, register)


def check_row(table: RegisterTable, register: Register) -> None:
    if register.space is Space.REGISTER:
        assert 0 <= register.address <= 0x7F
        model = next(model for model in MODELS.values() if model.table is table)
        bits = model.datagram_bits
        data_bits = model.spi.word_bits if model.spi is not None else bits - 8 if bits else 32  # of a UART
        assert 1 <= register.width <= data_bits, "wider than the data of a datagram"
    else:
        assert 0 <= register.address <= 0xFF, "the type byte of TMCL"
        assert register.width == 32
        assert table.find(register.alias.upper(), register.axis) == (register, None)
    assert register.help
    assert not register.help.endswith(".")
    assert SOURCE.match(register.source), register.source
    assert register.mask < 1 << register.width
    assert register.write_mask & ~register.mask == 0
    assert register.minimum <= register.maximum
    if register.when:
        assert table.at(register.address, register.space, register.access is Access.W) is not register
        assert register in table.meanings(register.address, register.space)
    else:
        assert table.at(register.address, register.space, register.access is Access.W) is register
    assert table.find(register.name.upper(), register.axis) == (register, None)
    if register.reset is not None:
        assert register.reset & ~register.mask == 0, "the reset sets a bit that means nothing"
        for part in register.fields:
            assert part.reset is None or part.unpack(register.reset) == part.reset
    if register.access is Access.RW_IF:
        assert register.write_note, "a conditional write must say its condition"
    for part in register.fields:
        assert part.help
        assert not part.help.endswith(".")


@every_table
def test_a_field_survives_packing_over_any_word(table: RegisterTable) -> None:
    for register in table:
        for part, word in product(register.fields, (0, register.mask, register.reset or 0x5A5A5A)):
            for value in {part.minimum, part.maximum, *part.values}:
                if part.minimum <= value <= part.maximum:
                    packed = part.pack(value, over=word)
                    assert part.unpack(packed) == value, (register.name, part.name)
                    assert packed & ~part.mask == word & ~part.mask, f"{register.name}: another field changed"


@every_table
def test_values_outside_the_range_are_refused_by_name(table: RegisterTable) -> None:
    for register in table:
        for part in (register, *register.fields):
            for value in (part.minimum - 1, part.maximum + 1):
                with pytest.raises(ValueError, match=re.escape(part.name)):
                    part.encode(value)


@given(
    st.sampled_from([register for model in MODELS.values() for register in model.table]), st.integers(0, 0xFFFF_FFFF)
)
def test_decode_and_encode_are_inverse(register: Register, raw: int) -> None:
    value = register.decode(raw)
    if register.minimum <= value <= register.maximum:
        assert register.encode(value) == raw & ((1 << register.width) - 1)


def test_fields_answer_to_their_own_names_on_their_axis() -> None:
    table = MODELS["tmc428"].table
    register, part = table.find("PMUL", axis=2) or (None, None)
    assert register is table.get("pmul_pdiv", 2)
    assert part is not None
    assert part.name == "pmul"
    assert table.find("clk2_div", axis=1) == table.find("CLK2_DIV")
    assert table.find("y_even") is None, "32 words have one: only the word's own name tells which"
    assert table.find("x_target") is None, "which axis?"


@pytest.mark.sheet("DS-TMC428", "7")
@pytest.mark.sheet("DS-TMC428", "10")
def test_address_partitions_of_the_tmc428() -> None:
    table = MODELS["tmc428"].table
    for register in table:
        if register.axis is not None:
            assert register.address >> 4 == register.axis
        elif register.group == "driver chain RAM":
            assert register.address >> 5 == 0b10
        elif register.group == "microstep table RAM":
            assert register.address >> 5 == 0b11
        else:
            assert register.address >> 4 == 0b11
    assert sum(register.group == "driver chain RAM" for register in table) == 32
    assert sum(register.group == "microstep table RAM" for register in table) == 32


@pytest.mark.sheet("DS-TMC428", "6.1")
@pytest.mark.sheet("DS-TMC428", "7.2")
def test_only_clk2_div_resets_to_something() -> None:
    """Besides the mantissa's leading one, which no write can change (8.10)."""
    table = MODELS["tmc428"].table
    assert {register.name for register in table if register.reset} == {
        "pmul_pdiv",
        "stepper_motor_global_parameter_register",
    }
    assert table.get("stepper_motor_global_parameter_register").unpack(0xF00)["clk2_div"] == 15


@pytest.mark.sheet("DS-TMC4210", "5.3")
def test_only_the_pulse_length_and_the_type_reset_to_something_on_the_tmc4210() -> None:
    table = MODELS["tmc4210"].table
    assert {register.name for register in table if register.reset} == {
        "PMUL_PDIV",
        "TYPE_VERSION_4210",
        "STEPPER_MOTOR_GLOBAL_PARAMETER_REGISTER",
    }
    assert table.get("TYPE_VERSION_4210").reset == 0x429101


@pytest.mark.sheet("DS-TMC428", "2.6")
def test_signed_registers_are_those_that_have_a_direction() -> None:
    signed = {register.name for register in MODELS["tmc428"].table if register.signed}
    assert signed == {"x_target", "x_actual", "v_target", "v_actual", "a_actual", "x_latched"}


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: Register("r", 8, "h", source="s", fields=(Field("a", 4, "h"), Field("b", 4, "h", lsb=3))), "overlaps"),
        (lambda: Register("r", 8, "h", source="s", fields=(Field("a", 4, "h", lsb=6),)), "leaves"),
        (lambda: Register("r", 8, "h", source="s", reset=256), "reset"),
        (lambda: Register("r", 8, "h"), "source"),
        (lambda: Field("f", 2, "h", range=(0, 4)), "range"),
        (lambda: Field("f", 2, "h", values={4: "four"}), "enumerated"),
    ],
)
def test_a_row_refuses_what_it_can_get_wrong_alone(make: object, message: str) -> None:
    assert callable(make)
    with pytest.raises(ValueError, match=message):
        make()


def test_a_table_refuses_two_rows_on_one_address_or_of_one_name() -> None:
    one = Register("one", 8, "h", address=1, source="s")
    with pytest.raises(ValueError, match="address"):
        RegisterTable("chip", (one, Register("two", 8, "h", address=1, source="s")))
    with pytest.raises(ValueError, match="called"):
        RegisterTable("chip", (one, Register("ONE", 8, "h", address=2, source="s")))


@pytest.mark.sheet("FM-PD42-1241", "4")
@pytest.mark.sheet("FM-PD42-1241", "5.1")
@pytest.mark.sheet("FM-PD42-1241", "5.2")
@pytest.mark.sheet("FM-PD42-1241", "5.3")
def test_the_parameters_of_the_pd42() -> None:
    """Numbers as PyTrinamic's TMCM1241.py lists them; bank 1 belongs to customers' own firmware."""
    table = MODELS["pd42-1241"].table
    numbers = {space: {row.address for row in table if row.space is space} for space in Space}
    axis = {*range(30), 31, 32, 33, 127, 140, *range(160, 175), 178, *range(180, 183), *range(184, 198), 202, 204}
    assert numbers[Space.AXIS] == axis | {206, 207, 208, 209, 210, 212, 214, 215, 216, 217, 218, 251, 254, 255}
    interface = {65, 66, 68, 69, 70, 71, 75, 76, 77, 81, 82, 83, 84, 85, 87}
    assert numbers[Space.GLOBAL_0] == interface | {128, 129, 130, 131, 132, 133, 255}
    assert all((row.stored == "auto") == (row.address < 128) for row in table if row.space is Space.GLOBAL_0)
    assert numbers[Space.GLOBAL_2] == set(range(256))
    assert [row.address for row in table if row.stored == "on request" and row.space is Space.GLOBAL_2] == [*range(56)]
    assert numbers[Space.GLOBAL_3] == {0, 1, 2, 27, 28, 39, 40, 41, 42}
    assert [row.name for row in table if row.read_clears] == ["extended_error_flags"]


@pytest.mark.sheet("FM-PD42-1241", "6.1")
@pytest.mark.sheet("FM-PD42-1241", "7.4")
def test_defaults_that_the_manual_tells() -> None:
    table = MODELS["pd42-1241"].table
    assert table.get("microstep_resolution", 0).reset == 8
    assert table.get("microstep_resolution", 0).values[8] == "256"
    assert table.get("unit_mode", 0).values[table.get("unit_mode", 0).reset or 0] == "pps"
