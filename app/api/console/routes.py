"""TMCL in direct mode: one command to a module, and its answer as it is."""

from __future__ import annotations

from ...errors import SoftLimit
from ..abilities import CurrentTmcl
from ..audit import wording
from ..http.problems import DEVICE_PROBLEMS, problems
from ..policy import policy
from ..router import subject_router
from .schemas import TmclCommand, TmclReply
from .tmcl_text import command_of

router = subject_router(prefix="/devices/{device}", tags=["tmcl"])


@router.post("/tmcl", responses=problems(*DEVICE_PROBLEMS, SoftLimit))
@policy(audit="told by drivers", words=wording.tmcl)
async def send_tmcl(device: CurrentTmcl, body: TmclCommand) -> TmclReply:
    """Send one command once, as it is. An error status of the module is an answer, not an error of this call."""
    opcode, type_, motor, value = command_of(body)
    sent = await device.tmcl(opcode, type_, motor, value)
    return TmclReply(
        request=sent.request.hex(),
        reply=sent.reply.hex() if sent.reply else None,
        status=sent.status,
        status_text=sent.status_text,
        value=sent.value,
        text=sent.text,
        took_ms=sent.took_ms,
    )
