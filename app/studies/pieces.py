"""What a study has measured and its record is too small for: kept beside it until the study is done.

Only a study that was cut off reads it again, to go on without measuring it anew.
"""

from __future__ import annotations

import asyncio
import contextlib
import logging
from pathlib import Path
from typing import Generic, TypeVar

from pydantic import TypeAdapter, ValidationError

from ..errors import StoreUnavailable
from ..store.document import Document, UnreadableDocument

log = logging.getLogger("stepscope.studies")

FILE = "pieces.json"
Piece = TypeVar("Piece")


class Pieces(Generic[Piece]):
    """A list of pieces on disk, in the order in which they were made."""

    def __init__(self, folder: Path, of: type[Piece], *, aside: bool) -> None:
        """`folder` of the study; `of` is what pydantic can write as JSON; `aside`: writes go to a thread, for the disk
        may be slow."""
        self._document, self._aside = Document(folder / FILE), aside
        self._json = TypeAdapter(list[of])  # type: ignore[valid-type]
        self._pieces: list[Piece] = []

    def read(self) -> list[Piece]:
        """Those of an earlier process or an earlier run; none where there are none, or where they cannot be read."""
        try:
            found = self._document.read() or {"pieces": []}
            self._pieces = self._json.validate_python(found.get("pieces"))
        except (UnreadableDocument, ValidationError) as error:
            log.warning("%s is left out, and measured anew: %s", self._document.path, error)
            self._pieces = []
        return list(self._pieces)

    async def add(self, piece: Piece) -> None:
        """On disk when this returns. Raises StoreUnavailable where the disk takes nothing."""
        self._pieces.append(piece)
        await self._write()

    async def forget(self) -> None:
        """None of them is needed any more."""
        self._pieces = []
        with contextlib.suppress(OSError):  # what stays is read by nobody: a study that is done does not go on
            self._document.path.unlink(missing_ok=True)

    async def _write(self) -> None:
        whole: dict[str, object] = {"pieces": self._json.dump_python(self._pieces, mode="json")}

        def write() -> None:
            self._document.path.parent.mkdir(parents=True, exist_ok=True)
            self._document.write(whole)

        try:
            await asyncio.to_thread(write) if self._aside else write()
        except OSError as error:
            raise StoreUnavailable(f"what the study has measured cannot be kept: {error}", "see to the disk") from error
