"""Shapes of the 3D view: what to show, how it is, and the numbers behind the picture."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import ConfigDict, Field, StringConstraints

from ...twin.service import State
from ...twin.shape import FieldSource, LoadSource
from ..schemas import Answer, AxisIndex, Body, Problem

DeviceName = Annotated[str, StringConstraints(strict=True, min_length=1, max_length=200)]
RecordingName = Annotated[str, StringConstraints(strict=True, min_length=1, max_length=60)]
Seconds = Annotated[float, Field(strict=True, allow_inf_nan=False, ge=-1e9, le=1e9)]


class TwinShow(Body):
    """Which axis to show, on which ground."""

    model_config = ConfigDict(json_schema_extra={"examples": [{"device": "bench", "axis": 0, "scheme": "dark"}]})

    device: DeviceName
    axis: AxisIndex = 0
    scheme: Literal["light", "dark"] = Field(default="light", description="of the page around it")


class TwinCursor(Body):
    """Where in a recording; null follows what happens now again."""

    model_config = ConfigDict(
        json_schema_extra={"examples": [{"recording": None}, {"recording": "20261121-184500-00ff", "time_s": 1.25}]}
    )

    recording: RecordingName | None
    time_s: Seconds = Field(default=0.0, description="since the recording's zero, as its plot counts [s]")
    scheme: Literal["light", "dark"] | None = Field(default=None, description="of the page; null leaves it as it is")


class TwinSlips(Answer):
    """Steps that the rotor lost against its field since the view began, or the recording."""

    lost_full_steps: int = Field(description="net: positive where the rotor fell behind a field that turns forward")
    events: int
    last_s: float | None = Field(description="when the last one happened, device time [s]")


class TwinLook(Answer):
    """The numbers that the picture shows; null: not measured by this family, or not known now."""

    time_s: float | None = Field(description="device time of the sample [s]")
    position: float | None = Field(description="what the counter shows [microsteps]")
    velocity_pps: float | None
    commanded_deg: float | None = Field(description="motor's shaft by the position counter [degrees]")
    measured_deg: float | None = Field(description="motor's shaft by its encoder [degrees]")
    place_commanded: float | None = Field(description="carriage [mm] or table [degrees] by the counter")
    place_measured: float | None = Field(description="carriage [mm] or table [degrees] by the encoder")
    field_deg: float | None = Field(description="stator's field [electrical degrees]; four full steps are a turn")
    field_from: FieldSource | None = Field(description="what tells it; position: what is meant, not what is measured")
    field_share: float | None = Field(description="length of the field against full current in one coil")
    load_deg: float | None = Field(description="how far the field leads the rotor [electrical degrees]")
    load_from: LoadSource | None
    current_a: float | None = Field(description="share of the full coil current, -1..1")
    current_b: float | None
    switch_left: bool | None
    switch_right: bool | None
    switch_home: bool | None
    slips: TwinSlips | None = Field(description="null where no encoder tells")


class TwinState(Answer):
    """How the 3D view is."""

    state: State
    device: str | None
    axis: int | None
    name: str | None = Field(description="of the axis")
    place_unit: Literal["mm", "deg"] | None = Field(description="mm: a stage with a carriage; deg: a rotary table")
    channels: list[str] = Field(description="what this axis tells at all; parts without data are grey")
    scheme: Literal["light", "dark"]
    path: str | None = Field(description="where the picture is, under this origin; null while it is off")
    following: Literal["telemetry", "recording"]
    recording: str | None
    recording_time_s: float | None
    updates_per_s: float = Field(description="shown in the last second; 0 where nothing changes")
    updates_per_s_max: float
    viewers: int
    look: TwinLook | None
    problem: Problem | None = Field(description="why it failed, or why there are no samples")
