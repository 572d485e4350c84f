"""Profiles: a device's whole configuration as a document, captured, compared, applied and kept."""

from __future__ import annotations

import asyncio
from typing import Annotated

from fastapi import Path, Query
from fastapi.responses import Response

from ...errors import OutOfRange, SoftLimit, StoreUnavailable, UnknownThing, WrongState
from ...profiles.diff import Diff, compare, diff
from ...profiles.document import ProfileDocument, plain, text_of
from ...profiles.errors import ProfileLeft, ProfileMisfit, ProfileTakenBack, UnreadableProfile
from ...profiles.program import commands_of
from ...profiles.register_bits import bits_of
from ..audit import wording
from ..deps import CurrentBench, CurrentDevice
from ..http.problems import DEVICE_PROBLEMS, problems
from ..policy import policy
from ..router import subject_router
from ..server_state import ServerState
from .schemas import (
    ApplyProgress,
    ProfileApplied,
    ProfileDetail,
    ProfileIn,
    ProfileInfo,
    ProfileLabel,
    ProfileList,
    ProfilePair,
    ProfileSave,
    TakenBack,
    TriedParameter,
    TriedWrites,
)
from .views import applied, detail, dry_run, info, progress_of, taken_back

router = subject_router(tags=["profiles"])

ProfileId = Annotated[int, Path(description="as in the list", ge=1, le=1 << 53)]
FILE = "application/vnd.stepscope.profile+json"
"""A file of one profile: JSON in the form that `POST /profiles` takes as a document."""

# --- of a device ------------------------------------------------------------------------------------


@router.get("/devices/{device}/profile", responses=problems(*DEVICE_PROBLEMS))
async def get_profile(
    device: CurrentDevice,
    bench: CurrentBench,
    program: Annotated[
        bool, Query(description="with the program in a module's memory: 64 commands or more are read, a call each")
    ] = True,
) -> ProfileDocument:
    """The device's whole configuration as a document, as it is now."""
    return await bench.profiles.capture(device, program=program)


@router.put(
    "/devices/{device}/profile",
    responses=problems(
        *DEVICE_PROBLEMS, UnreadableProfile, ProfileMisfit, SoftLimit, ProfileTakenBack, ProfileLeft, StoreUnavailable
    ),
)
@policy(lease="free as a dry run", audit="silent as a dry run", whole=True, words=wording.apply_profile)
async def put_profile(
    device: CurrentDevice,
    bench: CurrentBench,
    body: ProfileIn,
    dry_run_: Annotated[
        bool, Query(alias="dry_run", description="only tell what would change: nothing is written")
    ] = False,
    limits: Annotated[bool, Query(description="apply the profile's soft limits too, when all else is done")] = False,
) -> ProfileApplied:
    """Bring the device to what the profile says, as one transaction; what it does not speak of stays.

    Every write is read back. The first that fails ends it, and what was written is written back in reverse order: the
    problem then tells the step that failed (`failed`), and what is not as it was (`left`).
    """
    if dry_run_:
        return dry_run(await diff(device, body))
    return applied(await bench.profiles.apply(device, body, with_limits=limits))


@router.post("/devices/{device}/profile/try", responses=problems(*DEVICE_PROBLEMS))
@policy(audit="told by drivers", words=wording.done("try what can be set"))
async def try_profile(device: CurrentDevice, bench: CurrentBench) -> TriedWrites:
    """Find out what is configuration, of a device whose table does not tell what can be written.

    Each parameter that may be configuration is written the value that it holds, once, and read back; the motors have to
    stand. What the device takes is what a profile of it has from then on, until it is connected with another firmware.
    """
    tried = await bench.profiles.try_writes(device)
    refused = [TriedParameter(name=name, axis=axis) for name, axis in tried.refused]
    return TriedWrites(settable=tried.settable, refused=refused)


@router.get("/devices/{device}/profile/apply", responses=problems(UnknownThing))
async def get_apply(device: CurrentDevice, bench: CurrentBench) -> ApplyProgress:
    """How far the transaction under way is, or what an earlier one has left: cut off by a crash, or by a dead link."""
    unfinished = await asyncio.to_thread(bench.profiles.unfinished, device)  # reads its journal
    return progress_of(bench.profiles.progress(device), unfinished)


@router.post(
    "/devices/{device}/profile/apply/way-back", responses=problems(*DEVICE_PROBLEMS, ProfileLeft, StoreUnavailable)
)
@policy(whole=True, words=wording.done("take profile back"))
async def take_back(device: CurrentDevice, bench: CurrentBench) -> TakenBack:
    """Bring back what an unfinished transaction has written: each register that is not as it was before."""
    return taken_back(await bench.profiles.take_back(device))


@router.delete("/devices/{device}/profile/apply", status_code=204, responses=problems(UnknownThing, WrongState))
@policy(words=wording.done("forget half a profile"))
async def forget_apply(device: CurrentDevice, bench: CurrentBench) -> None:
    """Leave the device as an unfinished transaction has left it, and forget what it was before."""
    bench.profiles.forget(device)


# --- kept ones --------------------------------------------------------------------------------------


@router.get("/profiles", responses=problems(StoreUnavailable))
async def list_profiles(
    bench: CurrentBench,
    search: Annotated[str, Query(max_length=200, description="words of name, note, model or device")] = "",
    model: Annotated[str, Query(max_length=40, description="only those of this model")] = "",
) -> ProfileList:
    """All kept profiles, the latest first."""
    return ProfileList(profiles=[info(saved) for saved in await bench.profile_store.all(search, model)])


@router.post(
    "/profiles",
    status_code=201,
    responses=problems(*DEVICE_PROBLEMS, UnreadableProfile, StoreUnavailable),
)
@policy(lease="free", words=wording.named("save profile"))
async def save_profile(bench: CurrentBench, body: ProfileSave) -> ProfileInfo:
    """Keep a document, or what a device holds now. A document that no device could take is refused."""
    document: ProfileDocument
    if body.document is None:
        document = await bench.profiles.capture(bench.manager.get(body.device or ""), program=True)
    else:
        document = body.document
        bits_of(document)
        await asyncio.to_thread(commands_of, document)
    name = body.name or document.name or document.title
    note = document.note if body.note is None else body.note
    return info(await bench.profile_store.add(name, note, plain(document)))


@router.post(
    "/profiles/compare",
    responses=problems(UnknownThing, WrongState, ProfileMisfit, UnreadableProfile, StoreUnavailable),
)
@policy(lease="free", role="look", audit="silent")
async def compare_profiles(bench: CurrentBench, body: ProfilePair) -> Diff:
    """What differs between two profiles of the same model."""
    return compare(await _document(bench, body.left), await _document(bench, body.right))


async def _document(bench: ServerState, given: ProfileDocument | int) -> ProfileDocument:
    if isinstance(given, ProfileDocument):
        return given
    return detail(await bench.profile_store.get(given)).document


@router.get(
    "/profiles/{profile:int}", responses=problems(UnknownThing, WrongState, UnreadableProfile, StoreUnavailable)
)
async def get_profile_kept(bench: CurrentBench, profile: ProfileId) -> ProfileDetail:
    """A kept profile with its document."""
    return detail(await bench.profile_store.get(profile))


@router.get(
    "/profiles/{profile:int}/file",
    response_class=Response,
    responses={
        **problems(UnknownThing, WrongState, UnreadableProfile, StoreUnavailable),
        200: {"content": {FILE: {"schema": {"type": "object"}}}},  # what is empty is left out, as a document may
    },
)
async def get_profile_file(bench: CurrentBench, profile: ProfileId) -> Response:
    """The document alone as a file to be saved, one register a line: any tool shows what differs between two."""
    found = detail(await bench.profile_store.get(profile))
    named = {"content-disposition": f'attachment; filename="profile-{profile}.json"'}
    return Response(text_of(found.document), media_type=FILE, headers=named)


@router.patch("/profiles/{profile:int}", responses=problems(UnknownThing, WrongState, OutOfRange, StoreUnavailable))
@policy(lease="free", words=wording.named("edit profile"))
async def edit_profile(bench: CurrentBench, profile: ProfileId, body: ProfileLabel) -> ProfileInfo:
    """Another name or note."""
    return info(await bench.profile_store.edit(profile, body.name, body.note))


@router.delete("/profiles/{profile:int}", status_code=204, responses=problems(UnknownThing, StoreUnavailable))
@policy(words=wording.named("delete profile"))
async def delete_profile(bench: CurrentBench, profile: ProfileId) -> None:
    """Delete it for good."""
    await bench.profile_store.delete(profile)
