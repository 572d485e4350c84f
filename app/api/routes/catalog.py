"""The chips that stepscope knows, with every register and field as a row."""

from __future__ import annotations

from functools import cache

from fastapi import APIRouter

from app.api.problems import problems
from app.api.schemas import CatalogEntry, CatalogModel, FieldRow, RegisterRow
from app.links.errors import UnknownThing
from app.registers.catalog import MODELS, Model
from app.registers.model import Bits, Field, Register

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
    return CatalogModel(**_entry(model).model_dump(), rows=[_register(row) for row in model.table])


def _entry(model: Model) -> CatalogEntry:
    return CatalogEntry(
        name=model.name,
        title=model.title,
        summary=model.summary,
        axes=model.axes,
        registers=len(model.table),
        clock_hz_default=model.clock_hz_default,
        clock_hz_max=model.clock_hz_max,
    )


def _register(row: Register) -> RegisterRow:
    return RegisterRow(
        name=row.name,
        address=row.address,
        axis=row.axis,
        group=row.group,
        access=row.access,
        width=row.width,
        signed=row.signed,
        minimum=row.minimum,
        maximum=row.maximum,
        reset=row.reset,
        unit=row.unit,
        help=row.help,
        write_note=row.write_note,
        volatile=row.volatile,
        source=row.source,
        values=_names(row),
        fields=[_field(part) for part in row.fields],
    )


def _field(part: Field) -> FieldRow:
    return FieldRow(
        name=part.name,
        lsb=part.lsb,
        width=part.width,
        access=part.access,
        signed=part.signed,
        minimum=part.minimum,
        maximum=part.maximum,
        reset=part.reset,
        unit=part.unit,
        help=part.help,
        values=_names(part),
    )


def _names(bits: Bits) -> dict[str, str]:
    return {str(value): name for value, name in bits.values.items()}
