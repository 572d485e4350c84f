"""What decides whether the UI is built, and with which Node.js."""

from __future__ import annotations

import gzip
import json
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import built_folder
import pytest

import web


@pytest.fixture
def sources(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A UI of two files, in place of ours."""
    folder = tmp_path / "web"
    (folder / "src").mkdir(parents=True)
    (folder / "package.json").write_text("{}")
    (folder / "src" / "main.ts").write_text("export {};")
    monkeypatch.setattr(web, "WEB", folder)
    monkeypatch.setattr(web, "TARGET", tmp_path / "app" / "_web")
    web.TARGET.parent.mkdir()
    return folder


def finish(sources: Path, page: str = "a page") -> None:
    """What `build` does once npm is through."""
    (sources / "dist").mkdir(exist_ok=True)
    (sources / "dist" / "index.html").write_text(page)
    built_folder.replace(sources / "dist", web.TARGET, {"sources": web.sources_hash()})


def test_a_build_is_fresh_until_a_source_changes(sources: Path) -> None:
    assert not web.is_fresh()
    finish(sources)
    assert web.is_fresh()
    assert web.build() is False
    (sources / "src" / "main.ts").write_text("export const x = 1;")
    assert not web.is_fresh()


def test_two_that_build_at_once_build_once(sources: Path) -> None:
    build = "mkdir -p dist && cp src/main.ts dist/index.html"
    (sources / "package.json").write_text(json.dumps({"name": "page", "scripts": {"build": build}}))
    (sources / "package-lock.json").write_text(json.dumps({"name": "page", "lockfileVersion": 3, "packages": {"": {}}}))
    with ThreadPoolExecutor() as pool:
        builds = [pool.submit(web.build) for _ in range(3)]
    assert sorted(one.result() for one in builds) == [False, False, True]
    assert (web.TARGET / "index.html").read_text() == "export {};"


@pytest.mark.parametrize("change", ["renamed", "removed", "added"])
def test_names_count_as_well_as_contents(sources: Path, change: str) -> None:
    finish(sources)
    main = sources / "src" / "main.ts"
    if change == "renamed":
        main.rename(main.with_name("other.ts"))
    elif change == "removed":
        main.unlink()
    else:
        main.with_name("more.ts").touch()
    assert not web.is_fresh()


def test_what_tools_leave_behind_does_not_count(sources: Path) -> None:
    before = web.sources_hash()
    for folder in web.NOT_SOURCES:
        (sources / folder).mkdir()
        (sources / folder / "file").write_text("made by a tool")
    assert web.sources_hash() == before


def test_a_new_build_takes_the_place_of_the_old_one(sources: Path) -> None:
    finish(sources)
    (web.TARGET / "stale.js").touch()
    finish(sources, "another page")
    assert (web.TARGET / "index.html").read_text() == "another page"
    assert not (web.TARGET / "stale.js").exists()
    assert [path.name for path in web.TARGET.parent.iterdir()] == [web.TARGET.name]


def test_without_sources_the_build_says_so(sources: Path) -> None:
    (sources / "package.json").unlink()
    with pytest.raises(web.WebBuildError, match=r"web/package\.json is not in this tree"):
        web.build()


@pytest.mark.parametrize(
    ("node", "npm", "usable"),
    [
        ("v20.19.0", "11.0.0", True),
        ("v20.18.9", "11.0.0", False),
        ("v21.7.0", "11.0.0", False),
        ("v22.11.0", "11.0.0", False),
        ("v22.12.0", "11.5.1", True),
        ("v23.0.0", "11.0.0", True),
        ("v26.1.0", "12.0.0", True),
        ("v18.20.0", "11.0.0", False),
        ("v22.12.0", "10.9.0", False),
        ("not a version", "11.0.0", False),
    ],
)
def test_a_node_too_old_for_vite_is_passed_over(tmp_path: Path, node: str, npm: str, usable: bool) -> None:
    for name, version in (("node", node), ("npm", npm)):
        program = tmp_path / name
        program.write_text(f"#!/bin/sh\necho '{version}'\n")
        program.chmod(0o755)
    found = web._probe(tmp_path)
    assert (found is not None) == usable
    if found is not None:
        assert (found.node_version, found.npm_version) == (node.removeprefix("v"), npm)
        assert found.environment()["PATH"].startswith(f"{tmp_path}:")


def test_this_machine_has_a_node_that_runs() -> None:
    node = web.require_node()
    program = node.program("node")
    assert program is not None
    assert web._probe(Path(program).parent) == node


def test_what_shrinks_lies_packed_beside_itself(sources: Path) -> None:
    page = "<p>the same again</p>" * 100
    (sources / "dist").mkdir()
    (sources / "dist" / "small.js").write_text("// nothing to gain")
    (sources / "dist" / "logo.png").write_bytes(bytes(5000))
    finish(sources, page)
    assert gzip.decompress((web.TARGET / "index.html.gz").read_bytes()).decode() == page
    assert [path.name for path in web.TARGET.glob("*.gz")] == ["index.html.gz"]
