"""Connections in a browser: chips come and go, here and behind a socket, and so may the server."""

from __future__ import annotations

import re
import signal
import subprocess
import sys
from collections.abc import Callable, Iterator
from pathlib import Path

import httpx
import pytest
from playwright.sync_api import Page, expect
from server_process import ServerProcess, free_port

from tests.e2e.conftest import DESKTOP, PHONE, Errors
from tests.e2e.held import Held

NAME = "second"


@pytest.fixture(autouse=True)
def without_the_second(api: httpx.Client) -> Iterator[None]:
    yield
    api.delete(f"/devices/{NAME}")


@pytest.fixture
def far_chip() -> Iterator[tuple[int, subprocess.Popen[bytes]]]:
    """An emulated TMC428 in another process: its port, and the process."""
    port = free_port()
    command = [str(Path(sys.executable).with_name("stepscope")), "emulate", "tmc428", "--tcp", f"127.0.0.1:{port}"]
    process = subprocess.Popen(command, stdout=subprocess.PIPE)
    assert process.stdout is not None
    assert str(port).encode() in process.stdout.readline(), "it says where it listens when it does"
    yield port, process
    process.send_signal(signal.SIGINT)
    process.wait(30)
    process.stdout.close()


@pytest.fixture
def far_modules() -> Iterator[int]:
    """Two emulated modules on one line in another process, addresses 1 and 3: the port that they are behind."""
    port = free_port()
    program = str(Path(sys.executable).with_name("stepscope"))
    command = [program, "emulate", "pd42-1241", "--tcp", f"127.0.0.1:{port}", "--address", "1", "--address", "3"]
    process = subprocess.Popen(command, stdout=subprocess.PIPE)
    assert process.stdout is not None
    assert str(port).encode() in process.stdout.readline(), "it says where it listens when it does"
    yield port
    process.send_signal(signal.SIGINT)
    process.wait(30)
    process.stdout.close()


@pytest.fixture
def far_board() -> Iterator[int]:
    """An emulated evaluation board with a TMC4361 in another process: the port that it is behind."""
    port = free_port()
    program = str(Path(sys.executable).with_name("stepscope"))
    process = subprocess.Popen(
        [program, "emulate", "landungsbruecke", "--tcp", f"127.0.0.1:{port}"], stdout=subprocess.PIPE
    )
    assert process.stdout is not None
    assert str(port).encode() in process.stdout.readline(), "it says where it listens when it does"
    yield port
    process.send_signal(signal.SIGINT)
    process.wait(30)
    process.stdout.close()


def open_form(page: Page) -> None:
    page.goto("/connections")
    expect(page.get_by_role("region", name="bench")).to_contain_text("connected")
    page.get_by_role("button", name="Add a device").click()
    page.get_by_label("Name", exact=True).fill(NAME)


def remove(page: Page) -> None:
    page.get_by_role("region", name=NAME).get_by_role("button", name="Remove").click()
    page.get_by_role("dialog").get_by_role("button", name="Remove").click()
    expect(page.get_by_role("region", name=NAME)).to_have_count(0)


def test_an_emulated_chip_is_added_and_removed(page: Page, api: httpx.Client) -> None:
    open_form(page)
    page.get_by_role("button", name="Add and connect").click()
    expect(page.get_by_role("region", name=NAME)).to_contain_text("connected")
    assert api.get(f"/devices/{NAME}").raise_for_status().json()["state"] == "connected"
    page.get_by_role("region", name=NAME).get_by_role("link", name="First run").click()
    expect(page.get_by_role("region", name=re.compile(f"^{NAME} ·"))).to_contain_text("0 of 9 done")
    page.get_by_role("navigation", name="Pages").first.get_by_role("link", name="Connections").click()
    remove(page)
    assert api.get(f"/devices/{NAME}").status_code == 404


def test_thresholds_of_the_encoder_are_set_and_emptied_in_the_form(page: Page, api: httpx.Client) -> None:
    def kept() -> list[int | None]:
        axis = api.get(f"/devices/{NAME}").raise_for_status().json()["axes"][0]
        return [axis["lost_steps_microsteps"], axis["following_error_microsteps"]]

    api.post("/devices", json={"name": NAME, "model": "tmc5130", "link": {"kind": "emulator"}}).raise_for_status()
    page.goto("/connections")
    entry = page.get_by_role("region", name=NAME)
    entry.get_by_role("button", name="Edit").click()
    page.get_by_text("Encoder thresholds").click()
    lost = page.get_by_label("Lost steps from [µsteps]")
    lost.fill("0")
    expect(page.get_by_text("Wanted: a whole number, 1 to")).to_be_visible()
    lost.fill("700")
    page.get_by_label("Following error from [µsteps]").fill("1900")
    page.get_by_role("button", name="Save").click()
    expect(page.get_by_role("form")).to_have_count(0)
    assert kept() == [700, 1900]
    entry.get_by_role("button", name="Edit").click()
    expect(lost).to_have_value("700")
    lost.fill("")
    page.get_by_role("button", name="Save").click()
    expect(page.get_by_role("form")).to_have_count(0)
    assert kept() == [None, 1900]


def test_a_name_is_needed_and_asked_for(page: Page) -> None:
    open_form(page)
    page.get_by_label("Name", exact=True).fill("")
    page.get_by_role("button", name="Add and connect").click()
    expect(page.get_by_role("alert").filter(has_text="Not saved yet")).to_be_visible()


def test_a_chip_behind_a_socket(
    page: Page, api: httpx.Client, errors: Errors, far_chip: tuple[int, subprocess.Popen[bytes]]
) -> None:
    errors.expect("status of 404")  # a reading that is under way when the device goes
    port, process = far_chip
    open_form(page)
    page.get_by_text("TCP", exact=True).click()
    page.get_by_label("Port", exact=True).fill(str(port))
    page.get_by_role("button", name="Test the link").click()
    expect(page.get_by_role("form")).to_contain_text("It answers")
    page.get_by_role("button", name="Add and connect").click()
    entry = page.get_by_role("region", name=NAME)
    expect(entry).to_contain_text("connected")
    written = api.put(f"/devices/{NAME}/registers/V_MAX", params={"axis": 1}, json={"value": 1234})
    assert written.raise_for_status().json()["value"] == 1234
    process.send_signal(signal.SIGINT)
    process.wait(30)
    expect(entry).not_to_have_attribute("data-state", "connected", timeout=20_000)
    expect(entry.get_by_role("alert")).to_be_visible(timeout=20_000)
    remove(page)


def test_nobody_asks_for_the_wire_of_a_device_that_is_being_removed(page: Page, api: httpx.Client) -> None:
    api.post("/devices", json={"name": NAME, "model": "tmc428", "link": {"kind": "emulator"}}).raise_for_status()
    page.clock.install()
    page.goto("/connections")
    entry = page.get_by_role("region", name=NAME)
    expect(entry).to_contain_text("connected")
    with page.expect_request(f"**/devices/{NAME}/link"):
        page.clock.run_for(1500)
    held = Held(page, f"**/devices/{NAME}")
    entry.get_by_role("button", name="Remove").click()
    with page.expect_request(f"**/devices/{NAME}"):
        page.get_by_role("dialog").get_by_role("button", name="Remove").click()
    asked: list[str] = []
    page.on("request", lambda request: asked.append(request.url) if f"/devices/{NAME}/" in request.url else None)
    page.clock.run_for(5000)
    assert asked == []
    held.let_one_go()
    page.clock.resume()
    expect(entry).to_have_count(0)


def test_an_emulated_chip_whose_velocity_can_be_written_in_velocity_mode(page: Page, api: httpx.Client) -> None:
    open_form(page)
    page.get_by_role("button", name="Emulator: time").click()
    page.get_by_role("combobox", name="V_ACTUAL can be written in").click()
    page.get_by_role("option", name="velocity mode too").click()
    page.get_by_role("button", name="Add and connect").click()
    expect(page.get_by_role("region", name=NAME)).to_contain_text("connected")
    assert api.get(f"/devices/{NAME}/emulator").json()["v_actual_writable"] == "velocity-mode"


def test_an_emulated_module_is_added_with_a_load_on_its_shaft(page: Page, api: httpx.Client) -> None:
    open_form(page)
    page.get_by_role("combobox", name="Model").click()
    page.get_by_role("option", name="PD42-1241").click()
    page.get_by_role("button", name="Emulator: motor").click()
    page.get_by_label("Load torque [N m]").fill("99")
    page.get_by_role("button", name="Add and connect").click()
    expect(page.get_by_role("alert").filter(has_text="Not saved yet")).to_be_visible()
    page.get_by_label("Load torque [N m]").fill("0.05")
    page.get_by_role("button", name="Add and connect").click()
    entry = page.get_by_role("region", name=NAME)
    expect(entry).to_contain_text("connected")
    expect(entry).to_contain_text("calls/s, no limit of the wire")
    assert api.get(f"/devices/{NAME}").json()["link"]["load"] == {"torque_nm": 0.05}
    entry.get_by_role("link", name="Parameters").click()
    expect(page).to_have_title("Parameters · stepscope")
    expect(page.get_by_role("rowheader", name="Target position")).to_be_visible()
    page.goto("/connections")
    remove(page)


def test_modules_on_a_line_are_found_and_added(page: Page, api: httpx.Client, far_modules: int) -> None:
    page.goto("/connections")
    search = page.get_by_role("region", name="Look for modules")
    search.get_by_role("button", name="Probe").click()
    expect(search).to_contain_text("Choose a port")
    search.get_by_label("Port or address").fill(f"socket://127.0.0.1:{far_modules}")
    search.get_by_label("Addresses").fill("1-4")
    search.get_by_role("button", name="Probe").click()
    found = search.get_by_label("Modules found").get_by_role("listitem")
    expect(found).to_have_count(2, timeout=20_000)
    expect(found.nth(1)).to_contain_text("1241V144")
    expect(search.get_by_role("button", name="Abort")).to_have_count(0, timeout=20_000)
    found.nth(1).get_by_role("button", name="Add").click()
    form = page.get_by_role("form", name="Add a device")
    expect(form.get_by_label("Module address")).to_have_value("3")
    form.get_by_label("Name", exact=True).fill(NAME)
    form.get_by_role("button", name="Test the link").click()
    expect(form).to_contain_text("It answers")
    form.get_by_role("button", name="Add and connect").click()
    entry = page.get_by_role("region", name=NAME)
    expect(entry).to_have_attribute("data-state", "connected")
    expect(entry).to_contain_text("address 3")
    assert api.get(f"/devices/{NAME}/registers/gp0_66").json()["value"] == 3
    remove(page)


def test_an_evaluation_board_is_found_and_its_chip_added(page: Page, api: httpx.Client, far_board: int) -> None:
    page.goto("/connections")
    search = page.get_by_role("region", name="Look for modules")
    search.get_by_label("Port or address").fill(f"socket://127.0.0.1:{far_board}")
    search.get_by_label("Addresses").fill("1")
    search.get_by_role("button", name="Probe").click()
    # What an earlier search has found stands there until this one begins.
    found = search.get_by_label("Modules found").get_by_role("listitem").filter(has_text="Landungsbrücke")
    expect(found).to_contain_text("Landungsbrücke with TMC4361A and TMC2660", timeout=20_000)
    found.get_by_role("button", name="Add").click()
    form = page.get_by_role("form", name="Add a device")
    form.get_by_label("Name", exact=True).fill(NAME)
    form.get_by_role("button", name="Test the link").click()
    expect(form).to_contain_text("It answers")
    form.get_by_role("button", name="Add and connect").click()
    entry = page.get_by_role("region", name=NAME)
    expect(entry).to_have_attribute("data-state", "connected")
    expect(entry).to_contain_text("evaluation board at socket://")
    assert api.get(f"/devices/{NAME}/registers/AMAX").json()["value"] == 320_000
    remove(page)


def test_an_spi_bus_that_is_not_there_is_told_with_a_way_out(page: Page) -> None:
    open_form(page)
    page.get_by_role("combobox", name="Model").click()
    page.get_by_role("option", name="TMC4361").click()
    page.get_by_text("SPI bus", exact=True).click()
    form = page.get_by_role("form", name="Add a device")
    form.get_by_label("Bus", exact=True).fill("250")
    form.get_by_role("button", name="Test the link").click()
    problem = form.get_by_role("alert").filter(has_text="The link does not work")
    expect(problem).to_contain_text("spidev")


def test_a_search_is_aborted(page: Page, far_modules: int) -> None:
    page.goto("/connections")
    search = page.get_by_role("region", name="Look for modules")
    search.get_by_label("Port or address").fill(f"socket://127.0.0.1:{far_modules}")
    search.get_by_label("Addresses").fill("1-255")
    search.get_by_role("button", name="Probe").click()
    search.get_by_role("button", name="Abort").click()
    expect(search.get_by_role("button", name="Abort")).to_have_count(0)
    expect(search.get_by_role("button", name="Probe")).to_be_enabled()


def test_a_port_that_is_not_there_is_told_with_a_way_out(page: Page, api: httpx.Client) -> None:
    open_form(page)
    page.get_by_role("combobox", name="Model").click()
    page.get_by_role("option", name="PD42-1241").click()
    page.get_by_text("Serial", exact=True).click()
    form = page.get_by_role("form", name="Add a device")
    form.get_by_label("Port or address").fill("/dev/ttyNOWHERE")
    form.get_by_role("button", name="Test the link").click()
    problem = form.get_by_role("alert").filter(has_text="The link does not work")
    expect(problem).to_contain_text("/dev/ttyNOWHERE")
    assert api.get(f"/devices/{NAME}").status_code == 404


@pytest.mark.parametrize(
    ("model", "kind"),
    [
        *(("PD42-1241", kind) for kind in ("Serial", "TCP", "CAN", "Emulated here")),
        *(("TMC4361", kind) for kind in ("Eval board", "SPI bus")),
    ],
)
def test_every_kind_of_link_is_open_to_everybody(
    page: Page, check_axe: Callable[[Page], None], model: str, kind: str
) -> None:
    open_form(page)
    page.get_by_role("combobox", name="Model").click()
    page.get_by_role("option", name=model).click()
    page.get_by_text(kind, exact=True).click()
    if kind == "Emulated here":
        page.get_by_role("button", name="Emulator: motor").click()
    for size in (DESKTOP, PHONE):
        page.set_viewport_size(size)
        check_axe(page)
        sideways = page.evaluate("document.scrollingElement.scrollWidth - document.documentElement.clientWidth")
        assert sideways <= 0


def test_a_server_that_goes_and_comes_back(page: Page, errors: Errors, tmp_path: Path) -> None:
    # a part that comes behind the first page may not be there yet: that is told, and the page goes on
    errors.expect("ERR_CONNECTION_REFUSED|ERR_EMPTY_RESPONSE|ERR_CONNECTION_RESET|WebSocket|Failed to fetch|preload")
    with ServerProcess(tmp_path, "--demo") as server:
        page.goto(server.url)
        expect(page.get_by_test_id("server-status")).to_have_text("2 of 2 connected")
        port = int(server.url.rpartition(":")[2])
        assert server.stop() == 0, server.log()
        expect(page.get_by_test_id("disconnected")).to_be_visible(timeout=15_000)
        server.start(port)
        expect(page.get_by_test_id("disconnected")).to_have_count(0, timeout=15_000)
        expect(page.get_by_test_id("link-readout").first).to_contain_text("live", timeout=15_000)


def test_stop_and_every_page_outlive_a_server_that_is_away(page: Page, errors: Errors, tmp_path: Path) -> None:
    errors.expect("ERR_CONNECTION_REFUSED|ERR_EMPTY_RESPONSE|ERR_CONNECTION_RESET|WebSocket|Failed to fetch|preload")
    with ServerProcess(tmp_path, "--demo") as server:
        page.goto(server.url)
        expect(page.get_by_test_id("server-status")).to_have_text("2 of 2 connected")
        port = int(server.url.rpartition(":")[2])
        assert server.stop() == 0, server.log()
        # nothing was fetched but the first page: what says that the stop failed is there all the same
        for how in ("button", "key"):
            if how == "button":
                page.get_by_test_id("stop-all").click()
            else:
                page.keyboard.press("Escape")
            said = page.get_by_role("alert").filter(has_text="Stop failed")
            expect(said).to_contain_text("cut its power")
            said.get_by_role("button").click()
            expect(said).to_have_count(0)
        expect(page.get_by_test_id("disconnected")).to_be_visible(timeout=15_000)
        page.get_by_role("button", name="Keyboard shortcuts").click()  # a part that is fetched when it is wanted
        expect(page.get_by_text("A part of this page could not be loaded")).to_be_visible()
        for name in ("Registers", "Audit log", "Connections"):
            page.get_by_role("navigation").first.get_by_role("link", name=name).click()
            expect(page.get_by_test_id("not-loaded")).to_be_visible()
            expect(page.get_by_test_id("stop-all")).to_be_visible()
        page.get_by_role("navigation").first.get_by_role("link", name="Bench").click()
        expect(page.get_by_test_id("motion-card")).to_be_visible()
        page.get_by_role("navigation").first.get_by_role("link", name="Connections").click()
        expect(page.get_by_test_id("not-loaded")).to_be_visible()
        server.start(port)
        expect(page.get_by_role("heading", level=1, name="Connections")).to_be_attached(timeout=30_000)
        expect(page.get_by_test_id("not-loaded")).to_have_count(0)
        expect(page.get_by_test_id("server-status")).to_have_text("2 of 2 connected", timeout=15_000)
