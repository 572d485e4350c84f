"""The chips and modules that stepscope knows, with every register, parameter and command as a row."""

from __future__ import annotations

from functools import cache
from typing import Any

from fastapi import APIRouter

from ...errors import UnknownThing
from ...registers.catalog import MODELS, Model
from ...registers.model import Field, Register, Space
from ...registers.tmcl.commands import COMMANDS
from ..http.problems import problems
from .schemas import CatalogEntry, CatalogModel, CommandRow, FieldRow, RegisterRow

router = APIRouter(prefix="/catalog", tags=["catalog"])


@router.get("")
async def list_models() -> list[CatalogEntry]:
    """Every model, without its registers."""
    return [_entry(model) for model in MODELS.values()]


@router.get("/{model}", responses=problems(UnknownThing))
async def get_model(model: str) -> CatalogModel:
    """One model with all its registers and RAM words."""
    found = MODELS.get(model.casefold())
    if found is None:
        raise UnknownThing("model", model, sorted(MODELS))
    return _model(found.name)


@cache  # the tables never change, and 100 rows with fields are the longest answer of the API
def _model(name: str) -> CatalogModel:
    model = MODELS[name]
    return CatalogModel(
        **_entry(model).model_dump(),
        rows=[_register(row) for row in model.table],
        commands=[CommandRow.model_validate(row) for row in COMMANDS] if model.kind == "module" else [],
    )


def _entry(model: Model) -> CatalogEntry:
    return CatalogEntry(
        name=model.name,
        kind=model.kind,
        title=model.title,
        summary=model.summary,
        axes=model.axes,
        registers=len(model.table),
        clock_hz_default=model.clock_hz_default,
        clock_hz_max=model.clock_hz_max,
    )


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
        stored=row.stored,
        read_clears=row.read_clears,
        internal_range=None if row.internal_range is None else list(row.internal_range),
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
