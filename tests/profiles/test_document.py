"""The document: what goes in comes out again, and what is wrong with one is told with its place."""

from __future__ import annotations

import json
from typing import Any

import pytest

from app.profiles.capture import capture
from app.profiles.document import ProfileDocument, parse, plain, text_of
from app.profiles.errors import UnreadableProfile
from app.profiles.items import items_of
from app.profiles.register_bits import bits_of
from app.profiles.steps import steps_of
from app.registers.model import Access
from tests.profiles.harness import EVERY_MODEL, bench


@pytest.mark.parametrize("model", EVERY_MODEL)
async def test_a_captured_profile_speaks_of_every_register_and_survives_a_file(model: str) -> None:
    async with bench(model) as b:
        document = await capture(b.device, "one", unix_s=1.0)
        assert document.unknown == []
        assert list(bits_of(document)) == [item.key for item in items_of(model)]
        assert parse(json.loads(text_of(document))) == document
        assert {key: want.word for key, want in bits_of(document).items()} == {
            key: want.word for key, want in bits_of(parse(plain(document))).items()
        }


@pytest.mark.parametrize("model", EVERY_MODEL)
async def test_a_file_has_one_register_a_line_in_the_order_of_the_data_sheet(model: str) -> None:
    async with bench(model) as b:
        text = text_of(await capture(b.device, unix_s=1.0))
    entries = [json.loads(line.strip().rstrip(",")) for line in text.splitlines() if line.startswith('    {"name"')]
    assert len(entries) == len(b.device.axes) + sum(item.table is None for item in items_of(model))


def test_where_the_motor_is_and_what_cannot_be_undone_is_no_configuration() -> None:
    names = {(model, item.row.name) for model in EVERY_MODEL for item in items_of(model)}
    for model, name in (
        ("tmc428", "x_target"),
        ("tmc428", "cover_datagram"),
        ("tmc4361", "XACTUAL"),
        ("tmc4361", "RESET_CLK_GATING"),
        ("tmc5160", "OTP_PROG"),
        ("tmc5160", "RAMPMODE"),
        ("tmc5160", "NODECONF"),
        ("pd42-1241", "actual_position"),
        ("pd42-1241", "serial_address"),
        ("pd42-1241", "tmcl_code_protection"),
        ("pd42-1241", "out0"),
    ):
        assert (model, name) not in names
    assert not any(item.row.access in (Access.R, Access.R_W1C) for model in EVERY_MODEL for item in items_of(model))


def test_currents_come_before_the_chopper_and_the_unit_before_what_counts_in_it() -> None:
    order = {item.place: index for index, item in enumerate(items_of("tmc5160"))}
    assert order["GLOBAL_SCALER of axis 0"] < order["IHOLD_IRUN of axis 0"] < order["CHOPCONF of axis 0"]
    order = {item.place: index for index, item in enumerate(items_of("pd42-1241"))}
    assert order["unit_mode of axis 0"] < order["maximum_acceleration of axis 0"]
    order = {item.place: index for index, item in enumerate(items_of("tmc428"))}
    assert order["chain_conf_00"] < order["stepper_motor_global_parameter_register"] < order["v_max of axis 0"]


DOCUMENT: dict[str, Any] = {"format": "stepscope-profile", "version": 1, "model": "tmc428", "clock_hz": 16e6}
MODULE = DOCUMENT | {"model": "pd42-1241"}


@pytest.mark.parametrize(
    ("data", "place", "words"),
    [
        ([], "", "JSON object"),
        ({"version": 1}, "format", "missing"),
        (DOCUMENT | {"version": 2}, "", "newer stepscope: version 2"),
        (DOCUMENT | {"version": "1"}, "version", "Input should be 1"),
        (DOCUMENT | {"format": "gcode"}, "", '"gcode"'),
        (DOCUMENT | {"model": "tmc9000"}, "model", "tmc428"),
        (DOCUMENT | {"colour": "red"}, "colour", "not permitted"),
        (DOCUMENT | {"registers": [{"name": "v_max", "axis": 0, "valu": 1}]}, "registers[0].valu", "not permitted"),
        (DOCUMENT | {"registers": [{"name": "v_max", "axis": 0, "value": 1.5}]}, "registers[0].value", "integer"),
        (DOCUMENT | {"registers": [{"name": "v_max", "axis": 0}]}, "registers[0]", "neither value nor fields"),
        (DOCUMENT | {"registers": [{"name": "v_max", "value": 1}]}, "registers[0].axis", "say which"),
        (DOCUMENT | {"registers": [{"name": "LSMD", "value": 1}]}, "registers[0].name", "among its fields"),
        (DOCUMENT | {"registers": [{"name": "lut_00", "value": 1}]}, "registers[0].name", "tables.microstep"),
        (DOCUMENT | {"registers": [{"name": "v_max", "axis": 0, "value": 2048}]}, "registers[0].value", "11 bits"),
        (
            DOCUMENT | {"registers": [{"name": "pmul_pdiv", "axis": 0, "fields": {"pdiv": 14}}]},
            "registers[0].fields.pdiv",
            "0..13",
        ),
        (
            DOCUMENT | {"registers": [{"name": "lp_ref_conf_rm", "axis": 0, "fields": {"rm": "WARP"}}]},
            "registers[0].fields.rm",
            "RAMP_MODE",
        ),
        (DOCUMENT | {"tables": {"microstep": [0] * 63}}, "tables.microstep", "64"),
        (DOCUMENT | {"tables": {"driver_chain": ["0xFFFF"] * 32}}, "tables.driver_chain[0]", "6 bits"),
        (DOCUMENT | {"tables": {"driver_chain": ["0xZZ"] * 32}}, "tables.driver_chain[0]", "integer"),
        (MODULE | {"registers": [{"name": "ap4", "value": 1}]}, "registers[0]", "parameters"),
        (
            MODULE | {"parameters": [{"name": "maximum_current", "alias": "ap7", "value": 1}]},
            "parameters[0].alias",
            "ap6",
        ),
        (MODULE | {"parameters": [{"name": "maximum_current", "value": 256}]}, "parameters[0]", "0..255"),
    ],
)
def test_what_is_wrong_is_told_with_its_place(data: object, place: str, words: str) -> None:
    with pytest.raises(UnreadableProfile) as told:
        steps_of(parse(data))
    assert told.value.place == place
    assert words in str(told.value)


def test_fields_may_be_named_and_only_those_that_matter_told() -> None:
    document = parse(DOCUMENT | {"registers": [{"name": "LP_REF_CONF_RM", "axis": 1, "fields": {"RM": "SOFT_MODE"}}]})
    (step,) = steps_of(document)
    assert (step.write().fields, step.register.axis) == ({"rm": 1}, 1)


def test_a_document_of_python_is_checked_like_one_of_a_file() -> None:
    assert ProfileDocument(model="tmc4210", clock_hz=16e6).version == 1
