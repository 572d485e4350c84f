"""Chips of one's own and of lists in a browser: a register map inside the form, and a chip that a search proposes."""

from __future__ import annotations

import signal
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import httpx
import pytest
from playwright.sync_api import Page, expect

from app.links.datagram_uart import UartForm
from app.registers import catalog
from tests.e2e.conftest import Errors
from tests.e2e.test_connections import open_form, remove
from tests.registers.maps.test_reader import TOLD

NAME, MAP = "second", "own-core"
LISTED = next(
    model for model in catalog.listings() if model.kind == "chip" and model.uart and not model.name.endswith("-listed")
)


@pytest.fixture(autouse=True)
def _as_before(api: httpx.Client) -> Iterator[None]:
    yield
    api.delete(f"/devices/{NAME}")
    api.delete(f"/register-maps/{MAP}")


@pytest.fixture
def wire(tmp_path: Path) -> Iterator[Path]:
    """An emulated listed chip at node 2 of a serial port."""
    program, path = str(Path(sys.executable).with_name("stepscope")), tmp_path / "wire"
    command = [program, "emulate", LISTED.name, "--pty", str(path), "--node", "2"]
    process = subprocess.Popen(command, stdout=subprocess.PIPE)
    assert process.stdout is not None
    assert b"emulated" in process.stdout.readline(), "it says where it is when it is there"
    yield path
    process.send_signal(signal.SIGINT)
    process.wait(30)
    process.stdout.close()


def test_a_register_map_becomes_the_model_of_the_form(
    page: Page, api: httpx.Client, errors: Errors, tmp_path: Path
) -> None:
    errors.expect("status of 422")  # the file is wrong at first
    errors.expect("status of 404")  # a reading that is under way when the device goes
    file = tmp_path / f"{MAP}.toml"
    file.write_bytes(TOLD.replace(b'role = "mode"', b'role = "modus"').replace(b"address = 0x3ff", b"address = 0x400"))
    open_form(page)
    form = page.get_by_role("form", name="Add a device")

    def choose() -> None:
        with page.expect_file_chooser() as chooser:
            form.get_by_role("button", name="A chip of your own, from a register map").click()
        chooser.value.set_files(file)

    choose()
    mistakes = form.get_by_role("list", name=f"Mistakes in {MAP}.toml").get_by_role("listitem")
    expect(mistakes).to_have_text(
        [
            "line 21 register CTRL, field how, role: is 'modus', allowed is 'mode'",
            "line 28 register WHERE, address: is 1024, allowed is 1023 or less",
        ]
    )
    file.write_bytes(TOLD)
    choose()
    expect(form.get_by_role("combobox", name="Model")).to_have_value("Own datagrams · 1 axis · your map")
    expect(mistakes).to_have_count(0)
    form.get_by_label("Name", exact=True).fill(NAME)
    form.get_by_role("button", name="Add and connect").click()
    entry = page.get_by_role("region", name=NAME)
    expect(entry).to_have_attribute("data-state", "connected")
    assert api.get(f"/devices/{NAME}").json()["model"] == MAP
    api.put(f"/devices/{NAME}/registers/SPEED", json={"value": 700}).raise_for_status()
    entry.get_by_role("link", name="Registers").click()
    expect(page.get_by_role("rowheader", name="SPEED")).to_be_visible()
    page.goto("/connections")
    remove(page)


def test_a_listed_chip_on_a_uart_is_found_and_one_says_which_it_is(page: Page, api: httpx.Client, wire: Path) -> None:
    page.goto("/connections")
    search = page.get_by_role("region", name="Look for modules")
    search.get_by_text("Chips on a UART", exact=True).click()
    search.get_by_label("Port or address").fill(str(wire))
    search.get_by_label("Nodes").fill("1-2")
    search.get_by_role("button", name="Probe").click()
    found = search.get_by_label("Modules found").get_by_role("listitem").filter(has_text="version 0x00")
    expect(found).to_contain_text("node 2", timeout=30_000)
    beyond = page.evaluate("document.scrollingElement.scrollWidth - document.documentElement.clientWidth")
    assert beyond <= 0, "the long name of the port breaks"
    found.get_by_label("Which chip is version 0x00 at node 2").select_option(label=LISTED.title)
    found.get_by_role("button", name="Add").click()
    form = page.get_by_role("form", name="Add a device")
    form.get_by_label("Name", exact=True).fill(NAME)
    form.get_by_role("button", name="Add and connect").click()
    expect(page.get_by_role("region", name=NAME)).to_have_attribute("data-state", "connected")
    device = api.get(f"/devices/{NAME}").json()
    assert (device["model"], device["link"]["kind"], device["link"]["node"]) == (LISTED.name, "uart", 2)
    counted = next(row for row in catalog.find_model(LISTED.name).table if row.name == "IFCNT")
    assert UartForm(2).read(counted.address)[1] == 2
