"""The law of the house: outside its own folders nobody names a model or a family.

What still does is counted by room, with the reason. A count may only go down.
"""

from __future__ import annotations

import io
import re
import tokenize
from collections import Counter
from pathlib import Path

import grimp  # what import-linter, of which it is a dependency, sees imports with
import pytest

ROOT = Path(__file__).parent.parent
FAMILY_FOLDERS = {"tmc428", "tmc4361", "tmc5xxx", "tmcdrivers", "tmcl", "listed"}
REGISTRIES = {
    "app/calc/families.py",
    "app/procedures/families.py",
    "app/profiles/families.py",
    "app/registers/catalog.py",
    "app/devices/families.py",
    "app/emulators/families.py",
    "app/emulator_server/families.py",
    "web/src/families/families.ts",
}
VOCABULARY = {"app/registers/capabilities.py", "app/registers/names.py", "app/registers/wires.py"}
"""Who may name kinds of ramps and of links: words for what a chip can, which everybody may ask for."""
NAME = re.compile(r"tmc[_-]?\d{3,4}|tmc5xxx|pd42|tmcm|\b1241\b|(?<!ramp\.)sixpoint|landungs", re.IGNORECASE)

STILL_NAME_ONE = {
    "app": (2, "the demo and the command line say which chips stand on the bench"),
    "app/api": (12, "schemas of links and calculators, and views, are written by hand, one a family"),
    "app/calc": (6, "units, formats and calculators lie by subject, several families in one folder"),
    "app/emulators": (3, "boards carry chips of two families"),
    "app/profiles": (1, "descriptions of a document's tables say which chip has them"),
    "app/registers": (1, "the evaluation board's tables"),
    "web/src": (0, "pages ask the catalog"),
}


def without_words(path: Path) -> str:
    """The code of a file, without comments and docstrings: prose may say which chip does what."""
    text = path.read_text(encoding="utf-8")
    if path.suffix != ".py":
        return re.sub(r"/\*[\s\S]*?\*/|(?<!:)//.*", "", text)
    kept, fresh = [], True
    for token in tokenize.generate_tokens(io.StringIO(text).readline):
        if token.type == tokenize.COMMENT or (token.type == tokenize.STRING and fresh and "import" not in token.line):
            continue
        if token.type not in (tokenize.NL, tokenize.NEWLINE, tokenize.INDENT, tokenize.DEDENT):
            kept.append(token.string)
        fresh = token.type in (tokenize.NEWLINE, tokenize.NL, tokenize.INDENT, tokenize.DEDENT, tokenize.ENCODING)
    return "\n".join(kept)


def room_of(path: str) -> str:
    parts = path.split("/")
    return "web/src" if parts[0] == "web" else "/".join(parts[:2]) if len(parts) > 2 else parts[0]


@pytest.fixture(scope="module")
def naming() -> dict[str, list[str]]:
    found: dict[str, list[str]] = {room: [] for room in STILL_NAME_ONE}
    for folder, suffixes in (("app", {".py"}), ("web/src", {".ts", ".tsx"})):
        for path in sorted((ROOT / folder).rglob("*")):
            name = path.relative_to(ROOT).as_posix()
            if (
                path.suffix not in suffixes
                or ".test." in name
                or name in REGISTRIES | VOCABULARY
                or name.endswith("schema.d.ts")
            ):
                continue
            if FAMILY_FOLDERS & set(path.relative_to(ROOT).parts[:-1]) or path.name.startswith(("tmc", "sixpoint")):
                continue
            if NAME.search(without_words(path)):
                found.setdefault(room_of(name), []).append(name)
    return found


def test_nobody_else_names_a_family(naming: dict[str, list[str]]) -> None:
    more = {room: files for room, files in naming.items() if len(files) > STILL_NAME_ONE.get(room, (0, ""))[0]}
    assert not more, "ask for a capability instead, or move it into the family's folder"


def test_the_list_says_no_more_than_there_is(naming: dict[str, list[str]]) -> None:
    counted = Counter({room: len(files) for room, files in naming.items()})
    assert {room: counted[room] for room in STILL_NAME_ONE} == {
        room: most for room, (most, _) in STILL_NAME_ONE.items()
    }


FLOORS_MAX = 5


def floors(imports: dict[str, set[str]]) -> dict[str, int]:
    """By room: one above the highest of those that it imports. A room in a circle, or above one, has none."""
    found: dict[str, int] = {}
    while ready := [room for room, below in imports.items() if room not in found and below <= found.keys()]:
        found |= {room: 1 + max((found[each] for each in imports[room]), default=0) for room in ready}
    return found


def room_in_devices(module: str) -> str:
    """Of `app.devices.core.session` it is `core`: a folder, or a module beside the folders."""
    return module.split(".")[2]


def test_drivers_stand_on_few_floors() -> None:
    graph = grimp.build_graph("app", cache_dir=None)
    modules = {name for name in graph.modules if name.startswith("app.devices.")}
    imports = {name: graph.find_modules_directly_imported_by(name) & modules for name in modules}
    circled = modules - floors(imports).keys()
    assert not circled, "these import each other, or what does"
    rooms: dict[str, set[str]] = {room_in_devices(name): set() for name in modules}
    for name, below in imports.items():
        rooms[room_in_devices(name)] |= {room_in_devices(each) for each in below} - {room_in_devices(name)}
    found = floors(rooms)
    assert found.keys() == rooms.keys() > FAMILY_FOLDERS, "rooms that import each other"
    assert max(found.values()) <= FLOORS_MAX, found
    assert len({found[family] for family in FAMILY_FOLDERS}) == 1, "no family stands on another"


def test_floors_are_counted_and_circles_seen() -> None:
    assert floors({"a": set(), "b": {"a"}, "c": {"a", "b"}}) == {"a": 1, "b": 2, "c": 3}
    assert floors({"a": set(), "b": {"c"}, "c": {"b"}, "d": {"c"}}) == {"a": 1}
