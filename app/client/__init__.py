"""The same bench from a script: typed calls of the REST API, for plain code (`Bench`) and for asyncio (`AsyncBench`).

    from stepscope import Bench

    with Bench("http://127.0.0.1:8000") as bench:
        bench.write("bench", "V_MAX", 1200, axis=0)
        run = bench.record("bench", ["position.0", "residual.0"], rate_hz=500)
        bench.move("bench", 0, 40_000)  # answers when it has arrived
        bench.stop_recording(run.id)
        residual = bench.recorded(run.id)["residual.0"]  # numpy

Others see who has the bench, and cannot change anything meanwhile, inside of

    with bench.lease("tuning"):
        ...

`records` is what comes back, `errors` what may be raised. Nothing here is sent twice: a call whose answer got lost
may have moved a motor.
"""

from .asynchronous import AsyncBench
from .audit import AuditEntry
from .blocking import Bench
from .errors import BenchNotTaken, BenchTaken, ClientError, MoveEnded, NoAnswer, NoServer, Refused, SearchEnded
from .profiles import SavedProfile
from .records import (
    AxisState,
    Condition,
    Device,
    LeaseState,
    MoveStarted,
    Reading,
    Recording,
    Samples,
    Standing,
    Written,
)
from .scripts import Script

__all__ = [
    "AsyncBench",
    "AuditEntry",
    "AxisState",
    "Bench",
    "BenchNotTaken",
    "BenchTaken",
    "ClientError",
    "Condition",
    "Device",
    "LeaseState",
    "MoveEnded",
    "MoveStarted",
    "NoAnswer",
    "NoServer",
    "Reading",
    "Recording",
    "Refused",
    "Samples",
    "SavedProfile",
    "Script",
    "SearchEnded",
    "Standing",
    "Written",
]
