"""The settings of an own search: where they are, from where to where they may go, and how they are written."""

from __future__ import annotations

import difflib
import math
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, replace

from pydantic import ValidationError

from ...devices.core.device import Device
from ...devices.core.limit_rules.quantities import Quantity, View
from ...devices.core.limit_rules.rules import SLACK
from ...devices.families import family_of
from ...errors import SoftLimit, WrongState
from ...number_text import plain
from ...profiles.families import rules_of
from ...profiles.items import items_by_key, key_of
from ...profiles.physical import RESOLUTIONS
from ...profiles.steps import write_of
from ...registers.model import Field, Register, Space
from ..document import CustomSearch, SearchedSetting
from ..families import CHOPPERS, CURRENTS, by_hand_of, unsearched_of
from ..field_settings import FieldSpace, Place, place_of, units_of
from ..plan import AxisNow
from ..ramp_settings import ACCELERATION, JERK, SPEED, UNITS
from ..record import Held
from ..search import Dimension
from .found import Searchable

RAMP = "ramp."
RAMP_FIGURES = (SPEED, ACCELERATION, JERK)
GROUPS = frozenset(
    {"current", "ramp", "thresholds", "stealthchop", "driver", "chopper", "coolstep", "stallguard", "pid"}
    | {"closed loop"}
)
"""Registers of other groups say what stops the motor, what sees its steps, what a step is, or what hangs on outputs:
of those only what is tuned by hand anyway is searched."""
HALF = 0.49
"""A whole number is what is nearest: so its ends are asked for as often as what is between."""


class Refused(Exception):
    """A setting that may not be searched, and why."""


@dataclass(frozen=True, slots=True)
class Searched:
    """A setting of the space. unit : empty where it counts in its own numbers; one : what one more of its register is;
    low, high, now : numbers of the register, of a figure of the ramp 0; place : None of a figure of the ramp."""

    name: str
    unit: str
    dimension: Dimension
    one: float
    low: int
    high: int
    now: float
    place: Place | None
    row: Register | None = None
    field: Field | None = None

    def raw(self, value: float) -> int:
        """The number of its register that is nearest to a value, within its range."""
        return min(max(round(value / self.one), self.low), self.high)


class CustomSpace:
    """All settings of a search, as the axis has them."""

    def __init__(self, device: Device, axis: int, found: AxisNow, wanted: CustomSearch) -> None:
        """Raises Refused for a setting that may not be searched, WrongState where one could not be put back."""
        self._ramp = found.space
        maker = _Maker(device, axis, found, more_current=wanted.more_current)
        self.settings = [maker.made(each) for each in wanted.space]
        places = [each.place for each in self.settings if each.place is not None]
        self._fields = FieldSpace(device, axis, places, found.held)
        self._figures = [each.name.removeprefix(RAMP) for each in self.settings if each.place is None]
        ramp = self._ramp.before if self._figures else []
        self.before: list[Held] = [*ramp, *self._fields.before]
        """What the registers held before."""
        self.warnings = maker.warnings
        own = {each.name for each in ramp}
        twice = next((each for each in self.settings if each.row is not None and each.row.name in own), None)
        if twice is not None:
            raise Refused(f"{twice.name} is set by the figures of the ramp too: search for one of them")
        if len(set(places)) < len(places):
            raise Refused("a setting of the space is there twice, by two of its names: leave one out")

    @property
    def units(self) -> dict[str, str]:
        """Of each setting."""
        return {each.name: each.unit for each in self.settings}

    @property
    def dimensions(self) -> tuple[Dimension, ...]:
        """As a search has them."""
        return tuple(each.dimension for each in self.settings)

    @property
    def now(self) -> dict[str, float]:
        """The settings before."""
        return {each.name: each.now for each in self.settings}

    def rounded(self, values: Mapping[str, float]) -> dict[str, float]:
        """The setting that the chip makes of it."""
        ramp = self._ramp.rounded({**self._ramp.now(), **self._of_ramp(values)}) if self._figures else {}
        return {
            each.name: ramp[each.name.removeprefix(RAMP)]
            if each.place is None
            else each.raw(values[each.name]) * each.one
            for each in self.settings
        }

    def registers(self, values: Mapping[str, float]) -> list[Held]:
        """What to write for it."""
        places = {each.place: each.raw(values[each.name]) for each in self.settings if each.place is not None}
        ramp = self._ramp.registers(self._of_ramp(values)) if self._figures else []
        return [*ramp, *self._fields.registers(places)]

    def ramp_with(
        self, values: Mapping[str, float], pick: Callable[[Iterable[float]], float] = min
    ) -> dict[str, float]:
        """Speed and acceleration with a setting [pps, pps^2]; of several registers the one that `pick` takes."""
        told = self._ramp.now() | self._of_ramp(values)
        for figure in (SPEED, ACCELERATION):
            names = self._ramp.names(figure)
            own = [each for each in self.settings if each.row is not None and each.row.name in names]
            others = [told[figure]] if len(own) < len(names) else []
            told[figure] = pick([*(values[each.name] for each in own), *others])
        return told

    def neighbours(self) -> list[dict[str, float]]:
        """Settings beside the present one: an eighth of each range towards either end."""
        return [{each.name: _beside(each.dimension, each.now, way) for each in self.settings} for way in (-1, 1)]

    def _of_ramp(self, values: Mapping[str, float]) -> dict[str, float]:
        return {figure: values[RAMP + figure] for figure in self._figures}


def _beside(dimension: Dimension, now: float, way: int) -> float:
    """A value an eighth of the range from the present one, or from the nearest that is in the range."""
    inside = min(max(now, dimension.low), dimension.high)
    value: float
    if dimension.log:
        value = inside * (dimension.high / dimension.low) ** (way / 8)
    else:
        value = inside + way * (dimension.high - dimension.low) / 8
    return min(max(value, dimension.low), dimension.high)


def searchable(device: Device, axis: int, found: AxisNow) -> list[Searchable]:
    """All settings of an axis that may be searched, the figures of its ramp first."""
    maker = _Maker(device, axis, found, more_current=False)
    rows = [row for row in device.family.table if row.axis in (axis, None) and not row.when]
    places = [(row, field) for row in rows for field in (row.fields or (None,))]
    told = [*maker.figures(), *(maker.told(row, field) for row, field in places)]
    return [each for each in told if each is not None]


class _Maker:
    """Makes settings of what a document names."""

    def __init__(self, device: Device, axis: int, found: AxisNow, *, more_current: bool) -> None:
        self._device, self._axis, self._found, self._more_current = device, axis, found, more_current
        self._title = f"axis {axis} of {device.name}"
        self._context = units_of(device, found.held)
        self.warnings: list[str] = []

    def made(self, asked: SearchedSetting) -> Searched:
        """Raises Refused, WrongState."""
        if asked.name.casefold().startswith(RAMP):
            return self._figure(asked, asked.name.casefold().removeprefix(RAMP))
        row, field = self._named(asked.name)
        self._require_searchable(row, field, asked.name)
        made = self._number(asked, row, field)
        if not self._more_current:
            self._require_current(made, round(made.now / made.one))
        return made

    def figures(self) -> list[Searchable]:
        """The figures of the ramp that may be searched."""
        told = []
        for figure, now in self._found.space.now().items():
            most = self._most(figure)
            told.append(
                Searchable(
                    name=RAMP + figure,
                    unit=UNITS[figure],
                    low=min(now, most) / 100,
                    high=most,
                    now=now,
                    one=0.0,
                    group="ramp",
                    help=f"the {figure} of moves, in all registers that belong to it",
                )
            )
        return told

    def told(self, row: Register, field: Field | None) -> Searchable | None:
        """A register or field; None where it may not be searched as it is now."""
        name = row.name if field is None else f"{row.name}.{field.name}"
        low, high = self._range(row, field)
        one, unit = self._unit(row, field, high)
        asked = {"name": name, "high": high * one}
        for least in (low, low + 1):  # the least may switch the motor off
            try:
                self._require_searchable(row, field, name)
                wide = SearchedSetting.model_validate({**asked, "low": least * one})
                made = self._number(wide, row, field)
                now = round(made.now / one)
                try:
                    self._require_current(made, now)
                except Refused:
                    high = now
                bits: Register | Field = row if field is None else field
                return Searchable(
                    name=name,
                    unit=unit,
                    low=least * one,
                    high=high * one,
                    now=made.now,
                    one=one,
                    group=row.group,
                    help=bits.help,
                )
            except (Refused, WrongState, ValidationError):
                continue
        return None

    # --- figures of the ramp ------------------------------------------------------------------------

    def _figure(self, asked: SearchedSetting, figure: str) -> Searched:
        now = self._found.space.now()
        if figure not in now:
            there = ", ".join(RAMP + name for name in RAMP_FIGURES if name in now)
            raise Refused(f"{asked.name} is no figure of the ramp of {self._title} as it is set: there are {there}")
        limit = self._most(figure)
        if asked.low <= 0:
            raise Refused(f"{asked.name} has to begin above 0 {UNITS[figure]}: else it never moves")
        if asked.high > limit * SLACK:
            raise Refused(
                f"{asked.name} goes to {plain(asked.high)} {UNITS[figure]}, and the soft limit and the chip allow "
                f"{plain(limit)} at most: lower it"
            )
        dimension = Dimension(RAMP + figure, asked.low, asked.high, asked.log)
        return Searched(RAMP + figure, UNITS[figure], dimension, 1.0, 0, 0, now[figure], None)

    def _most(self, figure: str) -> float:
        """The greatest that the soft limits and the chip allow."""
        if figure == JERK:
            return self._found.space.most(figure)
        most = self._found.space.allowed(figure)
        return min(most, self._device.motion.speed_limit_pps(self._axis)) if figure == SPEED else most

    # --- registers, fields, parameters --------------------------------------------------------------

    def _named(self, name: str) -> tuple[Register, Field | None]:
        table = self._device.family.table
        register, _, part = name.partition(".")
        found = table.find(register, self._axis)
        if found is not None and part:
            field = None if found[1] is not None else found[0].field_named(part)
            if field is None:
                there = ", ".join(each.name for each in found[0].fields) or "none"
                raise Refused(f"{register} has no field {part}: it has {there}")
            return found[0], field
        if found is None:
            folded = {row.name.casefold(): row.name for row in table if row.axis in (self._axis, None)}
            near = [folded[each] for each in difflib.get_close_matches(name.casefold(), folded, 3)]
            hint = f"is {' or '.join(near)} meant?" if near else "the page Registers or Parameters names all of them"
            raise Refused(f"{name} is no register, field or parameter of {self._title}: {hint}")
        return found

    def _require_searchable(self, row: Register, field: Field | None, name: str) -> None:
        """Raises Refused for what a profile does not set, and for what has to stay as it is in a study."""
        model = self._device.model
        if not row.access.writable or (field is not None and not field.access.writable):
            raise Refused(f"{name} can only be read: nothing sets it")
        item, rules = items_by_key(model).get(key_of(row)), rules_of(model)
        own = {each.name for each in item.fields} if item is not None else set()
        acts = item is None or (field is not None and field.name not in own)
        if acts or (rules.positioning is not None and row.name == rules.positioning[0]):
            raise Refused(
                f"{name} is no setting: it is a position, a target or a mode, moves the motor, or does something as it "
                "is written; what a profile sets can be searched"
            )
        assert item is not None
        if item.table is not None or row.space not in (Space.REGISTER, Space.AXIS):
            raise Refused(f"{name} is part of a table, or of no axis: what an axis has of its own can be searched")
        if row.fields and field is None:
            fields = ", ".join(f"{row.name}.{each.name}" for each in item.fields)
            raise Refused(f"{name} is a register of several fields: name one of {fields}")
        if not self._device.configuration.settable(row):
            raise Refused(f"nobody has seen yet that {name} can be set: write it once")
        names = {row.name, *(() if field is None else (field.name,))}
        by_hand = any(self._is_at(each.place, row, field) for each in by_hand_of(self._device))
        if names & {each for each, _ in RESOLUTIONS}:
            raise Refused(f"{name} says what a microstep is: every position would mean something else")
        if row.group not in GROUPS and not by_hand:
            raise Refused(
                f"{name} belongs to '{row.group}', which stays as it is: it may say what stops the motor, or what sees "
                f"its steps; what belongs to {', '.join(sorted(GROUPS))} can be searched"
            )
        if names & unsearched_of(self._device):
            raise Refused(f"{name} protects the power stage, or says what a step is: no search tries it")
        if row.axis is None and len(self._device.axes) > 1:
            self.warnings.append(f"{name} is one of the whole chip: its other axes run by it meanwhile")

    def _number(self, asked: SearchedSetting, row: Register, field: Field | None) -> Searched:
        low, high = self._range(row, field)
        one, unit = self._unit(row, field, high)
        place, name = Place(row.name, "" if field is None else field.name), asked.name
        if asked.low < low * one - abs(low * one) * 1e-6 or asked.high > high * one + abs(high * one) * 1e-6:
            told = f"{plain(low * one)} to {plain(high * one)} {unit}".rstrip()
            raise Refused(
                f"{name} takes {told}, not {plain(asked.low)} to {plain(asked.high)}: mend its low or its high"
            )
        first, last = math.ceil(asked.low / one - 1e-6), math.floor(asked.high / one + 1e-6)
        if first >= last:
            raise Refused(f"{name} counts in {plain(one)} {unit}: there are no two numbers in this range, widen it")
        fields = FieldSpace(self._device, self._axis, [place], self._found.held)
        wide = 0.0 if unit else HALF
        dimension = Dimension(name, first * one - wide, last * one + wide, asked.log)
        if asked.log and dimension.low <= 0:
            raise Refused(f"{name} counts in {plain(one)} {unit}, so equal ratios begin there: raise its low")
        made = Searched(name, unit, dimension, one, first, last, fields[place] * one, place, row, field)
        self._require_on(made)
        return made

    def _range(self, row: Register, field: Field | None) -> tuple[int, int]:
        return self._device.configuration.range_of(row) if field is None else (field.minimum, field.maximum)

    def _unit(self, row: Register, field: Field | None, most: int) -> tuple[float, str]:
        """What one more is, and of what; 1 and nothing where it counts in numbers of its own."""
        one = None if field is not None else self._context.physical(row, 1)
        whole = None if one is None else self._context.physical(row, most)
        if one is None or whole is None or not one.unit or not math.isclose(whole.value, most * one.value):
            return 1.0, ""
        return one.value, one.unit

    def _is_at(self, place: Place, row: Register | None, field: Field | None) -> bool:
        return place_of(self._device, self._axis, place) == (row, field)

    def _require_on(self, made: Searched) -> None:
        """Raises Refused for what switches the motor off."""
        places = CHOPPERS.get(self._device.family.family)
        if places is not None and self._is_at(places.off, made.row, made.field) and made.low < 1:
            raise Refused(f"{made.name} 0 switches the motor off: begin at 1")

    # --- limits -------------------------------------------------------------------------------------

    def _require_current(self, made: Searched, now: int) -> None:
        """Raises Refused for more current than before."""
        remedy = "lower its range, or allow more current (more_current)"
        places = CURRENTS.get(self._device.family.family)
        scales = () if places is None else (places.run, places.hold)
        if any(self._is_at(each, made.row, made.field) for each in scales) and made.high > now:
            raise Refused(f"{made.name} goes to {made.high} and is {now}: that is more current; {remedy}")
        assert made.row is not None
        before = self._view({})
        for quantity in self._currents():
            if made.row.address not in (quantity.address, *quantity.others):
                continue
            for end in (made.low, made.high):
                after = quantity.worst(self._view({made.row.address: self._word(made, end)}))
                held = quantity.value(before)
                if held is None or after > held * SLACK:
                    raise Refused(f"{made.name} {end} is more current than now; {remedy}")

    def _currents(self) -> list[Quantity]:
        """What makes the current of the axis; as a share of full scale where nobody knows how much that is."""
        limits = [each.settings.limits for each in self._device.axes]
        own, family = limits[self._axis], family_of(self._device.model)
        if family.full_scale_a(self._device.model, own) is None:
            limits[self._axis] = replace(own, current_full_scale_a=1.0)
        rules = family.limit_rules(self._device, limits, self._device.clock_hz)
        return [each for each in rules.quantities[self._axis] if each.kind == "current"]

    def _view(self, changed: Mapping[int, int]) -> View:
        items, words = items_by_key(self._device.model), self._found.held.words
        held: dict[int, int | None] = {
            items[key].row.address: word
            for key, word in words.items()
            if items[key].row.space in (Space.REGISTER, Space.AXIS) and items[key].row.axis in (self._axis, None)
        }
        held.update(changed)
        return lambda address: held.get(address)

    def _word(self, made: Searched, number: int) -> int:
        assert made.row is not None
        before = self._found.held.words[key_of(made.row)] or 0
        return made.row.encode(number) if made.field is None else made.field.pack(number, before)


async def beyond_limits(device: Device, space: CustomSpace) -> list[str]:
    """What of the ranges the soft limits of the axis do not let be, setting by setting. Raises BenchError."""
    told, items = [], items_by_key(device.model)
    for each in space.settings:
        if each.row is None:
            continue
        item = items[key_of(each.row)]
        for end in (each.low, each.high):
            values = {**space.now, each.name: end * each.one}
            held = next(one for one in space.registers(values) if one.name == each.row.name)
            try:
                await device.registers.check_writes([write_of(item, each.row.encode(held.value), item.mask)])
            except (SoftLimit, WrongState) as error:
                told.append(f"{each.name} goes to {plain(end * each.one)} {each.unit}".rstrip() + f": {error}")
    return told
