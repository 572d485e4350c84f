"""Every page, at each size and at 200 % zoom, light and dark, with few devices and with twelve: nothing reaches beyond
the window, no label is cut off untold, none is too small to read, no panel lies upon another."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Literal

import httpx
import pytest
from playwright.sync_api import Browser, BrowserContext, Page, ViewportSize, expect
from server_process import ServerProcess

from tests.e2e.conftest import DESKTOP, PHONE

CHIP, CLOSED_LOOP, MODULE = "overflow-5160", "overflow-4361", "overflow-pd42"
DEVICES = {"bench": "", CHIP: "tmc5160", CLOSED_LOOP: "tmc4361", MODULE: "pd42-1241"}
PAGES = {
    "bench": ("/", "/registers", "/ramps", "/velocity", "/microsteps", "/chain", "/together", "/rotary"),
    CHIP: (
        "/",
        "/registers",
        "/sixpoint",
        "/currents",
        "/microsteps",
        "/encoder",
        "/stallguard",
        "/tune",
        "/first-run",
    ),
    CLOSED_LOOP: (
        "/registers",
        "/sramp",
        "/closed-loop",
        "/filters",
        "/start",
        "/driver-sync",
        "/drive-currents",
        "/microsteps",
    ),
    MODULE: ("/", "/parameters", "/program", "/console", "/encoder", "/stallguard"),
}
OF_A_DEVICE = (
    "/registers",
    "/encoder",
    "/stallguard",
    "/rotary",
    "/tune",
    "/twin",
    "/program",
    "/console",
    "/first-run",
    "/start",
    "/drive-currents",
    "/driver-sync",
    "/closed-loop",
    "/serial-encoder",
    "/parameters",
)
"""Pages that show nothing without a device."""
OF_NO_DEVICE = ("/recordings", "/profiles", "/connections", "/audit", "/health")
VISITS = [(device, path) for device, paths in PAGES.items() for path in paths] + [
    ("bench", path) for path in OF_NO_DEVICE
]

LAPTOP: ViewportSize = {"width": 1280, "height": 720}
ZOOMED: ViewportSize = {"width": 720, "height": 450}
"""1440x900 at 200 %: a browser lays out half as many pixels."""
SCHEMES: tuple[Literal["light", "dark"], ...] = ("light", "dark")
SIZES = {"desktop": DESKTOP, "laptop": LAPTOP, "phone": PHONE, "zoomed": ZOOMED}

CUT_OFF = """() => {
    const shown = (box) => box.width > 1 && box.height > 1;
    const told = (each) => each.closest("[title], [aria-label], [data-tip]") !== null;
    const found = [];
    const walker = document.createTreeWalker(document.body, NodeFilter.SHOW_TEXT);
    for (let node = walker.nextNode(); node; node = walker.nextNode()) {
        const text = node.textContent.trim();
        const owner = node.parentElement;
        if (text === "" || owner.closest("style, script, option, .unseen, pre, textarea")) continue;
        if (!owner.checkVisibility({ opacityProperty: true, visibilityProperty: true })) continue;
        const range = document.createRange();
        range.selectNodeContents(node);
        const words = range.getBoundingClientRect();
        if (!shown(words)) continue;
        for (let box = owner; box && box !== document.body; box = box.parentElement) {
            const style = getComputedStyle(box);
            if (style.position === "fixed" && box !== owner) break;
            if (style.clipPath !== "none" || style.overflowX === "auto" || style.overflowX === "scroll") break;
            if (style.overflowX === "visible") continue;
            const edge = box.getBoundingClientRect();
            if (edge.width <= 1 || edge.height <= 1) break;
            const over = Math.max(words.right - edge.right, edge.left - words.left);
            if (over <= 1.5) continue;
            if (box.closest("[data-cut]") || told(owner) || told(box)) break;
            found.push(`${text.slice(0, 60)}: ${Math.round(over)} px beyond ${box.tagName}.${box.className}`);
            break;
        }
    }
    return found;
}"""
"""Texts that a box around them cuts off, and no title tells."""

HINT_CUT = """() => {
    const drawn = document.createElement("canvas").getContext("2d");
    return [...document.querySelectorAll("input[placeholder]")].flatMap((each) => {
        if (!each.checkVisibility() || each.value !== "" || each.clientWidth < 2) return [];
        const style = getComputedStyle(each);
        drawn.font = style.font;
        const room = each.clientWidth - parseFloat(style.paddingLeft) - parseFloat(style.paddingRight);
        const over = drawn.measureText(each.placeholder).width - room;
        return over > 1.5 ? [`${each.placeholder}: ${Math.round(over)} px more than its field has`] : [];
    });
}"""
"""What an empty field says that it is for, where it has no room for that."""

SMALL = """() => {
    const found = new Set();
    const walker = document.createTreeWalker(document.body, NodeFilter.SHOW_TEXT);
    for (let node = walker.nextNode(); node; node = walker.nextNode()) {
        const text = node.textContent.trim();
        const owner = node.parentElement;
        if (text === "" || owner.closest("style, script, option, .unseen")) continue;
        if (!owner.checkVisibility({ opacityProperty: true, visibilityProperty: true })) continue;
        const size = parseFloat(getComputedStyle(owner).fontSize) * (owner.getScreenCTM?.()?.a ?? 1);
        const what = `${owner.tagName}.${owner.getAttribute("class")}`;
        if (size < 11.9) found.add(`${text.slice(0, 30)}: ${size.toFixed(1)} px, ${what}`);
    }
    return [...found];
}"""
"""Texts of less than 12 px, those of a drawing as large as they are shown."""

SQUEEZED = """() => {
    const found = [];
    for (const cell of document.querySelectorAll("#main :is(th, td)")) {
        if (!cell.checkVisibility() || cell.childElementCount > 0 || cell.clientWidth < 2) continue;
        if (getComputedStyle(cell.parentElement.parentElement).clipPath !== "none") continue;
        const [longest] = cell.textContent.split(/[^A-Za-z]+/).sort((one, other) => other.length - one.length);
        const size = parseFloat(getComputedStyle(cell).fontSize);
        if (longest.length < 12 && cell.clientWidth < 0.4 * size * longest.length)
            found.push(`${cell.textContent.slice(0, 30)}: in ${cell.clientWidth} px`);
    }
    return found;
}"""
"""Cells of a table in which an ordinary word does not fit on a line."""

OVERLAID = """() => {
    const panels = [...document.querySelectorAll("#main [class*=_stack_] > *, #main .column > *")];
    return panels
        .filter((each) => each.scrollHeight > each.clientHeight + 8 && getComputedStyle(each).overflowY === "visible")
        .map((each) => `${each.textContent.slice(0, 30)}: ${each.scrollHeight - each.clientHeight} px`);
}"""
"""Panels, one below the other, that reach into the next."""

BEYOND = """() => {
    const wide = document.documentElement.clientWidth;
    const over = document.scrollingElement.scrollWidth - wide;
    if (over <= 0) return [];
    const guilty = [...document.querySelectorAll("#main *")]
        .filter((each) => each.getBoundingClientRect().right > wide + 1)
        .slice(-3)
        .map((each) => `${each.tagName}.${each.className} ${each.textContent.slice(0, 40)}`);
    return [`scrolls sideways by ${over} px: ${guilty.join(" | ")}`];
}"""


LOOKS = (BEYOND, CUT_OFF, HINT_CUT, SMALL, SQUEEZED, OVERLAID)


@pytest.fixture(scope="module", autouse=True)
def devices(api: httpx.Client) -> Iterator[None]:
    """One of each family beside the demo bench."""
    made = {name: model for name, model in DEVICES.items() if model}
    for name, model in made.items():
        body = {"name": name, "model": model, "link": {"kind": "emulator"}}
        api.post("/devices", json=body, timeout=60).raise_for_status()
    yield
    for name in made:
        api.delete(f"/devices/{name}").raise_for_status()


def settled(page: Page) -> None:
    expect(page.get_by_role("heading", level=1)).to_be_attached()
    expect(page.get_by_label("Loading the page")).to_have_count(0)
    expect(page.locator("#main [aria-busy=true]")).to_have_count(0)


@pytest.mark.parametrize(("device", "path"), VISITS)
def test_nothing_is_cut_off(page: Page, device: str, path: str) -> None:
    page.goto(f"{path}?d={device}")
    settled(page)
    faults = []
    for size, viewport in SIZES.items():
        page.set_viewport_size(viewport)
        settled(page)
        faults += looked_at(page, size)
    assert not faults, "\n".join(faults)


def looked_at(page: Page, size: str) -> list[str]:
    """What is wrong in light and in dark, which may have other widths."""
    faults = []
    for scheme in SCHEMES:
        page.emulate_media(color_scheme=scheme)
        expect(page.locator(f"html[data-mantine-color-scheme={scheme}]")).to_have_count(1)
        faults += [f"{size}, {scheme}: {fault}" for look in LOOKS for fault in page.evaluate(look)]
    return faults


@pytest.fixture(scope="module")
def twelve(api: httpx.Client) -> Iterator[None]:
    """So many devices that there are twelve, some with long names."""
    there = len(api.get("/devices").raise_for_status().json())
    names = [f"overflow-of-a-long-name-{number}" for number in range(12 - there)]
    for name in names:
        body = {"name": name, "model": "tmc5160", "link": {"kind": "emulator"}}
        api.post("/devices", json=body, timeout=60).raise_for_status()
    yield
    for name in names:
        api.delete(f"/devices/{name}").raise_for_status()


@pytest.mark.parametrize("path", ["/", "/?layout=recording", "/?layout=macros", "/connections", "/together", "/health"])
@pytest.mark.usefixtures("twelve")
def test_nothing_is_cut_off_with_twelve_devices(page: Page, path: str) -> None:
    page.goto(path)
    settled(page)
    faults = []
    for size, viewport in SIZES.items():
        page.set_viewport_size(viewport)
        settled(page)
        faults += looked_at(page, size)
    assert not faults, "\n".join(faults)


def test_nothing_is_cut_off_without_a_device(browser: Browser, tmp_path: Path) -> None:
    faults = []
    with ServerProcess(tmp_path, "--no-demo") as bare:
        page = browser.new_context(base_url=bare.url, reduced_motion="reduce").new_page()
        for path in ("/microsteps", "/ramps", "/sramp", "/chain", *OF_NO_DEVICE):
            page.goto(path)
            for size in ("laptop", "phone"):
                page.set_viewport_size(SIZES[size])
                settled(page)
                faults += [f"{path}, {size}: {fault}" for look in LOOKS for fault in page.evaluate(look)]
        for path in OF_A_DEVICE:
            page.goto(path)
            settled(page)
            expect(page.get_by_role("link", name="Add a device")).to_be_visible()
        page.context.close()
    assert not faults, "\n".join(faults)


def test_the_columns_of_the_encoder_page_end_near_each_other(page: Page) -> None:
    """The lower right was blank: a chip has more settings than there are views."""
    page.goto(f"/encoder?d={CHIP}")
    settled(page)
    ends = page.locator("#main .live > .column").evaluate_all(
        "all => all.map((each) => each.lastElementChild).map((last) => last.getBoundingClientRect().bottom)"
    )
    assert len(ends) == 2
    assert abs(ends[0] - ends[1]) < 250, ends


@pytest.mark.parametrize("path", ["/", "/registers", "/recordings", "/connections"])
def test_nothing_is_cut_off_for_fingers(new_context: Callable[..., BrowserContext], path: str) -> None:
    page = new_context(viewport=PHONE, has_touch=True, is_mobile=True).new_page()
    page.goto(path)
    settled(page)
    assert page.locator("html").get_attribute("data-density") == "touch"
    assert page.evaluate(BEYOND) + page.evaluate(CUT_OFF) == []
    small = page.locator("button:visible").evaluate_all(
        "all => all.filter((each) => each.matches('.mantine-Button-root')"
        " && each.getBoundingClientRect().height < 43.5)"
        ".map((each) => each.textContent)"
    )
    assert small == []
