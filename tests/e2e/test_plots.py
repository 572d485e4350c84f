"""Plots, measured in a browser: their labels are whole, and one instant lies on one vertical line in a stack."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Any

import httpx
import pytest
from playwright.sync_api import BrowserContext, Page, ViewportSize

from tests.e2e import chips
from tests.e2e.conftest import DESKTOP, PHONE
from tests.e2e.motor import a_motor, select, wait_for

REMEMBER_TEXT = """
const drawn = new WeakMap();
const { fillText, clearRect } = CanvasRenderingContext2D.prototype;
CanvasRenderingContext2D.prototype.clearRect = function (...box) {
  drawn.set(this.canvas, []);
  return clearRect.apply(this, box);
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
  const over = plot.querySelector('.u-over').getBoundingClientRect();
  return {
    label: plot.parentElement.getAttribute('aria-label'),
    width: canvas.width, texts: drawn.get(canvas) ?? [],
    left: over.left, right: over.right, top: over.top, height: over.height,
    gutter: (over.left - canvas.getBoundingClientRect().left) * devicePixelRatio,
  };
});
"""
"""Has the page remember what it writes on the canvas of each plot, and where [canvas px]."""


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
