"""A physically based renderer: pictures with their errors, tests of methods, and rays.

    import pt_renderer

    scene = pt_renderer.load("cornell-box.json")
    picture = scene.render(spp=64)
    picture.rgb      # float32 (height, width, 3), linear
    picture.error    # the relative error of the picture, with its interval
    picture.save("cornell-box.exr")

Lengths are metres, radiances W·m⁻²·sr⁻¹, times seconds.
"""

from __future__ import annotations

import json as _json
import os as _os
from collections.abc import Mapping as _Mapping
from typing import Any as _Any

from . import _native
from ._compare import Comparison, compare
from ._native import Mesh, Part, PathRay, PathSampler, PathScene, PathSurface, Picture, Scene, __version__, merge, verify
from ._values import Error, ErrorEstimate, Fault, MeshHits, Price, Progress, Reading, SceneHits, Verification

__all__ = [
    "Comparison",
    "Error",
    "ErrorEstimate",
    "Fault",
    "Mesh",
    "MeshHits",
    "Part",
    "PathRay",
    "PathSampler",
    "PathScene",
    "PathSurface",
    "Picture",
    "Price",
    "Progress",
    "Reading",
    "Scene",
    "SceneHits",
    "Verification",
    "compare",
    "load",
    "merge",
    "verify",
]


def load(
    source: _Any,
    *,
    overrides: _Mapping[str, _Any] | None = None,
    size: tuple[int, int] | None = None,
    integrator: str | None = None,
    folder: str | _os.PathLike[str] | None = None,
    allow_outside: bool = False,
    view: str | None = None,
    up: str | None = None,
    ground: bool | None = None,
    studio: bool = False,
) -> Scene:
    """Reads, checks and builds a scene.

    Args:
        source: a path to a scene of any dialect that pt reads (`pt list dialects`); or the content of one, as a dict of pt's own format, as
            text, which begins with a brace or has several lines, or as bytes.
        overrides: values of the scene by JSON pointer, such as {"/camera/fov": 60}.
        size: width and height of the picture in pixels. The scene's own crop is dropped.
        integrator: name of the integrator; see `pt list integrators`. Default: the scene's, or nee.
        folder: folder of the files that a scene in memory names. Default: the working directory.
        allow_outside: whether the scene may name files that lie outside of its own folder.
        view: side from which a camera shows a model that has none: see `pt --help`.
        up: axis of a model that points up, "y" or "z".
        ground: whether a matte ground is put under a model. Default: under a model that has no light.
        studio: whether a model that has no light is lit by the lamps of a studio, in place of the sky.

    Raises:
        Error: with all faults of the scene. A dict has no lines and columns: faults have JSON pointers alone.
    """
    content, name, has_places = None, None, True
    if isinstance(source, _Mapping):
        content, name, has_places = _text(source, "the scene").encode(), "<dict>", False
    elif isinstance(source, (bytes, bytearray, memoryview)):
        content, name = bytes(source), "<bytes>"
    elif isinstance(source, str) and (source.lstrip().startswith("{") or "\n" in source):
        content, name = source.encode(), "<text>"
    if name is None:
        if folder is not None:
            raise Error("folder: expected with a scene in memory; a file's own folder is used")
        path = _os.fspath(source)
    else:
        path = _os.path.join(_os.fspath(folder), name) if folder is not None else name
    values = []
    if size is not None:
        width, height = size
        words = f"size=({width}, {height})"
        pairs = [("/film/width", width), ("/film/height", height), ("/film/crop", [0, width, 0, height])]
        values += [(words, pointer, _text(value, words)) for pointer, value in pairs]
    for pointer, value in (overrides or {}).items():
        text = _text(value, f"overrides[{pointer!r}]")
        values.append((f"{pointer}={text}", pointer, text))
    return _native._load(path, content, values, integrator, allow_outside, view, up, ground, studio, has_places)


def _text(value: _Any, what: str) -> str:
    """JSON text of a value. Numpy arrays and numbers count as lists and numbers."""

    def plain(other: _Any) -> _Any:
        if hasattr(other, "tolist"):
            return other.tolist()
        if isinstance(other, _Mapping):
            return dict(other)
        raise TypeError(f"{type(other).__name__} is not JSON")

    try:
        return _json.dumps(value, default=plain, allow_nan=False)
    except (TypeError, ValueError) as failure:
        raise Error(f"{what}: cannot be written as JSON: {failure}") from failure
