"""The control port of an emulated evaluation board: as that of a line of modules, with one board on it."""

from __future__ import annotations

from typing import Annotated

from fastapi import APIRouter, Depends, FastAPI, Request

from ..api.http.problems import problems as responses
from ..emulators.board.board import EmulatedBoard
from ..emulators.board.options import BoardPatch, BoardState
from ..emulators.line.server import LineServer
from ..errors import OutOfRange, WrongState
from .line_control import Served, control_app


class ControlledBoard(Served):
    """A line that another thread serves, and the board on it."""

    def __init__(self, server: LineServer, board: EmulatedBoard) -> None:
        super().__init__(server)
        self.board = board


router = APIRouter(tags=["emulator"])


async def _controlled(request: Request) -> ControlledBoard:
    controlled = request.app.state.controlled
    assert isinstance(controlled, ControlledBoard)
    return controlled


CurrentBoard = Annotated[ControlledBoard, Depends(_controlled)]


# Plain functions, which run in a thread of their own: each waits until the line is between two frames.
@router.get("/emulator")
def get_emulator(far: CurrentBoard) -> BoardState:
    """The board, its chip, and the motor and encoder at it."""
    return far.call(far.board.state)


@router.patch("/emulator", responses=responses(OutOfRange, WrongState))
def change_emulator(far: CurrentBoard, body: BoardPatch) -> BoardState:
    """Cause faults of the board or of its chip, load the shaft; what is left out stays."""
    return far.call(lambda: far.board.patch(body))


def make_board_control_app(server: LineServer, board: EmulatedBoard, allowed_hosts: tuple[str, ...] = ()) -> FastAPI:
    """The control port over a line with a board, with the guard and the problems of the dashboard's API."""
    return control_app(ControlledBoard(server, board), router, allowed_hosts)
