"""Modules and chips of which names alone are known, in a browser: found, staged, compared, applied, brought back."""

from __future__ import annotations

import contextlib
import signal
import subprocess
import sys
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import httpx
import pytest
from playwright.sync_api import BrowserContext, Locator, Page, ViewportSize, expect
from server_process import free_port

from app.registers import catalog
from app.registers.listed.modules import role_of
from app.registers.model import Register, Space
from tests.e2e.conftest import DESKTOP, PHONE
from tests.e2e.held import Held
from tests.e2e.modules import select
from tests.e2e.motor import wait_for

MODEL = max((model for model in catalog.listings() if model.kind == "module"), key=lambda model: model.axes)
SEVERAL_AXES = [model.name for model in catalog.listings() if model.kind == "chip" and model.axes > 1]
TABLE = catalog.find_model(MODEL.name).table
SPEED = next(row for row in TABLE if row.axis == 0 and role_of(row) == "max_speed")
OUTPUT = next(row for row in TABLE if row.space is Space.OUTPUT)
LACKING = next(
    row for row in TABLE if row.axis == 0 and row.address > 8 and not (row.read_clears or row.values or row.when)
)
"""A parameter that the firmware of this one lacks, by the settings of its emulator."""
NAME = "probed"


@pytest.fixture(autouse=True)
def module(api: httpx.Client) -> Iterator[str]:
    """The id of an emulated one. Made before the page, so that it goes after the page."""
    body = {"name": "drive", "model": MODEL.name, "link": {"kind": "emulator", "unknown_parameters": [LACKING.address]}}
    api.post("/devices", json=body).raise_for_status()
    yield "drive"
    for device in ("drive", NAME):
        api.delete(f"/devices/{device}")


@pytest.fixture
def drive(module: str, page: Page) -> str:
    select(page, module)
    return module


def line_of(page: Page, row: Register) -> Locator:
    return page.locator(f"[data-row='{'-' if row.axis is None else row.axis}/{row.name}']")


def held(api: httpx.Client, row: Register) -> int:
    answer = api.get(f"/devices/drive/registers/{row.name}", params={"axis": row.axis or 0})
    return int(answer.raise_for_status().json()["value"])


def test_what_its_firmware_lacks_is_grey_and_the_rest_is_staged_and_applied(
    page: Page, api: httpx.Client, drive: str
) -> None:
    page.goto("/parameters")
    expect(page.get_by_role("heading", level=1)).to_contain_text("names only")
    lacking = line_of(page, LACKING)
    expect(lacking).to_contain_text("not in this firmware")
    expect(lacking.get_by_role("button")).to_have_count(0)
    speed = line_of(page, SPEED)
    expect(speed).to_contain_text("2000")
    speed.dblclick()
    page.get_by_label(f"New value of {SPEED.name}").fill("1500")
    page.keyboard.press("Enter")
    expect(speed).to_have_attribute("data-staged", "true")
    assert held(api, SPEED) == 2000, "nothing is sent before Apply"
    page.get_by_role("tab", name="Changes").click()
    expect(page.get_by_role("tabpanel")).to_contain_text(SPEED.name)
    page.get_by_role("button", name="Apply", exact=True).click()
    expect(page.get_by_text("1 read back")).to_be_visible()
    assert held(api, SPEED) == 1500
    page.goto("/audit")
    expect(page.get_by_text(SPEED.name).first).to_be_visible()


def test_commands_by_hand_switch_an_output(page: Page, api: httpx.Client, drive: str) -> None:
    page.goto("/console")
    line = page.get_by_label("TMCL command")
    line.fill(f"SIO {OUTPUT.address}, 2, 1")
    line.press("Enter")
    entry = page.get_by_label("Commands sent, newest first").get_by_role("listitem").first
    expect(entry).to_contain_text("100 done")
    assert held(api, OUTPUT) == 1


def test_a_profile_is_captured_compared_and_brought_back(page: Page, api: httpx.Client, drive: str) -> None:
    page.goto("/profiles")
    page.get_by_role("button", name="Find out what can be set").click()
    expect(page.get_by_role("status").filter(has_text="parameters can be set")).to_be_visible(timeout=30_000)
    page.get_by_role("button", name="Capture drive").click()
    count = page.get_by_test_id("diff-count")
    expect(count).to_contain_text("No difference", timeout=30_000)
    write = {"value": 1234}
    api.put(f"/devices/drive/registers/{SPEED.name}", params={"axis": 0}, json=write).raise_for_status()
    page.get_by_role("button", name="Compare again").click()
    expect(count).to_contain_text("1 difference", timeout=30_000)
    page.get_by_role("button", name="Apply 1 change").click()
    expect(page.get_by_text("The profile is in drive")).to_be_visible(timeout=30_000)
    assert held(api, SPEED) == 2000
    for profile in api.get("/profiles").raise_for_status().json()["profiles"]:  # the pages of other tests have none
        api.delete(f"/profiles/{profile['id']}").raise_for_status()


def test_nothing_is_captured_while_it_is_found_out_what_can_be_set(page: Page, drive: str) -> None:
    held = Held(page, "**/profile/try")
    page.goto("/profiles")
    capture = page.get_by_role("button", name="Capture drive")
    expect(capture).to_be_enabled()
    page.get_by_role("button", name="Find out what can be set").click()
    expect(capture).to_be_disabled()
    held.let_one_go()
    expect(page.get_by_role("status").filter(has_text="parameters can be set")).to_be_visible(timeout=30_000)
    expect(capture).to_be_enabled()


@pytest.mark.parametrize("model", [MODEL.name, *SEVERAL_AXES])
def test_zero_is_set_for_one_axis_alone_and_nothing_moves(page: Page, api: httpx.Client, model: str) -> None:
    api.post("/devices", json={"name": NAME, "model": model, "link": {"kind": "emulator"}}).raise_for_status()
    for axis in (0, 1):
        api.post(f"/devices/{NAME}/axes/{axis}/move", json={"target": 300}).raise_for_status()
        wait_for(lambda axis=axis: state(api, axis)["position"] == 300, "it is there")  # type: ignore[misc]
    select(page, NAME, 1)
    page.goto("/")
    expect(page.get_by_test_id("scope")).to_contain_text("internal")  # of its speeds nobody knows the unit
    expect(page.get_by_test_id("scope")).not_to_contain_text("pps")
    page.get_by_role("tab", name="Zero").click()
    page.get_by_test_id("set-zero").click()
    wait_for(lambda: state(api, 1)["position"] == 0, "the count is zero")
    assert (state(api, 0)["position"], state(api, 1)["moving"]) == (300, False)


def state(api: httpx.Client, axis: int) -> dict[str, Any]:
    answer: dict[str, Any] = api.get(f"/devices/{NAME}/axes/{axis}").raise_for_status().json()
    return answer


@contextlib.contextmanager
def far_module() -> Iterator[int]:
    """One in another process: the port that it is behind."""
    port = free_port()
    program = str(Path(sys.executable).with_name("stepscope"))
    command = [program, "emulate", MODEL.name, "--tcp", f"127.0.0.1:{port}"]
    process = subprocess.Popen(command, stdout=subprocess.PIPE)
    assert process.stdout is not None
    try:
        assert str(port).encode() in process.stdout.readline(), "it says where it listens when it does"
        yield port
    finally:
        process.send_signal(signal.SIGINT)
        process.wait(30)
        process.stdout.close()


def test_a_search_names_what_answers_and_proposes_it(page: Page) -> None:
    with far_module() as port:
        page.goto("/connections")
        search = page.get_by_role("region", name="Look for modules")
        search.get_by_label("Port or address").fill(f"socket://127.0.0.1:{port}")
        search.get_by_label("Addresses").fill("1")
        search.get_by_role("button", name="Probe").click()
        number = MODEL.title.rpartition("-")[2]
        found = search.get_by_label("Modules found").get_by_role("listitem").filter(has_text=f"{number}V100")
        expect(found).to_be_visible(timeout=20_000)
        found.get_by_role("button", name="Add").click()
        form = page.get_by_role("form", name="Add a device")
        expect(form.get_by_role("combobox", name="Model")).to_have_value(f"{MODEL.title} · 6 axes · names only")
        form.get_by_label("Name", exact=True).fill(NAME)
        form.get_by_role("button", name="Add and connect").click()
        entry = page.get_by_role("region", name=NAME)
        expect(entry).to_have_attribute("data-state", "connected")
        expect(entry).to_contain_text("names only")
        expect(entry.get_by_role("button", name="Start up")).to_have_count(0)
        entry.get_by_role("button", name="Remove").click()
        page.get_by_role("dialog").get_by_role("button", name="Remove").click()
        expect(entry).to_have_count(0)


@pytest.mark.parametrize("size", [DESKTOP, PHONE], ids=["desktop", "phone"])
def test_its_parameters_are_open_to_everybody(
    module: str,
    new_context: Callable[..., BrowserContext],
    check_axe: Callable[[Page], None],
    size: ViewportSize,
) -> None:
    context = new_context(viewport=size)
    select(context, module)
    page = context.new_page()
    page.goto("/parameters")
    expect(line_of(page, LACKING)).to_contain_text("not in this firmware")
    check_axe(page)
