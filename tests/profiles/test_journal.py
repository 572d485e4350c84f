"""A crash in the middle: the next start knows what was half done, and can bring it back."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

from app.errors import WrongState
from app.profiles import journal
from app.profiles.apply import Transaction
from app.profiles.errors import ProfileLeft
from app.profiles.journal import FileJournal
from app.profiles.rollback import way_back
from app.profiles.service import ProfileService
from tests.profiles.faults import target_of
from tests.profiles.harness import FAMILIES, Bench, bench, by_place


class Crash(BaseException):
    """The process is gone: nothing catches this."""


class CrashingJournal(FileJournal):
    """The real journal, of a process that dies before step `at` is written."""

    at = 3

    def reached(self, index: int) -> None:
        super().reached(index)
        if index == self.at:
            assert self._file is not None
            self._file.close()  # as the system does for a process that is gone
            raise Crash


def service(folder: Path) -> ProfileService:
    async def nothing(*_: Any) -> None:
        raise AssertionError("no settings differ")

    return ProfileService(folder, lambda _: "", nothing)


async def crash(b: Bench, folder: Path) -> None:
    document = (await target_of(b.device.model, seed=4, share=0.2 if b.device.model != "tmc4210" else 0.8)).model_copy(
        update={"axes": []}
    )
    noted = CrashingJournal(journal.path_of(folder, b.device.id), b.device, document)
    with pytest.raises(Crash):
        await Transaction(b.device, document, journal=noted).run()


@pytest.mark.parametrize("model", FAMILIES)
async def test_what_was_half_done_is_known_and_can_be_brought_back(model: str, tmp_path: Path) -> None:
    async with bench(model) as b:
        before = b.truth()
        await crash(b, tmp_path)
        assert b.truth() != before
        profiles = service(tmp_path)  # the next start
        found = profiles.unfinished(b.device)
        assert found is not None
        assert found.crashed
        states = [half.state for half in found.halves]
        assert states[:5] == ["written", "written", "written", "perhaps written", "not begun"]
        with pytest.raises(WrongState, match="did not come to its end"):
            await profiles.apply(b.device, await target_of(model, seed=4, share=0.2))
        assert len(await profiles.take_back(b.device)) == 4
        assert by_place(b.truth(), model) == by_place(before, model)
        assert profiles.unfinished(b.device) is None
        with pytest.raises(WrongState, match="half applied"):
            await profiles.take_back(b.device)


async def test_it_can_be_forgotten(tmp_path: Path, caplog: pytest.LogCaptureFixture) -> None:
    async with bench("tmc428") as b:
        await crash(b, tmp_path)
        service(tmp_path).tell_unfinished()
        assert "did not come to its end" in caplog.text
        service(tmp_path).forget(b.device)
        assert service(tmp_path).unfinished(b.device) is None


async def test_a_way_back_that_fails_is_kept_and_done_again_when_the_device_is_there(tmp_path: Path) -> None:
    async with bench("tmc428") as b:
        before = b.truth()
        document = (await target_of("tmc428", seed=4, share=0.2)).model_copy(update={"axes": []})
        seen = 0

        def unplug(frame: bytes, answer: Any) -> bytes:
            nonlocal seen
            seen += frame[0] & 1 == 0  # writes
            if seen > 5:
                raise ConnectionError("unplugged")
            reply: bytes = answer(frame)
            return reply

        profiles = service(tmp_path)
        b.wire.spoil = unplug
        with pytest.raises(ProfileLeft) as told:
            await profiles.apply(b.device, document)
        b.wire.spoil = None
        await b.clock.advance(5.0)
        found = service(tmp_path).unfinished(b.device)
        assert found is not None
        assert [half.change.name for half in found.halves] == [entry["name"] for entry in told.value.left]
        await profiles.take_back(b.device)
        assert by_place(b.truth(), "tmc428") == by_place(before, "tmc428")


async def test_a_journal_that_nobody_can_read_hides_nothing_else(tmp_path: Path) -> None:
    async with bench("tmc428") as b:
        path = journal.path_of(tmp_path, b.device.id)
        path.parent.mkdir()
        for text in ("", "{}", "[]", '{"format": "other"}', "\xff"):
            path.write_text(text)
            assert service(tmp_path).unfinished(b.device) is None


async def test_a_torn_last_line_is_no_harm(tmp_path: Path) -> None:
    async with bench("tmc428") as b:
        await crash(b, tmp_path)
        path = journal.path_of(tmp_path, b.device.id)
        path.write_text(path.read_text() + "-")
        found = journal.read(path)
        assert found is not None
        assert found.halves[3].state == "perhaps written"
        before = b.truth()
        assert await way_back(b.device, found.steps) == []
        assert b.truth() != before
