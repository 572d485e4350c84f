"""An emulated evaluation board on a line of its own, and its control port."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Annotated

from fastapi import APIRouter, Depends, FastAPI, Request

from ..api.http.problems import problems as responses
from ..clock import Clock
from ..emulators.board.board import EmulatedBoard
from ..emulators.board.build import CHIPS, build_board
from ..emulators.board.options import BoardPatch, BoardState
from ..emulators.core.pace import Pace
from ..emulators.line.framing import TMCL
from ..emulators.line.server import LineServer
from ..errors import OutOfRange, WrongState
from ..registers.catalog import is_model
from .line import Far, LineOptions, line_of, of_chip
from .line_control import Served, control_app
from .listed.line import make_board_line


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


def make_line(clock: Clock, options: LineOptions) -> Far:
    """The board, alone on its line; a plain one with a chip of which only names are known."""
    if options.chip and options.chip not in CHIPS and is_model(options.chip):
        return make_board_line(clock, options)
    board = build_board(options.chip or CHIPS[0], clock, {**of_chip(options), "seed": options.seed})
    board.chip.pace = Pace(clock.now, share=1.0)

    def make_control(server: LineServer) -> FastAPI:
        return control_app(ControlledBoard(server, board), router)

    # Its firmware waits for nine bytes however long it takes.
    return Far(line_of([board], clock, options, replace(TMCL, pause_s=math.inf)), make_control)
