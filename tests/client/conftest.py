"""A real server on a free port; blocking clients run in a thread beside its loop."""

from __future__ import annotations

from collections.abc import AsyncIterator
from pathlib import Path

import pytest

from tests.api.live import live_server


@pytest.fixture
async def server(tmp_path: Path) -> AsyncIterator[str]:
    """The address of a server with the demo bench."""
    async with live_server(tmp_path, demo=True) as url:
        yield url
