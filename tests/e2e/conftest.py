"""A real browser against a real server. Playwright's fixtures are our own, a module long.

Playwright's synchronous API keeps an event loop running in this thread, in which pytest-asyncio could start no other:
a browser that lived for the whole session, as pytest-playwright's does, would fail every async test after it.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Generator, Iterator
from pathlib import Path

import httpx
import pytest
from axe_playwright_python.sync_playwright import Axe
from chromium import chromium_flags, find_chromium
from playwright.sync_api import (
    Browser,
    BrowserContext,
    ConsoleMessage,
    Page,
    ViewportSize,
    WebError,
    expect,
    sync_playwright,
)
from server_process import ServerProcess

from tests.e2e.session import a_client, begin_with_the_bench, take_the_bench

RESULTS = Path(__file__).parents[2] / "test-results"
DESKTOP: ViewportSize = {"width": 1440, "height": 900}
PHONE: ViewportSize = {"width": 390, "height": 844}

expect.set_options(timeout=30_000)  # the machine may be busy; passing tests do not wait for it


def pytest_itemcollected(item: pytest.Item) -> None:
    """Mark every test here: `make test` runs them apart, each file by one worker, which has a server of its own."""
    item.add_marker(pytest.mark.e2e)


class Errors:
    """What went wrong in the pages of a test: failed scripts and console errors. Any makes the test fail."""

    def __init__(self) -> None:
        self._seen: list[str] = []
        self._expected: list[re.Pattern[str]] = []

    def expect(self, pattern: str) -> None:
        """Let errors pass that `pattern` finds: the test causes them on purpose."""
        self._expected.append(re.compile(pattern))

    def on_console(self, message: ConsoleMessage) -> None:
        if message.type == "error":
            self._seen.append(f"console: {message.text} ({message.location.get('url', '')})")

    def on_error(self, error: WebError) -> None:
        self._seen.append(f"uncaught: {error.error}")

    def unexpected(self) -> list[str]:
        return [error for error in self._seen if not any(pattern.search(error) for pattern in self._expected)]


@pytest.fixture(scope="session")
def server(tmp_path_factory: pytest.TempPathFactory) -> Iterator[ServerProcess]:
    """One server for all browser tests: they leave its demo bench standing still, as they found it."""
    with ServerProcess(tmp_path_factory.mktemp("data"), "--demo") as running:
        yield running


@pytest.fixture(scope="session")
def api(server: ServerProcess) -> Iterator[httpx.Client]:
    """The same server without a browser: to arrange, and to look behind the page, as the same session."""
    with a_client(server.url) as client:
        yield client


@pytest.fixture(scope="module")
def browser() -> Iterator[Browser]:
    with sync_playwright() as playwright:
        # All pages of a context in one process: a fresh one would start, and compile every script, for each.
        flags = [*chromium_flags(), "--renderer-process-limit=1"]
        running = playwright.chromium.launch(executable_path=find_chromium(), args=flags)
        yield running
        running.close()


@pytest.fixture
def errors() -> Errors:
    return Errors()


@pytest.fixture
def new_context(
    browser: Browser, server: ServerProcess, errors: Errors, api: httpx.Client
) -> Iterator[Callable[..., BrowserContext]]:
    """Make further browsers-in-the-browser, of other sizes or schemes, that fail the test for errors too.

    Their pages have the bench already, together with `api`; `stranger=True`: as somebody who opens the first page.
    Pictures step instead of rolling, which is most of what a browser works: `reduced_motion=None` for others.
    """
    made: list[BrowserContext] = []

    def make(*, stranger: bool = False, **options: object) -> BrowserContext:
        wanted = {"base_url": server.url, "viewport": DESKTOP, "reduced_motion": "reduce", **options}
        context = browser.new_context(**wanted)  # type: ignore[arg-type]
        context.set_default_timeout(30_000)
        context.on("console", errors.on_console)
        context.on("weberror", errors.on_error)
        if not stranger:
            take_the_bench(api)
            begin_with_the_bench(context)
        made.append(context)
        return context

    yield make
    for context in made:
        context.close()


@pytest.fixture(scope="module")
def usual_context(browser: Browser, server: ServerProcess) -> Iterator[BrowserContext]:
    """The browser-in-the-browser of every `page` of a module: in a fresh one, all scripts would be compiled anew."""
    context = browser.new_context(base_url=server.url, viewport=DESKTOP, reduced_motion="reduce")
    context.set_default_timeout(30_000)
    begin_with_the_bench(context)
    # A tab of our origin that stays, without a script of ours: with the last one goes what the browser has compiled.
    context.new_page().goto("/api/v1/health")
    yield context
    context.close()


@pytest.fixture
def page(
    usual_context: BrowserContext,
    server: ServerProcess,
    api: httpx.Client,
    errors: Errors,
    request: pytest.FixtureRequest,
) -> Iterator[Page]:
    """A fresh page of desktop size; nothing is stored or allowed in its browser. After the test no error may have
    been seen.

    What a test adds (scripts, routes, listeners) it adds to the page, which ends with it, and not to its context.
    """
    forget_all(usual_context, server.url)
    take_the_bench(api)
    idle = usual_context.pages[0]

    def on_console(message: ConsoleMessage) -> None:
        if message.page is not idle:  # for a page that is no HTML, Chromium asks for a /favicon.ico, some time
            errors.on_console(message)

    usual_context.on("console", on_console)
    usual_context.on("weberror", errors.on_error)
    page = usual_context.new_page()
    yield page
    # Before the page closes: what a test ends in the middle of is not its doing.
    usual_context.remove_listener("console", on_console)
    usual_context.remove_listener("weberror", errors.on_error)
    if request.node.stash.get(FAILED, False):
        RESULTS.mkdir(exist_ok=True)
        name = re.sub(r"[^\w.-]+", "_", request.node.name)
        page.screenshot(path=RESULTS / f"{name}.png")
        (RESULTS / f"{name}.html").write_text(page.content())
    for opened in usual_context.pages[1:]:
        opened.close()
    assert not errors.unexpected()


def forget_all(context: BrowserContext, origin: str) -> None:
    """Leave nothing of former tests but the browser's caches: no storage, no cookies, no permissions."""
    context.clear_cookies()
    context.clear_permissions()
    tools = context.new_cdp_session(context.pages[0])
    kinds = "local_storage,indexeddb,cache_storage,service_workers"
    tools.send("Storage.clearDataForOrigin", {"origin": origin, "storageTypes": kinds})
    tools.detach()


FAILED = pytest.StashKey[bool]()


@pytest.hookimpl(wrapper=True)
def pytest_runtest_makereport(item: pytest.Item) -> Generator[None, pytest.TestReport, pytest.TestReport]:
    """Let fixtures know whether their test failed: a failed one leaves a picture of its page."""
    report = yield
    if report.when == "call":
        item.stash[FAILED] = report.failed
    return report


@pytest.fixture
def check_axe() -> Callable[[Page], None]:
    """Fail for what axe calls serious or critical on a page, naming the rule and the elements."""
    axe = Axe()

    def look(page: Page) -> list[str]:
        # What is being calculated anew is faded for that moment, and meant to be.
        expect(page.locator(".stale")).to_have_count(0)
        return [
            f"{violation['id']} ({violation['impact']}): {violation['help']}\n"
            + "\n".join(f"    {node['html']}\n    {node['failureSummary']}" for node in violation["nodes"])
            for violation in axe.run(page).response["violations"]
            if violation["impact"] in ("serious", "critical")
        ]

    def check(page: Page) -> None:
        # Colours half-way between two schemes are nobody's choice.
        page.add_style_tag(content="*, *::before, *::after { transition: none !important; animation: none !important }")
        # Twice, for a calculation may begin while axe looks; what is wrong stays wrong.
        findings = look(page) and look(page)
        assert not findings, "\n".join(findings)

    return check
