"""The list of recordings: paged, searched, and never older than the folder."""

from __future__ import annotations

import json
import os
import threading
import time
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from app.errors import StoreUnavailable, UnknownThing, UsageError, WrongState
from app.store.recordings import file
from app.store.recordings import library as library_module
from app.store.recordings.file import RecordingWriter, Rows
from app.store.recordings.head import Column, Head
from app.store.recordings.library import Label, Library, Stamp
from app.store.recordings.notebook import Cell, Notebook

LONG_AGO_NS = 1_000_000_000


def head(number: int, device: str = "bench") -> Head:
    return Head(
        id=f"20260101-{number // 3600:02}{number // 60 % 60:02}{number % 60:02}-{number:04x}",
        device=device,
        model="tmc428",
        columns=(Column("position.0", "microsteps"),),
        rate_hz=100.0,
        started_unix_s=0.0,
        time_origin_unix_s=0.0,
        chip_timed=True,
        clock_hz=16e6,
    )


def fill(folder: Path, numbers: range) -> None:
    """Recordings without a label, as if copied in: `bench` made the even ones, `other` the odd ones."""
    folder.mkdir(parents=True, exist_ok=True)
    for number in numbers:
        made = head(number, "other" if number % 2 else "bench")
        RecordingWriter(folder / f"{made.id}.arrows", made).close()


def aged(folder: Path) -> None:
    """As if nothing had changed in the folder for long, so that a look at it is kept."""
    os.utime(folder, ns=(LONG_AGO_NS, LONG_AGO_NS))


def counted_scans(monkeypatch: pytest.MonkeyPatch) -> list[Path]:
    """Every look at the names in a folder from now on."""
    scans: list[Path] = []
    listdir = os.listdir

    def counted(path: Path) -> Any:
        scans.append(path)
        return listdir(path)

    monkeypatch.setattr(os, "listdir", counted)
    return scans


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    return tmp_path / "recordings"


@pytest.mark.parametrize("search", ["", "bench tmc428", "OTHER"])
def test_pages_laid_together_are_the_whole_list(folder: Path, search: str) -> None:
    fill(folder, range(53))
    aged(folder)
    library = Library(folder.parent)
    whole = [entry.id for entry in library.page(search).entries]
    pages, before = [], ""
    while True:
        page = library.page(search, limit=7, before=before)
        pages += [entry.id for entry in page.entries]
        assert page.total == len(whole)
        if page.next is None:
            break
        before = page.next
    assert pages == whole == sorted(whole, reverse=True)
    assert len(whole) == {"": 53, "bench tmc428": 27, "OTHER": 26}[search]
    assert [entry.id for entry in library.page(device="other").entries] == [
        entry.id for entry in library.page("other").entries
    ]


def test_a_page_reads_its_own_recordings_and_a_second_look_none(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    fill(folder, range(40))
    aged(folder)
    library = Library(folder.parent)
    read: list[str] = []
    read_head = file.read_head
    scans = counted_scans(monkeypatch)

    def counted_read(path: Path) -> Head:
        read.append(path.stem)
        return read_head(path)

    monkeypatch.setattr(file, "read_head", counted_read)
    shown = [entry.id for entry in library.page(limit=10).entries]
    assert sorted(read, reverse=True) == shown
    assert len(scans) == 1
    assert [entry.id for entry in library.page(limit=10).entries] == shown
    assert (len(read), len(scans)) == (10, 1)


@pytest.mark.parametrize(
    ("age_ns", "tick_ns", "scanned"),
    [
        (0, 1, 3),
        (99_000_000, 1, 3),
        (101_000_000, 1, 1),
        (101_000_000, 1_000_000, 3),
        (1_999_000_000, 1_000_000_000, 3),
        (2_999_000_001, 1_000_000_000, 1),
    ],
)
def test_a_look_is_kept_once_a_change_would_show_on_the_clock_of_the_file_system(
    folder: Path, monkeypatch: pytest.MonkeyPatch, age_ns: int, tick_ns: int, scanned: int
) -> None:
    fill(folder, range(3))
    now_ns = 1_700_000_000_000_000_000
    changed_ns = (now_ns - age_ns) // tick_ns * tick_ns
    os.utime(folder, ns=(changed_ns, changed_ns + (tick_ns == 1)))
    monkeypatch.setattr(time, "time_ns", lambda: now_ns)
    size_bytes = sum(path.stat().st_size for path in folder.iterdir())
    scans = counted_scans(monkeypatch)
    library = Library(folder.parent)
    for _ in range(3):
        assert library.page().size_bytes == size_bytes
    assert len(scans) == scanned


def test_a_change_in_the_tick_of_a_look_that_took_long_is_seen(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    fill(folder, range(3))
    changed_ns = 1_700_000_000_000_000_001
    os.utime(folder, ns=(changed_ns, changed_ns))
    now_ns = changed_ns
    listdir = os.listdir

    def slow(path: Path) -> Any:
        nonlocal now_ns
        now_ns += 5_000_000_000
        return listdir(path)

    monkeypatch.setattr(time, "time_ns", lambda: now_ns)
    monkeypatch.setattr(os, "listdir", slow)
    library = Library(folder.parent)
    assert library.page().total == 3
    fill(folder, range(3, 4))
    os.utime(folder, ns=(changed_ns, changed_ns))
    assert library.page().total == 4


def test_a_search_that_reads_thousands_keeps_nobody_from_a_page(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    fill(folder, range(6))
    aged(folder)
    library = Library(folder.parent)
    newest = library.page(limit=1).entries[0].id
    read_head = file.read_head
    shown: list[str] = []

    def read_while_another_looks(path: Path) -> Head:
        other = threading.Thread(target=lambda: shown.extend(each.id for each in library.page(limit=1).entries))
        other.start()
        other.join(5.0)
        assert set(shown) == {newest}
        return read_head(path)

    monkeypatch.setattr(file, "read_head", read_while_another_looks)
    assert library.page("other").total == 3
    assert len(shown) == 5


@pytest.mark.parametrize(("search", "device"), [("OTHER", ""), ("", "other"), ("", ""), ("nowhere", "")])
def test_a_page_reads_for_so_long_and_the_next_goes_on_where_it_ended(
    folder: Path, monkeypatch: pytest.MonkeyPatch, search: str, device: str
) -> None:
    fill(folder, range(40))
    aged(folder)
    library = Library(folder.parent)
    now_s, read = 0.0, 0
    read_head = file.read_head

    def slow_read(path: Path) -> Head:
        nonlocal now_s, read
        now_s, read = now_s + 1.0, read + 1
        return read_head(path)

    monkeypatch.setattr(file, "read_head", slow_read)
    monkeypatch.setattr(time, "monotonic", lambda: now_s)
    searched = bool(search or device)
    found: list[str] = []
    before, pages = "", 0
    while True:
        pages, read = pages + 1, 0
        page = library.page(search, device, limit=100, before=before, within_s=4.5)
        assert 1 <= read <= 5
        assert page.unread == (40 - 5 * pages if searched else 0)
        found += [entry.id for entry in page.entries]
        if page.next is None:
            break
        before = page.next
    assert pages == 8
    assert found == [each.id for each in library.page(search, device).entries]
    assert len(found) == (0 if search == "nowhere" else 20 if searched else 40)
    assert library.page(search, device, limit=100, within_s=0.0).next is None  # all of it is known


def test_what_was_read_ahead_is_found_without_reading(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    fill(folder, range(20))
    library = Library(folder.parent)
    library.read_all(threading.Event())
    assert len(library.page().entries) == 20
    monkeypatch.setattr(file, "read_head", lambda path: pytest.fail(f"{path} is read again"))
    assert library.page("other", device="other").total == 10
    ended = threading.Event()
    ended.set()
    Library(folder.parent).read_all(ended)  # the server goes: nothing is read any more


def test_the_list_keeps_no_configurations(folder: Path) -> None:
    folder.mkdir(parents=True)
    whole = replace(head(1), configuration={"registers": ["x" * 1000]})
    RecordingWriter(folder / f"{whole.id}.arrows", whole).close()
    library = Library(folder.parent)
    listed = library.page().entries[0]
    assert listed.head is not None
    assert not hasattr(listed.head, "configuration")
    assert library.head(whole.id).configuration == whole.configuration


def test_what_comes_goes_or_is_renamed_is_seen_at_once(folder: Path) -> None:
    fill(folder, range(3))
    aged(folder)
    library = Library(folder.parent)
    first = library.page().entries
    assert len(first) == 3
    fill(folder, range(3, 5))
    assert len(library.page().entries) == 5
    library.label(first[0].id, Label("mine", "a note"))
    assert library.page("mine").entries[0].label == Label("mine", "a note")
    (folder / f"{first[0].id}.json").write_text(json.dumps({"name": "by hand", "note": ""}))
    assert [entry.label.name for entry in library.page().entries if entry.id == first[0].id] == ["by hand"]
    library.delete(first[1].id)
    (folder / f"{first[2].id}.arrows").unlink()
    assert {entry.id for entry in library.page().entries} == {first[0].id, head(3).id, head(4).id}
    with pytest.raises(UnknownThing):
        library.entry(first[1].id)


def test_one_that_is_written_grows_in_the_list_and_in_the_sum(folder: Path) -> None:
    library = Library(folder.parent)
    writer = library.begin(head(1), Label("growing"))
    aged(folder)
    before, sum_before = library.page().entries[0], library.size_bytes
    assert before.recording
    rows = Rows(np.arange(1000.0), np.zeros((1, 1000)))
    writer.append(rows)
    after = library.page().entries[0]
    assert after.size_bytes >= before.size_bytes + 16_000
    sum_after = library.size_bytes
    assert sum_before is not None
    assert sum_after is not None
    assert sum_after - sum_before == after.size_bytes - before.size_bytes
    library.ended(after.id)
    assert not library.page().entries[0].recording
    writer.close()


@pytest.mark.parametrize(
    "text",
    [
        b"",
        b"{",
        b"[]",
        b'{"name": 5}',
        b'{"name": "\\ud800", "note": ["x"]}',
        b"\xff",
        b'{"name": "' + b"x" * 5000 + b'"}',
    ],
)
def test_a_label_that_somebody_spoilt_is_no_obstacle(folder: Path, text: bytes) -> None:
    fill(folder, range(2))
    spoilt = head(1, "other").id
    (folder / f"{spoilt}.json").write_bytes(text)
    entries = Library(folder.parent).page().entries
    assert len(entries) == 2
    assert all(len(entry.label.name.encode()) <= 100 for entry in entries)


def test_a_disk_that_takes_nothing_is_told(folder: Path) -> None:
    library = Library(folder.parent)
    library.begin(head(1), Label("first")).close()
    library.ended(head(1).id)
    (folder / f"{head(1).id}.json.lock").unlink()
    (folder / f"{head(1).id}.json.lock").mkdir()  # nobody may write beside it, not even root
    with pytest.raises(StoreUnavailable, match="is not kept"):
        library.label(head(1).id, Label("second"))
    assert library.entry(head(1).id).label.name == "first"


def test_the_first_page_of_thousands_looks_at_its_own_files_alone(
    folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("app.store.recordings.library.WEIGHED_AT_ONCE", 2)
    fill(folder, range(7))
    looked: list[str] = []

    def looking(path: str) -> Stamp | None:
        looked.append(Path(path).name.partition(".")[0])
        return stamp(path)

    stamp = library_module._stamp
    monkeypatch.setattr(library_module, "_stamp", looking)
    library = Library(folder.parent)
    shown = [entry.id for entry in library.page(limit=2).entries]
    assert shown == [head(6).id, head(5).id]
    assert set(shown) <= set(looked)
    assert len(set(looked)) <= 4  # its own, and two that are weighed
    told = [library.page(limit=1).size_bytes, library.size_bytes, library.size_bytes]
    assert told == [None, None, sum(path.stat().st_size for path in folder.iterdir())]
    looked.clear()
    (folder / f"{head(3).id}.arrows").unlink()
    aged(folder)
    assert library.size_bytes == sum(path.stat().st_size for path in folder.iterdir())
    assert set(looked) <= {head(3).id}


def test_tags_colour_and_notebook_are_kept_searched_and_gone_with_the_recording(folder: Path) -> None:
    fill(folder, range(2))
    library = Library(folder.parent)
    first = library.page().entries[0].id
    library.label(first, Label("mine", "", ("warm", "with load"), "green"))
    cells = (Cell("text", "what was seen"), Cell("figure", "", 0.5, 2.0, ("position.0",)), Cell("table"))
    library.write_notebook(first, cells)
    again = Library(folder.parent)
    assert again.entry(first).label == Label("mine", "", ("warm", "with load"), "green")
    assert [entry.id for entry in again.page("with load").entries] == [first]
    assert again.notebook(first) == Notebook(cells, 1)
    assert again.notebook(library.page().entries[1].id) == Notebook()
    again.write_notebook(first, cells[:1], based_on=1)
    with pytest.raises(WrongState, match="revision 1, and has revision 2"):
        library.write_notebook(first, cells, based_on=1)
    assert library.notebook(first) == Notebook(cells[:1], 2)
    again.delete(first)
    assert list(folder.glob(f"{first}*")) == []


def test_a_notebook_takes_so_much_and_what_is_no_cell_of_an_edited_one_is_left_out(folder: Path) -> None:
    fill(folder, range(1))
    library = Library(folder.parent)
    first = library.page().entries[0].id
    for cells in ([Cell("text")] * 101, [Cell("text", "x" * 4001)], [Cell("figure", "", 2.0, 1.0)]):
        with pytest.raises(UsageError):
            library.write_notebook(first, cells)
    spoilt = [
        7,
        {"kind": "code"},
        {"kind": "text", "text": 5},
        {"kind": "figure", "from_s": "now", "channels": [1, "a"]},
    ]
    (folder / f"{first}.notebook.json").write_text(json.dumps({"cells": spoilt}))
    assert library.notebook(first).cells == (Cell("text", "5"), Cell("figure", "", None, None, ("a",)))
    (folder / f"{first}.notebook.json").write_text("{")
    assert library.notebook(first) == Notebook()
    (folder / f"{first}.json").write_text(json.dumps({"tags": ["a", 3, "b" * 90], "colour": 4}))
    assert library.entry(first).label == Label("", "", ("a", "b" * 40), "")
