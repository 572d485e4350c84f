"""A recording's notebook in a browser: cells of text, figures and statistics in an order, tags, a colour."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator

import httpx
import pytest
from playwright.sync_api import APIResponse, Page, Route, expect

from tests.e2e.conftest import PHONE, Errors
from tests.e2e.held import Held
from tests.e2e.motor import wait_for


@pytest.fixture(scope="module")
def recording(api: httpx.Client) -> Iterator[str]:
    """A second of the demo's axis X, from a move on: without that a busy machine may be through before it moves."""
    body = {"device": "bench", "channels": ["position.0", "velocity.0"], "rate_hz": 100.0, "duration_s": 1.0}
    body["trigger"] = {"kind": "move", "axis": 0}
    made = api.post("/recordings", json={**body, "name": "for notes"}).raise_for_status().json()["id"]
    api.post("/devices/bench/axes/0/move", json={"target": 900, "relative": True}).raise_for_status()
    wait_for(lambda: api.get(f"/recordings/{made}/info").json()["state"] == "done", "the recording is over")
    yield made
    api.delete(f"/recordings/{made}").raise_for_status()


def test_a_notebook_is_written_ordered_and_kept(
    page: Page, api: httpx.Client, recording: str, check_axe: Callable[[Page], None]
) -> None:
    pieces = Held(page, re.compile(rf"/recordings/{recording}/plot"))
    page.goto(f"/recordings/{recording}?t=0.2~0.6")
    notebook = page.get_by_role("region", name="Notebook")
    add = notebook.get_by_role("button", name="Add")
    add.click()
    stood = add.bounding_box()
    assert stood
    pieces.let_go()
    expect(page.get_by_test_id("recording-plots")).to_be_visible()
    stands = add.bounding_box()
    assert stands
    assert abs(stands["y"] - stood["y"]) < 1, "it moved away from a hand that reaches for it"
    page.get_by_role("menuitem", name="Text").click()
    words = notebook.get_by_label("Text of the cell")
    words.fill("It rings at the end.")
    notebook.get_by_role("button", name="Keep").click()
    expect(notebook.get_by_test_id("cell-1")).to_contain_text("It rings at the end.")
    for kind in ("Figure of what is shown", "Statistics of what is shown"):
        add.click()
        page.get_by_role("menuitem", name=kind).click()
    figure, table = notebook.get_by_test_id("cell-2"), notebook.get_by_test_id("cell-3")
    expect(figure.get_by_role("img", name=re.compile("^Position, "))).to_be_visible()
    expect(table.get_by_test_id("figures")).to_contain_text("velocity")
    table.get_by_role("button", name="Move cell 3 up").click()
    expect(notebook.get_by_test_id("cell-2").get_by_test_id("figures")).to_be_visible()
    page.reload()
    expect(notebook.get_by_test_id("cell-1")).to_contain_text("It rings at the end.")
    expect(notebook.get_by_test_id("cell-2").get_by_test_id("figures")).to_be_visible()
    check_axe(page)
    page.set_viewport_size(PHONE)
    assert page.evaluate("document.scrollingElement.scrollWidth - document.documentElement.clientWidth") <= 0
    cells = api.get(f"/recordings/{recording}").raise_for_status().json()["notebook"]
    assert [cell["kind"] for cell in cells] == ["text", "table", "figure"]
    assert (cells[1]["from_s"], cells[1]["to_s"]) == (pytest.approx(0.2), pytest.approx(0.6))
    notebook.get_by_role("button", name="Remove cell 2").click()
    expect(notebook.get_by_test_id("cell-3")).to_have_count(0)


def test_tags_are_found_by_the_search(page: Page, recording: str) -> None:
    page.goto(f"/recordings/{recording}")
    page.get_by_role("button", name=re.compile("^More")).first.click()
    page.get_by_role("menuitem", name="Name and note").click()
    form = page.get_by_role("dialog")
    form.get_by_role("combobox", name="Tags").fill("warm motor")
    page.keyboard.press("Enter")
    form.get_by_role("combobox", name="Colour in comparisons").click()
    page.get_by_role("option", name="green").click()
    form.get_by_role("button", name="Save").click()
    expect(page.get_by_test_id("tag")).to_have_text(["warm motor"])
    page.goto("/recordings?find=warm")
    page.get_by_label("Search recordings").fill("warm motor")
    expect(page.get_by_test_id("recordings").locator("tbody tr")).to_have_count(1)


RIGOL = "X,CH1,Start,Increment\nSequence,Volt,0.000000e+00,1.000000e-02\n" + "".join(
    f"{row},{row % 7}.5e-01\n" for row in range(100)
)
"""As an oscilloscope exports it: a counter, start and step above; 1 s at 100 Hz."""

DROP = """([target, text]) => {
    const files = new DataTransfer();
    files.items.add(new File([text], "dropped.csv", { type: "text/csv" }));
    for (const kind of ["dragover", "drop"])
        target.dispatchEvent(new DragEvent(kind, { dataTransfer: files, bubbles: true, cancelable: true }));
}"""


def test_a_file_of_an_oscilloscope_is_dropped_in_aligned_and_removed(
    page: Page, api: httpx.Client, recording: str, errors: Errors, check_axe: Callable[[Page], None]
) -> None:
    errors.expect(r"status of 422 .*/added")
    page.goto(f"/recordings/{recording}")
    card = page.get_by_role("region", name="Other instruments")
    expect(card).to_contain_text("Drop the CSV file")
    page.evaluate(DROP, [card.element_handle(), RIGOL])
    file = card.get_by_role("region", name="dropped.csv")
    expect(file).to_contain_text("100 rows")
    expect(file.get_by_role("img", name="CH1 over time")).to_be_visible()
    figures = page.get_by_role("region", name="Figures").get_by_test_id("figures")  # the notebook has some too
    expect(figures).to_contain_text("CH1")
    check_axe(page)
    offset = file.get_by_role("textbox", name="Where the 0 of dropped.csv lies")
    offset.fill("0.25")
    offset.press("Enter")
    expect(file).to_contain_text("0.250 to 1.240")
    (kept,) = api.get(f"/recordings/{recording}").raise_for_status().json()["added"]
    assert kept["offset_s"] == 0.25
    page.get_by_role("button", name="Work it out").click()
    page.get_by_role("combobox", name="Channel of the spectrum").click()
    page.get_by_role("option", name="CH1").click()
    expect(page.get_by_test_id("spectrum")).to_contain_text("highest at")
    file.get_by_role("combobox", name="Mark that the 0 of dropped.csv lies on").click()
    page.get_by_role("option").first.click()
    expect(file).to_contain_text("its 0 on the mark")
    card.locator("input[type=file]").set_input_files(
        {"name": "broken.csv", "mimeType": "text/csv", "buffer": b"time [s],CH1 [V]\n0.0,1.0\n0.1,word\n"}
    )
    alert = card.get_by_role("alert")
    expect(alert).to_contain_text("line 3")
    expect(card.get_by_test_id("added-file")).to_have_count(1)
    file.get_by_role("button", name="Remove").click()
    expect(card.get_by_test_id("added-file")).to_have_count(0)
    assert api.get(f"/recordings/{recording}").raise_for_status().json()["added"] == []


def test_figures_that_were_asked_for_before_a_file_was_added_are_asked_for_again(page: Page, recording: str) -> None:
    """They came after it, without it, and stayed."""
    held: list[tuple[Route, APIResponse]] = []

    def late(route: Route) -> None:
        if held:
            route.continue_()
        else:
            held.append((route, route.fetch()))

    page.route("**/figures*", late)
    with page.expect_request("**/figures*"):
        page.goto(f"/recordings/{recording}")
    card = page.get_by_role("region", name="Other instruments")
    expect(card).to_contain_text("Drop the CSV file")
    page.evaluate(DROP, [card.element_handle(), RIGOL])
    expect(card.get_by_role("region", name="dropped.csv")).to_contain_text("100 rows")
    ((route, before),) = held
    route.fulfill(response=before)
    figures = page.get_by_role("region", name="Figures").get_by_test_id("figures")
    expect(figures).to_contain_text("CH1")
    card.get_by_role("button", name="Remove").click()
    expect(figures).not_to_contain_text("CH1")
