"""What the installed package lists, told from its files alone: nothing of it is imported for that.

The package is PyTrinamic (docs/sources.md), the extra `pytrinamic`. Each module is one class in a file of its own,
which makes one object a motor. Each chip is one too, in a file or in a folder with the map of its registers, and a
second class tells how an evaluation board leads to it.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import cache
from importlib import metadata, util
from pathlib import Path
from typing import Literal

from ..entry import Slot
from ..spi_format import USUAL, Spi, SpiFormat, TaggedFormat

PACKAGE = "pytrinamic"
EXTRA = f'pip install "stepscope[{PACKAGE}]"'
FILE_BYTES_MAX = 1 << 20
"""No file of the package is a tenth as long: what is longer is not read."""

_CLASS = re.compile(r"^class (\w+)\(TMCLModule\):\s*(?:\"\"\"(.*?)\"\"\")?", re.MULTILINE | re.DOTALL)
_MOTORS = re.compile(r"self\.motors\s*=\s*\[(.*?)\]", re.DOTALL)
_CHIP = re.compile(r"^class (\w+)\([^)]*\bTMCIc\b[^)]*\):\s*(?:\"\"\"(.*?)\"\"\")?", re.MULTILINE | re.DOTALL)
_TARGET = re.compile(r"(?:\bM(\d)_)?XTARGET(?:_M(\d))?\s*=\s*(?:\((0x\w+, *0x\w+)\))?")
"""Where a target is set: a motor's number in its name, or an address for each of two."""
_DRIVER, _CONTROLLER = re.compile(r"read_drv", re.IGNORECASE), re.compile(r"read_mc", re.IGNORECASE)
_MODULE = re.compile(r"module_id=(\d+)")
_ADDRESS_BITS = re.compile(r"address_bit_width\s*=\s*(\d+)")
WITHOUT_SPI = ("PDN_UART", "PDN_DISABLE", "UART_ENABLED")
"""Names of pins or bits of chips that choose between their UART and standing alone: such a chip has no SPI."""
SIGNATURES: tuple[tuple[frozenset[str], Spi], ...] = (
    (frozenset({"GCONF", "GSTAT"}), USUAL),
    (frozenset({"GCR_GCONF", "GCR_GSTAT"}), USUAL),
    (frozenset({"GLOBAL_CFG", "STATUS_CFG", "DC_H2L"}), SpiFormat(data_bits=16)),
    (frozenset({"SPI_STATUS_MASK", "FAULTN_INT_MASK", "IO_MATRIX"}), SpiFormat(address_bits=10)),
    (frozenset({"DRVCTRL", "SMARTEN", "SGCSCONF", "DRVCONF"}), TaggedFormat()),
)
"""Registers by whose names a chip has these datagrams, as the maker's own C code sends them (API, `tmc/ic`)."""
_DECLARED = re.compile(r'^DATAGRAM_FORMAT = ">BI"$', re.MULTILINE)
"""A class that sends datagrams itself: an address and 32 bits, answered at once."""
_REG = re.compile(r"^    class REG\b.*?:\n(.*?)(?=^    \S|\Z)", re.MULTILINE | re.DOTALL)
_NUMBERS = re.compile(r"0x[0-9A-Fa-f]+")
_AXIS_PARAMETERS = re.compile(r"^ +class AP\b.*?:\n(.*?)(?=^ *(?:class|def) |\Z)", re.MULTILINE | re.DOTALL)
_DECIMALS = re.compile(r"^ +\w+ *= *(\d+)\b", re.MULTILINE)
_MAPPED = re.compile(r"Access\.\w+,\s*(0x[0-9A-Fa-f]+),\s*(?:True|False)\)")
"""A register of a map: access, address, sign. A field has a mask and a shift there."""
_TITLE = re.compile(r"^([A-Z]+)(\d)")


@dataclass(frozen=True, slots=True)
class Listing:
    """A module or chip as its file tells it, before its parameters or registers were read.

    spi, uart, slot : of a chip what leads to it, as far as names in its files tell; `addresses` of its registers,
        or numbers of the axis parameters of a module
    """

    name: str
    title: str
    summary: str
    axes: int
    class_name: str
    kind: Literal["module", "chip"] = "module"
    where: str = "modules"
    spi: Spi | None = None
    uart: Literal["", "node"] = ""
    slot: Slot | None = None
    addresses: frozenset[int] = frozenset()

    @property
    def module(self) -> str:
        """What has to be imported for its parameters or registers."""
        return f"{PACKAGE}.{self.where}.{self.class_name}"


@cache
def version() -> str | None:
    """The version of the installed package; None where it is not installed."""
    try:
        return metadata.version(PACKAGE)
    except metadata.PackageNotFoundError:
        return None


@cache
def listings() -> dict[str, Listing]:
    """Every module and chip of the installed package, by name; empty where it is not installed."""
    found = util.find_spec(PACKAGE)
    if found is None or not found.submodule_search_locations:
        return {}
    folder = Path(found.submodule_search_locations[0])
    modules = (listing_of(path) for path in sorted((folder / "modules").glob("*.py")))
    ics = sorted((folder / "ic").glob("*.py")) + sorted((folder / "ic").glob("*/*.py"))
    chips = (chip_listing_of(path, folder / "evalboards") for path in ics)
    return {listing.name: listing for listing in (*modules, *chips) if listing is not None}


def listing_of(path: Path) -> Listing | None:
    """The module that the file is about; None where it is about none, or cannot be read."""
    text = _text(path)
    declared = next((found for found in _CLASS.finditer(text) if found[1] == path.stem), None)
    if declared is None:
        return None
    title = _TITLE.sub(r"\1-\2", path.stem).replace("_", "-")
    motors = _MOTORS.search(text)
    axes = 0 if motors is None else motors[1].count("(")
    numbers = frozenset(int(told) for block in _AXIS_PARAMETERS.findall(text) for told in _DECIMALS.findall(block))
    return Listing(title.lower(), title, _summary(declared[2] or ""), axes, path.stem, addresses=numbers)


def chip_listing_of(path: Path, boards: Path) -> Listing | None:
    """The chip that the file is about; None where it is about none, or cannot be read. `boards` has a file for each
    evaluation board."""
    text = _text(path)
    declared = next((found for found in _CHIP.finditer(text) if found[1] == path.stem), None)
    if declared is None:
        return None
    title, folder = path.stem, path.parent
    where = "ic" if folder.name == "ic" else f"ic.{folder.name}"
    summary = _summary(declared[2] or "").removeprefix(f"{title} - ")
    maps = [_text(map_) for map_ in sorted(folder.glob("*map.py"))] if folder.name == title else []

    def named(*words: str) -> bool:
        """Whether one of these is a register or field: quoted in a map, else a name of the class."""
        if maps:
            return any(f'"{word}"' in map_ for map_ in maps for word in words)
        return any(word in text and re.search(rf"\b{word}\b", text) is not None for word in words)

    return Listing(
        title.lower(),
        title,
        "" if "<" in summary else summary,
        int(any('XTARGET"' in map_ for map_ in maps)) if maps else _axes(text),
        title,
        "chip",
        where,
        spi=None if named(*WITHOUT_SPI) else _spi(named, text),
        uart="node" if named("IFCNT") and named("SLAVECONF", "NODECONF") else "",
        slot=_slot(_text(boards / f"{title}_eval.py")),
        addresses=frozenset(int(told, 0) for told in _addresses(text, maps)),
    )


def _addresses(text: str, maps: list[str]) -> Iterator[str]:
    """Numbers of its registers, as its files spell them."""
    for map_ in maps:
        yield from _MAPPED.findall(map_)
    block = _REG.search(text)
    for line in block[1].splitlines() if block is not None else ():
        yield from _NUMBERS.findall(line.partition("#")[0].partition("=")[2])


def _spi(named: Callable[[str], bool], text: str) -> Spi | None:
    """Its datagrams on SPI, by the names of its registers, or as its class declares them; None where nothing tells."""
    known = next((spi for names, spi in SIGNATURES if all(named(name) for name in names)), None)
    if known is None and _DECLARED.search(text) is not None and not named("IFCNT"):
        return SpiFormat(answer="same")
    return known


def _axes(text: str) -> int:
    """How many ramp generators have a target, by name."""
    found = [_TARGET.search(line) for line in text.splitlines() if "XTARGET" in line]
    targets = [target for target in found if target is not None]
    numbered = {number for target in targets for number in target.group(1, 2) if number}
    return max(2 if any(target[3] for target in targets) else min(len(targets), 1), len(numbered))


def _slot(text: str) -> Slot | None:
    """How the board of that file leads to its chip; None where it says no registers."""
    driver = _DRIVER.search(text) is not None
    if not driver and _CONTROLLER.search(text) is None:
        return None
    module, bits = _MODULE.search(text), _ADDRESS_BITS.search(text)
    plain = Slot()
    return Slot(
        "driver" if driver else "controller",
        plain.module if module is None else int(module[1]),
        plain.address_bits if bits is None else int(bits[1]),
        blocks=bits is not None,
    )


def _text(path: Path) -> str:
    """What the file holds; empty where it cannot be read, or is longer than any of the package is."""
    try:
        return path.read_text(encoding="utf-8") if path.stat().st_size <= FILE_BYTES_MAX else ""
    except (OSError, UnicodeDecodeError):
        return ""


def _summary(docstring: str) -> str:
    """The first sentence, in one line."""
    return re.split(r"(?<=[a-z)])\.\s|\n\s*\n|\n\s*\*", docstring.strip())[0].replace("\n", " ").strip().rstrip(".")
