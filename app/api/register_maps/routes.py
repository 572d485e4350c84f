"""Register maps: a file that says what registers a chip has, which makes a model of it."""

from __future__ import annotations

from typing import Annotated

from fastapi import Path, Query

from ...errors import StoreUnavailable, UnknownThing, UsageError, WrongState
from ...registers.maps.findings import UnreadableMap
from ...store.register_maps import StoredMap
from ..audit import wording
from ..deps import CurrentBench
from ..http.problems import problems
from ..policy import policy
from ..router import subject_router
from ..server_state import ServerState
from .schemas import MapFinding, RegisterMapFile, RegisterMapInfo, RegisterMapList, RegisterMapText

router = subject_router(prefix="/register-maps", tags=["register maps"])

MapName = Annotated[str, Path(description="small letters, digits and dashes; the model is called so", max_length=60)]


@router.get("", responses=problems(StoreUnavailable))
async def list_register_maps(bench: CurrentBench) -> RegisterMapList:
    """Every register map of this server, also those that cannot be read, and what is wrong with them."""
    kept = await bench.maps.scan()
    return RegisterMapList(
        folder=str(bench.maps.folder),
        maps=[_info(bench, each) for each in kept],
        passed_over=list(bench.maps.passed_over),
    )


@router.get("/{name}", responses=problems(UnknownThing, StoreUnavailable))
async def get_register_map(bench: CurrentBench, name: MapName) -> RegisterMapFile:
    """The file of a register map."""
    content = await bench.maps.content(name)
    return RegisterMapFile(name=name, text=content.decode("utf-8-sig", errors="replace"))


@router.put("/{name}", responses=problems(UnreadableMap, WrongState, UsageError, StoreUnavailable))
@policy(audit="silent as a dry run", words=wording.named("keep register map"))
async def put_register_map(
    bench: CurrentBench,
    name: MapName,
    body: RegisterMapText,
    dry_run: Annotated[bool, Query(description="only say what is wrong with it")] = False,
) -> RegisterMapInfo:
    """Keep a register map, instead of the one of that name: a model of that name is in the catalog from then on.

    One that a connected device is made of stays as it is: disconnect first.
    """
    kept = await bench.maps.put(name, body.text.encode(), csv=body.format == "csv", dry_run=dry_run)
    return _info(bench, kept)


@router.delete("/{name}", status_code=204, responses=problems(UnknownThing, WrongState, StoreUnavailable))
@policy(words=wording.named("delete register map"))
async def delete_register_map(bench: CurrentBench, name: MapName) -> None:
    """Delete a register map that no device is made of, and the model of that name."""
    await bench.maps.delete(name)


def _info(bench: ServerState, kept: StoredMap) -> RegisterMapInfo:
    found = kept.found
    head = None if isinstance(found, UnreadableMap) else found.head
    return RegisterMapInfo(
        name=kept.name,
        title="" if head is None else head.title,
        summary="" if head is None else head.summary,
        axes=0 if head is None else head.axes,
        registers=0 if isinstance(found, UnreadableMap) else len(found.table),
        bytes=kept.bytes,
        findings=[MapFinding(**each) for each in found.findings] if isinstance(found, UnreadableMap) else [],
        more=found.more if isinstance(found, UnreadableMap) else 0,
        behind=kept.behind,
        devices=list(bench.maps.users().get(kept.name, {})),
    )
