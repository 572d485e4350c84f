"""The process that draws: viser on the loopback address, told by lines of JSON on its standard input.

In: `{"shape": ..., "scheme": ...}` sets the scene up, `{"look": ...}` moves it. Out: `{"ready": {"port", "scripts"}}`
once, then `{"shown": n}` for each look. The end of standard input ends it, also when the server was killed.

A process of its own, because a busy thread beside the server's loop makes every serial round trip slower, and because
viser brings threads, a port and much memory: all of it is gone when this ends.
"""

from __future__ import annotations

import base64
import hashlib
import json
import os
import re
import struct
import sys
import zlib
from pathlib import Path
from typing import Any, BinaryIO

import numpy as np
import viser
import zstandard
from viser._messages import BackgroundImageMessage

from .bodies import DIAL_AT, scenery
from .colours import Scheme, rgb
from .scene import Placement, placements
from .shape import AxisPose, Shape

NICENESS = 5
"""A picture may come late; a stop command may not."""
FOV_DEG = 30.0
LOOK_AT = (DIAL_AT[0] / 2, 0.0, -1.2)
CAMERA = (DIAL_AT[0] / 2 + 3.0, -16.4, 4.4)


class Viewer(viser.ViserServer):
    """viser without its one way out of this machine."""

    def request_share_url(self, verbose: bool = True) -> str | None:
        """Refuse: a page could ask for a public tunnel to this scene otherwise."""
        del verbose
        return None


class Stage:
    """The scene as viser has it. Sends only what differs from what it was."""

    def __init__(self, viewer: Viewer) -> None:
        self._viewer = viewer
        self._shape: Shape | None = None
        self._scheme: Scheme = "dark"
        self._nodes: dict[str, Any] = {}
        self._placed: dict[str, Placement] = {}
        viewer.gui.configure_theme(show_logo=False, show_share_button=False)
        viewer.initial_camera.fov = np.radians(FOV_DEG)
        viewer.initial_camera.look_at = LOOK_AT
        viewer.initial_camera.position = CAMERA

    def set_up(self, shape: Shape, scheme: Scheme) -> None:
        """Build the scene of an axis."""
        self._shape, self._scheme = shape, scheme
        scene = self._viewer.scene
        with self._viewer.atomic():
            scene.reset()
            self._nodes.clear()
            self._placed.clear()
            scene.set_up_direction("+z")
            scene.world_axes.visible = False
            self._fill_background(rgb("background", scheme))
            scene.configure_environment_map(None)
            scene.configure_default_lights(enabled=False)
            scene.add_light_ambient("/light/ambient", intensity=1.1)
            scene.add_light_directional("/light/key", position=(-4.0, -9.0, 9.0), intensity=2.0, cast_shadow=False)
            scene.add_light_directional("/light/fill", position=(9.0, -6.0, 2.0), intensity=0.9, cast_shadow=False)
            made = scenery(linear=shape.linear)
            for name, place in made.frames.items():
                self._nodes[name] = scene.add_frame(name, show_axes=False, position=place)
            for part in made.parts:
                self._nodes[part.name] = scene.add_mesh_simple(
                    part.name,
                    part.mesh.vertices.astype(np.float32),
                    part.mesh.faces.astype(np.uint32),
                    color=rgb(part.colour, scheme),
                    opacity=part.opacity,
                    flat_shading=True,
                    cast_shadow=False,
                    receive_shadow=False,
                    visible=part.visible,
                )
            for label in made.labels:
                self._nodes[label.name] = scene.add_label(
                    label.name,
                    label.text,
                    position=label.position,
                    font_screen_scale=label.scale,
                    anchor="center-center",
                    visible=bool(label.text),
                )

    def _fill_background(self, colour: tuple[int, int, int]) -> None:
        """Send a picture of one pixel. viser's own call has Pillow pack it, 20 MB that an image does without."""
        picture = BackgroundImageMessage(format="png", rgb_data=one_pixel(colour), depth_data=None)
        self._viewer.scene._websock_interface.queue_message(picture)  # noqa: SLF001

    def show(self, look: AxisPose) -> None:
        """Move, turn and colour what has changed."""
        if self._shape is None:
            return
        with self._viewer.atomic():
            for name, placement in placements(self._shape, look, self._scheme).items():
                self._place(name, placement)
        self._viewer.flush()

    def _place(self, name: str, wanted: Placement) -> None:
        before = self._placed.get(name, Placement())
        node = self._nodes[name]
        if wanted.wxyz is not None and wanted.wxyz != before.wxyz:
            node.wxyz = wanted.wxyz
        if wanted.position is not None and wanted.position != before.position:
            node.position = wanted.position
        if wanted.colour is not None and wanted.colour != before.colour:
            node.color = wanted.colour
        if wanted.opacity is not None and wanted.opacity != before.opacity:
            node.opacity = None if wanted.opacity >= 1.0 else wanted.opacity
        if wanted.visible is not None and wanted.visible != before.visible:
            node.visible = wanted.visible
        if wanted.text is not None and wanted.text != before.text:
            node.text = wanted.text or " "
            node.visible = bool(wanted.text)
        if wanted.mesh is not None and wanted.visible is not False:
            vertices = wanted.mesh.vertices.astype(np.float32)
            if not np.array_equal(vertices, node.vertices):
                node.vertices = vertices
        self._placed[name] = wanted


def one_pixel(colour: tuple[int, int, int]) -> bytes:
    """A PNG of it (RFC 2083)."""

    def chunk(kind: bytes, data: bytes) -> bytes:
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))

    header = struct.pack(">IIBBBBB", 1, 1, 8, 2, 0, 0, 0)  # 8 bits of red, green and blue
    row = zlib.compress(bytes((0, *colour)))
    return b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header) + chunk(b"IDAT", row) + chunk(b"IEND", b"")


def script_hashes(page: str) -> list[str]:
    """What a content security policy has to name so that viser's page may run, and nothing else: `sha256-...`.

    The page is one inline script that unpacks another from its own attribute and starts it. An empty list means that
    this viser packs its page in another way.
    """
    loader = re.search(r'<script data-p="(?P<p>[^"]*)"(?P<rest>[^>]*)>(?P<code>.*?)</script>', page, re.DOTALL)
    if loader is None or page.count("<script") != 1:
        return []
    sizes = dict(re.findall(r'data-(ss|cs)="(\d+)"', loader["rest"]))
    alphabet = re.search(r'const A="((?:[^"\\]|\\.)*)"', loader["code"])
    if alphabet is None or set(sizes) != {"ss", "cs"}:
        return []
    packed = _unpack(loader["p"], json.loads(f'"{alphabet[1]}"'))
    styles, code = int(sizes["ss"]), int(sizes["cs"])
    text = zstandard.ZstdDecompressor().decompress(packed, max_output_size=styles + code)
    return [_hash(loader["code"].encode()), _hash(text[styles : styles + code])]


def _unpack(text: str, alphabet: str) -> bytes:
    """Base 88: five characters are four bytes, a last group of k characters k - 1."""
    values = np.full(128, -1, dtype=np.int64)
    values[[ord(letter) for letter in alphabet]] = np.arange(len(alphabet))
    digits = values[np.frombuffer(text.encode("ascii"), dtype=np.uint8)]
    whole = len(digits) // 5 * 5
    base = len(alphabet)
    words = digits[:whole].reshape(-1, 5) @ np.array([base**power for power in (4, 3, 2, 1, 0)], dtype=np.int64)
    rest = digits[whole:]
    tail = b""
    if len(rest):
        value = 0
        for digit in rest:
            value = value * base + int(digit)
        tail = value.to_bytes(len(rest) - 1, "big")
    return words.astype(">u4").tobytes() + tail


def _hash(script: bytes) -> str:
    return "sha256-" + base64.b64encode(hashlib.sha256(script).digest()).decode()


def main() -> None:
    """Draw until standard input ends."""
    # What viser prints of itself is for nobody; the lines to the server keep a way of their own.
    answers = os.fdopen(os.dup(sys.stdout.fileno()), "wb")
    with open(os.devnull, "wb") as nowhere:
        os.dup2(nowhere.fileno(), sys.stdout.fileno())
    os.nice(NICENESS)
    viewer = Viewer(host="127.0.0.1", port=0, label="stepscope", verbose=False)
    page = (Path(viser.__file__).parent / "client" / "build" / "index.html").read_text(encoding="utf-8")
    _say(answers, {"ready": {"port": viewer.get_port(), "scripts": script_hashes(page)}})
    stage = Stage(viewer)
    shown = 0
    for line in sys.stdin.buffer:
        message = json.loads(line)
        if "shape" in message:
            stage.set_up(Shape.of_message(message["shape"]), message["scheme"])
        if "look" in message:
            stage.show(AxisPose.of_message(message["look"]))
            shown += 1
            _say(answers, {"shown": shown})
    viewer.stop()


def _say(answers: BinaryIO, message: dict[str, object]) -> None:
    answers.write(json.dumps(message).encode() + b"\n")
    answers.flush()


if __name__ == "__main__":
    main()
