"""Scripts on request: made, tried, and kept with what the trial showed."""

from __future__ import annotations

import asyncio
import hashlib
import time
from collections import OrderedDict
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass

from ...devices.tmcl import units
from ...errors import WrongState
from ...registers.model import Register
from ..document import ProfileDocument, text_of
from ..items import Key
from ..register_bits import RegisterBits, bits_of
from . import c, curl, python, tmcl
from .errors import ScriptFailed
from .plan import Plan, mechanics_of, plan_of
from .proof import How, Language, Trial, attempt
from .text import file_stem

RENDER: Mapping[Language, Callable[[Plan], str]] = {
    "python": python.render,
    "tmcl": tmcl.render,
    "c": c.render,
    "curl": curl.render,
}
ENDINGS: Mapping[Language, str] = {"python": "py", "tmcl": "tmc", "c": "h", "curl": "sh"}
KEPT = 64
"""How many scripts are remembered."""
ASKED_AT_MOST = 8
"""How many may wait for a trial: each takes seconds."""
DIFFERENCES_TOLD = 8


@dataclass(frozen=True, slots=True)
class Checked:
    """What the trial of a script showed; that it is there says that the emulator holds the profile."""

    model: str
    registers: int
    """How many were written and compared."""
    took_s: float
    how: How
    differences: tuple[str, ...] = ()
    """None: where there was one, the script is not offered."""


@dataclass(frozen=True, slots=True)
class Script:
    """A script that may be handed out."""

    language: Language
    text: str
    file_name: str
    checked: Checked


class Scripts:
    """Makes scripts of profiles. One trial runs at a time: they cost a core for seconds."""

    def __init__(self) -> None:
        self._trying = asyncio.Lock()
        self._asked = 0
        self._kept: OrderedDict[str, Script] = OrderedDict()

    async def make(self, document: ProfileDocument, language: Language) -> Script:
        """The script, tried. Raises UnreadableProfile, WrongState (no such language here), and ScriptFailed."""
        plan = plan_of(document)
        text = RENDER[language](plan)
        # By the text, and by the document that it shall make: remarks leave out what fields of 0 say.
        key = hashlib.sha256(f"{language}\0{text}\0{text_of(document)}".encode()).hexdigest()
        if key not in self._kept:
            if self._asked >= ASKED_AT_MOST:
                raise WrongState(f"{self._asked} scripts are being tried, one after the other", "ask again in a while")
            self._asked += 1
            try:
                async with self._trying:
                    if key not in self._kept:  # another request may have asked for it meanwhile
                        self._kept[key] = await self._tried(plan, document, language, text)
            finally:
                self._asked -= 1
            while len(self._kept) > KEPT:
                self._kept.popitem(last=False)
        self._kept.move_to_end(key)
        return self._kept[key]

    async def _tried(self, plan: Plan, document: ProfileDocument, language: Language, text: str) -> Script:
        began = time.perf_counter()
        trial = await attempt(plan, language, text)
        differences = list(differences_of(plan, document, language, trial))
        if differences:
            told = "; ".join(differences[:DIFFERENCES_TOLD])
            more = len(differences) - DIFFERENCES_TOLD
            rest = f" and {more} more" if more > 0 else ""
            raise ScriptFailed(language, plan.model, f"afterwards {told}{rest}", differences)
        checked = Checked(plan.model, plan.count, time.perf_counter() - began, trial.how)
        return Script(language, text, f"{file_stem(plan.name)}.{ENDINGS[language]}", checked)


def differences_of(plan: Plan, document: ProfileDocument, language: Language, trial: Trial) -> Iterator[str]:
    """What a device holds otherwise than a profile says, in words; of what the profile does not tell nothing."""
    have = bits_of(trial.held)
    wants = bits_of(document)
    rounded = _rounding(plan, wants)
    for key, want in wants.items():
        row, place, got = want.item.row, want.item.place, have.get(key)
        if got is None:
            yield f"nobody knows what {place} holds"
        elif (got.word ^ want.word) & want.mask:
            wanted, held = row.decode(want.word), row.decode(got.word & want.mask)
            if abs(wanted - held) > rounded(row, wanted):
                yield f"{place} is {held} instead of {wanted}"
    if language == "python":  # the others have no say in it
        for index, axis in enumerate(trial.held.axes[: len(plan.mechanics)]):
            if mechanics_of(axis) != plan.mechanics[index]:
                yield f"the mechanics of axis {index} are {mechanics_of(axis)}"


def _rounding(plan: Plan, wants: Mapping[Key, RegisterBits]) -> Callable[[Register, int], float]:
    """By how much a module may hold another number than was written: its driver chip has whole units of its own."""
    if plan.family.kind != "module":
        return lambda row, value: 0.0
    held = {want.item.row.name: want.item.row.decode(want.word) for want in wants.values()}
    if held.get("unit_mode") == units.INTERNAL:
        return lambda row, value: 0.0
    microsteps = 1 << held.get("microstep_resolution", 8)
    return lambda row, value: units.read_back_tolerance(row.unit, value, plan.clock_hz, microsteps)
