"""A module on a CAN bus, in a browser: added by the form, moved, and its heartbeat and second identifier set.

The bus is python-can's `udp_multicast`, which needs no driver of the kernel and leads from process to process.
"""

from __future__ import annotations

import re
from collections.abc import Iterator

import httpx
import pytest
from can import Bus
from playwright.sync_api import Page, expect

from tests.e2e.motor import Motor, select, wait_for
from tests.peers.emulator_process import EmulatorProcess, emulator

CHANNEL = "239.74.163.138"
HEARTBEAT = "can_heartbeat"


@pytest.fixture
def module() -> Iterator[EmulatorProcess]:
    """Delivered, alone on its bus."""
    try:
        Bus(interface="udp_multicast", channel=CHANNEL).shutdown()
    except OSError as error:
        pytest.skip(f"no multicast here: {error}")
    with emulator("--can", f"udp_multicast:{CHANNEL}", "--control", "127.0.0.1:0") as running:
        yield running


def test_a_module_on_a_bus_is_added_moves_and_takes_a_heartbeat(
    page: Page, api: httpx.Client, module: EmulatorProcess
) -> None:
    page.goto("/connections")
    page.get_by_role("button", name="Add a device").click()
    form = page.get_by_role("complementary", name="Add or edit a device")
    form.get_by_role("textbox", name="Name", exact=True).first.fill("onbus")
    form.get_by_role("combobox", name="Model").click()
    page.get_by_role("option", name="PD42-1241").first.click()
    form.get_by_text("CAN", exact=True).click()
    form.get_by_label("Interface of python-can").fill("udp_multicast")
    form.get_by_role("textbox", name="Channel").fill(CHANNEL)
    form.get_by_role("button", name="Add and connect").click()
    try:
        expect(page.get_by_role("region", name="onbus")).to_contain_text("connected")
        motor = Motor(api, "onbus")
        select(page, motor)
        page.goto("/")
        expect(page.get_by_test_id("link-readout").first).to_contain_text("live")
        page.get_by_label("Move to").fill("25600")
        page.get_by_role("button", name="Go", exact=True).click()
        wait_for(lambda: motor.reasons()[:1] == ["target_reached"], "it has arrived")
        assert motor.axis()["position"] == 25_600

        page.goto("/parameters")
        page.get_by_placeholder("Name, number like AP 4, or words of the help").fill(HEARTBEAT)
        page.locator(f"[data-row='-/{HEARTBEAT}']").dblclick()
        page.get_by_label(re.compile("new value of can heartbeat", re.IGNORECASE)).fill("700")
        page.keyboard.press("Enter")
        page.get_by_role("button", name="Apply", exact=True).click()
        expect(page.get_by_text("1 read back")).to_be_visible()
        assert motor.parameter(HEARTBEAT) == 700
    finally:
        api.post("/stop")
        api.delete("/devices/onbus")
