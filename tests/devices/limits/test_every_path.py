"""No word beyond a limit reaches an emulated chip, whichever register it is written to and by whichever path."""

from __future__ import annotations

import random
from collections.abc import Iterator

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from app.devices.core.device import Device
from app.devices.core.results import WriteItem
from app.errors import BenchError, SoftLimit
from app.links import datagram32, datagram40
from app.links.datagram_uart import UartForm
from app.links.tmcl import Request
from app.registers.catalog import CHIPS_32, MODELS
from app.registers.model import Register, Space
from app.registers.tmcl.commands import Opcode
from app.registers.tmcl.modules import MODULES
from tests.devices.limits.harness import ALL_MODELS, Bench, bench, limits_of
from tests.devices.limits.oracle import Oracle
from tests.devices.limits.setup import module_ramp

PATHS = ("value", "field", "batch", "raw", "queue")
REGISTER_MODELS = tuple(model for model in ALL_MODELS if model not in MODULES)


def frame_of(device: Device, register: Register, word: int) -> bytes:
    """The frame that writes a word, made here and not by the driver."""
    if device.model in CHIPS_32:
        return datagram32.write(register.address, word & 0xFF_FFFF)
    if device.model in MODULES:
        signed = word - (1 << 32) if word >> 31 else word
        return Request(1, Opcode.SAP, register.address, 0, signed).encode()
    if MODELS[device.model].uart_alone:
        return UartForm().write(register.address, word)
    if MODELS[device.model].spi is not None:
        return ((register.address & 7) << 17 | word & (1 << register.width) - 1).to_bytes(3, "big")
    return datagram40.write(register.address, word)


def items_of(register: Register, word: int) -> list[WriteItem]:
    """The fields of a word one by one, where it has some."""
    fields = {part.name: part.unpack(word) for part in register.fields if part.access.writable and not part.when}
    return [WriteItem(register.name, register.axis, fields={name: value}) for name, value in fields.items()]


async def put(device: Device, register: Register, word: int, path: str) -> SoftLimit | None:
    """Write by one of the paths; the refusal, where it is one by a limit."""
    value = register.decode(word)
    items = items_of(register, word) or [WriteItem(register.name, register.axis, value)]
    try:
        if path == "value":
            await device.registers.write(register.name, register.axis, value)
        elif path == "field":
            for item in items:
                await device.registers.write(item.name, item.axis, item.value, item.fields)
        elif path == "batch":
            await device.registers.write_many(items)
        elif path == "raw":
            await device.raw.exchange(frame_of(device, register, word))
        else:
            await device.session.queue.exchange(frame_of(device, register, word))
    except SoftLimit as refused:
        return refused
    except BenchError:
        pass  # refused by somebody else, for another reason
    return None


def writable(model: str) -> list[Register]:
    """Every register or axis parameter that can be written at its address."""
    table = MODELS[model].table
    wanted = Space.AXIS if model in MODULES else Space.REGISTER
    return [row for row in table if row.access.writable and row.space is wanted and not row.when]


def words_of(register: Register, chance: random.Random) -> Iterator[int]:
    """Great ones, small ones and one by chance."""
    width = (1 << register.width) - 1
    yield from (width, width >> 1, (width >> 1) + 1, register.encode(register.maximum), chance.randint(0, width))


async def at_rest_within(made: Bench, model: str) -> Oracle:
    """Limits on a chip that holds nothing beyond them: what it does hold after power-on is written first."""
    limits = limits_of(model)
    oracle = Oracle(model, limits)
    await made.device.identity.refresh()
    if model in MODULES:
        for name, value in {**module_ramp(model, 1000.0, 100_000.0, 500.0), "ap6": 60, "ap7": 8}.items():
            await made.device.registers.write(name, 0, value)
        for row in writable(model):
            oracle.words[row.address] = (await made.device.registers.read(row.name, row.axis)).value
    if MODELS[model].spi is not None:  # nothing of it can be read
        await made.device.registers.write("DRVCONF", None, 0)
        await made.device.registers.write("SGCSCONF", 0, fields={"CS": 8})
    elif not MODELS[model].counts_position:  # full current after power-on
        await made.device.registers.write("IHOLD_IRUN", 0, fields={"IRUN": 8, "IHOLD": 4})
    oracle.heard(made.port.frames)
    await made.limit(limits)
    if model == "tmc428":
        for axis in range(3):
            await made.device.registers.write("is_agtat_is_aleat_is_v0_a_threshold", axis, 0x222000)
    made.port.frames.clear()
    assert [meaning for meaning in oracle.beyond() if meaning.quantity != "current"] == []
    return oracle


@pytest.mark.parametrize("model", ALL_MODELS)
async def test_no_word_beyond_a_limit_reaches_the_chip_by_any_path(model: str) -> None:
    chance = random.Random(model)
    refused: set[str] = set()
    async with bench(model) as made:
        oracle = await at_rest_within(made, model)
        for register in writable(model):
            for path in PATHS:
                for word in words_of(register, chance):
                    refusal = await put(made.device, register, word, path)
                    oracle.heard(made.port.frames)
                    made.port.frames.clear()
                    assert oracle.beyond() == [], (register.name, hex(word), path)
                    if refusal is not None:
                        refused.add(refusal.quantity)
    wanted = {"position", "velocity", "acceleration", "current"} - ({"current"} if model == "tmc4210" else set())
    if not MODELS[model].counts_position:
        wanted -= {"position", "acceleration"} | (set() if MODELS[model].can("own_velocity") else {"velocity"})
    assert refused == wanted  # none of the limits has gone untried


@pytest.mark.parametrize("model", REGISTER_MODELS)
@settings(max_examples=12, deadline=None, suppress_health_check=list(HealthCheck))
@given(data=st.data())
async def test_nor_does_a_sequence_of_writes_that_change_what_others_mean(model: str, data: st.DataObject) -> None:
    rows = [row for row in writable(model) if "RAM" not in row.group and "LUT" not in row.name]
    async with bench(model) as made:
        oracle = await at_rest_within(made, model)
        for _ in range(25):
            register = data.draw(st.sampled_from(rows))
            word = data.draw(
                st.one_of(st.integers(0, (1 << register.width) - 1), st.integers(0, min(1 << register.width, 4000) - 1))
            )
            await put(made.device, register, word, data.draw(st.sampled_from(PATHS)))
            oracle.heard(made.port.frames)
            made.port.frames.clear()
            assert oracle.beyond() == []
