"""Modules and chips of the installed package as the catalog has them: each is read when it is asked for by its name."""

from __future__ import annotations

import threading
from dataclasses import replace

from ...errors import UnreadableModel
from ..capabilities import Capability
from ..entry import Model
from ..model import RegisterTable, Space
from ..wires import WIRES
from . import ic, modules
from .chips import CLOCK_HZ, FAMILY, chip
from .package import EXTRA, Listing, version

CAPABILITIES: frozenset[Capability] = frozenset({"parameters", "motion"})

BESIDE = "-listed"
"""What the name of a model ends with that is offered beside one that is known well."""
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
        board=listing.class_name if listing.slot is not None else "",
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


def model(listing: Listing) -> Model:
    """The module or chip with its parameters or registers. Some 0.2 s where it is the first of a process, which imports
    the package. Raises UnreadableModel."""
    name = listing.name
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


def why_not(listing: Listing) -> str:
    """Why one that is listed cannot be used, as its files tell or where somebody tried; empty where it can."""
    found = _read.get(listing.name)
    if listing.kind == "chip" and listing.slot is None:
        return str(_without_registers(listing))
    return str(found) if isinstance(found, UnreadableModel) else ""


def beside(listing: Listing, well: Model) -> Listing | None:
    """The same under a name of its own, to be offered beside a model that is known `well`; None where that has every
    link and every register that the package tells of."""
    # Of a module no file tells the links: those of its entry are all that TMCL goes over.
    links = entry(listing).wires - well.wires if listing.kind == "chip" else frozenset()
    counted = (Space.AXIS, "axis parameters") if listing.kind == "module" else (Space.REGISTER, "registers")
    lacking = listing.addresses - {row.address for row in well.table if row.space is counted[0]}
    if not (links or lacking):
        return None
    more = [f"by {' and '.join(WIRES[wire].title for wire in WIRES if wire in links)}"] if links else []
    more += [f"with more {counted[1]}: {len(lacking)}"] if lacking else []
    summary = f"as the package lists it: {', '.join(more)}"
    return replace(listing, name=f"{listing.name}{BESIDE}", title=f"{listing.title} by names", summary=summary)


def hint() -> str:
    """Where more models are to be had; empty where they are there."""
    return "" if version() is not None else f"{EXTRA} adds the chips and modules that the maker's package lists"
