"""`stepscope doctor`: what on this machine would keep stepscope from working, and what to do about each."""

from __future__ import annotations

import glob
import os
import platform
import shutil
import sys
from collections.abc import Callable, Iterator
from dataclasses import asdict, dataclass
from importlib import metadata, util
from pathlib import Path
from typing import Annotated, Literal

import typer

from .. import __version__
from ..listening import CannotListen, listen
from ..settings import Settings
from .shared import AsJson, print_json

State = Literal["well", "note", "wrong"]
SIGNS: dict[State, tuple[str, str]] = {"well": ("ok", "green"), "note": ("--", "yellow"), "wrong": ("!!", "red")}
FREE_BYTES_MIN = 1 << 30
"""Below this a few long recordings fill the disk."""
EXTRAS = {
    "can": ("can", "CAN links"),
    "pytrinamic": ("pytrinamic", "the maker's list of further models"),
    "spidev": ("spidev", "SPI buses of this machine"),
}
"""Optional parts by name: what to import, and what for."""
REINSTALL = f"{sys.executable} -m pip install --upgrade stepscope"


@dataclass(frozen=True, slots=True)
class Finding:
    """One thing that was looked at: how it is, and what to do where it is not well."""

    what: str
    state: State
    detail: str
    remedy: str = ""


def doctor(
    data_dir: Annotated[Path | None, typer.Option(help="The server's. [default: STEPSCOPE_DATA_DIR, or usual]")] = None,
    port: Annotated[int | None, typer.Option(help="The server's.", min=0, max=65535)] = None,
    as_json: AsJson = False,
) -> None:
    """Tell what is wrong with versions, data directory, compiled parts, ports and permissions. Changes nothing.

    Exit code 1 where something keeps stepscope from working.
    """
    try:
        given = {name: value for name, value in {"data_dir": data_dir, "port": port}.items() if value is not None}
        settings = Settings(**given)  # type: ignore[arg-type]  # checked by pydantic
    except ValueError as error:
        typer.secho(f"stepscope: {error}", fg="red", err=True)
        raise typer.Exit(2) from error
    found: list[Finding] = []
    for check in CHECKS:
        try:
            found += check(settings)
        except ImportError as error:  # a package is broken: what does not need it is looked at all the same
            found.append(Finding(check.__name__.replace("_", " "), "wrong", f"cannot be told: {error}", REINSTALL))
    if as_json:
        print_json([asdict(finding) for finding in found])
    else:
        for finding in found:
            sign, colour = SIGNS[finding.state]
            typer.echo(f"{typer.style(sign, fg=colour)}  {finding.what}: {finding.detail}")
            if finding.remedy:
                typer.echo(f"      {finding.remedy}")
    if any(finding.state == "wrong" for finding in found):
        raise typer.Exit(1)


def versions(settings: Settings) -> Iterator[Finding]:
    """Which stepscope, Python and optional parts these are."""
    del settings
    where = Path(__file__).parents[1]
    yield Finding("version", "well", f"stepscope {__version__} in {where}, Python {platform.python_version()}")
    for extra, (module, what_for) in EXTRAS.items():
        if util.find_spec(module) is None:
            yield Finding(extra, "note", f"not installed: no {what_for}", f'pip install "stepscope[{extra}]"')
        else:
            yield Finding(extra, "well", f"{_version_of(extra, module)}, for {what_for}")


def packages(settings: Settings) -> Iterator[Finding]:
    """Whether what stepscope stands on is there, in versions that it goes with."""
    del settings
    from packaging.requirements import Requirement

    try:
        lines = metadata.requires("stepscope") or []
    except metadata.PackageNotFoundError:
        yield Finding("packages", "note", "stepscope is not installed here, but run from its source")
        return
    needed = [one for one in map(Requirement, lines) if one.marker is None or one.marker.evaluate({"extra": ""})]
    wrong = []
    for one in needed:
        try:
            found = metadata.version(one.name)
        except metadata.PackageNotFoundError:
            wrong.append(f"{one.name} is missing")
        else:
            if not one.specifier.contains(found, prereleases=True):
                wrong.append(f"{one.name} {found} is installed, {one.specifier} is needed")
    if wrong:
        yield Finding("packages", "wrong", "; ".join(wrong), REINSTALL)
    else:
        yield Finding("packages", "well", f"all {len(needed)} are there, in versions that go with it")


def _version_of(extra: str, module: str) -> str:
    for name in (extra, f"python-{module}"):
        try:
            return f"{name} {metadata.version(name)}"
        except metadata.PackageNotFoundError:
            continue
    return extra


def page(settings: Settings) -> Iterator[Finding]:
    """Whether the browser UI and the help are there."""
    from ..api.http.page import INDEX, BuiltFiles  # imports Starlette, 0.1 s

    if BuiltFiles(settings.web_dir).find(INDEX) is not None:
        yield Finding("page", "well", str(settings.web_dir))
    else:
        yield Finding(
            "page", "wrong", f"{settings.web_dir} has no page", "install the wheel, or `make web` in a checkout"
        )
    if BuiltFiles(settings.help_dir).find(INDEX) is None:
        cure = "install the wheel, or `make help-site` in a checkout"
        yield Finding("help", "wrong", f"{settings.help_dir} has no help", cure)


def directory(settings: Settings) -> Iterator[Finding]:
    """Whether recordings and connections can be kept."""
    folder = settings.data_dir
    above = next(path for path in (folder, *folder.parents) if path.exists())
    if not above.is_dir() or not os.access(above, os.W_OK | os.X_OK):
        yield Finding("data directory", "wrong", f"{above} cannot be written", "choose another one: --data-dir PATH")
        return
    free = shutil.disk_usage(above).free
    told = f"{folder}, {free / 1e9:.1f} GB free" if folder.exists() else f"{folder}, made at the first start"
    if free < FREE_BYTES_MIN:
        yield Finding("data directory", "note", told, "make room: recordings end before the disk is full")
    else:
        yield Finding("data directory", "well", told)


def kernels(settings: Settings) -> Iterator[Finding]:
    """Whether emulators and calculators are compiled already."""
    del settings
    from .. import preparation  # imports Numba, 0.5 s
    from ..kernels import all_compiled, kept_in

    folder = kept_in()
    if folder is None:
        remedy = "set NUMBA_CACHE_DIR to a folder that may be written"
        yield Finding("compiled parts", "note", "can be kept nowhere: each start compiles them for a minute", remedy)
    elif all_compiled():
        yield Finding("compiled parts", "well", f"kept in {folder}")
    else:
        module = preparation.__name__
        remedy = f"the first start does it in the background; or now: {sys.executable} -m {module}"
        yield Finding("compiled parts", "note", f"not compiled yet, to be kept in {folder}", remedy)


def address(settings: Settings) -> Iterator[Finding]:
    """Whether the server can listen."""
    try:
        listen(settings.host, settings.port).close()
    except CannotListen as error:
        yield Finding("address", "note", str(error))
    else:
        yield Finding("address", "well", f"{settings.host}:{settings.port} is free")


def serial_lines(settings: Settings) -> Iterator[Finding]:
    """Serial ports, and whether they may be opened."""
    del settings
    from serial.tools import list_ports

    names = sorted(port.device for port in list_ports.comports())
    yield from _devices("serial ports", names, "dialout", "plug the adapter in; virtual machines have to pass it on")


def spi_buses(settings: Settings) -> Iterator[Finding]:
    """SPI buses of this machine, and whether they may be opened."""
    del settings
    if sys.platform == "linux":
        buses = sorted(glob.glob("/dev/spidev*"))  # names are what is shown
        yield from _devices("SPI buses", buses, "spi", "on a Raspberry Pi: raspi-config, interface options, SPI")


def _devices(what: str, names: list[str], group: str, none: str) -> Iterator[Finding]:
    if not names:
        yield Finding(what, "note", "none found", none)
        return
    closed = [name for name in names if not os.access(name, os.R_OK | os.W_OK)] if os.name == "posix" else []
    if closed:
        remedy = f"sudo usermod -aG {group} {os.environ.get('USER', '$USER')}, then log in anew"
        yield Finding(what, "wrong", f"{', '.join(closed)} may not be opened by this user", remedy)
    opened = [name for name in names if name not in closed]
    if opened:
        yield Finding(what, "well", ", ".join(opened))


CHECKS: tuple[Callable[[Settings], Iterator[Finding]], ...] = (
    versions,
    packages,
    page,
    directory,
    kernels,
    address,
    serial_lines,
    spi_buses,
)
