"""Plots, measured in a browser: their labels are whole, and one instant lies on one vertical line in a stack."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from typing import Any

import httpx
import pytest
from playwright.sync_api import BrowserContext, Page, ViewportSize, expect

from tests.e2e import chips
from tests.e2e.conftest import DESKTOP, PHONE
from tests.e2e.motor import a_motor, select, wait_for

LAPTOP: ViewportSize = {"width": 1280, "height": 720}

REMEMBER_TEXT = """
const drawn = new WeakMap();
const lines = new WeakMap();
const { fillText, clearRect, beginPath, lineTo, stroke } = CanvasRenderingContext2D.prototype;
CanvasRenderingContext2D.prototype.clearRect = function (...box) {
  drawn.set(this.canvas, []);
  lines.set(this.canvas, []);
  return clearRect.apply(this, box);
};
let path = [];
CanvasRenderingContext2D.prototype.beginPath = function () {
  path = [];
  return beginPath.call(this);
};
CanvasRenderingContext2D.prototype.lineTo = function (x, y) {
  path.push(y);
  return lineTo.call(this, x, y);
};
CanvasRenderingContext2D.prototype.stroke = function (...what) {
  if (what.length === 0 && path.length > 1)
    lines.get(this.canvas)?.push({ color: this.strokeStyle, from: Math.min(...path), to: Math.max(...path) });
  return stroke.apply(this, what);
};
CanvasRenderingContext2D.prototype.fillText = function (text, x, y, ...rest) {
  const width = this.measureText(text).width;
  const at = this.getTransform().transformPoint(new DOMPoint(x, y));
  const left = at.x - width * ({ right: 1, end: 1, center: 0.5 }[this.textAlign] ?? 0);
  const px = parseFloat(/([\\d.]+)px/.exec(this.font)[1]) / devicePixelRatio;
  drawn.get(this.canvas)?.push({ text, left, right: left + width, y: at.y, px });
  return fillText.call(this, text, x, y, ...rest);
};
window.textOfPlots = () => [...document.querySelectorAll('.uplot')].map((plot) => {
  const canvas = plot.querySelector('canvas');
  const node = plot.querySelector('.u-over');
  const over = node.getBoundingClientRect();
  return {
    label: plot.parentElement.getAttribute('aria-label'),
    width: canvas.width, texts: drawn.get(canvas) ?? [], lines: lines.get(canvas) ?? [],
    inner: { top: node.offsetTop * devicePixelRatio, bottom: (node.offsetTop + node.offsetHeight) * devicePixelRatio },
    left: over.left, right: over.right, top: over.top, height: over.height,
    gutter: (over.left - canvas.getBoundingClientRect().left) * devicePixelRatio,
  };
});
"""
"""Has the page remember what it writes and draws on the canvas of each plot, and where [canvas px]."""


def plots_of(page: Page) -> list[dict[str, Any]]:
    """The plots from top to bottom: the box that is drawn on [px], and all text around and on it [canvas px]."""
    found: list[dict[str, Any]] = page.evaluate("textOfPlots()")
    return found


def labels_beside(plot: dict[str, Any]) -> list[str]:
    """The labels of the left axis."""
    return [each["text"] for each in plot["texts"] if each["right"] <= plot["gutter"]]


def cut_or_small(page: Page) -> list[str]:
    """What does not stand on its canvas whole, or in letters under 12 px."""
    return [
        f"{plot['label']}: {text['text']!r} from {text['left']:.1f} to {text['right']:.1f} px of {plot['width']}, "
        f"{text['px']} px high"
        for plot in plots_of(page)
        for text in plot["texts"]
        if text["left"] < -0.5 or text["right"] > plot["width"] + 0.5 or text["px"] < 12
    ]


def crooked(stack: list[dict[str, Any]]) -> list[str]:
    """The plots that do not begin and end on the vertical lines of the first."""
    return [
        f"{plot['label']}: {plot['left']:.1f} to {plot['right']:.1f} px, "
        f"the first {stack[0]['left']:.1f} to {stack[0]['right']:.1f} px"
        for plot in stack[1:]
        if abs(plot["left"] - stack[0]["left"]) > 0.5 or abs(plot["right"] - stack[0]["right"]) > 0.5
    ]


@pytest.fixture
def far(api: httpx.Client) -> Iterator[chips.Chip]:
    """An emulated TMC5160 at -20 000 000 microsteps, at rest."""
    with chips.a_chip(api, "far away") as chip:
        chips.set_up(chip)
        for name in ("RAMPMODE", "XACTUAL", "XTARGET"):
            chip.write(name, 3 if name == "RAMPMODE" else -20_000_000)
        wait_for(lambda: chip.axis()["position"] == -20_000_000, "it is there")
        yield chip


@pytest.mark.parametrize("size", [DESKTOP, PHONE], ids=["desktop", "phone"])
def test_a_label_keeps_its_sign_and_its_leading_digits(
    new_context: Callable[..., BrowserContext], far: chips.Chip, size: ViewportSize
) -> None:
    context = new_context(viewport=size)
    context.add_init_script(REMEMBER_TEXT)
    chips.select(context, far)
    page = context.new_page()
    for path, plot in (("/", "Position of"), ("/encoder", "Position of motor")):
        page.goto(path)

        def position(name: str = plot) -> list[str]:
            return next((labels_beside(each) for each in plots_of(page) if each["label"].startswith(name)), [])

        wait_for(lambda: any("20" in label for label in position()), f"{path} shows where it is")
        assert not cut_or_small(page)
        assert len(position()) >= 2
        # the window may still hold a sample from before it was put there
        assert all(label.startswith("\N{MINUS SIGN}") or label == "0" for label in position()), position()


def test_one_instant_is_on_one_vertical_line_over_load(page: Page, api: httpx.Client) -> None:
    """The plot of the current has a second axis, those above and below it have none."""
    with a_motor(api, "stacked") as motor:
        select(page, motor)
        page.add_init_script(REMEMBER_TEXT)
        page.goto("/stallguard")
        stack: list[dict[str, Any]] = []

        def drawn() -> bool:
            stack[:] = [plot for plot in plots_of(page) if "over time" in plot["label"]]
            return any("%" in text["text"] for plot in stack for text in plot["texts"])

        wait_for(drawn, "the second axis is there")
        assert len(stack) == 3
        assert crooked(stack) == []
        page.goto("/connections")  # before the motor is gone


CUT = """() => [...document.querySelectorAll('[data-testid=scope] [data-row]')].flatMap((panel) => {
  const outer = panel.parentElement.getBoundingClientRect();
  return [panel, ...panel.querySelectorAll('li, h3')]
    .map((node) => [node, node.getBoundingClientRect()])
    .filter(([node, box]) => box.bottom > outer.bottom + 0.5 || node.scrollHeight > node.clientHeight + 1)
    .map(([node, box]) => `${node.textContent}: ${box.bottom} below ${outer.bottom}`);
})"""
"""The parts of the scope's legends that are not to be seen whole."""


def eventually(check: Callable[[], None]) -> None:
    """All of `check` holds at once within 20 s: events come when they like, and take room."""
    until_s = time.monotonic() + 20
    while True:
        try:
            return check()
        except AssertionError:
            if time.monotonic() > until_s:
                raise
        time.sleep(0.1)


def whole(page: Page, at_least: int) -> None:
    """So many plots of the scope are to be seen whole, on the same vertical lines, with labels and their time."""
    stack = plots_of(page)
    assert len(stack) > at_least, [plot["label"] for plot in stack]
    *plots, axis = stack
    assert crooked(stack) == []
    assert page.evaluate(CUT) == []
    for plot in plots:
        assert len(labels_beside(plot)) >= 2, (plot["label"], labels_beside(plot))
        assert plot["height"] > 50
    assert sum(plot["label"].startswith("Switches") for plot in plots) <= 1
    assert len(axis["texts"]) > 2, "the time axis has its ticks"
    scope = page.get_by_test_id("scope")
    expect(scope.get_by_test_id("time-axis")).to_be_in_viewport(ratio=1, timeout=1000)
    for plot in plots:
        drawn = scope.get_by_role("img", name=plot["label"], exact=True)
        expect(drawn).to_be_in_viewport(ratio=0.95, timeout=1000)


@pytest.mark.parametrize("size", [DESKTOP, LAPTOP], ids=["desktop", "laptop"])
@pytest.mark.parametrize("model", ["tmc4361", "tmc5160"])
def test_the_scope_shows_whole_plots_and_their_time(
    new_context: Callable[..., BrowserContext], api: httpx.Client, model: str, size: ViewportSize
) -> None:
    context = new_context(viewport=size)
    context.add_init_script(REMEMBER_TEXT)
    with chips.a_chip(api, "scoped", model) as chip:
        chips.select(context, chip)
        page = context.new_page()
        page.goto("/")
        expect(page.get_by_test_id("events")).to_be_visible()  # the last to come, and it takes room
        scope = page.get_by_test_id("scope")
        eventually(lambda: whole(page, at_least=2 if size is LAPTOP else 3))
        folded = scope.get_by_test_id("folded-plots").get_by_role("button")
        if folded.count():
            expect(folded.first).to_be_in_viewport(ratio=1)
            name = folded.first.locator("span").first.inner_text()
            folded.first.click()
            expect(scope.get_by_role("img", name=name)).to_have_count(1)
            expect(scope.get_by_test_id("time-axis")).to_be_in_viewport(ratio=1)
            scope.get_by_role("button", name=name, exact=True).click()
            expect(scope.get_by_role("img", name=name)).to_have_count(0)
        page.goto("/connections")  # before the chip is gone


def record(api: httpx.Client, way: int, name: str) -> str:
    """Four seconds of the demo's axis X: at rest, `way` there, and from the second second on back and beyond."""
    channels = ["position.0", "velocity.0"]
    body = {"device": "bench", "channels": channels, "rate_hz": 100.0, "name": name, "duration_s": 4.0}
    recording: str = api.post("/recordings", json=body).raise_for_status().json()["id"]
    api.post("/devices/bench/axes/0/move", json={"target": way}).raise_for_status()
    time.sleep(2)  # the recording is in real time
    api.post("/devices/bench/axes/0/move", json={"target": -3 * way}).raise_for_status()
    state = f"/recordings/{recording}/info"
    wait_for(lambda: api.get(state).raise_for_status().json()["state"] == "done", "it is recorded")
    api.post("/devices/bench/axes/0/move", json={"target": 0}).raise_for_status()
    wait_for(lambda: not api.get("/devices/bench/axes/0").raise_for_status().json()["moving"], "back at zero")
    return recording


def test_compared_recordings_are_seen_whole_and_have_colours_of_their_own(page: Page, api: httpx.Client) -> None:
    recordings = [record(api, 900, "first run"), record(api, 1000, "second run")]
    try:
        page.add_init_script(REMEMBER_TEXT)
        page.goto(f"/recordings/compare?of={','.join(recordings)}")
        expect(page.get_by_test_id("compare-plots")).to_be_visible()

        def curves(plot: dict[str, Any]) -> list[dict[str, Any]]:
            return [line for line in plot["lines"] if line["color"].startswith("#")]

        def drawn() -> list[dict[str, Any]]:
            return [plot for plot in plots_of(page) if "of 2 recordings" in plot["label"]]

        wait_for(lambda: len(drawn()) == 2 and all(len(curves(plot)) == 2 for plot in drawn()), "both are drawn")
        page.wait_for_timeout(500)
        for plot in drawn():
            inner = plot["inner"]
            for line in curves(plot):
                assert line["from"] >= inner["top"], (plot["label"], line, inner)
                assert line["to"] <= inner["bottom"], (plot["label"], line, inner)
            assert len({line["color"] for line in curves(plot)}) == 2, curves(plot)
        assert crooked(drawn()) == []
    finally:
        page.goto("/connections")
        for recording in recordings:
            api.delete(f"/recordings/{recording}").raise_for_status()
