"""Layouts in a browser: arranged by mouse, by menu and by keys, kept here and on the server, and shown on a phone."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator
from typing import Any

import httpx
import pytest
from playwright.sync_api import BrowserContext, Locator, Page, expect

from tests.e2e.conftest import PHONE, Errors
from tests.e2e.held import Held

KEPT = "() => JSON.parse(localStorage.getItem('stepscope.layouts') ?? '{}')"


@pytest.fixture(autouse=True)
def no_layouts(api: httpx.Client) -> Iterator[None]:
    """Each test finds a server that keeps none."""
    yield
    for layout in api.get("/layouts").raise_for_status().json()["layouts"]:
        api.delete(f"/layouts/{layout['id']}").raise_for_status()


def opened(page: Page, address: str = "/") -> Page:
    page.goto(address)
    expect(page.get_by_test_id("motion-card")).to_be_visible()
    expect(page.get_by_test_id("layout-menu")).to_be_visible()
    return page


def choose(page: Page, *names: str) -> None:
    page.get_by_test_id("layout-menu").click()
    for name in names:
        page.get_by_role("menuitem", name=name, exact=True).click()


def arrange(page: Page) -> Locator:
    choose(page, "Arrange the panels")
    dock = page.get_by_test_id("dock")
    expect(dock.get_by_role("tab", name="Scope", exact=True)).to_be_visible()
    expect(dock.get_by_test_id("motion-card")).to_be_visible()
    return dock


def places(page: Page, layout: str = "bench") -> Any:
    """Where the panels of a layout stand, without their sizes."""

    def bare(part: dict[str, Any]) -> Any:
        if "tabs" in part:
            return part["tabs"]
        way = "row" if "row" in part else "col"
        return {way: [bare(each) for each in part[way]]}

    return bare(page.evaluate(KEPT)[layout]["screens"]["desktop"])


def test_by_mouse_by_menu_and_by_keys_comes_the_same_layout(new_context: Callable[..., BrowserContext]) -> None:
    found = []
    for way in ("mouse", "menu", "keys"):
        page = opened(new_context().new_page())
        dock = arrange(page)
        if way == "mouse":
            target = dock.get_by_role("tabpanel", name="Scope").bounding_box()
            assert target
            dock.get_by_role("tab", name="Devices and axes").hover()
            page.mouse.down()
            page.mouse.move(target["x"] + target["width"] - 12, target["y"] + target["height"] / 2, steps=12)
            page.mouse.up()
        elif way == "menu":
            dock.get_by_role("button", name="Menu of Devices and axes").click()
            page.get_by_role("menuitem", name="Move right of").hover()
            page.get_by_role("menuitem", name="Scope", exact=True).click()
        else:
            dock.get_by_role("button", name="Menu of Devices and axes").press("Enter")
            expect(page.get_by_role("menuitem", name="Move left of")).to_be_visible()
            page.get_by_role("menuitem", name="Move right of").focus()
            page.keyboard.press("ArrowRight")
            # the menu that opens takes the focus to its first entry: from there on by keys, as one does
            expect(page.locator('[role="menuitem"]:focus')).not_to_have_text("Move right of")
            for _ in range(12):
                if page.locator('[role="menuitem"]:focus').inner_text() == "Scope":
                    break
                page.keyboard.press("ArrowDown")
            page.keyboard.press("Enter")
        expect(page.get_by_test_id("layout-said")).to_have_text("Devices and axes moved")
        found.append(places(page))
        page.close()
    assert found[0] == found[1] == found[2]
    assert found[0] == {"row": [["motion"], {"col": [["demo"], ["stage"], ["limits"], {"row": [["scope"], ["axes"]]}]}]}


def test_a_splitter_moves_by_keys_and_a_reload_keeps_it(page: Page) -> None:
    opened(page)
    dock = arrange(page)
    splitter = dock.locator("[role=separator][aria-orientation=vertical]").first
    before = page.get_by_test_id("motion-card").bounding_box()
    splitter.focus()
    for _ in range(5):
        page.keyboard.press("ArrowRight")
    expect(page.get_by_test_id("layout-said")).to_have_text("Sizes changed")
    page.get_by_role("button", name="Done").click()
    expect(dock).to_have_count(0)
    after = page.get_by_test_id("motion-card").bounding_box()
    assert before
    assert after
    assert after["width"] > before["width"] + 5
    page.reload()
    expect(page.get_by_test_id("motion-card")).to_be_visible()
    again = page.get_by_test_id("motion-card").bounding_box()
    assert again
    assert abs(again["width"] - after["width"]) < 2
    choose(page, "Reset to how it came")
    expect(page.get_by_test_id("layout-menu")).to_have_attribute("data-touched", "false")
    back = page.get_by_test_id("motion-card").bounding_box()
    assert back
    assert abs(back["width"] - 300) < 2


def test_what_moves_the_motor_stays_in_sight(page: Page) -> None:
    opened(page)
    dock = arrange(page)
    dock.get_by_role("button", name="Menu of Motion").click()
    expect(page.get_by_role("menuitem", name="Close")).to_be_disabled()
    expect(page.get_by_role("menuitem", name="Move into the tabs of")).to_have_count(0)
    page.keyboard.press("Control+k")  # closes the menu, and Escape would stop what moves
    page.keyboard.press("Control+k")
    page.goto("/?max=scope")
    expect(page.get_by_test_id("scope")).to_be_visible()
    expect(page.get_by_test_id("stage")).to_have_count(0)
    expect(page.get_by_test_id("move-go")).to_be_in_viewport()
    expect(page.get_by_test_id("stop-all")).to_be_in_viewport()
    page.get_by_role("button", name="All panels").click()
    expect(page.get_by_test_id("stage")).to_be_visible()
    page.go_back()
    expect(page.get_by_test_id("stage")).to_have_count(0)


PROBE = """() => {
  const frame = document.createElement('iframe');
  let loads = 0;
  frame.title = 'probe';
  frame.srcdoc = '<p>probe</p>';
  frame.onload = () => { loads += 1; frame.dataset.loads = String(loads); };
  document.querySelector('[data-panel=scope]').append(frame);
}"""


def test_a_frame_that_is_moved_is_loaded_once(page: Page) -> None:
    """As the 3D view is one; any page of ours does, and needs no process of its own."""
    opened(page)
    page.evaluate(PROBE)
    probe = page.get_by_title("probe")
    expect(probe).to_have_attribute("data-loads", "1")
    dock = arrange(page)
    for side, other in (("Move right of", "Stage"), ("Move below", "Devices and axes")):
        dock.get_by_role("button", name="Menu of Scope").click()
        page.get_by_role("menuitem", name=side).hover()
        page.get_by_role("menuitem", name=other, exact=True).click()
        expect(page.get_by_test_id("layout-said")).to_have_text("Scope moved")
        expect(dock.get_by_title("probe")).to_be_attached()
    page.get_by_role("button", name="Done").click()
    expect(dock).to_have_count(0)
    expect(probe).to_have_attribute("data-loads", "1")


def test_a_save_over_somebody_elses_is_told(page: Page, api: httpx.Client, errors: Errors) -> None:
    opened(page)
    page.get_by_test_id("emulator-open").click()
    expect(page.get_by_test_id("layout-menu")).to_have_attribute("data-touched", "true")
    theirs = {**page.evaluate(KEPT)["bench"], "name": "Theirs"}
    api.put("/layouts/bench", json={"based_on": 0, "document": theirs}).raise_for_status()
    errors.expect("409")
    choose(page, "Save")
    expect(page.get_by_text("saved elsewhere meanwhile")).to_be_visible()
    assert api.get("/layouts/bench").json()["name"] == "Theirs"
    page.get_by_role("button", name="Save over theirs").click()
    expect(page.get_by_test_id("layout-menu")).to_have_attribute("data-touched", "false")
    kept = api.get("/layouts/bench").json()
    assert (kept["name"], kept["revision"]) == ("Bench", 2)


def test_a_layout_is_kept_under_a_name_and_its_link_shows_it_elsewhere(
    page: Page, new_context: Callable[..., BrowserContext]
) -> None:
    # Whoever saves has not waited until the typing has settled.
    page.add_init_script(
        "const set = setTimeout; window.setTimeout = (f, ms, ...a) => (ms === 400 ? 0 : set(f, ms, ...a))"
    )
    opened(page)
    arrange(page)
    page.get_by_role("button", name="Add a panel").click()
    page.get_by_role("menuitem", name="Notes").click()
    page.get_by_role("button", name="Done").click()
    page.get_by_role("textbox", name="Notes notes").fill("loose coupling?")
    choose(page, "Save as…")
    page.get_by_role("dialog").get_by_label("Name").fill("My bench")
    page.get_by_role("dialog").get_by_role("button", name="OK").click()
    expect(page).to_have_url(re.compile("layout=my-bench"))
    elsewhere = opened(new_context().new_page(), page.url)
    expect(elsewhere.get_by_role("textbox", name="Notes notes")).to_have_value("loose coupling?")
    choose(elsewhere, "Bench")
    expect(elsewhere.get_by_role("textbox", name="Notes notes")).to_have_count(0)
    elsewhere.go_back()
    expect(elsewhere.get_by_role("textbox", name="Notes notes")).to_be_visible()


def test_a_newer_layout_is_shown_and_not_changed_and_an_unknown_panel_keeps_its_place(
    page: Page, api: httpx.Client
) -> None:
    panels = {
        "motion": {"type": "motion", "v": 1, "at": "$", "config": {}},
        "oracle": {"type": "oracle", "v": 3, "at": "$", "config": {"asks": 7}},
    }
    screens = {"desktop": {"row": [{"tabs": ["motion"], "size": "300px"}, {"tabs": ["oracle"]}]}, "phone": []}
    for name, version in (("old", 1), ("new", 2)):
        document = {
            "format": "stepscope.layout",
            "version": version,
            "name": name,
            "screens": screens,
            "panels": panels,
        }
        api.put(f"/layouts/{name}", json={"based_on": 0, "document": document}).raise_for_status()
    opened(page, "/?layout=old")
    expect(page.get_by_text("has no such panel")).to_be_visible()
    choose(page, "Rename…")
    page.get_by_role("dialog").get_by_label("Name").fill("older")
    page.get_by_role("dialog").get_by_role("button", name="OK").click()
    choose(page, "Save")
    expect(page.get_by_test_id("layout-menu")).to_have_attribute("data-touched", "false")
    kept = api.get("/layouts/old").json()
    assert (kept["name"], kept["document"]["panels"]["oracle"]) == ("older", panels["oracle"])
    opened(page, "/?layout=new")
    expect(page.get_by_text("A newer stepscope has made this layout")).to_be_visible()
    page.get_by_test_id("layout-menu").click()
    expect(page.get_by_role("menuitem", name="Arrange the panels")).to_be_disabled()
    expect(page.get_by_role("menuitem", name="Save", exact=True)).to_be_disabled()
    assert api.get("/layouts/new").json()["document"]["version"] == 2


def test_on_a_phone_the_panels_are_a_stack_with_an_order_of_its_own(
    new_context: Callable[..., BrowserContext], check_axe: Callable[[Page], None]
) -> None:
    page = new_context(viewport=PHONE, has_touch=True).new_page()
    page.goto("/")
    expect(page.get_by_test_id("motion-card")).to_be_visible()
    page.get_by_role("button", name="Arrange the panels").click()
    page.get_by_role("button", name="Scope up").click()
    expect(page.get_by_test_id("layout-said")).to_have_text("Scope is number 4 of 6")
    check_axe(page)
    page.get_by_role("button", name="Close", exact=True).click()
    kept = page.evaluate(KEPT)["bench"]["screens"]
    assert kept["phone"] == ["motion", "demo", "stage", "scope", "limits", "axes"]
    assert kept["desktop"]["row"][0]["size"] == "300px", "the desktop is as it was"
    page.reload()
    expect(page.get_by_test_id("motion-card")).to_be_visible()
    assert page.evaluate(KEPT)["bench"]["screens"] == kept


@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_accessible_while_arranged_and_with_every_layout(
    new_context: Callable[..., BrowserContext], check_axe: Callable[[Page], None], scheme: str
) -> None:
    page = opened(new_context(color_scheme=scheme).new_page())
    arrange(page)
    check_axe(page)
    for layout in ("tuning", "wire"):
        opened(page, f"/?layout={layout}")
        check_axe(page)


def test_registers_are_edited_and_written_in_a_layout_and_the_log_tells_it(page: Page, api: httpx.Client) -> None:
    before = api.get("/devices/bench/registers/v_max", params={"axis": 0}).raise_for_status().json()["raw"]
    opened(page, "/?layout=registers&d=bench&a=0")
    registers = page.get_by_role("region", name="Registers")
    registers.get_by_label("Search registers").fill("v_max")
    registers.get_by_role("button", name="v_max", exact=True).click()
    registers.get_by_role("button", name=re.compile("^Edit")).first.click()
    wanted = 900 if before != 900 else 901
    entry = registers.get_by_role("textbox", name=re.compile("v_max"))
    entry.fill(str(wanted))
    entry.press("Enter")
    changes = page.get_by_role("region", name="Changes")
    expect(changes).to_contain_text("v_max")
    changes.get_by_role("button", name=re.compile("^Apply")).click()
    log = page.get_by_role("region", name="Log of bench")
    entry = log.get_by_test_id("audit-entry").filter(has_text="v_max").first
    expect(entry).to_contain_text(str(wanted))
    assert api.get("/devices/bench/registers/v_max", params={"axis": 0}).raise_for_status().json()["raw"] == wanted
    entry.get_by_role("button", name=re.compile("^Undo")).click()
    expect(page.get_by_role("dialog")).to_contain_text("v_max")
    api.put("/devices/bench/registers/v_max", params={"axis": 0}, json={"value": before}).raise_for_status()


def test_a_layout_shows_how_far_the_encoder_is_over_time_and_over_the_turn(page: Page, api: httpx.Client) -> None:
    body = {"name": "turning", "model": "tmc5160", "link": {"kind": "emulator"}, "start_up": True}
    api.post("/devices", json=body).raise_for_status()
    try:
        opened(page, "/?layout=encoder&d=turning&a=0")
        expect(page.get_by_role("img", name="Deviation over time")).to_be_visible()
        expect(page.get_by_role("heading", name="Deviation against shaft angle")).to_be_visible()
    finally:
        api.delete("/devices/turning").raise_for_status()


@pytest.mark.parametrize("width", [1000, 1280, 1440])
def test_the_stop_stays_in_the_window_while_one_arranges(page: Page, width: int) -> None:
    page.set_viewport_size({"width": width, "height": 720})
    opened(page)
    arrange(page)
    expect(page.get_by_role("button", name="Done")).to_be_visible()
    stop = page.get_by_role("button", name=re.compile("^STOP", re.IGNORECASE)).last.bounding_box()
    assert stop
    assert stop["x"] + stop["width"] <= width, stop


def test_f6_goes_round_the_panels(page: Page) -> None:
    opened(page)

    def focused() -> str | None:
        name: str | None = page.evaluate("document.activeElement?.closest('[data-panel]')?.dataset.panel ?? null")
        return name

    page.keyboard.press("F6")
    expect(page.locator("[data-panel]:focus")).to_have_count(1)
    first = str(focused())
    round_trip = [first]
    for _ in range(8):
        page.keyboard.press("F6")
        round_trip.append(str(focused()))
        if round_trip[-1] == first:
            break
    assert round_trip[-1] == first
    assert {"motion", "axes", "scope"} <= set(round_trip), "what has nothing to show is left out"
    page.keyboard.press("Shift+F6")
    assert focused() == round_trip[-2]
    expect(page.get_by_role("group", name="Scope", exact=True)).to_have_count(1)
    page.keyboard.press("Tab")
    assert focused() == round_trip[-2], "from there one goes on into the panel"


@pytest.mark.parametrize("address", ["/", "/?layout=registers"])
def test_f6_is_heard_before_the_parts_that_come_later(page: Page, address: str) -> None:
    held = Held(page, "**/assets/layouts-*.js")
    page.goto(address)
    expect(page.get_by_test_id("layout-menu")).to_be_visible()
    page.keyboard.press("F6")
    held.let_go()
    expect(page.locator("[data-panel]:focus")).to_have_count(1)


def test_a_layout_keeps_how_the_scope_is_set(page: Page, api: httpx.Client) -> None:
    opened(page, "/?t=-5s&rows=velocity")
    expect(page.get_by_role("img", name=re.compile("^Velocity"))).to_be_visible()
    choose(page, "Save as…")
    page.get_by_role("dialog").get_by_label("Name").fill("Only speed")
    page.get_by_role("dialog").get_by_role("button", name="OK").click()
    expect(page).to_have_url(re.compile("layout=only-speed"))
    kept = api.get("/layouts/only-speed").raise_for_status().json()["document"]["panels"]["scope"]["config"]["scope"]
    assert (kept["spanS"], kept["rows"]) == (5, ["velocity"])
    page.evaluate("sessionStorage.clear(); localStorage.clear()")
    opened(page, "/?rows=position")
    expect(page.get_by_role("img", name=re.compile("^Position"))).to_be_visible()
    expect(page.get_by_role("img", name=re.compile("^Velocity"))).to_have_count(0)
    page.evaluate("sessionStorage.clear(); localStorage.clear()")
    opened(page, "/?layout=only-speed")
    expect(page.get_by_role("img", name=re.compile("^Velocity"))).to_be_visible()
    expect(page.get_by_role("img", name=re.compile("^Position"))).to_have_count(0)
    expect(page).to_have_url(re.compile("t=-5s"))


def test_the_layout_recording_begins_one_and_leads_to_it(page: Page, api: httpx.Client) -> None:
    opened(page, "/?layout=recording")
    card = page.get_by_role("region", name="Recordings")
    before = {each["id"] for each in api.get("/recordings").raise_for_status().json()["recordings"]}
    card.get_by_role("button", name="Record this axis").click()
    card.get_by_role("button", name="End the recording").click()
    expect(card.get_by_role("button", name="Record this axis")).to_be_visible()
    (made,) = {each["id"] for each in api.get("/recordings").raise_for_status().json()["recordings"]} - before
    try:
        card.get_by_test_id("recordings-panel").get_by_role("link", name=made).click()
        expect(page).to_have_url(re.compile(f"/recordings/{made}"))
    finally:
        api.delete(f"/recordings/{made}").raise_for_status()
