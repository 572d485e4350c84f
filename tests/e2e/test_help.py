"""The help in a browser: found from every page, searched, and drawn by the server's own calculators."""

from __future__ import annotations

from collections.abc import Callable

from playwright.sync_api import BrowserContext, Page, expect

from tests.e2e.conftest import PHONE

SMALLEST_PX = 12
TOO_SMALL = f"""[...document.querySelectorAll("body *")].filter(e =>
  [...e.childNodes].some(n => n.nodeType === 3 && n.textContent.trim()) && e.checkVisibility() &&
  parseFloat(getComputedStyle(e).fontSize) < {SMALLEST_PX} && !e.closest("svg, .md-visually-hidden")
).map(e => e.outerHTML.slice(0, 80))"""


def test_help_is_a_click_away_and_works_without_a_network(
    page: Page, new_context: Callable[..., BrowserContext], check_axe: Callable[[Page], None]
) -> None:
    page.goto("/")
    with page.context.expect_page() as opened:
        page.get_by_role("navigation", name="Pages").first.get_by_role("link", name="Help").click()
    help_page = opened.value
    expect(help_page.get_by_role("heading", name="stepscope", level=1)).to_be_visible()

    help_page.goto("/help/how/ramp-law.html")
    figure = help_page.get_by_role("img", name="Velocity and acceleration over")
    expect(figure).to_be_visible()
    before = figure.get_attribute("aria-label")
    slider = help_page.get_by_role("slider", name="Acceleration")
    slider.focus()
    slider.press("End")
    expect(figure).not_to_have_attribute("aria-label", before or "")
    numbers = help_page.locator("[data-live=registers]")
    for pulse_div, ramp_div in ((3, 6), (4, 5)):
        numbers.get_by_role("slider", name="pulse_div").fill(str(pulse_div))
        numbers.get_by_role("slider", name="ramp_div").fill(str(ramp_div))
        # the formulas of the page, at the v, a and f that the sliders and the text begin with
        velocity_pps = 1500 * 16e6 / (2**pulse_div * 2048 * 32)
        acceleration_pps2 = round(400 * 16e6**2 / 2 ** (pulse_div + ramp_div + 29))
        p = 400 / (128 * 2 ** (ramp_div - pulse_div))
        told = (
            ("velocity", f"{velocity_pps:,.6g} pps"),
            ("acceleration", f"{acceleration_pps2:,} pps²"),
            ("p, wanted", f"{p:,.6g}"),
        )
        for what, value in told:
            row = numbers.get_by_role("row").filter(has=help_page.get_by_role("rowheader", name=what, exact=True))
            expect(row.get_by_role("cell")).to_have_text(value)
    check_axe(help_page)
    assert help_page.evaluate(TOO_SMALL) == []

    help_page.keyboard.press("Control+k")
    help_page.get_by_role("dialog").get_by_role("textbox").or_(help_page.get_by_role("combobox")).first.fill("SGTHRS")
    expect(help_page.get_by_role("dialog").get_by_text("TMC2209 registers").first).to_be_visible()

    dark = new_context(viewport=PHONE, color_scheme="dark").new_page()
    dark.goto("/help/reference/registers/tmc5160.html")
    expect(dark.get_by_role("heading", name="TMC5160 registers")).to_be_visible()
    check_axe(dark)
    assert dark.evaluate("document.documentElement.scrollWidth <= innerWidth")
    assert dark.evaluate(TOO_SMALL) == []
