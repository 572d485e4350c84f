"""The maker's own classes of evaluation boards against plain emulated chips on one: registers, fields, motion."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any, cast

import pytest
import pytrinamic.evalboards
from pytrinamic.connections import ConnectionManager
from pytrinamic.ic import RegisterApiDevice

from app.clock import WallClock
from app.emulators.build import build_emulator
from app.emulators.line.line import Line
from app.emulators.listed.board import PlainBoard
from app.emulators.listed.chip import PlainChip
from app.registers import catalog
from app.registers.entry import Model
from tests.devices.listed.test_every_chip import NAMES
from tests.peers.served_line import served


def _class(model: Model) -> type[Any] | None:
    found = getattr(pytrinamic.evalboards, f"{model.board}_eval", None)
    return found if isinstance(found, type) else None


BOARDS = [name for name in NAMES if _class(catalog.find_model(name)) is not None]
OLDER = [name for name in BOARDS if not issubclass(_class(catalog.find_model(name)) or object, RegisterApiDevice)]
NEWER = [name for name in BOARDS if name not in OLDER]


@pytest.fixture
def board(request: pytest.FixtureRequest, tmp_path: Path) -> Iterator[tuple[Any, PlainChip]]:
    model = catalog.find_model(request.param)
    chip = cast("PlainChip", build_emulator(model.name, WallClock()))
    with served(Line([PlainBoard(chip)], WallClock()), tmp_path / "port") as (host, port):
        arguments = f"--interface socket_serial_tmcl --port {host}:{port} --timeout 5"
        with ConnectionManager(arguments).connect() as connection:
            kind = _class(model)
            assert kind is not None
            yield kind(connection), chip


@pytest.mark.parametrize("board", OLDER, indirect=True)
def test_registers_of_older_classes(board: tuple[Any, PlainChip]) -> None:
    made, chip = board
    table = catalog.find_model(chip.model).table
    rows = [row for row in table if row.access.writable and row.address <= 0xFF and not row.volatile]
    for row in rows[:8]:
        word = 0x5A5A_5A5A & row.write_mask
        made.write_register(row.address, word)
        assert made.read_register(row.address) & row.write_mask == word
        assert chip.held(row.address) & row.write_mask == word


@pytest.mark.parametrize("board", NEWER, indirect=True)
def test_registers_of_newer_maps(board: tuple[Any, PlainChip]) -> None:
    made, chip = board
    model = catalog.find_model(chip.model)
    bits = model.slot.address_bits
    rows = [row for row in model.table if row.access.value == "RW" and row.address & (1 << bits) - 1 <= 0xFF]
    for row in rows[:8]:
        block, address = (row.address >> bits if model.slot.blocks else 0), row.address & (1 << bits) - 1
        word = 0x5A5A_5A5A & row.write_mask
        made.write_register(address, block, word)
        assert made.read_register(address, block) & row.write_mask == word or row.volatile
