"""The law of the house: outside its own folders nobody names a model or a family.

What still does is listed, each file with its reason.
"""

from __future__ import annotations

import io
import re
import tokenize
from pathlib import Path

import grimp  # what import-linter, of which it is a dependency, sees imports with

ROOT = Path(__file__).parent.parent
FAMILY_FOLDERS = {"tmc428", "tmc4361", "tmc5xxx", "tmcdrivers", "tmcl", "listed"}
REGISTRIES = {
    "app/calc/families.py",
    "app/procedures/families.py",
    "app/profiles/families.py",
    "app/registers/catalog.py",
    "app/studies/families.py",
    "app/devices/families.py",
    "app/emulators/families.py",
    "app/emulator_server/families.py",
    "web/src/families/families.ts",
}
VOCABULARY = {"app/registers/capabilities.py", "app/registers/names.py", "app/registers/wires.py"}
"""Who may name kinds of ramps and of links: words for what a chip can, which everybody may ask for."""
NAME = re.compile(r"tmc[_-]?\d{3,4}|tmc5xxx|pd42|tmcm|\b1241\b|(?<!ramp\.)sixpoint|landungs", re.IGNORECASE)

STILL_NAME_ONE = {
    "app/api/calc/ramps.py": "finds a design for every kind of ramp, and each is asked in its own fields",
    "app/api/calc/routes.py": "one calculator, one route: which fields it takes is a family's",
    "app/api/calc/schemas.py": "the contract's fields for a ramp, which a chip's registers bear out",
    "app/api/calc/units.py": "one request takes the units of every family, by its `model` field",
    "app/api/catalog/schemas.py": "two descriptions give an example",
    "app/api/devices/schemas.py": "the contract's links: their `kind` and models tell a body what it is",
    "app/api/devices/views.py": "makes a configuration of each kind of link of the contract",
    "app/api/links/schemas.py": "descriptions say which adapter has what was found",
    "app/api/motion/schemas.py": "descriptions of a search say which parameter of the module a field sets",
    "app/api/profiles/schemas.py": "the example of a model",
    "app/api/profiles/script_schemas.py": "the example of a model",
    "app/api/schemas.py": "descriptions say which models need a field of an axis",
    "app/calc/driver_chain/signals.py": "driver chips, which are behind a controller: no family of ours",
    "app/calc/ramps/pmul_pdiv.py": "imports one family's units: the ramp is made of its registers",
    "app/calc/ramps/pmul_pdiv_inverse.py": "the same",
    "app/calc/ramps/pmul_pdiv_table.py": "the same",
    "app/calc/ramps/sramp_warnings.py": "a warning names the section that it is from",
    "app/calc/ramps/ticked.py": "imports the family's units: the same ramp as pmul_pdiv.py",
    "app/cli.py": "help gives examples of models",
    "app/demo.py": "somebody has to say which chips stand on the demo's bench",
    "app/emulators/board/board.py": "an evaluation board carries a chip of either of two families",
    "app/emulators/board/build.py": "the same",
    "app/emulators/board/options.py": "the same",
    "app/profiles/document.py": "descriptions of a document's tables say which chip has them",
    "app/registers/evaluation_board.py": "the board's own table of what may be in its slots",
}
"""Files that do, each with its reason. It may only become shorter."""


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


def who_names_one() -> set[str]:
    """Files outside the families' folders, from the root, whose code names a model or a family."""
    found = set()
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
                found.add(name)
    return found


def test_nobody_else_names_a_family() -> None:
    found = who_names_one()
    more = found - STILL_NAME_ONE.keys()
    assert not more, "ask for a capability instead, or move it into the family's folder"
    assert found == STILL_NAME_ONE.keys(), "the list says no more than there is"


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
