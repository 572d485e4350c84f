"""Chips that the maker's package lists: all of them, by a reading of the package that shares nothing with ours."""

from __future__ import annotations

import inspect
import re
import subprocess
import sys
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest
import pytrinamic.ic
from pytrinamic.ic import RegisterGroup, RegisterSet, TMCIc

from app.errors import UnreadableModel
from app.registers import catalog
from app.registers.entry import Slot
from app.registers.listed import ic, models, package
from app.registers.listed.chips import chip, table_of
from app.registers.listed.models import BESIDE
from app.registers.listed.ramp import ramps_of
from app.registers.model import Access
from app.registers.spi_format import SpiFormat, TaggedFormat

ROOT = Path(__file__).parent.parent.parent
CLASSES: dict[str, type[Any]] = {
    kind.__name__.lower(): kind
    for _, kind in inspect.getmembers(pytrinamic.ic, inspect.isclass)
    if issubclass(kind, TMCIc) and kind is not TMCIc
}
LISTED = [model.name for model in catalog.listings() if model.kind == "chip"]
WITH_REGISTERS = {
    name
    for name, kind in CLASSES.items()
    if hasattr(kind, "REG") or any(isinstance(held, RegisterGroup | RegisterSet) for held in vars(kind).values())
}
READABLE = [name for name in LISTED if name in WITH_REGISTERS]


def addresses(kind: type[Any]) -> list[tuple[str, int]]:
    """(name, address within its block) of every register, as the package has them."""
    if hasattr(kind, "REG"):
        return [
            (name, address)
            for name, place in vars(kind.REG).items()
            if not name.startswith("_")
            for address in (place if isinstance(place, tuple) else (place,))
        ]
    groups: list[Any] = []
    for held in vars(kind).values():
        groups += [held] if isinstance(held, RegisterGroup) else held.groups() if isinstance(held, RegisterSet) else []
    return [(row.name, row.address) for group in groups for row in group.registers()]


def test_every_chip_of_the_package_is_listed_or_known_well() -> None:
    known = {name for name, model in catalog.MODELS.items() if model.kind == "chip"}
    assert {name for name in LISTED if not name.endswith(BESIDE)} == CLASSES.keys() - known
    assert CLASSES.keys() & known, "some of them are known well"


def test_beside_one_that_is_known_well_it_is_offered_only_where_that_lacks_something() -> None:
    """By links and registers, counted here from the package's classes."""
    offered = {name.removesuffix(BESIDE) for name in LISTED if name.endswith(BESIDE)}
    lacking = set()
    for name in CLASSES.keys() & {name for name, model in catalog.MODELS.items() if model.kind == "chip"}:
        well = catalog.MODELS[name]
        if {address for _, address in addresses(CLASSES[name])} - {row.address for row in well.table}:
            lacking.add(name)
        if (package.listings()[name].slot is not None) and "landungsbruecke" not in well.wires:
            lacking.add(name)
    assert offered == lacking
    for name in offered:
        model = catalog.find_model(f"{name}{BESIDE}")
        assert (model.tier, model.title) == ("names", f"{catalog.MODELS[name].title} by names")
        assert model.summary.startswith("as the package lists it: ")
        assert model.wires - catalog.MODELS[name].wires


def test_what_is_lacking_is_said() -> None:
    name = next(name for name in CLASSES if name in catalog.MODELS and catalog.MODELS[name].spi is None)
    listing, well = package.listings()[name], catalog.MODELS[name]
    own = chip(name, "x", "", table_of(name, ic.read(listing)), slot=Slot(), uart="node")
    own = replace(own, wires=own.wires | well.wires)
    assert models.beside(listing, own) is None
    first, *rest = own.table
    less = replace(own, table=table_of(name, [row for row in rest if row.address != first.address]))
    told = models.beside(listing, less)
    assert told is not None
    assert (told.name, told.summary) == (f"{name}{BESIDE}", "as the package lists it: with more registers: 1")
    told = models.beside(listing, replace(own, wires=own.wires - {"landungsbruecke"}))
    assert told is not None
    assert told.summary == "as the package lists it: by Eval board"
    assert catalog.listing_of(name) is None
    assert catalog.is_model(f"{name}{BESIDE}") is (models.beside(listing, well) is not None)


@pytest.mark.parametrize("name", READABLE)
def test_addresses_are_told_without_an_import(name: str) -> None:
    assert package.listings()[name].addresses == {address for _, address in addresses(CLASSES[name])}


@pytest.mark.parametrize("name", READABLE)
def test_every_register_of_the_package_is_a_row(name: str) -> None:
    model, kind = catalog.find_model(name), CLASSES[name]
    bits = model.slot.address_bits if model.slot.blocks else 32
    rows = sorted((row.address & (1 << bits) - 1, row.name) for row in model.table)
    told = sorted((address, register) for register, address in addresses(kind))
    assert [address for address, _ in rows] == [address for address, _ in told]
    for (_, called), (_, register) in zip(rows, told, strict=True):
        assert register in called or {entry for _, entry in told if entry in called}
    assert model.tier == "names"
    assert model.axes == package.listings()[name].axes == len(ramps_of(model.table))
    assert model.can("motion") is (model.axes > 0)
    older = hasattr(kind, "REG")
    for row in model.table:  # nothing is made up
        assert row.reset is None
        assert "reset" in row.untold
        if isinstance(model.spi, TaggedFormat):  # of such datagrams the format tells what is read and what is written
            assert row.access is (Access.W if row.address & 8 else Access.R)
        else:
            assert not older or ("access" in row.untold and row.access in (Access.UNKNOWN, Access.R, Access.RW))


@pytest.mark.parametrize("name", READABLE)
def test_every_field_of_the_package_is_there(name: str) -> None:
    """By mask and sign, of the newer maps; by mask, of the older classes."""
    model, kind = catalog.find_model(name), CLASSES[name]
    if not hasattr(kind, "REG"):
        return
    masks = {(row.address, part.mask) for row in model.table for part in (*row.fields,)}
    widths = {row.address: row.width for row in model.table}
    plain = {(row.address, (1 << row.width) - 1) for row in model.table if not row.fields}
    for inner in [held for holder, held in vars(kind).items() if holder.startswith("FIELD")]:
        for part, told in vars(inner).items():
            if part.startswith("_") or not isinstance(told, tuple) or not isinstance(told[0], int):
                continue
            address, mask, _ = told
            if address in widths and re.fullmatch("0*1+0*", f"{mask:b}"):
                if isinstance(model.spi, TaggedFormat) and mask >> widths[address]:
                    continue  # what says which register it is
                assert (address, mask) in masks | plain, part


@pytest.mark.parametrize("name", [name for name in LISTED if name.removesuffix(BESIDE) not in WITH_REGISTERS])
def test_one_without_registers_says_so(name: str) -> None:
    with pytest.raises(UnreadableModel, match="no registers"):
        catalog.find_model(name)


def test_datagrams_are_told_by_what_a_chip_lists() -> None:
    """As the maker's own C code sends them (TMC-API): bits of data and address, and when the answer comes."""
    told = {name: catalog.find_model(name).spi for name in READABLE}
    kinds = {(spi.data_bits, spi.address_bits, spi.answer) for spi in told.values() if isinstance(spi, SpiFormat)}
    assert kinds == {(32, 7, "same"), (16, 7, "next"), (32, 10, "next")}
    assert sum(isinstance(spi, TaggedFormat) for spi in told.values()) == 1
    without = [name for name in READABLE if not {"spidev", "uart"} & catalog.find_model(name).wires]
    assert len(without) == 3, without  # I2C, none at all, and one whose SPI the maker's code leaves open


def test_nothing_is_imported_until_a_chip_is_asked_for() -> None:
    code = (
        "import sys, app.main; from app.registers import catalog;"
        "found = [model for model in catalog.listings() if model.kind == 'chip'];"
        "assert found and not any(name.startswith('pytrinamic') for name in sys.modules);"
        "catalog.find_model(found[0].name); assert 'pytrinamic.ic' in sys.modules"
    )
    subprocess.run([sys.executable, "-c", code], check=True, cwd=ROOT, timeout=120)
