"""The browser's page: every route of the client is the page, files are themselves, and it is served safely."""

from __future__ import annotations

import gzip
from pathlib import Path

import httpx
import pytest

from app.main import create_app
from app.settings import Settings


@pytest.mark.parametrize("path", ["/", "/registers", "/devices/bench/ramps", "/index.html"])
async def test_every_route_of_the_client_is_the_page_and_never_kept(pages: httpx.AsyncClient, path: str) -> None:
    answer = await pages.get(path)
    assert answer.status_code == 200
    assert "the page" in answer.text
    assert answer.headers["cache-control"] == "no-cache"
    assert "script-src 'self'" in answer.headers["content-security-policy"]
    assert "frame-ancestors 'none'" in answer.headers["content-security-policy"]
    assert answer.headers["x-content-type-options"] == "nosniff"


async def test_hashed_files_are_kept_for_ever(pages: httpx.AsyncClient) -> None:
    answer = await pages.get("/assets/index-abc123.js")
    assert answer.status_code == 200
    assert "immutable" in answer.headers["cache-control"]
    assert answer.headers["content-type"].startswith(("text/javascript", "application/javascript"))
    assert (await pages.get("/favicon.svg")).headers["cache-control"] == "no-cache"


async def test_what_has_not_changed_is_not_sent_again(pages: httpx.AsyncClient) -> None:
    first = await pages.get("/")
    again = await pages.get("/", headers={"if-none-match": first.headers["etag"]})
    assert again.status_code == 304
    assert again.content == b""


@pytest.fixture
def packed(settings: Settings) -> bytes:
    """A script that the build has packed."""
    plain = b"export const answer = 42;\n" * 100
    for name, content in (("big-abc123.js", plain), ("big-abc123.js.gz", gzip.compress(plain))):
        (settings.web_dir / "assets" / name).write_bytes(content)
    return plain


async def test_what_is_packed_goes_packed_to_who_takes_it(pages: httpx.AsyncClient, packed: bytes) -> None:
    answer = await pages.get("/assets/big-abc123.js", headers={"accept-encoding": "gzip, deflate, br, zstd"})
    assert (answer.headers["content-encoding"], answer.headers["vary"]) == ("gzip", "Accept-Encoding")
    assert answer.headers["content-type"].startswith("text/javascript")
    assert "immutable" in answer.headers["cache-control"]
    assert "script-src 'self'" in answer.headers["content-security-policy"]
    assert int(answer.headers["content-length"]) < len(packed) / 5
    assert answer.content == packed
    tag = answer.headers["etag"]
    again = await pages.get("/assets/big-abc123.js", headers={"accept-encoding": "gzip", "if-none-match": tag})
    assert again.status_code == 304
    plain = await pages.get("/assets/big-abc123.js", headers={"accept-encoding": "identity", "if-none-match": tag})
    assert plain.status_code == 200


@pytest.mark.parametrize("accepted", ["identity", "", "br", "gzip;q=0", "gzip; q=0.0, br", "*;q=0", "*, gzip;q=0"])
async def test_who_takes_no_gzip_gets_the_file_itself(pages: httpx.AsyncClient, packed: bytes, accepted: str) -> None:
    answer = await pages.get("/assets/big-abc123.js", headers={"accept-encoding": accepted})
    assert "content-encoding" not in answer.headers
    assert answer.headers["vary"] == "Accept-Encoding"
    assert answer.content == packed


@pytest.mark.parametrize("accepted", ["gzip;q=0.5", "br, GZIP", "*", "identity;q=0.1, *;q=1"])
async def test_other_words_for_gzip(pages: httpx.AsyncClient, packed: bytes, accepted: str) -> None:
    answer = await pages.get("/assets/big-abc123.js", headers={"accept-encoding": accepted})
    assert (answer.headers["content-encoding"], answer.content) == ("gzip", packed)


@pytest.mark.parametrize("accepted", ["gzip", "identity"])
async def test_what_is_kept_packed_only_goes_to_everybody(
    pages: httpx.AsyncClient, packed: bytes, settings: Settings, accepted: str
) -> None:
    (settings.web_dir / "assets/big-abc123.js").unlink()
    asked = {"accept-encoding": accepted}
    answer = await pages.get("/assets/big-abc123.js", headers=asked)
    assert (answer.status_code, answer.content) == (200, packed)
    assert answer.headers.get("content-encoding", "identity") == accepted
    assert answer.headers["content-type"].startswith("text/javascript")
    assert "immutable" in answer.headers["cache-control"]
    assert answer.headers["vary"] == "Accept-Encoding"
    tag = answer.headers["etag"]
    assert (await pages.get("/assets/big-abc123.js", headers={**asked, "if-none-match": tag})).status_code == 304
    other = {"accept-encoding": "identity" if accepted == "gzip" else "gzip", "if-none-match": tag}
    assert (await pages.get("/assets/big-abc123.js", headers=other)).status_code == 200


@pytest.mark.parametrize("path", ["/", "/registers"])
async def test_a_page_that_is_kept_packed_only_is_found(
    pages: httpx.AsyncClient, settings: Settings, path: str
) -> None:
    (settings.web_dir / "index.html.gz").write_bytes(gzip.compress(b"<title>the packed page</title>"))
    (settings.web_dir / "index.html").unlink()
    for accepted in ("gzip", "identity"):
        answer = await pages.get(path, headers={"accept-encoding": accepted})
        assert answer.headers["content-type"].startswith("text/html")
        assert "the packed page" in answer.text


async def test_the_page_itself_is_packed_too(pages: httpx.AsyncClient, settings: Settings) -> None:
    (settings.web_dir / "index.html.gz").write_bytes(gzip.compress(b"<title>the packed page</title>"))
    answer = await pages.get("/registers", headers={"accept-encoding": "gzip"})
    assert (answer.headers["content-encoding"], answer.headers["cache-control"]) == ("gzip", "no-cache")
    assert answer.headers["content-type"].startswith("text/html")
    assert "the packed page" in answer.text


@pytest.mark.parametrize("path", ["/missing.js", "/assets/old-123.css", "/favicon.ico"])
async def test_a_missing_file_is_404_and_not_the_page(pages: httpx.AsyncClient, path: str) -> None:
    answer = await pages.get(path)
    assert answer.status_code == 404
    assert answer.headers["content-type"] == "application/problem+json"


@pytest.mark.parametrize(
    "path",
    ["/../secret.txt", "/..%2Fsecret.txt", "/assets/%2e%2e/%2e%2e/secret.txt", "/%2Fetc/passwd.txt", "/link.txt"],
)
async def test_no_path_leads_out_of_the_directory(pages: httpx.AsyncClient, settings: Settings, path: str) -> None:
    (settings.web_dir.parent / "secret.txt").write_text("secret")
    (settings.web_dir / "link.txt").symlink_to(settings.web_dir.parent / "secret.txt")
    answer = await pages.get(path)
    assert answer.status_code == 404
    assert "secret" not in answer.text.replace("secret.txt", "")


@pytest.mark.parametrize("path", ["/%00", "/a%00.js", "/" + "x" * 5000])
async def test_strange_paths_are_answered(pages: httpx.AsyncClient, path: str) -> None:
    assert (await pages.get(path)).status_code in (200, 404)


async def test_posting_to_the_page_is_405(pages: httpx.AsyncClient) -> None:
    answer = await pages.post("/registers")
    assert answer.status_code == 405
    assert answer.headers["allow"] == "GET, HEAD"


async def test_without_a_built_page_it_says_how_to_build_it(tmp_path: Path) -> None:
    app = create_app(Settings(data_dir=tmp_path, web_dir=tmp_path / "nothing", demo=False))
    async with httpx.AsyncClient(transport=httpx.ASGITransport(app), base_url="http://localhost") as client:
        answer = await client.get("/")
        assert answer.status_code == 503
        assert "make run" in answer.text
        assert (await client.get("/api/v1/health")).json()["status"] == "ok"


@pytest.mark.parametrize(
    ("path", "title"), [("/help/", "the help"), ("/help/index.html", "the help"), ("/help/how/ramp.html", "ramps")]
)
async def test_the_help_stands_beside_the_page(pages: httpx.AsyncClient, path: str, title: str) -> None:
    answer = await pages.get(path)
    assert (answer.status_code, title in answer.text) == (200, True)
    assert answer.headers["cache-control"] == "no-cache"
    assert "script-src 'self';" in answer.headers["content-security-policy"]


async def test_the_help_is_a_folder(pages: httpx.AsyncClient) -> None:
    answer = await pages.get("/help", follow_redirects=False)
    assert (answer.status_code, answer.headers["location"]) == (307, "/help/")


@pytest.mark.parametrize(
    "path", ["/help/none.html", "/help/how", "/help/../web/index.html", "/help/%2e%2e/web/favicon.svg"]
)
async def test_no_page_of_the_help_is_told(pages: httpx.AsyncClient, path: str) -> None:
    answer = await pages.get(path)
    assert answer.status_code == 404 or "the page" in answer.text  # clients take .. out of a path themselves


async def test_help_that_was_not_built_says_how_it_is(tmp_path: Path) -> None:
    app = create_app(Settings(data_dir=tmp_path, web_dir=tmp_path, help_dir=tmp_path / "nothing", demo=False))
    async with httpx.AsyncClient(transport=httpx.ASGITransport(app), base_url="http://127.0.0.1:8000") as client:
        answer = await client.get("/help/")
    assert answer.status_code == 503
    assert "make run" in answer.text
