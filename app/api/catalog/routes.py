"""The chips and modules that stepscope knows, with every register, parameter and command as a row."""

from __future__ import annotations

import asyncio
from contextlib import suppress
from dataclasses import asdict
from functools import cache
from typing import Any

from ...errors import StoreUnavailable, UnknownThing
from ...registers.capabilities import TITLES
from ...registers.catalog import MODELS, Model, find_model, listings, maps, why_not
from ...registers.model import Field, Register, Space
from ...registers.spi_format import SpiFormat, TaggedFormat
from ...registers.tmcl.commands import COMMANDS
from ...registers.wires import WIRES, Wire
from ..deps import CurrentBench
from ..http.problems import problems
from ..router import subject_router
from .schemas import (
    CapabilityTitle,
    CatalogEntry,
    CatalogModel,
    CommandRow,
    DriverPlaceRow,
    FieldRow,
    RegisterRow,
    SpiFormatRow,
    TaggedFormatRow,
    WireRow,
)

router = subject_router(prefix="/catalog", tags=["catalog"])


@router.get("")
async def list_models(bench: CurrentBench) -> list[CatalogEntry]:
    """Every model, without its registers: first those that stepscope knows well, then those of register maps, and those
    that an installed package lists, whose parameters are read when one of them is asked for."""
    with suppress(StoreUnavailable):  # then those that were read before
        await bench.maps.scan()
    return entries()


def entries() -> list[CatalogEntry]:
    """The same, as far as it is known."""
    known = [_entry(model, len(model.table)) for model in (*MODELS.values(), *maps())]
    return [*known, *(_entry(model, None) for model in listings())]


@router.get("/capabilities")
async def list_capabilities() -> list[CapabilityTitle]:
    """Everything that some model can and another cannot, in plain words."""
    return [CapabilityTitle(name=name, title=title) for name, title in TITLES.items()]


@router.get("/{model}", responses=problems(UnknownThing))
async def get_model(model: str) -> CatalogModel:
    """One model with all its registers and RAM words."""
    found = await loaded(model.casefold())
    return _model(found)


@cache  # the table of a model never changes, and 100 rows with fields are the longest answer of the API
def _model(model: Model) -> CatalogModel:
    return CatalogModel(
        **_entry(model, len(model.table)).model_dump(),
        rows=[_register(row) for row in model.table],
        commands=[CommandRow.model_validate(row) for row in COMMANDS] if model.kind == "module" else [],
    )


async def loaded(name: str) -> Model:
    """The model of that name. One that a package lists is read in a thread: importing it takes some tenths of a second,
    and stops wait for nobody. Raises UnknownThing, UsageError."""
    return MODELS[name] if name in MODELS else await asyncio.to_thread(find_model, name)


def _entry(model: Model, registers: int | None) -> CatalogEntry:
    return CatalogEntry(
        name=model.name,
        kind=model.kind,
        family=model.family,
        title=model.title,
        summary=model.summary,
        description=model.description,
        axes=model.axes,
        registers=registers,
        tier=model.tier,
        unreadable=why_not(model.name),
        clock_hz_default=model.clock_hz_default,
        clock_hz_min=model.clock_hz_min,
        clock_hz_max=model.clock_hz_max,
        capabilities=[name for name in TITLES if model.can(name)],
        wires=[_wire(model, kind) for kind in WIRES if kind in model.wires],
        datagram_bits=model.datagram_bits,
        spi=SpiFormatRow.model_validate(asdict(model.spi)) if isinstance(model.spi, SpiFormat) else None,
        tagged=(
            TaggedFormatRow(written=model.spi.written, tag_lsb=model.spi.tag_lsb)
            if isinstance(model.spi, TaggedFormat)
            else None
        ),
        uart=model.uart,
        nodes=model.nodes,
        driver=model.driver,
        current_scale=model.current_scale,
    )


def _wire(model: Model, kind: Wire) -> WireRow:
    known = WIRES[kind]
    by_board = known.frames == "datagram" and not model.datagram_bits  # of an emulated chip whose SPI is not known
    frames = "tmcl" if model.kind == "module" else "board" if by_board else known.frames
    if model.uart_alone:
        frames = "uart"
    return WireRow(kind=kind, title=known.title, frames=frames)


def _register(row: Register) -> RegisterRow:
    return RegisterRow(
        **_bits(row),
        address=row.address,
        space=row.space.value,
        alias=_alias(row),
        axis=row.axis,
        group=row.group,
        write_note=row.write_note,
        volatile=row.volatile,
        untold=sorted(row.untold),
        stored=row.stored,
        read_clears=row.read_clears,
        internal_range=None if row.internal_range is None else list(row.internal_range),
        driver=None if row.driver is None else DriverPlaceRow.model_validate(row.driver),
        source=row.source,
        fields=[FieldRow(**_bits(part), lsb=part.lsb) for part in row.fields],
    )


def _alias(row: Register) -> str:
    """As people write it: "AP 4", "GP0 66"."""
    return "" if row.space is Space.REGISTER else f"{row.space.value.upper()} {row.address}"


def _bits(bits: Register | Field) -> dict[str, Any]:
    """What the rows of registers and of fields tell alike."""
    return {
        "name": bits.name,
        "access": bits.access,
        "width": bits.width,
        "signed": bits.signed,
        "minimum": bits.minimum,
        "maximum": bits.maximum,
        "reset": bits.reset,
        "unit": bits.unit,
        "help": bits.help,
        "values": {str(value): name for value, name in bits.values.items()},
        "when": bits.when,
        "behaviour": bits.behaviour,
    }
