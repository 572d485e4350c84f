"""Listed chips and those of register maps on a UART: proposed by where they have a version, and by which it is."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import cast

import pytest

from app.clock import WallClock
from app.emulators.build import build_emulator
from app.emulators.line.uart import uart_line
from app.emulators.listed.chip import PlainChip
from app.links import discovery
from app.links.datagram_uart import IFCNT
from app.links.discovery import INPUTS, FoundModule, probe_chips
from app.registers import catalog
from app.registers.entry import Model
from app.registers.maps.models import MAPS, entry
from app.registers.maps.reader import read
from tests.peers.served_line import served

UNKNOWN = 0x7E
"""No chip that is known well has that version."""
LISTED = [
    catalog.find_model(model.name)
    for model in catalog.listings()
    if model.kind == "chip" and model.uart and not model.name.endswith("-listed")
]


def version_address(model: Model) -> int | None:
    """Where its list names a version, by a reading of its own."""
    return next(
        (row.address for row in model.table for part in row.fields if part.name.upper().endswith("VERSION")), None
    )


PLACED = [(model.name, address) for model in LISTED if (address := version_address(model)) is not None]


@pytest.fixture(autouse=True)
def _patience(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(discovery, "WAIT_S", 0.3)  # for chips that are threads on a busy machine


@pytest.fixture
def own() -> Iterator[str]:
    content = b"""format = 1
title = "Own"
[uart]
[[register]]
name = "IOIN"
address = 6
access = "R"
reset = 0x7e000000
  [[register.field]]
  name = "VERSION"
  lsb = 24
  width = 8
"""
    MAPS["own"] = entry(read("own", content))
    yield "own"
    del MAPS["own"]


async def found_on(folder: Path, model: str, version: int | None = None, at: int = 0) -> tuple[FoundModule, PlainChip]:
    """What the search says of one on a line, that shows `version` at the address `at`."""
    chip = cast("PlainChip", build_emulator(model, WallClock()))
    if version is not None:
        chip.write(at, version << 24)
    with served(uart_line([chip], WallClock()), folder / "wire"):
        (found,) = await probe_chips(str(folder / "wire"), [115_200], [0])
    return found, chip


@pytest.mark.parametrize(("model", "address"), PLACED)
async def test_each_is_among_those_that_are_proposed(model: str, address: int, tmp_path: Path) -> None:
    found, chip = await found_on(tmp_path, model, UNKNOWN, address)
    assert (found.chip, found.number, found.version, found.node) == ("", UNKNOWN, "version 0x7e", 0)
    beside = {f"{name}-listed" for name in catalog.MODELS}
    assert set(found.candidates) - beside == {name for name, place in PLACED if place == address}
    assert chip.read(IFCNT) == 0, "nothing was written"


async def test_one_that_shows_no_version_may_be_any_that_has_one(tmp_path: Path) -> None:
    found, _ = await found_on(tmp_path, PLACED[0][0])
    assert {name for name, place in PLACED if place in INPUTS} <= set(found.candidates)


async def test_one_that_is_known_well_comes_first_and_others_are_named(tmp_path: Path) -> None:
    known = next(model for model in catalog.MODELS.values() if model.uart == "node" and model.version is not None)
    assert known.version is not None
    model = next(name for name, place in PLACED if place == known.version_address)
    found, _ = await found_on(tmp_path, model, known.version, known.version_address)
    assert found.chip == known.title
    assert model in found.candidates


async def test_a_register_map_that_tells_its_version_is_told_by_it(own: str, tmp_path: Path) -> None:
    found, _ = await found_on(tmp_path, own)
    assert own in found.candidates
    place = next((name, at) for name, at in PLACED if at == 6)
    other, _ = await found_on(tmp_path, place[0], UNKNOWN - 1, place[1])
    assert own not in other.candidates
