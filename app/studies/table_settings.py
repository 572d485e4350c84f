"""The microstep table of an axis as a setting: the registers that hold it, and how they go into a profile."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TypeVar

from ..calc.microsteps.mslut import MslutRegisters
from ..devices.core.device import Device
from ..errors import WrongState
from ..profiles.capture import CapturedConfiguration
from ..profiles.document import MslutPart, ParameterPart, ProfileDocument, RegisterPart
from ..profiles.register_bits import mslut_rows
from ..registers.catalog import MODELS
from .record import Held

P = TypeVar("P", bound=RegisterPart | ParameterPart)


class TableSpace:
    """The table of differences (MSLUT) that turns the motor of an axis."""

    def __init__(self, device: Device, axis: int, held: CapturedConfiguration) -> None:
        """`held` is what the device was set to before. Raises WrongState where there is none, or nobody knows it."""
        own = mslut_rows(device.model, axis)
        items = own or mslut_rows(device.model, None)
        if not items:
            raise WrongState(f"a {device.model.upper()} has no table of differences (MSLUT)", "")
        self.shared = not own and len(device.axes) > 1
        """Whether all motors of the chip are turned by it."""
        words = [held.word(item) for item in items]
        unknown = next((item for item, word in zip(items, words, strict=True) if word is None), None)
        if unknown is not None:
            raise WrongState(
                f"what {unknown.row.name} holds is not known, so it could not be put back",
                "write the table once (Microsteps), or switch the chip off and on",
            )
        self._start = items[-1]
        self.before = [
            Held(name=item.row.name, axis=item.row.axis, value=word or 0)
            for item, word in zip(items, words, strict=True)
        ]

    @property
    def now(self) -> MslutRegisters:
        """The table as it was before."""
        *words, select, start = (each.value for each in self.before)
        return MslutRegisters(tuple(words), select, start)

    def registers(self, table: MslutRegisters) -> list[Held]:
        """What to write for a table; what else shares its last register (DAC_OFFSET) stays."""
        start = table.with_dac_offset(self.before[-1].value >> 24).start & self._start.mask
        values = (*table.words, table.select, start)
        return [each.model_copy(update={"value": value}) for each, value in zip(self.before, values, strict=True)]


def with_registers(document: ProfileDocument, registers: Sequence[Held]) -> ProfileDocument:
    """A profile with these registers or parameters instead of its own."""
    if MODELS[document.model].kind == "module":
        told = [ParameterPart(name=each.name, axis=each.axis, value=each.value) for each in registers]
        return document.model_copy(update={"parameters": _put(document.parameters, told)})
    plain, tables = _plain_and_tables(document.model, registers)
    whole = document.model_copy(update={"registers": _put(document.registers, plain)})
    if tables:
        kept = [part for part in document.tables.mslut or () if part.axis not in {each.axis for each in tables}]
        whole.tables = document.tables.model_copy(update={"mslut": [*kept, *tables]})
    return whole


def _plain_and_tables(model: str, registers: Sequence[Held]) -> tuple[list[RegisterPart], list[MslutPart]]:
    """Registers as a profile has them: by themselves, and those of tables together."""
    tables = {
        (item.row.name, item.row.axis): item.row.axis
        for axis in {None, *(each.axis for each in registers)}
        for item in mslut_rows(model, axis)
    }
    words: dict[int | None, list[int]] = {}
    plain = []
    for each in registers:
        key = (each.name, each.axis)
        if key in tables:
            words.setdefault(tables[key], []).append(each.value)
        else:
            plain.append(RegisterPart(name=each.name, axis=each.axis, value=each.value))
    return plain, [MslutPart(axis=axis, words=held[:8], select=held[8], start=held[9]) for axis, held in words.items()]


def _put(parts: Sequence[P], others: Sequence[P]) -> list[P]:
    """These parts with the others, each in the place of the one that it replaces, or behind them all."""
    new = {(each.name, each.axis): each for each in others}
    whole: list[P] = []
    for part in parts:
        whole.append(new.pop((part.name, part.axis), part))
        whole[-1].unit = part.unit
    return [*whole, *new.values()]
