"""What holds for every test."""

from __future__ import annotations

import pytest

from tests.conformance import sections


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Refuse `sheet` marks that name no section of a data sheet."""
    sections.check(items)
