"""What outlives a run: readable, atomic, versioned, never lost."""

from __future__ import annotations

import asyncio
import json
import multiprocessing
import os
import threading
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from app.clock import VirtualClock
from app.devices.core.config import AxisSettings, DeviceConfig
from app.store.connections import FILE_NAME, ConnectionStore
from app.store.document import Document, UnreadableDocument
from app.store.saver import RETRY_S, Saver


def config(name: str = "Bench", seed: int = 1, *, demo: bool = False) -> DeviceConfig:
    axes = (AxisSettings("X", gear_ratio=2.5, travel_mm_per_rev=8.0),)
    return DeviceConfig(name, "tmc4210", {"kind": "emulator", "seed": seed}, 16e6, axes, demo)


def names(directory: Path) -> list[str]:
    return [one.name for one in ConnectionStore(directory).load().configs]


def test_nothing_saved_is_no_connections_and_no_file(tmp_path: Path) -> None:
    loaded = ConnectionStore(tmp_path / "new").load()
    assert (loaded.configs, loaded.warnings) == ([], [])
    assert not (tmp_path / "new").exists()


def test_there_and_back_without_the_demo(tmp_path: Path) -> None:
    kept = [config("Änderung 1"), config("b", 2)]
    ConnectionStore(tmp_path / "deep" / "down").save([*kept, config("demo", demo=True)])
    assert ConnectionStore(tmp_path / "deep" / "down").load().configs == kept
    text = (tmp_path / "deep" / "down" / FILE_NAME).read_text()
    assert "Änderung 1" in text  # for people too
    assert text.count("\n") > 20
    assert json.loads(text)["version"] == 1


@settings(max_examples=30, deadline=None)
@given(
    given_names=st.lists(st.text(min_size=1, max_size=10).filter(lambda text: bool(text.strip())), max_size=5),
    gear=st.floats(1e-3, 1e3),
)
def test_any_configuration_survives(
    given_names: list[str], gear: float, tmp_path_factory: pytest.TempPathFactory
) -> None:
    kept = [
        DeviceConfig(name, "tmc428", {"kind": "tcp", "host": name, "port": 1}, axes=(AxisSettings(gear_ratio=gear),))
        for name in given_names
    ]
    directory = tmp_path_factory.mktemp("store")
    ConnectionStore(directory).save(kept)
    assert ConnectionStore(directory).load().configs == kept


@pytest.mark.parametrize(
    "text",
    [
        "",
        "{",
        "[]",
        "\x00\x01",
        '{"format": "stepscope-connections", "version": 2, "connections": []}',
        '{"format": "other", "version": 1, "connections": []}',
        '{"format": "stepscope-connections", "version": 1, "connections": {}}',
        "[" * 100_000,
    ],
)
def test_a_broken_file_is_set_aside_and_not_lost(tmp_path: Path, text: str) -> None:
    path = tmp_path / FILE_NAME
    path.write_text(text)
    store = ConnectionStore(tmp_path)
    loaded = store.load()
    assert loaded.configs == []
    assert len(loaded.warnings) == 1
    assert str(path) in loaded.warnings[0]
    store.save([config()])
    assert names(tmp_path) == ["Bench"]
    aside = [other for other in tmp_path.iterdir() if ".broken-" in other.name]
    assert text in {other.read_text() for other in aside}
    assert str(aside[0]) in loaded.warnings[0]


LINKS: list[dict[str, object]] = [
    {"kind": "serial", "port": "/dev/ttyACM0", "baud": 115_200, "address": 3, "timeout_s": 0.5},
    {"kind": "tcp", "host": "gateway", "port": 4001, "address": 2},
    {"kind": "can", "interface": "socketcan", "channel": "can0", "bitrate": 500_000, "send_id": 3, "receive_id": 4},
    {"kind": "emulator", "eeprom": "motor", "motor": {"rated_current_a": 1.0}, "stage": {"left_at_fullsteps": -50.0}},
]


def test_links_of_modules_survive(tmp_path: Path) -> None:
    kept = [DeviceConfig(f"module {number}", "pd42-1241", link) for number, link in enumerate(LINKS)]
    ConnectionStore(tmp_path).save(kept)
    assert ConnectionStore(tmp_path).load().configs == kept


def test_what_is_kept_back_stays_in_the_file(tmp_path: Path) -> None:
    odd = DeviceConfig("odd", "pd42-1241", {"kind": "usb-hid", "serial": "A1"})
    ConnectionStore(tmp_path).save([config("good"), odd])
    store = ConnectionStore(tmp_path)
    assert [one.name for one in store.load().configs] == ["good", "odd"]  # it knows no kinds of links
    store.keep_back(odd)
    store.save([config("good"), config("new", 2)])
    store.save([config("new", 3), config("odd", 4)])
    later = [(one.name, one.link) for one in ConnectionStore(tmp_path).load().configs]
    assert sorted(later, key=str) == [
        ("new", {"kind": "emulator", "seed": 3}),
        ("odd", {"kind": "emulator", "seed": 4}),
        ("odd", odd.link),
    ]


def test_one_bad_connection_does_not_take_the_others_with_it(tmp_path: Path) -> None:
    ConnectionStore(tmp_path).save([config("good"), config("bad")])
    path = tmp_path / FILE_NAME
    document = json.loads(path.read_text())
    document["connections"][1]["model"] = "tmc9999"
    path.write_text(json.dumps(document))
    store = ConnectionStore(tmp_path)
    loaded = store.load()
    assert [one.name for one in loaded.configs] == ["good"]
    assert "'bad'" in loaded.warnings[0]
    assert "tmc9999" in loaded.warnings[0]
    store.save(loaded.configs)
    assert ConnectionStore(tmp_path).load().warnings == []  # told once, kept in the file set aside
    aside = next(other for other in tmp_path.iterdir() if ".broken-" in other.name)
    assert "tmc9999" in aside.read_text()


@pytest.mark.parametrize(
    "damage",
    [
        {"link": "emulator"},
        {"axes": 3},
        {"axes": [{"gear_ratio": 0}]},
        {"axes": [{"wheels": 4}]},
        {"name": 5},
        {"clock_hz": "fast"},
        {"colour": "red"},
    ],
)
def test_every_kind_of_damage_is_one_warning_and_a_copy(tmp_path: Path, damage: dict[str, object]) -> None:
    ConnectionStore(tmp_path).save([config("bad")])
    path = tmp_path / FILE_NAME
    document = json.loads(path.read_text())
    document["connections"][0] |= damage
    path.write_text(json.dumps(document))
    loaded = ConnectionStore(tmp_path).load()
    assert loaded.configs == []
    assert len(loaded.warnings) == 2


def test_a_disk_that_is_full_leaves_the_old_file(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    store = ConnectionStore(tmp_path)
    store.save([config("old")])

    def full(_: int) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(os, "fsync", full)
    with pytest.raises(OSError, match="No space"):
        store.save([config("new")])
    monkeypatch.undo()
    assert names(tmp_path) == ["old"]
    assert not list(tmp_path.glob("*.tmp"))


def test_a_crash_before_the_rename_leaves_the_old_file(tmp_path: Path) -> None:
    document = Document(tmp_path / "d.json")
    document.write({"a": 1})
    (tmp_path / "d.json.x.tmp").write_text('{"a": 2')  # what a killed writer leaves behind
    assert document.read() == {"a": 1}


def test_two_programs_do_not_lose_each_other_s_connections(tmp_path: Path) -> None:
    ConnectionStore(tmp_path).save([config("shared"), config("doomed")])
    one, other = ConnectionStore(tmp_path), ConnectionStore(tmp_path)
    ours, theirs = one.load().configs, other.load().configs
    other.save([*theirs, config("theirs")])
    one.save([ours[0], config("ours")])  # removes "doomed", has never heard of "theirs"
    assert sorted(names(tmp_path)) == ["ours", "shared", "theirs"]
    one.save([ours[0], config("ours")])  # and once more: what was not ours still is not
    assert sorted(names(tmp_path)) == ["ours", "shared", "theirs"]


def test_of_two_changes_to_one_connection_the_later_stays_and_an_unchanged_one_yields(tmp_path: Path) -> None:
    ConnectionStore(tmp_path).save([config("a", 1), config("b", 1)])
    one, other = ConnectionStore(tmp_path), ConnectionStore(tmp_path)
    one.load(), other.load()
    other.save([config("a", 2), config("b", 2)])
    one.save([config("a", 1), config("b", 3)])
    assert [c.link["seed"] for c in ConnectionStore(tmp_path).load().configs] == [2, 3]


def _write_many(directory: str, who: int) -> None:
    store = ConnectionStore(Path(directory))
    found = store.load().configs
    for number in range(10):
        store.save([*found, *(config(f"process {who} entry {entry}") for entry in range(number + 1))])


def test_many_processes_write_at_once(tmp_path: Path) -> None:
    context = multiprocessing.get_context("spawn")
    writers = [context.Process(target=_write_many, args=(str(tmp_path), who)) for who in range(2)]
    for writer in writers:
        writer.start()
    for writer in writers:
        writer.join(60)
        assert writer.exitcode == 0
    assert len(names(tmp_path)) == 20


def test_threads_see_a_whole_document_always(tmp_path: Path) -> None:
    document = Document(tmp_path / "d.json")
    document.write({"values": [0] * 1000})
    torn: list[object] = []
    ended = threading.Event()

    def read() -> None:
        while not ended.is_set():
            try:
                found = document.read()
            except UnreadableDocument as error:
                torn.append(error)
            else:
                values = found["values"] if found else None
                if not isinstance(values, list) or len(values) != 1000 or len(set(values)) != 1:
                    torn.append(found)

    reader = threading.Thread(target=read)
    reader.start()
    for number in range(50):
        document.write({"values": [number] * 1000})
    ended.set()
    reader.join()
    assert torn == []


async def test_many_changes_are_written_soon_and_the_last_one_wins(tmp_path: Path) -> None:
    store = ConnectionStore(tmp_path)
    present: list[DeviceConfig] = []
    saver = Saver(store, lambda: present, VirtualClock())
    for number in range(50):
        present.append(config(f"n{number}"))
        saver.request()
    await saver.close()
    assert len(names(tmp_path)) == 50
    assert saver.problem is None


async def test_what_cannot_be_saved_is_told_and_tried_again(tmp_path: Path) -> None:
    blocked = tmp_path / "file"
    blocked.write_text("")
    saver = Saver(ConnectionStore(blocked / "dir"), lambda: [config()], VirtualClock())
    saver.request()
    await saver.close()
    problems = [saver.problem]
    blocked.unlink()
    saver.request()
    await saver.close()
    problems.append(saver.problem)
    assert [problem is None for problem in problems] == [False, True]
    assert names(blocked / "dir") == ["Bench"]


def test_a_byte_order_mark_is_no_obstacle(tmp_path: Path) -> None:
    ConnectionStore(tmp_path).save([config()])
    file = tmp_path / FILE_NAME
    file.write_bytes(b"\xef\xbb\xbf" + file.read_bytes())
    loaded = ConnectionStore(tmp_path).load()
    assert (loaded.configs, loaded.warnings) == ([config()], [])


async def test_what_the_disk_does_not_take_is_tried_again_by_itself(tmp_path: Path) -> None:
    blocked, clock = tmp_path / "file", VirtualClock()
    blocked.write_text("")
    saver = Saver(ConnectionStore(blocked / "dir"), lambda: [config()], clock)
    saver.request()
    assert "tried again" in await saver.settled()
    saver.request()
    assert "tried again" in await saver.settled()
    blocked.unlink()
    while saver.problem is not None:
        await clock.advance(RETRY_S)
        await asyncio.sleep(0.001)  # the disk's own time
    assert names(blocked / "dir") == ["Bench"]
    assert await saver.settled() == ""
    await saver.close()
