"""How long a connection without a call is kept."""

from __future__ import annotations

from pathlib import Path

import httpx

from app.main import create_app
from app.serving import BenchServer
from app.settings import Settings


def test_an_idle_connection_is_kept_longer_by_the_server_than_by_its_clients(tmp_path: Path) -> None:
    """Else a call every few seconds meets, now and then, a connection that is just being closed."""
    settings = Settings(data_dir=tmp_path, web_dir=tmp_path / "no-web", port=0)
    server = BenchServer(create_app(settings), settings, on_ready=lambda: None)
    kept_by_client_s = httpx.Limits().keepalive_expiry
    assert kept_by_client_s is not None
    assert server.config.timeout_keep_alive >= 2 * kept_by_client_s
