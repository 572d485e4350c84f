"""The motor data base: figures of a public list, and the user's own beside them."""

from __future__ import annotations

import asyncio
from dataclasses import asdict
from typing import Annotated

from fastapi import Path, Query

from ...calc.motors.data_base import OWN, Motor, found, listed
from ...errors import StoreUnavailable, UnknownThing, UsageError
from ...store.motors import KEPT_MAX
from ..audit import wording
from ..deps import CurrentBench
from ..http.problems import problems
from ..policy import policy
from ..router import subject_router
from .schemas import MotorFigures, MotorInfo, MotorList

router = subject_router(prefix="/motors", tags=["motors"])

PUBLIC_LIST = "github.com/andrewmcgr/klipper_tmc_autotune (a list of users, not checked against the makers' sheets)"

MotorName = Annotated[
    str, Path(description="as it is called on its plate", min_length=1, max_length=80, pattern=r"^[^/\x00-\x1f]+$")
]


@router.get("")
async def list_motors(
    bench: CurrentBench,
    search: Annotated[str, Query(max_length=100, description="words of the name; all of them")] = "",
    limit: Annotated[int, Query(ge=1, le=KEPT_MAX)] = 50,
    own: Annotated[bool, Query(description="only your own, none of the public list")] = False,
) -> MotorList:
    """Motors whose names have all these words: your own first, then those of a public list."""
    kept = await asyncio.to_thread(bench.motors.all)
    names = {motor.name for motor in kept}
    others = () if own else (motor for motor in listed() if motor.name not in names)
    motors = found([*kept, *others], search)
    return MotorList(found=len(motors), motors=[_info(motor) for motor in motors[:limit]])


@router.put("/{motor}", responses=problems(UsageError, StoreUnavailable))
@policy(lease="free", words=wording.named("keep motor"))
async def put_motor(bench: CurrentBench, motor: MotorName, body: MotorFigures) -> MotorInfo:
    """Keep a motor of your own, instead of the one of that name."""
    own = Motor(name=motor, **body.model_dump())
    await asyncio.to_thread(bench.motors.put, own)
    return _info(own)


@router.delete("/{motor}", status_code=204, responses=problems(UnknownThing, StoreUnavailable))
@policy(lease="free", words=wording.named("delete motor"))
async def delete_motor(bench: CurrentBench, motor: MotorName) -> None:
    """Forget a motor of your own; one of the list under the same name is there again."""
    await asyncio.to_thread(bench.motors.delete, motor)


def _info(motor: Motor) -> MotorInfo:
    own = motor.source == OWN
    return MotorInfo(**{**asdict(motor), "source": "kept on this server" if own else PUBLIC_LIST}, own=own)
