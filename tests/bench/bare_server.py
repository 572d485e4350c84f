"""A server of nothing but stepscope's libraries and its page, to compare a start with: `python bare_server.py PORT`.

It runs in an environment where stepscope is installed, and imports nothing of it.
"""

from __future__ import annotations

import importlib
import sys
from importlib import util
from pathlib import Path

LIBRARIES = ("fastapi", "httptools", "numpy", "pydantic_settings", "serial", "sqlalchemy.orm", "typer", "websockets")
"""What a start of stepscope imports too."""


def main(port: int) -> None:
    """Serve until Ctrl-C."""
    for name in LIBRARIES:
        importlib.import_module(name)
    import uvicorn
    from fastapi import FastAPI
    from starlette.staticfiles import StaticFiles

    installed = util.find_spec("stepscope")
    assert installed is not None
    assert installed.origin is not None
    app = FastAPI()
    app.mount("/", StaticFiles(directory=Path(installed.origin).parent / "_web", html=True))
    uvicorn.run(app, host="127.0.0.1", port=port, log_level="error")


if __name__ == "__main__":
    main(int(sys.argv[1]))
