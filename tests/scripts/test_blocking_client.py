"""What becomes of the client for asyncio in the one for plain scripts."""

from __future__ import annotations

from pathlib import Path

import pytest
from blocking_client import Unmade, blocking_text

from app import client

FOLDER = Path(client.__file__).parent
SOURCE = (FOLDER / "asynchronous.py").read_text()


def test_what_stands_in_the_repository_is_what_is_made() -> None:
    assert blocking_text(SOURCE) == (FOLDER / "blocking.py").read_text()


def test_a_new_call_is_in_both() -> None:
    more = """
    async def added(self) -> None:
        async with self._http as http:
            async for _ in http.things():
                await self.stop("one")
"""
    made = blocking_text(SOURCE + more)
    assert more.replace("async ", "").replace("await ", "").strip() in made


@pytest.mark.parametrize("left", ["asyncio.gather()", "anext(self)", "AsyncThing()"])
def test_what_is_not_known_without_asyncio_is_told(left: str) -> None:
    with pytest.raises(Unmade, match=left.split("(")[0].split(".")[0]):
        blocking_text(f"{SOURCE}\n{left}\n")
