"""Modules of the installed package as the catalog has them: each is read when it is asked for by its name."""

from __future__ import annotations

import threading

from ...errors import UnknownThing, UnreadableModel
from ..capabilities import Capability
from ..entry import Model
from ..model import RegisterTable
from .modules import read
from .package import EXTRA, Listing, listings, version

FAMILY = "listed"
CLOCK_HZ = 16e6
"""Of the motion controller inside; nothing is computed from it [Hz]."""
CAPABILITIES: frozenset[Capability] = frozenset({"parameters", "motion"})

_lock = threading.Lock()
_read: dict[str, Model | UnreadableModel] = {}


def entry(listing: Listing, table: RegisterTable | None = None) -> Model:
    """The catalog's entry, with or without its parameters."""
    return Model(
        listing.name,
        FAMILY,
        listing.title,
        listing.summary or f"a module that PyTrinamic {version()} lists",
        "a module whose parameters are known by name",
        listing.axes,
        RegisterTable(listing.name, ()) if table is None else table,
        clock_hz_default=CLOCK_HZ,
        clock_hz_max=CLOCK_HZ,
        capabilities=CAPABILITIES,
        wires=frozenset({"emulator", "serial", "tcp", "can"}),
        kind="module",
        datagram_bits=0,
        tier="names",
    )


def known(name: str) -> bool:
    """Whether the installed package lists a module of that name."""
    return name in listings()


def model(name: str) -> Model:
    """The module of that name with its parameters. Some 0.2 s where it is the first of a process, which imports the
    package. Raises UnknownThing, UnreadableModel."""
    listing = listings().get(name)
    if listing is None:
        raise UnknownThing("model", name, sorted(listings()))
    with _lock:  # two threads would import the package in turns
        if name not in _read:
            try:
                _read[name] = entry(listing, read(listing))
            except UnreadableModel as error:
                _read[name] = error
        found = _read[name]
    if isinstance(found, UnreadableModel):
        raise found
    return found


def why_not(name: str) -> str:
    """Why a module that is listed cannot be used, where somebody has tried; empty where nobody has, or it can."""
    found = _read.get(name)
    return str(found) if isinstance(found, UnreadableModel) else ""


def hint() -> str:
    """Where more models are to be had; empty where they are there."""
    return "" if version() is not None else f"{EXTRA} adds the modules that the maker's package lists"
