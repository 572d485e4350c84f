"""Requests of a page that wait until a test lets them go."""

from __future__ import annotations

import re

from playwright.sync_api import Page, Route

PASSES, PASS_MS = 3000, 10


class Held:
    """Every request to `url` from now on, in the order in which they were made."""

    def __init__(self, page: Page, url: str | re.Pattern[str]) -> None:
        self._page = page
        self._waiting: list[Route] = []
        self._open = False
        page.route(url, self._on_route)

    def _on_route(self, route: Route) -> None:
        # Letting one go takes a moment in which the next may come. The page's own `unroute` would have let go of those
        # that wait, of which some may have been taken care of just then.
        if self._open:
            route.continue_()
        else:
            self._waiting.append(route)

    def let_one_go(self) -> None:
        """The oldest; waits for one where none has come yet."""
        for _ in range(PASSES):
            if self._waiting:
                break
            self._page.wait_for_timeout(PASS_MS)  # routes come while the browser is waited for
        self._waiting.pop(0).continue_()

    def let_go(self) -> None:
        """All that wait, and all that come."""
        self._open = True
        while self._waiting:
            self._waiting.pop(0).continue_()
