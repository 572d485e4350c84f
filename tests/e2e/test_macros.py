"""Macros in a browser: recorded, edited, tried, run, and stopped while one runs."""

from __future__ import annotations

import json
import re
from collections.abc import Callable, Iterator

import httpx
import pytest
from playwright.sync_api import BrowserContext, Page, expect

LAYOUT = {
    "format": "stepscope.layout",
    "version": 1,
    "name": "Macros",
    "screens": {"desktop": {"row": [{"tabs": ["motion"]}, {"tabs": ["macros"]}]}, "phone": ["motion", "macros"]},
    "panels": {
        "motion": {"type": "motion", "v": 1, "at": "$", "config": {}},
        "macros": {"type": "macros", "v": 1, "at": "$", "config": {}},
    },
}


@pytest.fixture(autouse=True)
def nothing_left(api: httpx.Client) -> Iterator[None]:
    yield
    api.delete("/devices/bench/macro-run").raise_for_status()
    for kind in ("macros", "layouts"):
        for kept in api.get(f"/{kind}").raise_for_status().json()[kind]:
            api.delete(f"/{kind}/{kept['id']}").raise_for_status()


def test_record_edit_try_run_and_stop(new_context: Callable[..., BrowserContext], api: httpx.Client) -> None:
    api.put("/layouts/macros", json={"based_on": 0, "document": LAYOUT}).raise_for_status()
    page: Page = new_context().new_page()
    page.goto("/?layout=macros&d=bench")
    page.get_by_role("button", name="Record", exact=True).click()
    expect(page.get_by_text("now becomes steps")).to_be_visible()

    speed = api.get("/devices/bench/registers/v_max", params={"axis": 0}).raise_for_status().json()["value"]
    api.put("/devices/bench/registers/v_max", params={"axis": 0}, json={"value": speed}).raise_for_status()
    for way in (800, -800):
        body = {"target": way, "relative": True}
        api.post("/devices/bench/axes/0/move", json=body).raise_for_status()
    page.get_by_role("combobox", name="Device and axis").click()
    page.get_by_role("option", name="slider").first.click()  # nothing of another device is recorded
    expect(page.get_by_role("button", name="Record", exact=True)).to_be_visible()
    page.get_by_role("combobox", name="Device and axis").click()
    page.get_by_role("option", name="bench").first.click()
    page.get_by_role("button", name="Stop recording").click()
    editor = page.get_by_test_id("macro-editor")
    expect(editor.get_by_role("group", name=re.compile("^Step"))).not_to_have_count(0)
    editor.get_by_text("JSON", exact=True).click()
    steps = editor.get_by_role("textbox", name="Steps, one a line")
    wanted = [step["do"] for step in json.loads(steps.input_value())]
    assert [do for do in wanted if not do.startswith("wait")] == ["write", "move", "move"]

    editor.get_by_role("textbox", name="Name").fill("There and back")
    editor.get_by_role("button", name="Save").click()
    row = page.get_by_test_id("macro-there-and-back")
    expect(row).to_contain_text("not tried in this revision")
    row.get_by_role("button", name="Try").click()
    expect(page.get_by_test_id("macro-trial")).to_contain_text("came to its end", timeout=60_000)
    expect(row).to_contain_text(", tried")
    row.get_by_role("button", name="Run", exact=True).click()
    run = page.get_by_test_id("macro-run")
    expect(run).to_contain_text("There and back: done", timeout=30_000)

    row.get_by_role("button", name="Edit").click()
    editor.get_by_text("JSON", exact=True).click()
    steps.fill("[1]")
    expect(editor.get_by_role("button", name="Save")).to_be_disabled()
    steps.fill(json.dumps([{"do": "rotate", "velocity": 500}, {"do": "wait", "seconds": 600}]))
    editor.get_by_role("button", name="Save").click()
    expect(row).to_contain_text("2 steps, not tried in this revision")
    row.get_by_role("button", name="Run untried").click()
    expect(run).to_contain_text("step 2 of 2: wait 600 s")
    run.get_by_role("button", name="Stop").click()
    expect(run).to_contain_text("aborted")
    expect(run.get_by_role("alert")).to_contain_text("stopped on request")


def test_a_macro_found_in_the_palette_opens_its_form(
    new_context: Callable[..., BrowserContext], api: httpx.Client, check_axe: Callable[[Page], None]
) -> None:
    document = {"format": "stepscope.macro", "version": 1, "name": "Small way", "steps": [{"do": "wait", "seconds": 1}]}
    kept = api.post("/macros", json={"document": document}).raise_for_status().json()["id"]
    page: Page = new_context().new_page()
    page.goto("/?d=bench")
    expect(page.get_by_test_id("motion-card")).to_be_visible()
    page.keyboard.press("Control+k")
    page.get_by_role("combobox", name="Find", exact=True).fill("Small way")
    expect(page.get_by_text("Small way").first).to_be_visible()
    page.keyboard.press("Enter")
    editor = page.get_by_test_id("macro-editor")
    expect(editor.get_by_role("group", name="Step 1")).to_be_visible()
    assert api.get("/devices/bench/macro-run").raise_for_status().json()["run"]["name"] != "Small way"

    editor.get_by_role("textbox", name="Time").fill("-1")
    expect(editor.get_by_text("cannot stand here")).to_be_visible()
    editor.get_by_role("textbox", name="Time").fill("0.5")
    editor.get_by_role("button", name="Add a step").click()
    second = editor.get_by_role("group", name="Step 2")
    second.get_by_role("textbox", name="Target").fill("0.25")
    second.get_by_role("combobox", name="Unit").click()
    page.get_by_role("option", name="rev", exact=True).click()
    second.get_by_role("combobox", name="Way").click()
    page.get_by_role("option", name="by", exact=True).click()
    editor.get_by_role("button", name="Step 2 up").click()
    check_axe(page)
    editor.get_by_role("button", name="Save").click()
    expect(editor).to_have_count(0)
    steps = api.get(f"/macros/{kept}").raise_for_status().json()["document"]["steps"]
    assert [step["do"] for step in steps] == ["move", "wait"]
    assert (steps[0]["target"], steps[0]["unit"], steps[0]["relative"]) == (0.25, "rev", True)
    assert steps[1]["seconds"] == 0.5
    row = page.get_by_test_id(f"macro-{kept}")
    expect(row.get_by_role("button", name="Run untried")).to_have_accessible_description(
        re.compile("Try shows on a twin what it does")
    )
