"""https by option: the server as a user starts it, with a certificate of an authority made for this test."""

from __future__ import annotations

import re
import ssl
from pathlib import Path

import httpx
import pytest
import trustme

from app.certificate import BadCertificate, require_certificate
from tests.api.processes import address, running


def test_https_with_a_token_for_a_network(tmp_path: Path) -> None:
    authority = trustme.CA()
    issued = authority.issue_cert("127.0.0.1", "localhost")
    certificate, key = tmp_path / "cert.pem", tmp_path / "key.pem"
    for blob in issued.cert_chain_pems:
        blob.write_to_path(certificate, append=True)
    issued.private_key_pem.write_to_path(key)
    trusting = ssl.create_default_context()
    authority.configure_trust(trusting)

    arguments = ["--host", "0.0.0.0", "--port", "0", "--no-demo", "--data-dir", str(tmp_path / "data")]
    with running("serve", *arguments, "--tls-cert", str(certificate), "--tls-key", str(key)) as (_, line):
        found = re.search(r"(https://127\.0\.0\.1:\d+)/\?token=(\S+)", line)
        assert found is not None, line
        url, token = found.groups()
        with httpx.Client(base_url=url, verify=trusting, timeout=30) as visitor:
            assert visitor.get("/api/v1/devices").status_code == 401
            welcome = visitor.get("/", params={"token": token})
            assert welcome.status_code == 303
            assert "secure" in welcome.headers["set-cookie"].casefold()
            assert visitor.get("/api/v1/devices").json() == []
            for path in ("/api/v1/devices", "/", "/api/v1/nothing"):
                assert visitor.get(path).headers["strict-transport-security"].startswith("max-age=")
        with httpx.Client(base_url=url.replace("https", "http")) as plain, pytest.raises(httpx.TransportError):
            plain.get("/api/v1/health")


@pytest.fixture(scope="module")
def pems() -> dict[str, bytes]:
    authority = trustme.CA()
    issued, other = authority.issue_cert("localhost"), authority.issue_cert("elsewhere")
    certificate = issued.cert_chain_pems[0].bytes()
    key = issued.private_key_pem.bytes()
    middle = len(key) // 2
    return {
        "cert": certificate,
        "key": key,
        "other key": other.private_key_pem.bytes(),
        "empty": b"",
        "der": ssl.PEM_cert_to_DER_cert(certificate.decode()).ljust(10, b"\0"),
        "cut cert": certificate[: len(certificate) // 2] + b"\n-----END CERTIFICATE-----\n",
        "cut key": key[:middle] + b"\n" + key[middle + 40 :],
        "locked": b"-----BEGIN ENCRYPTED PRIVATE KEY-----\nMIIB\n-----END ENCRYPTED PRIVATE KEY-----\n",
    }


@pytest.mark.parametrize(
    ("certificate", "key", "named", "why"),
    [
        ("none", "key", "cert.pem", "No such file"),
        ("cert", "none", "key.pem", "No such file"),
        ("empty", "key", "cert.pem", "it is to be PEM"),
        ("der", "key", "cert.pem", "openssl x509 -inform der"),
        ("cert", "empty", "key.pem", "it is to be PEM"),
        ("cut cert", "key", "cert.pem", "damaged"),
        ("cert", "cut key", "key.pem", "damaged"),
        ("key", "cert", "cert.pem", "wrong way round"),
        ("cert", "other key", "key.pem", "is not the key of"),
        ("cert", "locked", "key.pem", "passphrase"),
    ],
)
def test_what_is_wrong_with_a_certificate_is_told_by_the_name_of_its_file(
    tmp_path: Path, pems: dict[str, bytes], certificate: str, key: str, named: str, why: str
) -> None:
    paths = tmp_path / "cert.pem", tmp_path / "key.pem"
    for path, content in zip(paths, (certificate, key), strict=True):
        if content in pems:
            path.write_bytes(pems[content])
    with pytest.raises(BadCertificate, match=re.escape(why)) as found:
        require_certificate(*paths)
    assert str(tmp_path / named) in str(found.value)
    assert "PEM lib" not in str(found.value)


def test_a_server_that_cannot_begin_says_so_in_one_line(tmp_path: Path) -> None:
    (tmp_path / "cert.pem").write_text("nothing")
    arguments = ["--port", "0", "--data-dir", str(tmp_path / "data"), "--tls-cert", str(tmp_path / "cert.pem")]
    with running("serve", *arguments, "--tls-key", str(tmp_path / "key.pem")) as (process, line):
        assert "key.pem cannot be read: No such file" in line
        assert process.wait(30) not in (0, None)


def test_plain_http_promises_no_https(tmp_path: Path) -> None:
    with running("serve", "--port", "0", "--no-demo", "--data-dir", str(tmp_path / "data")) as (_, line):
        assert "strict-transport-security" not in httpx.get(f"{address(line)}/api/v1/health", timeout=30).headers
