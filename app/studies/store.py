"""Studies on disk: a folder each in the data directory, with its record, its search's memory and what it was before."""

from __future__ import annotations

import asyncio
import logging
import re
import shutil
import time
from pathlib import Path

from pydantic import ValidationError

from ..errors import StoreUnavailable, UnknownThing, WrongState
from ..store.document import Document, UnreadableDocument
from .document import StudyDocument
from .record import StudyRecord

log = logging.getLogger("stepscope.studies")

FOLDER, RECORD = "studies", "study.json"
KEPT_MAX = 500
ID = re.compile(r"[0-9]{8}-[0-9]{6}(-[0-9]{1,3})?")


class StudyStore:
    """The folder of all studies. What blocks says so."""

    def __init__(self, data_dir: Path, *, aside: bool = True) -> None:
        """`aside`: writes go to a thread, for the disk may be slow."""
        self._root, self._aside = data_dir / FOLDER, aside
        self._records: dict[str, StudyRecord] = {}
        self._new: set[str] = set()
        """Those that were begun and are not on disk yet: nobody is shown a record that a disk may still refuse."""
        self._read = False

    def folder(self, study: str) -> Path:
        """Of one study."""
        return self._root / study

    def load(self) -> list[StudyRecord]:
        """Read all of them, once; what ran when the server ended is told as interrupted. Blocks."""
        if self._read:
            return list(self._records.values())
        self._read = True
        for path in sorted(self._root.glob(f"*/{RECORD}")):
            if not ID.fullmatch(path.parent.name):
                continue
            try:
                # What an older version told beside is no reason to leave a study out.
                record = StudyRecord.model_validate(Document(path).read(), extra="ignore")
            except (UnreadableDocument, ValidationError) as error:
                log.warning("%s is left out, and stays: %s", path, error)
                continue
            if record.state == "running":
                record.state, record.phase, record.left_s = "interrupted", "over", None
                record.message = "the server ended in the middle of it"
                before = ", ".join(record.before_told())
                set_still = f"the last setting that was tried may still be set: look at {before}"
                if before:
                    record.left = [set_still, "the motor may still turn: stop it first"]
                else:  # it has set nothing: there is nothing to put back before the next study
                    record.left, record.message = [], f"{record.message}: the motor may still turn, stop it"
            self._records[record.id] = record
        return list(self._records.values())

    def all(self) -> list[StudyRecord]:
        """The latest first."""
        return sorted(self._records.values(), key=lambda record: record.id, reverse=True)

    def get(self, study: str) -> StudyRecord:
        """Raises UnknownThing."""
        found = self._records.get(study)
        if found is None:
            raise UnknownThing("study", study, sorted(self._records, reverse=True)[:12])
        return found

    def begin(self, document: StudyDocument) -> StudyRecord:
        """A new record; it is listed when it is on disk. Raises WrongState where there are too many."""
        if len(self._records) >= KEPT_MAX:
            raise WrongState(f"{KEPT_MAX} studies are kept already", "delete some of them")
        now_s = time.time()
        stem = time.strftime("%Y%m%d-%H%M%S", time.gmtime(now_s))
        name, count = stem, 1
        while name in self._records or name in self._new or self.folder(name).exists():
            count += 1
            name = f"{stem}-{count}"
        record = StudyRecord(id=name, document=document, started_unix_s=now_s)
        self._new.add(name)
        return record

    async def save(self, record: StudyRecord) -> None:
        """On disk when this returns. Raises StoreUnavailable."""
        whole = record.model_dump(mode="json")

        def write() -> None:
            folder = self.folder(record.id)
            folder.mkdir(parents=True, exist_ok=True)
            Document(folder / RECORD).write(whole)

        try:
            await asyncio.to_thread(write) if self._aside else write()
        except OSError as error:
            raise StoreUnavailable(f"the study cannot be kept: {error}", "see to the disk") from error
        finally:
            new = record.id in self._new
            self._new.discard(record.id)
        if new:
            self._records[record.id] = record

    def delete(self, study: str) -> None:
        """Gone for good. Blocks. Raises UnknownThing, WrongState while it runs, StoreUnavailable."""
        if self.get(study).state == "running":
            raise WrongState("the study runs", "stop it first")
        try:
            if self.folder(study).exists():
                shutil.rmtree(self.folder(study))
        except OSError as error:
            raise StoreUnavailable(f"the study cannot be deleted: {error}", "see to the disk") from error
        del self._records[study]
