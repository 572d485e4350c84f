"""A server that does nothing: what the machine and the framework alone take for an answer. `PORT`."""

from __future__ import annotations

import sys

import uvicorn
from fastapi import FastAPI

app = FastAPI()


@app.post("/api/v1/stop")
async def stop() -> None:
    """Nothing."""


if __name__ == "__main__":
    uvicorn.run(app, host="127.0.0.1", port=int(sys.argv[1]), log_level="error", loop="asyncio", http="httptools")
