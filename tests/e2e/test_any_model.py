"""From "Add a device" to a parameter on the scope, for a chip and a module drawn at random, by what the page says."""

from __future__ import annotations

import random
from collections.abc import Iterator

import httpx
import pytest
from playwright.sync_api import Page

from app.registers import catalog
from tests.e2e.way_to_scope import way_to_the_scope

NAME = "drawn"
SEED = 15
DRAWN = [
    random.Random(SEED).choice([model.title for model in catalog.listings() if model.kind == kind])
    for kind in ("chip", "module")
]


@pytest.fixture(autouse=True)
def without_it(api: httpx.Client) -> Iterator[None]:
    yield
    api.delete(f"/devices/{NAME}")


@pytest.mark.parametrize("title", DRAWN)
def test_a_parameter_comes_onto_the_scope(page: Page, title: str) -> None:
    page.goto("/")
    assert way_to_the_scope(page, title, NAME)
