"""The address of a page: what is looked at comes again by Reload, by Back, and by its link in another browser."""

from __future__ import annotations

import re
from collections.abc import Callable

import httpx
from playwright.sync_api import BrowserContext, Locator, Page, expect

from tests.e2e.held import Held
from tests.e2e.views import SHOWN, shown


def picker(page: Page) -> Locator:
    return page.get_by_role("combobox", name="Device and axis")


def test_a_view_comes_again_by_reload_by_back_and_by_its_link(
    page: Page, api: httpx.Client, new_context: Callable[..., BrowserContext]
) -> None:
    other = next(one for one in api.get("/devices").json() if one["id"] != "bench")
    elsewhere = new_context().new_page()
    for address in (
        "/?d=bench&a=1&tab=reference&t=-0.5s&rows=position,velocity",
        "/registers?d=bench&a=2&find=max&reg=2/v_max&axes=all&tab=changes",
        f"/console?d={other['id']}",
        "/audit?d=bench&find=v_max&outcome=refused&span=hour",
    ):
        page.goto(address)
        view = shown(page)
        assert page.url.endswith(address), "nothing is put in place of what a link says"
        page.reload()
        assert shown(page) == view, f"{address} by Reload"
        page.get_by_role("navigation", name="Pages").get_by_role("link", name="Health").click()
        expect(page).to_have_title("Health · stepscope")
        page.go_back()
        assert shown(page) == view, f"{address} by Back"
        elsewhere.goto(page.url)
        assert shown(elsewhere) == view, f"{address} in another browser"


def test_a_page_is_busy_until_the_last_part_of_its_view_is_there(page: Page) -> None:
    held = Held(page, re.compile("/ReferenceSection-"))
    page.goto("/?d=bench&a=1&tab=reference")
    expect(page.get_by_role("tab", name="Zero")).to_have_attribute("aria-selected", "true")
    expect(page.locator("#main i[aria-busy=true]")).to_have_count(1)
    assert page.evaluate(SHOWN) is None
    held.let_go()
    assert "reference" in shown(page)["choices"]


def test_what_is_chosen_goes_into_the_address_and_back_undoes_it(page: Page) -> None:
    page.goto("/registers")
    expect(page).to_have_url(re.compile(r"/registers\?d=bench$"))
    first = picker(page).input_value()
    picker(page).click()
    page.get_by_role("option", name=re.compile("Z")).first.click()
    expect(page).to_have_url(re.compile(r"\?d=bench&a=2$"))
    page.get_by_role("textbox", name="Search registers").fill("v m+")
    expect(page).to_have_url(re.compile(r"&find=v%20m%2B$"))
    page.get_by_role("navigation", name="Pages").get_by_role("link", name="Console").click()
    expect(page).to_have_url(re.compile(r"/console\?d=bench&a=2$"))
    page.go_back()
    expect(page.get_by_role("textbox", name="Search registers")).to_have_value("v m+")
    page.go_back()
    expect(picker(page)).to_have_value(first)
    expect(page).to_have_url(re.compile(r"/registers\?d=bench$"))


def test_tabs_show_axes_of_their_own(page: Page) -> None:
    page.goto("/registers?d=bench&a=1")
    other = page.context.new_page()
    other.goto("/registers?d=bench&a=2")
    third = shown(other)["axis"]
    for each, number in ((page, 1), (other, 2)):
        each.get_by_role("navigation", name="Pages").get_by_role("link", name="Console").click()
        expect(each).to_have_url(re.compile(f"/console\\?d=bench&a={number}$"))
    assert shown(other)["axis"] == third != shown(page)["axis"]
    other.close()


def test_a_link_to_a_device_that_is_gone_shows_the_first_and_stays_as_it_is(page: Page) -> None:
    page.goto("/registers?d=sold&a=3")
    assert shown(page)["axis"].startswith("bench"), "the first device"
    expect(page).to_have_url(re.compile(r"\?d=sold&a=3$"))


def test_the_link_is_copied(page: Page) -> None:
    page.context.grant_permissions(["clipboard-read", "clipboard-write"])
    page.goto("/registers?d=bench&find=max")
    page.get_by_role("button", name="Copy the link to this view").click()
    expect(page.get_by_text("The link to this view is copied.")).to_be_visible()
    assert page.evaluate("navigator.clipboard.readText()") == page.url
    page.context.clear_permissions()
    # as over http to another machine
    page.evaluate("Object.defineProperty(navigator, 'clipboard', { value: undefined })")
    page.get_by_role("button", name="Copy the link to this view").click()
    expect(page.get_by_text(f"Copy it by hand: {page.url}")).to_be_visible()
