"""Modules and chips of the installed package as the catalog has them: each is read when it is asked for by its name."""

from __future__ import annotations

import threading
from dataclasses import replace

from ...errors import UnknownThing, UnreadableModel
from ..capabilities import Capability
from ..entry import Model
from ..model import RegisterTable
from . import ic, modules
from .chips import CLOCK_HZ, FAMILY, chip
from .package import EXTRA, Listing, listings, version

CAPABILITIES: frozenset[Capability] = frozenset({"parameters", "motion"})

_lock = threading.Lock()
_read: dict[str, Model | UnreadableModel] = {}


def entry(listing: Listing, table: RegisterTable | None = None) -> Model:
    """The catalog's entry, with or without its parameters or registers."""
    known = RegisterTable(listing.name, ()) if table is None else table
    if listing.kind == "chip":
        return _chip(listing, known)
    return Model(
        listing.name,
        FAMILY,
        listing.title,
        listing.summary or f"a module that PyTrinamic {version()} lists",
        "a module whose parameters are known by name",
        listing.axes,
        known,
        clock_hz_default=CLOCK_HZ,
        clock_hz_max=CLOCK_HZ,
        capabilities=CAPABILITIES,
        wires=frozenset({"emulator", "serial", "tcp", "can"}),
        kind="module",
        datagram_bits=0,
        tier="names",
    )


def _chip(listing: Listing, table: RegisterTable) -> Model:
    model = chip(
        listing.name,
        listing.title,
        listing.summary or f"a chip that PyTrinamic {version()} lists",
        table,
        spi=listing.spi,
        uart=listing.uart,
        board=listing.title if listing.slot is not None else "",
        slot=listing.slot,
    )
    if len(table):
        return model
    moves: frozenset[Capability] = frozenset({"motion"} if listing.axes else ())
    return replace(model, axes=listing.axes, capabilities=model.capabilities | moves)


def _read_table(listing: Listing) -> RegisterTable:
    """Raises UnreadableModel."""
    if listing.kind == "module":
        return modules.read(listing)
    if listing.slot is None:
        raise _without_registers(listing)
    return ic.read(listing)


def _without_registers(listing: Listing) -> UnreadableModel:
    return ic.unreadable(listing, "no registers of it, and no board that would lead to them")


def known(name: str) -> bool:
    """Whether the installed package lists a module or chip of that name."""
    return name in listings()


def model(name: str) -> Model:
    """The module or chip of that name with its parameters or registers. Some 0.2 s where it is the first of a process,
    which imports the package. Raises UnknownThing, UnreadableModel."""
    listing = listings().get(name)
    if listing is None:
        raise UnknownThing("model", name, sorted(listings()))
    with _lock:  # two threads would import the package in turns
        if name not in _read:
            try:
                _read[name] = entry(listing, _read_table(listing))
            except UnreadableModel as error:
                _read[name] = error
            except ValueError as error:  # its registers do not fit the datagrams that their names speak of
                _read[name] = ic.unreadable(listing, str(error))
        found = _read[name]
    if isinstance(found, UnreadableModel):
        raise found
    return found


def why_not(name: str) -> str:
    """Why one that is listed cannot be used, as its files tell or where loading was tried; empty where it can."""
    found, listing = _read.get(name), listings().get(name)
    if listing is not None and listing.kind == "chip" and listing.slot is None:
        return str(_without_registers(listing))
    return str(found) if isinstance(found, UnreadableModel) else ""


def hint() -> str:
    """Where more models are to be had; empty where they are there."""
    return "" if version() is not None else f"{EXTRA} adds the chips and modules that the maker's package lists"
