"""Random sequences of what people do to a device, each undone from the audit log, and whether what is told is true."""

from __future__ import annotations

import contextlib
import random
import tempfile
from collections.abc import AsyncIterator, Awaitable, Callable, Iterator, Sequence
from contextlib import asynccontextmanager
from dataclasses import dataclass
from pathlib import Path

from app.audit.listener import AuditListener, note_settings
from app.devices.core.actor import Actor, actor
from app.devices.core.config import AxisSettings
from app.devices.core.device import Device
from app.devices.manager import DeviceChange
from app.errors import BenchError, OutOfRange
from app.profiles.capture import capture
from app.profiles.document import ProfileDocument
from app.profiles.items import items_of
from app.profiles.service import ProfileService
from app.profiles.undo import Aim, Before, Preview, UndoService
from app.store.audit import AuditLog, request_under_way
from app.store.audit_entries import EntryFilter
from app.store.database import Database
from tests.profiles.faults import same
from tests.profiles.harness import NOT_BY_CHANCE, Bench, allowed, bench, change

ANN, BOB = (Actor(name, "client", None, "") for name in ("Ann", "Bob"))
DESIGN_SHARE = 0.04
PROFILE_SHARE = 0.1
"""How many registers a design and a profile change."""


@dataclass
class Undoing:
    """One device with an audit log of its own, profiles and undo."""

    bench: Bench
    audit: AuditLog
    profiles: ProfileService
    undo: UndoService

    @property
    def device(self) -> Device:
        return self.bench.device

    async def next_entry(self) -> int:
        """An id that no entry has yet, and none will have that is below."""
        latest = await self.audit.search(EntryFilter(), 1)
        return 1 + max((entry.id or 0 for entry in latest), default=0)

    async def put_all_back(self, aim: Aim, by: Actor = ANN) -> Preview:
        """Put back everything that can be; what was told before."""
        preview = await self.undo.preview(self.device, aim, by)
        places = [each.place for each in preview.registers if each.state != "cannot"]
        with self.by(by):
            await self.undo.put_back(self.device, aim, by, places, preview.seen)
        return preview

    @contextlib.contextmanager
    def by(self, who: Actor) -> Iterator[None]:
        """A request of theirs."""
        before = actor.set(who)
        try:
            with request_under_way():
                yield
        finally:
            actor.reset(before)


@asynccontextmanager
async def undoing(model: str) -> AsyncIterator[Undoing]:
    """A device that is set up, and what its changes are heard by."""
    with tempfile.TemporaryDirectory() as folder:
        async with bench(model) as b:
            database = Database(Path(folder))
            audit = AuditLog(database, b.clock, lambda: 1e9 + b.clock.now())

            async def configure(device: Device, axes: Sequence[AxisSettings]) -> None:
                before = [axis.settings for axis in device.axes]
                await b.manager.edit(device.id, DeviceChange(axes=tuple(axes)))
                note_settings(audit, device, before, axes)

            profiles = ProfileService(Path(folder), lambda _: "", configure)
            listener = AuditListener(audit)
            listener.sync(b.manager.devices)
            try:
                yield Undoing(b, audit, profiles, UndoService(audit, profiles))
            finally:
                listener.sync([])
                await audit.close()
                await profiles.close()
                database.close()


# --- a sequence -----------------------------------------------------------------------------------------


@dataclass(frozen=True)
class Report:
    """What came of one sequence.

    back : registers that were put back. told : those that were told as what cannot be. wrong : registers that are not
    as before and of which nothing is told, or that are told wrongly
    """

    model: str
    seed: int
    doings: Sequence[str]
    back: int
    told: int
    wrong: Sequence[str]


async def undo_of(model: str, seed: int, length: int = 6) -> Report:
    """Do `length` things by chance, undo all of them, and compare with before."""
    rng = random.Random(seed)
    async with undoing(model) as u:
        kept = await _other_profile(u.device, rng)
        before, settings = u.bench.truth(), [axis.settings for axis in u.device.axes]
        first = await u.next_entry()
        doings = [await _one(u, rng, kept) for _ in range(length)]
        preview = await u.put_all_back(Before(first))
        after = u.bench.truth()
        cannot = {each.place for each in preview.registers if each.state == "cannot"}
        wrong = []
        for item in items_of(model):
            place = item.row.name, item.row.axis
            if place not in cannot and not same(u.bench, item, after[item.key], before[item.key]):
                wrong.append(f"{item.place} was {before[item.key]:#x} and is {after[item.key]:#x}, and nobody tells")
        if [axis.settings for axis in u.device.axes] != settings:
            wrong.append("the mechanics are not as they were")
        return Report(model, seed, doings, len(preview.registers) - len(cannot), len(cannot), wrong)


async def _other_profile(device: Device, rng: random.Random) -> ProfileDocument:
    """The device's configuration with some registers of it changed, while the device stays as it is."""
    async with bench(device.model) as scratch:
        await change(scratch.device, rng, PROFILE_SHARE)
        document = await capture(scratch.device, "another", unix_s=1.0)
    document.axes[0].gear_ratio = rng.choice([1.0, 2.5])
    return document


async def _one(u: Undoing, rng: random.Random, kept: ProfileDocument) -> str:
    doing = rng.choice(list(DOINGS))
    with u.by(rng.choice([ANN, BOB])), contextlib.suppress(BenchError):  # what is refused is in the log as well
        await DOINGS[doing](u, rng, kept)
    return doing


async def _write(u: Undoing, rng: random.Random, _: ProfileDocument) -> None:
    item = rng.choice([item for item in items_of(u.device.model) if item.row.name not in NOT_BY_CHANCE])
    write = allowed(item, rng.randint)
    if item.row.name == "START_CONF" and write.fields is not None:
        write.fields |= {f"start_en[{index}]": 0 for index in range(5)}
    with contextlib.suppress(OutOfRange):
        await u.device.registers.write(write.name, write.axis, write.value, write.fields)


async def _design(u: Undoing, rng: random.Random, _: ProfileDocument) -> None:
    await change(u.device, rng, DESIGN_SHARE)


async def _profile(u: Undoing, _: random.Random, kept: ProfileDocument) -> None:
    await u.profiles.apply(u.device, kept)


async def _undo(u: Undoing, rng: random.Random, _: ProfileDocument) -> None:
    """Of something that was done so far, by Ann: one more change, which is undone with the others."""
    entries = [entry for entry in await u.audit.search(EntryFilter(action="write"), 50) if entry.id is not None]
    if entries:
        await u.undo.put_back(u.device, Before(rng.choice(entries).id or 1), ANN)


DOINGS: dict[str, Callable[[Undoing, random.Random, ProfileDocument], Awaitable[None]]] = {
    "write": _write,
    "design": _design,
    "profile": _profile,
    "undo": _undo,
}
