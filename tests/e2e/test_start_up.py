"""A new device moves with the first click, and one that cannot move has the cure beside the reason."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator

import httpx
import pytest
from playwright.sync_api import BrowserContext, Page, expect

from app.registers.catalog import MODELS
from tests.e2e.chips import a_chip, select
from tests.e2e.conftest import PHONE, Errors
from tests.e2e.motor import wait_for

DEMO = ("tmc428", "tmc4210")
"""Models that the demo has already: another one comes from the form."""


@pytest.fixture(autouse=True)
def as_before(api: httpx.Client, errors: Errors) -> Iterator[None]:
    errors.expect("status of 40[49]")  # looks under way when a device goes, and refusals that are meant
    yield
    api.post("/stop")
    for device in api.get("/devices").raise_for_status().json():
        if not device["demo"]:
            api.delete(f"/devices/{device['id']}").raise_for_status()


def add(page: Page, model: str) -> str:
    """Add an emulated device by clicks alone; its id."""
    title = MODELS[model].title
    if model in DEMO:
        page.goto("/connections")
        page.get_by_role("button", name="Add a device").click()
        page.get_by_label("Name", exact=True).fill(f"new {model}")
        page.get_by_role("combobox", name="Model").click()
        page.get_by_role("option", name=re.compile(title)).click()
        page.get_by_role("button", name="Add and connect").click()
        entry = page.get_by_role("region", name=f"new {model}")
        expect(entry).to_contain_text("connected")
        entry.get_by_role("link", name="Bench").click()
        return f"new-{model}"
    page.goto("/")
    several = {"tmc5xxx": "TMC5xxx", "tmcdrivers": "TMC2xxx", "tmcl": "modules"}.get(MODELS[model].family)
    if several is not None:
        page.get_by_role("button", name=f"Add one of the emulated {several}").click()
    page.get_by_role("button", name=f"Add an emulated {title}").click()
    return model


@pytest.mark.parametrize("model", MODELS)
def test_a_device_added_by_a_click_moves_at_the_first_go(page: Page, api: httpx.Client, model: str) -> None:
    device = add(page, model)
    card = page.get_by_test_id("motion-card")
    expect(card).to_contain_text(f"{device.replace('new-', 'new ')} · ")

    def state() -> dict[str, object]:
        answer: dict[str, object] = api.get(f"/devices/{device}/axes/0").raise_for_status().json()
        return answer

    def shaft() -> float:
        truth = state()["ground_truth"]
        assert isinstance(truth, dict)
        return float(truth["shaft_position"])

    wait_for(lambda: state()["condition"]["kind"] != "cannot_move", "it is set up")  # type: ignore[index]
    before = shaft()
    if not MODELS[model].counts_position:  # it can be sent nowhere, and rotates
        own = MODELS[model].can("own_velocity")
        if own:
            card.get_by_role("button", name="Rotate", exact=True).last.click()
        else:
            api.patch(f"/devices/{device}/emulator", json={"pins": {"step_hz": 10_000}}).raise_for_status()
        wait_for(lambda: state()["condition"]["kind"] == "moving", "it turns")  # type: ignore[index]
        wait_for(lambda: shaft() - before > 512, "the shaft turns with it")
        if own:
            card.get_by_test_id("stop-axis").click()
        else:
            api.patch(f"/devices/{device}/emulator", json={"pins": {"step_hz": 0}}).raise_for_status()
        wait_for(lambda: not state()["moving"], "it stops")
        return
    card.get_by_test_id("move-go").click()
    wait_for(lambda: state()["position"] != 0, "it sets off")
    wait_for(lambda: bool(state()["position_reached"]) and not state()["moving"], "it arrives")
    at = state()
    assert at["position"] == at["target_position"] != 0
    turned = abs(shaft() - before)
    assert abs(turned - abs(int(str(at["position"])))) < 300, "the shaft turned with it"


@pytest.mark.parametrize("size", ["desktop", "phone"])
def test_a_refused_move_has_the_start_up_beside_it(
    new_context: Callable[..., BrowserContext], api: httpx.Client, check_axe: Callable[[Page], None], size: str
) -> None:
    context = new_context(**({"viewport": PHONE} if size == "phone" else {}))
    with a_chip(api, f"fresh {size}") as chip:
        select(context, chip)
        page = context.new_page()
        page.goto("/")
        expect(page.get_by_test_id("condition-card")).to_contain_text("Cannot move")
        expect(page.get_by_test_id("condition-card").get_by_test_id("start-up-open")).to_be_visible()
        page.get_by_test_id("move-go").click()
        alert = page.get_by_test_id("motion-card").get_by_role("alert")
        expect(alert).to_contain_text("VMAX is 0")
        before = chip.register("CHOPCONF")["value"]
        alert.get_by_role("button", name="Start up").click()
        dialog = page.get_by_role("dialog")
        expect(dialog.get_by_role("region", name="Changes")).to_contain_text("VMAX")
        expect(dialog.get_by_test_id("start-up-state")).to_contain_text("Nothing is written yet")
        assert chip.register("CHOPCONF")["value"] == before
        check_axe(page)
        dialog.get_by_role("button", name=re.compile("Apply [0-9]+ changes")).click()
        expect(dialog.get_by_test_id("start-up-state")).to_contain_text("Done")
        check_axe(page)
        dialog.get_by_role("button", name="Close").last.click()
        expect(alert).to_have_count(0)
        page.get_by_test_id("move-go").click()
        wait_for(lambda: chip.axis()["position"] != 0, "it sets off")
        expect(page.get_by_test_id("condition-card")).not_to_contain_text("Cannot move")


def test_connections_start_a_device_up(page: Page, api: httpx.Client) -> None:
    with a_chip(api, "fresh", "tmc5072") as chip:
        page.goto("/connections")
        entry = page.get_by_role("region", name="fresh")
        entry.get_by_role("button", name="Start up").click()
        dialog = page.get_by_role("dialog")
        dialog.get_by_role("button", name=re.compile("Apply")).click()
        expect(dialog.get_by_test_id("start-up-state")).to_contain_text("Done")
        chip.call("move", target=100)
