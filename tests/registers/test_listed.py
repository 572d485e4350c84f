"""Modules that the maker's package lists: all of them, by a reading of the package that shares nothing with ours."""

from __future__ import annotations

import importlib
import pkgutil
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest
import pytrinamic.modules
from pytrinamic.modules import TMCLModule

from app.errors import UnknownThing, UnreadableModel
from app.registers import catalog
from app.registers.listed import modules, package
from app.registers.listed.modules import read, role_of
from app.registers.listed.package import Listing, listing_of
from app.registers.model import Access, Space

NAMES = [model.name for model in catalog.listings() if model.kind == "module"]


def classes() -> dict[str, type[Any]]:
    """Every module class of the package, by the name that its title makes."""
    found = {}
    for info in pkgutil.iter_modules(pytrinamic.modules.__path__):
        kind = getattr(importlib.import_module(f"pytrinamic.modules.{info.name}"), info.name, None)
        if isinstance(kind, type) and issubclass(kind, TMCLModule) and kind is not TMCLModule:
            found[info.name] = kind
    return found


def numbers(kind: type[Any]) -> dict[str, int]:
    return {name: number for name, number in vars(kind).items() if not name.startswith("_") and isinstance(number, int)}


def test_every_module_of_the_package_is_listed_or_known_well() -> None:
    squeezed = {name.replace("-", "") for name in (*NAMES, *catalog.MODELS)}
    assert {name.replace("_", "").lower() for name in classes()} <= squeezed
    assert len(NAMES) + 1 == len(classes())  # one of them is known well
    assert not set(NAMES) & set(catalog.MODELS)


@pytest.mark.parametrize("name", NAMES)
def test_every_name_and_number_of_the_package_is_a_row(name: str) -> None:
    model = catalog.find_model(name)
    kind = classes()[package.listings()[name].class_name]
    made = kind(object())
    assert model.axes == len(made.motors)
    for axis, motor in enumerate(made.motors):
        rows = {row.name.split("_ap")[0]: row.address for row in model.table if row.axis == axis}
        assert rows == numbers(motor.AP)
    for bank, space in (("GP", Space.GLOBAL_0), ("GP0", Space.GLOBAL_0), ("GP3", Space.GLOBAL_3)):
        if hasattr(kind, bank):
            listed = {row.address for row in model.table if row.space is space}
            assert listed == set(numbers(getattr(kind, bank)).values())
    assert package.listings()[name].addresses == {
        number for motor in made.motors for number in numbers(motor.AP).values()
    }
    assert {role_of(row) for row in model.table if row.axis == 0} > set(modules.NEEDED)
    assert model.tier == "names"
    for row in model.table:  # nothing is made up
        assert row.reset is None
        assert (row.width, row.signed, row.unit) == (32, True, "")
        if row.space is Space.OUTPUT:
            assert (row.access, row.range) == (Access.RW, (0, 1))
        elif row.space in (Space.DIGITAL_IN, Space.ANALOG_IN):
            assert (row.access, row.range, row.volatile) == (Access.R, None, True)
        else:
            assert row.range is None
            assert row.access is Access.RW or role_of(row) is not None


@pytest.mark.parametrize("name", NAMES)
def test_every_port_whose_kind_is_told_is_a_row(name: str) -> None:
    model = catalog.find_model(name)
    kind = classes()[package.listings()[name].class_name]
    wanted = {
        space: numbers(getattr(kind, folder, type(None)))
        for folder, space in (("DI", Space.DIGITAL_IN), ("DO", Space.OUTPUT), ("AIN", Space.ANALOG_IN))
    }
    untold: dict[str, int] = {}
    for port, number in numbers(getattr(kind, "IO", type(None))).items():
        letters = port.rstrip("0123456789").rstrip("_")
        space = KINDS_OF_PORTS.get(letters)
        (untold if space is None else wanted[space])[port] = number
    for space, ports in wanted.items():
        assert {row.name: row.address for row in model.table if row.space is space} == ports
    assert set(untold) <= {"Home", "Enable", "STO", "STO1", "STO2"}
    for ports in wanted.values():
        for port in ports:  # a port goes by its name, though another has a number that reads like it (IN2 is in4)
            found = model.table.find(port)
            assert found is not None
            assert found[0].name == port


KINDS_OF_PORTS = {
    **dict.fromkeys(("OUT", "GPO"), Space.OUTPUT),
    **dict.fromkeys(("IN", "GPI"), Space.DIGITAL_IN),
    **dict.fromkeys(("AIN", "ADIN", "VIN", "Voltage", "Temperature"), Space.ANALOG_IN),
}


def test_names_of_values_come_from_constants_that_begin_with_the_parameter() -> None:
    found = [row for name in NAMES for row in catalog.find_model(name).table if row.name == "MicrostepResolution"]
    assert found
    named = [row for row in found if row.values]
    assert named
    assert {(row.values[0].lower(), int(row.values[8][:3])) for row in named} == {("fullstep", 256)}


def test_nothing_is_imported_until_a_module_is_asked_for() -> None:
    code = (
        "import sys, app.main; from app.registers import catalog; found = catalog.listings();"
        "assert found and not any(name.startswith('pytrinamic') for name in sys.modules);"
        "catalog.find_model(found[0].name); assert 'pytrinamic.modules' in sys.modules"
    )
    subprocess.run([sys.executable, "-c", code], check=True, cwd=Path(__file__).parent.parent.parent, timeout=120)


def test_without_the_package_nothing_is_listed_and_the_cure_is_told(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(package, "PACKAGE", "no_such_package_as_this")
    package.listings.cache_clear()
    package.version.cache_clear()
    try:
        assert catalog.listings() == ()
        with pytest.raises(UnknownThing, match=r"stepscope\[pytrinamic\]"):
            catalog.find_model(NAMES[0])
    finally:
        monkeypatch.undo()
        package.listings.cache_clear()
        package.version.cache_clear()


GOOD = '''
class Made(TMCLModule):
    """A module that was made up. It has no second sentence."""
    def __init__(self, connection, module_id=1):
        self.motors = [self._Motor(self, 0), self._Motor(self, 1)]

    class _Motor:
        def __init__(self, module, axis):
            pass

        class AP:
            TargetPosition = 0
            ActualPosition = 1
            TargetVelocity = 2
            ActualVelocity = 3
            MaxVelocity = 4
            MaxAcceleration = 5
            First = 6
            second = 6
            SECOND = 7
            Wide = 300

    class GP0:
        Baud = 65
'''


def write_module(folder: Path, text: str, monkeypatch: pytest.MonkeyPatch, name: str = "Made") -> Listing | None:
    """`text` as a module of a package of its own."""
    inside = folder / "somepackage" / "modules"
    inside.mkdir(parents=True, exist_ok=True)
    (inside / f"{name}.py").write_text(f"class TMCLModule:\n    pass\n\n{text}", encoding="utf-8")
    monkeypatch.syspath_prepend(folder)
    monkeypatch.setattr(package, "PACKAGE", "somepackage")
    for known in [known for known in sys.modules if known.split(".")[0] == "somepackage"]:
        monkeypatch.delitem(sys.modules, known)
    importlib.invalidate_caches()
    return listing_of(inside / f"{name}.py")


def test_a_module_of_another_version_is_read_as_it_is(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    listing = write_module(tmp_path, GOOD, monkeypatch)
    assert listing is not None
    assert (listing.title, listing.summary, listing.axes) == ("Made", "A module that was made up", 2)
    table = read(listing)
    assert [(row.name, row.when) for row in table if row.axis == 1 and row.address == 6] == [
        ("First", ""),
        ("second", "another name of First"),
    ]
    assert [row.name for row in table if row.address == 7] == ["SECOND_ap7", "SECOND_ap7"]
    wide = table.at(300, Space.AXIS, axis=1)
    assert wide is not None
    assert (wide.name, wide.axis) == ("Wide", 1)


@pytest.mark.parametrize(
    ("change", "why"),
    [
        (("self.motors = [", "self.engines = ["), "reading it fails"),
        (("self._Motor(self, 1)]", "self._Motor(self, 1)] * 2"), "tells of 2 axes, and its class of 4"),
        (("self.motors = [", "connection.send(1); self.motors = ["), r"asks the module for something \(send\)"),
        (("MaxAcceleration = 5", ""), "nothing that would be the max_acceleration of axis 0"),
        (("Wide = 300", "Wide = 5000"), "Wide has the number 5000"),
        (("Baud = 65", "Baud = 256"), "Baud has the number 256"),
        (("class GP0:", "raise OSError('broken')\n\n    class GP0:"), "OSError: broken"),
    ],
)
def test_what_cannot_be_read_says_why(
    change: tuple[str, str], why: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    listing = write_module(tmp_path, GOOD.replace(*change), monkeypatch)
    assert listing is not None
    with pytest.raises(UnreadableModel, match=why):
        read(listing)


@pytest.mark.parametrize("text", ["", "class Other(TMCLModule):\n    pass\n", "class Made(object):\n    pass\n"])
def test_a_file_about_no_module_is_passed_over(text: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    assert write_module(tmp_path, text, monkeypatch) is None


def test_a_file_that_is_no_text_is_passed_over(tmp_path: Path) -> None:
    (tmp_path / "Made.py").write_bytes(b"\xff\xfe\x00class Made(TMCLModule):")
    assert listing_of(tmp_path / "Made.py") is None
    assert listing_of(tmp_path / "None.py") is None
