"""What must hold for every register row of every chip."""

from __future__ import annotations

from itertools import product

import pytest
from hypothesis import given
from hypothesis import strategies as st

from app.registers.catalog import MODELS
from app.registers.model import Access, Field, Register, RegisterTable

EVERY_REGISTER = [
    pytest.param(model.table, register, id=f"{model.title}.{register.name}.{register.axis}")
    for model in MODELS.values()
    for register in model.table
]


@pytest.mark.parametrize(("table", "register"), EVERY_REGISTER)
def test_every_row_is_complete_and_consistent(table: RegisterTable, register: Register) -> None:
    assert 0 <= register.address <= 0x7F
    assert 1 <= register.width <= 24, "a datagram carries 24 data bits"
    assert register.help
    assert not register.help.endswith(".")
    assert register.source.split(",")[0] in {"000", "001"}
    assert register.mask < 1 << register.width
    assert register.write_mask & ~register.mask == 0
    assert register.minimum <= register.maximum
    assert table.at(register.address) is register
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


@pytest.mark.parametrize(("table", "register"), EVERY_REGISTER)
def test_a_field_survives_packing_over_any_word(table: RegisterTable, register: Register) -> None:
    for part, word in product(register.fields, (0, register.mask, register.reset or 0x5A5A5A)):
        for value in {part.minimum, part.maximum, *part.values}:
            if part.minimum <= value <= part.maximum:
                packed = part.pack(value, over=word)
                assert part.unpack(packed) == value
                assert packed & ~part.mask == word & ~part.mask, "another field changed"


@pytest.mark.parametrize(("table", "register"), EVERY_REGISTER)
def test_values_outside_the_range_are_refused_by_name(table: RegisterTable, register: Register) -> None:
    for part in (register, *register.fields):
        for value in (part.minimum - 1, part.maximum + 1):
            with pytest.raises(ValueError, match=part.name):
                part.encode(value)


@given(st.sampled_from([register for model in MODELS.values() for register in model.table]), st.integers(0, 0xFF_FFFF))
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


@pytest.mark.sheet("001", "7")
@pytest.mark.sheet("001", "10")
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


@pytest.mark.sheet("001", "6.1")
@pytest.mark.sheet("001", "7.2")
def test_only_clk2_div_resets_to_something() -> None:
    """Besides the mantissa's leading one, which no write can change (8.10)."""
    table = MODELS["tmc428"].table
    assert {register.name for register in table if register.reset} == {
        "pmul_pdiv",
        "stepper_motor_global_parameter_register",
    }
    assert table.get("stepper_motor_global_parameter_register").unpack(0xF00)["clk2_div"] == 15


@pytest.mark.sheet("000", "5.3")
def test_only_the_pulse_length_and_the_type_reset_to_something_on_the_tmc4210() -> None:
    table = MODELS["tmc4210"].table
    assert {register.name for register in table if register.reset} == {
        "PMUL_PDIV",
        "TYPE_VERSION_4210",
        "STEPPER_MOTOR_GLOBAL_PARAMETER_REGISTER",
    }
    assert table.get("TYPE_VERSION_4210").reset == 0x429101


@pytest.mark.sheet("001", "2.6")
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
