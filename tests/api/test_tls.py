"""https by option: the server as a user starts it, with a certificate of an authority made for this test."""

from __future__ import annotations

import re
import ssl
from pathlib import Path

import httpx
import pytest
import trustme

from tests.api.processes import running


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
        with httpx.Client(base_url=url, verify=trusting) as visitor:
            assert visitor.get("/api/v1/devices").status_code == 401
            welcome = visitor.get("/", params={"token": token})
            assert welcome.status_code == 303
            assert "secure" in welcome.headers["set-cookie"].casefold()
            assert visitor.get("/api/v1/devices").json() == []
        with httpx.Client(base_url=url.replace("https", "http")) as plain, pytest.raises(httpx.TransportError):
            plain.get("/api/v1/health")
