"""What holds for every test."""

from __future__ import annotations

import pytest
from hypothesis import settings

from tests.conformance import sections

# How fast something is, `make bench` measures; here a busy machine must not fail a test that is right.
settings.register_profile("stepscope", deadline=None)
settings.load_profile("stepscope")


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Refuse `sheet` marks that name no section of a data sheet."""
    sections.check(items)
