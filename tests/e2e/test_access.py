"""Roles in a browser: who may only look sees all, is told why nothing moves, and may stop; log-out and revoking."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator

import httpx
import pytest
from playwright.sync_api import BrowserContext, Page, expect
from server_process import ServerProcess

from app.store.tokens import TokenStore
from tests.e2e.conftest import PHONE, Errors

OWN = "the server's own token"


@pytest.fixture(scope="module")
def networked(tmp_path_factory: pytest.TempPathFactory) -> Iterator[ServerProcess]:
    with ServerProcess(tmp_path_factory.mktemp("guarded"), "--demo", "--token", OWN) as running:
        yield running


@pytest.fixture(scope="module")
def tokens(networked: ServerProcess) -> TokenStore:
    return TokenStore(networked.data_dir)


@pytest.fixture
def visit(
    new_context: Callable[..., BrowserContext], networked: ServerProcess, errors: Errors
) -> Iterator[Callable[[str], Page]]:
    """Open the server's first page in a browser of one's own, and log in there."""
    errors.expect("HTTP Authentication failed")  # a socket that comes back as its session ends
    errors.expect(r"status of 40[13]")  # what is refused here is refused on purpose

    def come(token: str) -> Page:
        page = new_context(stranger=True, base_url=networked.url).new_page()
        page.goto("/")
        log_in(page, token)
        return page

    yield come
    assert not errors.unexpected()


def log_in(page: Page, token: str) -> None:
    page.get_by_label("Token").fill(token)
    page.get_by_role("button", name="Open the bench").click()
    expect(page.get_by_test_id("lease")).to_be_visible()


def position(server: ServerProcess) -> int:
    bearer = {"authorization": f"Bearer {OWN}"}
    found: int = httpx.get(f"{server.url}/api/v1/devices/bench/axes/0", headers=bearer).json()["position"]
    return found


def test_look_then_drive_then_out(
    visit: Callable[[str], Page], networked: ServerProcess, tokens: TokenStore, check_axe: Callable[[Page], None]
) -> None:
    looks, drives = tokens.add("Zoë", "look"), tokens.add("anna", "drive")
    page = visit(looks)
    expect(page.get_by_test_id("lease")).to_have_attribute("data-lease", "look")
    expect(page.get_by_test_id("link-readout").first).to_contain_text("live")
    page.get_by_role("textbox", name=re.compile("^Move by")).fill("1000")
    page.get_by_role("button", name="Move forward by this distance").click()
    expect(page.get_by_role("alert").filter(has_text="This token may not do that")).to_contain_text("needs drive")
    assert position(networked) == 0
    page.get_by_test_id("lease").click()
    expect(page.get_by_text("for one that may drive")).to_be_visible()
    page.get_by_test_id("lease").click()
    with page.expect_response("**/api/v1/stop") as stopped:
        page.get_by_test_id("stop-all").click()
    assert stopped.value.status == 200

    page.get_by_role("navigation", name="Pages").get_by_role("link", name="Health").click()
    expect(page.get_by_test_id("health-devices")).to_contain_text("slider")
    expect(page.get_by_text("you are Zoë, who may look")).to_be_visible()
    expect(page.get_by_test_id("tokens")).to_have_count(0)
    check_axe(page)
    page.set_viewport_size(PHONE)
    expect(page.get_by_test_id("stop-all")).to_be_in_viewport(ratio=1)
    page.get_by_role("button", name="Log out").click()

    log_in(page, drives)
    page.set_viewport_size({"width": 1440, "height": 900})
    page.get_by_role("textbox", name=re.compile("^Move by")).fill("1000")
    page.get_by_role("button", name="Move forward by this distance").click()
    expect(page.get_by_test_id("lease")).to_have_attribute("data-lease", "mine")
    bearer = {"authorization": f"Bearer {OWN}"}
    assert httpx.get(f"{networked.url}/api/v1/lease", headers=bearer).json()["holder"] == "anna"

    tokens.revoke("anna")
    expect(page.get_by_label("Token")).to_be_visible()


def test_tokens_are_made_shown_once_and_revoked_on_the_page(
    visit: Callable[[str], Page], networked: ServerProcess, check_axe: Callable[[Page], None]
) -> None:
    page = visit(OWN)
    page.goto("/health")
    page.get_by_label("Name", exact=True).fill("bob")
    page.get_by_label("Role", exact=True).select_option("drive")
    page.get_by_role("button", name="Make a token").click()
    token = page.get_by_test_id("new-token").inner_text()
    bearer = {"authorization": f"Bearer {token}"}
    assert httpx.get(f"{networked.url}/api/v1/access", headers=bearer).json()["name"] == "bob"
    check_axe(page)
    page.reload()
    row = page.get_by_test_id("tokens").get_by_role("row").filter(has_text="bob")
    expect(row).to_contain_text("drive")
    expect(page.get_by_text(token)).to_have_count(0)
    row.get_by_role("button", name="Revoke bob").click()
    row.get_by_role("button", name="Revoke bob now").click()
    expect(row).to_have_count(0)
    assert httpx.get(f"{networked.url}/api/v1/access", headers=bearer).status_code == 401


def test_health_without_a_server_says_so(page: Page, errors: Errors) -> None:
    errors.expect("ERR_FAILED")
    page.goto("/health")
    expect(page.get_by_test_id("health")).to_have_attribute("data-stale", "false")
    page.route("**/api/v1/health/details", lambda route: route.abort())
    expect(page.get_by_test_id("health")).to_have_attribute("data-stale", "true")
    expect(page.get_by_text("old: the server does not answer")).to_be_visible()
    page.unroute("**/api/v1/health/details")
    expect(page.get_by_test_id("health")).to_have_attribute("data-stale", "false")
