"""The lease in a browser: who opens a page only looks, one at a time takes the bench, and everybody may stop it."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator
from typing import Any

import httpx
import pytest
from playwright.sync_api import BrowserContext, Locator, Page, expect
from server_process import ServerProcess

from tests.e2e.conftest import Errors
from tests.e2e.motor import wait_for
from tests.e2e.session import a_client, take_the_bench
from tests.e2e.test_pages import LOOKS

AXIS = "/devices/bench/axes/0"


@pytest.fixture(scope="module")
def look(server: ServerProcess) -> Iterator[httpx.Client]:
    """The server as a session sees it that is in none of the pages here."""
    with a_client(server.url) as client:
        yield client


@pytest.fixture(autouse=True)
def free_bench(look: httpx.Client) -> Iterator[None]:
    """Each test finds the motor at 0 and the bench free, and leaves what was set as it was."""
    wait_for(lambda: lease(look)["state"] == "free" or lease(look)["mine"], "the pages of the test before are gone", 30)
    take_the_bench(look)
    look.put("/lease", json={"on_vanish": "stop", "vanish_after_s": 15}).raise_for_status()
    look.post("/stop").raise_for_status()
    wait_for(lambda: not axis(look)["moving"], "at rest")
    look.post(f"{AXIS}/move", json={"target": 0}).raise_for_status()
    wait_for(lambda: axis(look)["position_reached"], "at 0")
    look.delete("/lease").raise_for_status()
    yield
    look.post("/stop").raise_for_status()


@pytest.fixture
def visit(
    new_context: Callable[..., BrowserContext], errors: Errors, server: ServerProcess
) -> Iterator[Callable[..., Page]]:
    """Open the bench as somebody of that name, who has never been here when it is None."""
    sessions: set[str] = set()

    def come(name: str | None) -> Page:
        context = new_context(stranger=True)
        if name is not None:
            context.add_init_script(f"if (location.protocol !== 'about:') localStorage['stepscope.name'] = '{name}'")
        page = context.new_page()
        page.on("request", lambda request: sessions.add(request.headers.get("stepscope-session", "")))
        page.goto("/")
        expect(page.get_by_test_id("lease")).to_be_visible()
        expect(page.get_by_test_id("link-readout").first).to_contain_text("live")
        return page

    yield come
    assert not errors.unexpected()
    for session in sessions - {""}:  # a closed page only falls silent: the next test would wait for its end
        httpx.delete(f"{server.url}/api/v1/lease", headers={"Stepscope-Session": session})


def lease(look: httpx.Client) -> dict[str, Any]:
    state: dict[str, Any] = look.get("/lease").raise_for_status().json()
    return state


def axis(look: httpx.Client) -> dict[str, Any]:
    state: dict[str, Any] = look.get(AXIS).raise_for_status().json()
    return state


def shuttles(look: httpx.Client) -> bool:
    running: bool = look.get(f"{AXIS}/shuttle").raise_for_status().json()["running"]
    return running


def control(page: Page) -> Locator:
    return page.get_by_test_id("lease")


def dialog(page: Page) -> Locator:
    return page.get_by_role("dialog", name="You are only looking")


def take(page: Page) -> None:
    control(page).click()
    expect(control(page)).to_have_text("You have the bench")


def go_to(page: Page, target: int) -> None:
    page.get_by_test_id("move-target").fill(str(target))
    page.get_by_test_id("move-go").click()


def test_the_first_change_takes_the_free_bench_without_a_word(visit: Callable[..., Page], look: httpx.Client) -> None:
    page = visit(None)
    expect(control(page)).to_have_text("Free · Take the bench")
    go_to(page, 3000)
    wait_for(lambda: axis(look)["position"] == 3000, "the motor is there")
    expect(control(page)).to_have_text("You have the bench")
    expect(dialog(page)).to_have_count(0)
    assert (lease(look)["holder"], lease(look)["mine"]) == ("Chrome on Linux", False)
    page.get_by_test_id("jog-left").hover()
    page.mouse.down()
    wait_for(lambda: axis(look)["velocity_pps"] < 0, "held, it jogs")
    page.mouse.up()
    wait_for(lambda: not axis(look)["moving"], "released, at rest")


def test_who_says_no_is_told_that_nothing_was_sent(visit: Callable[..., Page], look: httpx.Client) -> None:
    take_the_bench(look)
    page = visit("Ann")
    go_to(page, 3000)
    dialog(page).get_by_role("button", name="Only look").click()
    said = page.get_by_test_id("motion-card").get_by_role("status").filter(has_text="Nothing was sent")
    expect(said).to_contain_text("Take the bench, above, and do it again.")
    assert axis(look)["target_position"] == 0
    look.delete("/lease").raise_for_status()


def test_a_jog_button_takes_the_free_bench_too(visit: Callable[..., Page], look: httpx.Client) -> None:
    page = visit("Ann")
    page.get_by_test_id("jog-right").hover()
    page.mouse.down()
    wait_for(lambda: axis(look)["velocity_pps"] > 0, "held, it jogs")
    page.mouse.up()
    wait_for(lambda: not axis(look)["moving"], "released, at rest")
    expect(control(page)).to_have_text("You have the bench")
    expect(dialog(page)).to_have_count(0)


def test_the_bench_is_asked_for_and_handed_over(visit: Callable[..., Page], look: httpx.Client) -> None:
    ann, bob = visit("Ann"), visit("Bob")
    take(ann)
    expect(control(bob)).to_have_text(re.compile(r"^Taken by Ann · \d+\ss$"))
    go_to(bob, 2000)
    expect(dialog(bob)).to_contain_text("Ann has the bench")
    dialog(bob).get_by_role("button", name="Ask Ann for it").click()
    asks = ann.get_by_role("alert").filter(has_text="Bob asks for the bench")
    asks.get_by_role("button", name="Hand over").click()
    expect(asks).to_be_hidden()
    expect(dialog(bob)).to_contain_text("The bench was handed to you. Go on with what you wanted?")
    assert axis(look)["target_position"] == 0
    dialog(bob).get_by_role("button", name="Go on").click()
    wait_for(lambda: axis(look)["position"] == 2000, "what was asked for is done")
    expect(control(ann)).to_have_text(re.compile("^Taken by Bob"))
    expect(control(bob)).to_have_text("You have the bench")


def test_who_does_not_ask_any_more_is_not_shown(visit: Callable[..., Page]) -> None:
    ann, bob = visit("Ann"), visit("Bob")
    take(ann)
    expect(control(bob)).to_have_text(re.compile("^Taken by Ann"))
    control(bob).click()
    bob.get_by_role("button", name="Ask Ann for it").click()
    asks = ann.get_by_role("alert").filter(has_text="Bob asks for the bench")
    expect(asks).to_be_visible()
    bob.get_by_role("button", name="Do not ask any more").click()
    expect(asks).to_be_hidden()
    control(ann).click()
    ann.get_by_role("button", name="Give the bench back").click()
    expect(control(bob)).to_have_text("Free · Take the bench")


def test_who_only_looks_stops_the_motor_and_disturbs_it_not_otherwise(
    visit: Callable[..., Page], look: httpx.Client
) -> None:
    ann, bob = visit("Ann"), visit("Bob")
    take(ann)
    ann.get_by_test_id("shuttle-toggle").click()
    wait_for(lambda: shuttles(look), "it goes there and back")
    expect(control(bob)).to_have_text(re.compile("^Taken by Ann"))
    bob.get_by_test_id("jog-left").hover()
    bob.mouse.down()
    expect(dialog(bob)).to_be_visible()
    bob.mouse.up()
    dialog(bob).get_by_role("button", name="Only look").click()
    expect(dialog(bob)).to_be_hidden()
    assert shuttles(look)
    bob.get_by_test_id("stop-axis").click()
    wait_for(lambda: not shuttles(look), "stopped by one who has not got the bench")
    expect(ann.get_by_test_id("shuttle-toggle")).to_have_text("Start")
    ann.get_by_test_id("shuttle-toggle").click()
    wait_for(lambda: shuttles(look), "it goes again")
    expect(ann.get_by_test_id("shuttle-toggle")).to_have_text("End")  # else a later "Start" may be this one's
    bob.keyboard.press("Escape")
    wait_for(lambda: not shuttles(look), "stopped by the key")
    expect(ann.get_by_test_id("shuttle-toggle")).to_have_text("Start")
    ann.get_by_test_id("shuttle-toggle").click()
    wait_for(lambda: shuttles(look), "it goes once more")
    bob.get_by_role("button", name="Go", exact=True).click()
    expect(dialog(bob)).to_be_visible()
    bob.get_by_test_id("stop-all").click()
    wait_for(lambda: not shuttles(look), "stopped by the button, whatever is asked meanwhile")
    expect(dialog(bob)).to_be_hidden()
    assert lease(look)["holder"] == "Ann"


def test_a_tab_that_vanishes_loses_the_bench_and_its_motor_stops(
    visit: Callable[..., Page], look: httpx.Client
) -> None:
    take_the_bench(look)
    look.put("/lease", json={"on_vanish": "stop", "vanish_after_s": 7}).raise_for_status()
    look.delete("/lease").raise_for_status()
    ann, bob = visit("Ann"), visit("Bob")
    take(ann)
    ann.get_by_test_id("shuttle-toggle").click()
    wait_for(lambda: shuttles(look), "it goes there and back")
    ann.context.close()
    expect(control(bob)).to_have_text("Free · Take the bench", timeout=20_000)
    wait_for(lambda: not shuttles(look) and not axis(look)["moving"], "what is set for it has happened")


def test_the_tabs_of_a_browser_share_the_bench_until_the_last_one_closes(
    visit: Callable[..., Page], look: httpx.Client
) -> None:
    page = visit("Ann")
    take(page)
    second = page.context.new_page()
    second.goto("/")
    expect(control(second)).to_have_text("You have the bench")
    go_to(second, 500)
    wait_for(lambda: axis(look)["position"] == 500, "the second tab moves the motor")
    second.reload()
    expect(control(second)).to_have_text("You have the bench")
    page.close(run_before_unload=True)
    expect(second.get_by_test_id("link-readout").first).to_contain_text("live")
    assert lease(look)["holder"] == "Ann", "the first was not the last"
    second.close(run_before_unload=True)
    wait_for(lambda: lease(look)["state"] == "free", "closed at rest: free", 5.0)


def test_a_tab_that_is_too_busy_to_say_that_it_closes_frees_the_bench(
    visit: Callable[..., Page], look: httpx.Client
) -> None:
    page = visit("Ann")
    take(page)
    page.evaluate("setTimeout(() => { for (const from = Date.now(); Date.now() - from < 4000; ); })")
    page.close(run_before_unload=True)
    wait_for(lambda: lease(look)["state"] == "free", "closed at rest: free", 5.0)


def test_a_reload_loses_and_stops_nothing(visit: Callable[..., Page], look: httpx.Client) -> None:
    bob, page = visit("Bob"), visit("Ann")
    take(page)
    page.get_by_test_id("shuttle-toggle").click()
    wait_for(lambda: shuttles(look), "it goes there and back")
    page.reload()
    expect(control(page)).to_have_text("You have the bench")
    expect(page.get_by_test_id("shuttle-toggle")).to_have_text("End")
    assert shuttles(look)
    page.close(run_before_unload=True)
    wait_for(lambda: lease(look)["left"], "its tab has closed, and its motor moves")
    expect(control(bob)).to_have_text("Free · Take the bench")
    go_to(bob, 100)
    expect(control(bob)).to_have_text("You have the bench")
    bob.keyboard.press("Escape")
    wait_for(lambda: not shuttles(look), "stopped")


def test_what_happens_at_vanishing_is_set_by_keyboard(visit: Callable[..., Page], look: httpx.Client) -> None:
    page = visit(None)
    control(page).focus()
    page.keyboard.press("Enter")
    expect(control(page)).to_have_text("You have the bench")
    control(page).focus()
    page.keyboard.press("Enter")
    panel = page.get_by_role("dialog", name="The bench")
    panel.get_by_role("radio", name="Stop").focus()
    page.keyboard.press("ArrowRight")
    wait_for(lambda: lease(look)["on_vanish"] == "hold", "chosen")
    expect(panel).to_contain_text("a move runs to its target")
    after = panel.get_by_role("textbox", name="after")
    after.fill("20")
    after.press("Enter")
    wait_for(lambda: lease(look)["vanish_after_s"] == 20, "set")
    page.keyboard.press("Escape")
    expect(panel).to_be_hidden()
    expect(control(page)).to_be_focused()


def test_it_is_open_to_everybody(visit: Callable[..., Page], check_axe: Callable[[Page], None]) -> None:
    ann, bob = visit("Ann"), visit(None)
    take(ann)
    expect(control(bob)).to_have_accessible_name(re.compile("^Taken by Ann"))
    bob.get_by_test_id("jog-left").click()
    dialog(bob).get_by_role("button", name="Ask Ann for it").click()
    expect(ann.get_by_role("alert").filter(has_text="asks for the bench")).to_be_visible()
    control(ann).click()
    expect(ann.get_by_role("dialog", name="The bench")).to_be_visible()
    for size, scheme in LOOKS:
        for page in (ann, bob):
            page.set_viewport_size(size)
            page.emulate_media(color_scheme=scheme)
            check_axe(page)
            expect(page.get_by_test_id("stop-all")).to_be_in_viewport(ratio=1)
            expect(control(page)).to_be_in_viewport(ratio=1)
            sideways = page.evaluate("document.scrollingElement.scrollWidth - document.documentElement.clientWidth")
            assert sideways <= 0, f"{size} can be scrolled sideways by {sideways} px"
