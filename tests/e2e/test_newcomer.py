"""The first minute: an empty data directory, a browser that was never here, three clicks at most."""

from __future__ import annotations

from pathlib import Path

from playwright.sync_api import Browser, Page, expect

from tests.e2e.newcomer import CLICKS_AT_MOST, arrive
from tests.e2e.pictures import hold
from tests.e2e.tutorials import DOCS


def test_a_motor_moves_with_its_prediction_on_top_after_three_clicks_at_most(browser: Browser, tmp_path: Path) -> None:
    """How many seconds that takes is a row of the bench (`newcomer`): a machine that runs tests has other work."""
    picture = tmp_path / "bench.png"

    def look(page: Page) -> None:
        expect(page.get_by_role("button", name="End demo motion")).to_be_visible()
        page.screenshot(path=picture)
        for link in page.get_by_label("Demo").get_by_role("link").all():
            expect(link).to_be_in_viewport(ratio=1)  # what to do next is not cut off

    met = arrive(browser, tmp_path / "data", look)
    assert 0 < met.clicks <= CLICKS_AT_MOST
    assert met.residual < 100, "the prediction is that of this move"
    hold(picture, DOCS / "images" / "bench.png")  # the README's
