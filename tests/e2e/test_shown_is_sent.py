"""What a page shows at the moment of a click is what it sends, on a computer that is four times too slow."""

from __future__ import annotations

import json
import re
from collections import Counter
from collections.abc import Iterator
from typing import Any

import httpx
import pytest
from playwright.sync_api import Page, expect

from tests.e2e import motor as modules
from tests.e2e.chips import a_chip, select
from tests.e2e.conftest import Errors
from tests.e2e.motor import TURN, a_motor

SLOWER = 4
CLICK_AND_LOOK = """async ([look, name]) => {
  const button = () => [...document.querySelectorAll("button")].find((each) => each.textContent.trim() === name);
  while (button() === undefined || button().disabled) await new Promise(requestAnimationFrame);
  const shown = [...document.querySelectorAll(look)].map((cell) => cell.textContent);
  button().click();
  return shown;
}"""
"""As soon as the button can be clicked, and in one turn of the page's loop: nothing runs between look and click."""
DESIGN = "tr[data-changed] td:nth-of-type(2)"


NOTE_WHAT_IS_SENT = """const send = window.fetch;
window.sent = [];
window.fetch = async (request, ...rest) => {
  if (request instanceof Request && request.method !== "GET")
    window.sent.push({ url: request.url, body: await request.clone().text() });
  return send(request, ...rest);
};"""
"""Playwright does not see the body of a `Request` object."""


@pytest.fixture
def slow(page: Page, errors: Errors) -> Iterator[Page]:
    """The page on a computer that has other things to do."""
    errors.expect("404")  # a question about the device that was under way when its test took it away
    page.add_init_script(NOTE_WHAT_IS_SENT)
    page.set_default_timeout(60_000)
    tools = page.context.new_cdp_session(page)
    tools.send("Emulation.setCPUThrottlingRate", {"rate": SLOWER})
    yield page
    tools.send("Emulation.setCPUThrottlingRate", {"rate": 1})


def numbers(texts: list[str]) -> list[int]:
    """Those of the texts that are a number; the others are the names of a field's values."""
    plain = (re.sub(r"\s", "", text.replace("\N{MINUS SIGN}", "-")) for text in texts)
    return [int(text) for text in plain if re.fullmatch(r"-?\d+", text)]


def sends(page: Page, look: str, button: str, to: str) -> tuple[list[str], Any]:
    """What the page shows at `look` when `button` is clicked, and the body that it then sends to that address."""
    page.evaluate("window.sent = []")
    shown = page.evaluate(CLICK_AND_LOOK, [look, button])
    sent = page.wait_for_function("to => window.sent.find(({ url }) => url.endsWith(to))", arg=to)
    return shown, json.loads(sent.json_value()["body"])


def type_in(page: Page, label: re.Pattern[str], value: int) -> None:
    field = page.get_by_label(label).first
    field.fill(str(value))
    field.press("Enter")


@pytest.mark.parametrize(
    ("model", "path", "label", "values"),
    [
        ("tmc428", "/ramps", re.compile("^a_max in chip units", re.IGNORECASE), (300, 700, 1500)),
        ("tmc5160", "/sixpoint", re.compile("^AMAX in chip units$"), (1200, 3400, 5600)),
        ("tmc4361", "/sramp", re.compile("^AMAX in "), (120_000, 340_000, 560_000)),
    ],
)
def test_a_design_goes_to_the_chip_as_the_table_shows_it(
    slow: Page, api: httpx.Client, model: str, path: str, label: re.Pattern[str], values: tuple[int, ...]
) -> None:
    with a_chip(api, f"slow {model}", model) as chip:
        select(slow, chip)
        slow.goto(path)
        expect(slow.get_by_label(label).first).not_to_have_value("", timeout=60_000)
        for value in values:
            type_in(slow, label, value)
            shown, body = sends(slow, DESIGN, "Send", "/registers")
            written = [
                part
                for write in body["writes"]
                for part in ([write["value"]] if write.get("value") is not None else write["fields"].values())
            ]
            assert len(shown) == len(written)
            assert numbers(shown)
            assert not Counter(numbers(shown)) - Counter(written)
        slow.goto("about:blank")  # before its chip is gone


def test_a_dial_turns_to_the_target_that_it_shows(slow: Page, api: httpx.Client) -> None:
    with a_motor(api, "slow table") as motor:
        motor.write("maximum_positioning_speed", 2 * TURN)
        modules.select(slow, motor)
        slow.goto("/rotary")
        field = slow.get_by_test_id("per-turn")
        field.fill(str(TURN))
        field.press("Tab")
        slow.get_by_test_id("watch").click()
        expect(slow.get_by_test_id("state")).to_have_text("stands", timeout=60_000)
        for angle in (90, 270, 45):
            field = slow.get_by_test_id("target-angle")
            field.fill(str(angle))
            field.press("Tab")
            shown, body = sends(
                slow,
                "[data-testid=preview-target]",
                "Go",
                "/extended-position",
            )
            assert numbers(shown) == [int(body["target"])]
            expect(slow.get_by_test_id("state")).to_have_text("stands", timeout=60_000)
        slow.goto("about:blank")
