"""The health check of the image: it finds a server by what that has left in its data directory, whatever the port."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest
import trustme

from tests.api.processes import running
from tests.docker.test_files import DOCKER


def check(data_dir: Path) -> subprocess.CompletedProcess[str]:
    environment = {name: value for name, value in os.environ.items() if not name.startswith("STEPSCOPE_")}
    return subprocess.run(
        [sys.executable, str(DOCKER / "healthy.py")],
        env={**environment, "STEPSCOPE_DATA_DIR": str(data_dir)},
        capture_output=True,
        text=True,
        check=False,
    )


@pytest.mark.parametrize("tls", [False, True], ids=["http", "https"])
def test_it_follows_port_and_tls_and_tells_when_nobody_answers(tmp_path: Path, tls: bool) -> None:
    options = ["--host", "0.0.0.0", "--port", "0", "--no-demo", "--data-dir", str(tmp_path / "data")]
    if tls:
        issued = trustme.CA().issue_cert("bench.local")  # by whom nobody here trusts, for a name that is not asked
        for blob in issued.cert_chain_pems:
            blob.write_to_path(tmp_path / "cert.pem", append=True)
        issued.private_key_pem.write_to_path(tmp_path / "key.pem")
        options += ["--tls-cert", str(tmp_path / "cert.pem"), "--tls-key", str(tmp_path / "key.pem")]
    with running("serve", *options) as (_, line):
        assert ("https://" in line) == tls
        well = check(tmp_path / "data")
        assert (well.returncode, well.stderr) == (0, "")
        assert '"version"' in well.stdout
    assert check(tmp_path / "data").returncode == 1
    assert check(tmp_path / "nothing").returncode == 1
