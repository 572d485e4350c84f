"""Makes the client for plain scripts of the one for asyncio: the same calls, not awaited."""

from __future__ import annotations

import re
import subprocess
import sys

DOCSTRINGS = {
    "The client for asyncio: the methods of `blocking.Bench`, awaited.": (
        "The client for plain scripts. Each call waits for its answer. Made by `make types` of `asynchronous`."
    ),
    "Cancelling a call\n    stops nothing that has begun.": (
        "May be used from\n    several threads, and as a context manager."
    ),
}
WORDS = (
    (r"\basync (def|with|for)\b", r"\1"),
    (r"\bawait ", ""),
    (r"\bAsync(Bench|Lease|Client|BaseTransport)\b", r"\1"),
    (r"\b__a(enter|exit)__\b", r"__\1__"),
    (r"\baclose\b", "close"),
    (r"\bimport asyncio\b", "import time"),
    (r"\basyncio\.sleep\b", "time.sleep"),
    (r"\bwebsockets\.asyncio\b", "websockets.sync"),
)


class Unmade(ValueError):
    """The client for asyncio has something of asyncio left that is not known here."""


def blocking_text(source: str) -> str:
    """Return the module of `Bench`, made of that of `AsyncBench`. Raises Unmade."""
    text = source
    for said, instead in DOCSTRINGS.items():
        if said not in text:
            raise Unmade(f"the client for asyncio does not say {said!r} any more: change scripts/blocking_client.py")
        text = text.replace(said, instead)
    for pattern, instead in WORDS:
        text = re.sub(pattern, instead, text)
    left = re.search(r"\b(async|await|asyncio|anext|aiter)\b|\bAsync\w+", text)
    if left is not None:
        raise Unmade(f"what {left.group()!r} is without asyncio is not known: add it to scripts/blocking_client.py")
    for step in (["check", "--select", "I", "--fix-only", "--quiet"], ["format", "--quiet"]):
        command = [sys.executable, "-m", "ruff", *step, "--stdin-filename", "app/client/blocking.py", "-"]
        text = subprocess.run(command, input=text, capture_output=True, text=True, check=True, timeout=60).stdout
    return text
