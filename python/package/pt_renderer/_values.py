"""Small values of the package: faults, errors of pictures, prices and progress."""

from __future__ import annotations

from typing import Any, NamedTuple, Optional

import numpy as np


class Fault(NamedTuple):
    """One fault of a scene or of a call, with its place."""

    file: str
    """File as the user named it; empty if there is none."""
    line: Optional[int]
    """Line, from 1."""
    column: Optional[int]
    """Column in characters, from 1."""
    pointer: str
    """JSON pointer to the faulty value; empty if there is none."""
    message: str
    """Description of the fault."""


class Error(Exception):
    """Error of pt. Its text is that of the command line: one line for each fault.

    Attributes:
        faults: all faults that were found, in file order.
        kind: "usage" for a wrong argument, "invalid" for a scene or file with faults, "limit" for what is too large, "io" for what the
            system refuses, "internal" for a bug of pt.
    """

    faults: list[Fault]
    kind: str

    def __init__(self, message: str, faults: list[Fault] | None = None, kind: str = "usage") -> None:
        super().__init__(message, faults, kind)
        self.faults = list(faults) if faults is not None else [Fault("", None, None, "", message)]
        self.kind = kind

    def __str__(self) -> str:
        return str(self.args[0])


def _error(message: str, faults: list[Any], kind: str) -> Error:
    return Error(message, [Fault(*fault) for fault in faults], kind)


class ErrorEstimate(NamedTuple):
    """Relative error of a whole picture, the root of the mean relative squared error, with the interval that holds it."""

    value: Optional[float]
    """The error, such as 0.02 for 2 %; None where none can be stated."""
    low: Optional[float]
    """Lower end of the interval."""
    high: Optional[float]
    """Upper end of the interval."""
    confidence: float
    """Confidence of the interval."""
    refusal: Optional[str]
    """Reason why no error is stated; None if one is."""

    def __str__(self) -> str:
        if self.value is None or self.low is None or self.high is None:
            return str(self.refusal)
        return f"{100 * self.value:.3g} % ({100 * self.confidence:.3g} %: {100 * self.low:.3g}–{100 * self.high:.3g})"


class Price(NamedTuple):
    """Time that a relative error takes, with its interval."""

    error: float
    """The relative error."""
    seconds: float
    """Render time of the whole picture in seconds."""
    low: float
    """Lower end of the interval in seconds."""
    high: float
    """Upper end of the interval in seconds."""


class Progress(NamedTuple):
    """State of a render between two waves of samples."""

    samples: int
    """Samples per pixel so far."""
    seconds: float
    """Render time so far."""
    error: Optional[float]
    """Relative error when it was last measured; None before that, and where none can be stated."""
    expected: Optional[int]
    """Samples per pixel that the render will probably take, if the error has just been measured."""


class SceneHits(NamedTuple):
    """Where rays first meet a scene. All arrays have the batch shape of the rays."""

    t: np.ndarray
    """float64: distance in lengths of the direction; infinite for a ray that meets nothing."""
    shape: np.ndarray
    """int64: index of the shape in Scene.shapes; -1 for none."""
    primitive: np.ndarray
    """int64: index within the shape, such as that of a triangle of a mesh; -1 for none."""
    uv: np.ndarray
    """float64 (..., 2): weights of the second and third corner of a triangle, or coordinates on the primitive; NaN for none."""
    normal: np.ndarray
    """float64 (..., 3): unit geometric normal to the outside; NaN for none."""
    exact: np.ndarray
    """bool: whether the hit was decided by exact arithmetic; true for a ray that meets nothing."""
    instance: np.ndarray
    """int64: which instance shows the shape, counted from 0 in the order of the scene, those within an instance after it; shapes that move
    count as instances too, after all others. -1 for none, for shapes at rest of the scene itself, and for shapes at rest with emission or a
    medium."""

    @property
    def hit(self) -> np.ndarray:
        """bool: whether a ray meets something."""
        return self.shape >= 0


class MeshHits(NamedTuple):
    """Where rays first meet a mesh. All arrays have the batch shape of the rays."""

    t: np.ndarray
    """float64: distance in lengths of the direction; infinite for a ray that meets nothing."""
    triangle: np.ndarray
    """int64: index of the triangle; -1 for none."""
    uv: np.ndarray
    """float64 (..., 2): weights of the second and third corner; NaN for none."""
    normal: np.ndarray
    """float64 (..., 3): unit normal, towards the side from which the corners are counter-clockwise; NaN for none."""
    enters: np.ndarray
    """bool: whether the ray comes from the side of the normal."""

    @property
    def hit(self) -> np.ndarray:
        """bool: whether a ray meets something."""
        return self.triangle >= 0


class Verification(NamedTuple):
    """Result of a test of whether two sides are estimates of the same picture."""

    verdict: str
    """"same": no difference was found; "different"; or "inconclusive": a few samples hold all the noise of a side."""
    p: float
    """Smallest risk `alpha` with which the sides would be called different; near 0 where they are."""
    smallest_bias: Optional[float]
    """Relative difference of the whole pictures that would have shown with a probability of 90 %; None where that is not known."""
    alpha: float
    """Risk of calling two sides different that are the same."""
    tests: dict[str, float]
    """p of each test: of single pixels, of blocks of pixels, of the whole picture, and of the spread of the differences."""
    heavy: tuple[bool, bool]
    """For each side, whether a few samples hold all its noise."""


class Reading(NamedTuple):
    """What a meter of a scene has measured."""

    name: str
    """Name of the meter, or its JSON pointer."""
    quantity: str
    """"irradiance", "illuminance", "radiance" or "luminance"."""
    unit: str
    """Unit of the value."""
    rgb: tuple[float, float, float]
    """Red, green and blue, in W/m² on a plane and in W/(m² sr) in a direction."""
    rgb_half_width: tuple[Optional[float], Optional[float], Optional[float]]
    """Half the widths of their intervals; None where none is stated."""
    value: float
    """Irradiance and radiance: the mean of the three colours. Illuminance and luminance: 683 times their luminance."""
    half_width: Optional[float]
    """Half the width of its interval; None where none is stated."""
    confidence: float
    """Confidence of the intervals."""
    samples: int
    """Number of samples."""
    invalid: int
    """Samples that were not finite or were negative, and count as black."""
    seconds: float
    """Time of the measurement."""
    refusal: Optional[str]
    """Reason why no interval is stated; None if one is."""
    target_met: Optional[bool]
    """Whether the target was reached; None without a target."""


def _reading(name: Any, colors: Any, value: Any, counts: Any, outcome: Any) -> Reading:
    rgb, widths = colors
    return Reading._make([*name, tuple(rgb), tuple(widths), *value, *counts, *outcome])


def _rows(values: Any, what: str) -> np.ndarray:
    """Array of float64 whose last axis has three numbers."""
    try:
        array = np.asarray(values, dtype=np.float64)
    except (TypeError, ValueError) as failure:
        raise Error(f"{what}: expected numbers of shape (..., 3): {failure}") from failure
    if array.ndim == 0 or array.shape[-1] != 3:
        raise Error(f"{what}: expected numbers of shape (..., 3), found shape {array.shape}")
    return array


def _check(rows: np.ndarray, what: str, least: float = 0.0) -> None:
    """Refuses rows that are no points or directions, by the index of the first: coordinates must be numbers of up to 1e60."""
    largest = np.abs(rows).max(axis=-1, initial=0.0)
    wrong = ~((largest >= least) & (largest <= 1e60))
    if wrong.any():
        index = np.unravel_index(np.argmax(wrong), wrong.shape)
        place = "".join(f"[{int(k)}]" for k in index)
        span = "up to 1e60" if least == 0.0 else f"from {least:g} to 1e60"
        raise Error(f"{what}{place}: expected a vector whose largest coordinate is {span}, found {rows[index].tolist()}")


def _points(points: Any) -> tuple[np.ndarray, tuple[int, ...]]:
    rows = _rows(points, "points")
    _check(rows, "points")
    return np.ascontiguousarray(rows).reshape(-1, 3), rows.shape[:-1]


def _rays(origins: Any, directions: Any) -> tuple[np.ndarray, np.ndarray, tuple[int, ...]]:
    origins, directions = _rows(origins, "origins"), _rows(directions, "directions")
    _check(origins, "origins")
    _check(directions, "directions", 1e-60)
    try:
        origins, directions = np.broadcast_arrays(origins, directions)
    except ValueError as failure:
        raise Error(f"origins and directions: shapes {origins.shape} and {directions.shape} do not go together") from failure
    flat = [np.ascontiguousarray(array).reshape(-1, 3) for array in (origins, directions)]
    return flat[0], flat[1], origins.shape[:-1]


def _mesh(vertices: Any, triangles: Any) -> tuple[np.ndarray, np.ndarray]:
    corners = np.ascontiguousarray(_rows(vertices, "vertices")).reshape(-1, 3)
    indices = np.asarray(triangles)
    if indices.ndim != 2 or indices.shape[1] != 3 or not (np.issubdtype(indices.dtype, np.integer) or indices.size == 0):
        raise Error(f"triangles: expected whole numbers of shape (n, 3), found {indices.dtype} of shape {indices.shape}")
    return corners, np.ascontiguousarray(indices, dtype=np.int64)


def _scene_hits(shape: tuple[int, ...], t: Any, index: Any, primitive: Any, uv: Any, normal: Any, exact: Any, instance: Any) -> SceneHits:
    plain = [array.reshape(shape) for array in (t, index, primitive, exact, instance)]
    return SceneHits(plain[0], plain[1], plain[2], uv.reshape(*shape, 2), normal.reshape(*shape, 3), plain[3], plain[4])


def _mesh_hits(shape: tuple[int, ...], t: Any, triangle: Any, uv: Any, normal: Any, enters: Any) -> MeshHits:
    plain = [array.reshape(shape) for array in (t, triangle, enters)]
    return MeshHits(plain[0], plain[1], uv.reshape(*shape, 2), normal.reshape(*shape, 3), plain[2])
