from collections.abc import Callable, Mapping, Sequence
from os import PathLike
from typing import Any, Literal, final

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ._values import Error as Error
from ._values import ErrorEstimate as ErrorEstimate
from ._values import Fault as Fault
from ._values import MeshHits as MeshHits
from ._values import Price as Price
from ._values import Progress as Progress
from ._values import Reading as Reading
from ._values import SceneHits as SceneHits
from ._values import Verification as Verification

__version__: str

@final
class Picture:
    @property
    def rgb(self) -> NDArray[np.float32]: ...
    @property
    def stderr(self) -> NDArray[np.float32] | None: ...
    @property
    def samples(self) -> NDArray[np.float32]: ...
    @property
    def layers(self) -> dict[str, NDArray[np.float32]]: ...
    @property
    def width(self) -> int: ...
    @property
    def height(self) -> int: ...
    @property
    def region(self) -> list[int]: ...
    @property
    def error(self) -> ErrorEstimate: ...
    @property
    def hash(self) -> str: ...
    @property
    def scene_hash(self) -> str: ...
    @property
    def integrator(self) -> str: ...
    @property
    def spp(self) -> float: ...
    @property
    def seconds(self) -> float: ...
    @property
    def invalid(self) -> int: ...
    @property
    def interrupted(self) -> bool: ...
    @property
    def target_met(self) -> bool | None: ...
    @property
    def attributes(self) -> dict[str, str]: ...
    def price(self, errors: Sequence[float] = ..., *, confidence: float | None = None) -> list[Price | None]: ...
    def save(
        self,
        path: str | PathLike[str],
        *,
        exposure: float | Literal["auto"] | None = None,
        tonemap: Literal["none", "filmic", "agx", "normalize", "postcard"] = "none",
    ) -> None: ...
    def _repr_png_(self) -> bytes: ...
    def __eq__(self, other: object) -> bool: ...
    def __hash__(self) -> int: ...

@final
class Scene:
    @property
    def width(self) -> int: ...
    @property
    def height(self) -> int: ...
    @property
    def spp(self) -> int: ...
    @property
    def integrator(self) -> str: ...
    @property
    def file(self) -> str: ...
    @property
    def warnings(self) -> list[str]: ...
    @property
    def shapes(self) -> list[str]: ...
    def json(self) -> str: ...
    def check(self) -> dict[str, Any]: ...
    def render(
        self,
        spp: int | None = None,
        *,
        target: float | None = None,
        time: float | None = None,
        integrator: str | None = None,
        sampler: str | None = None,
        seed: int | None = None,
        scramblings: int | None = None,
        layers: Sequence[str] | None = None,
        region: Sequence[int] | None = None,
        confidence: float = 0.95,
        threads: int | None = None,
        progress: Callable[[Progress], object] | None = None,
    ) -> Picture: ...
    def intersect(self, origins: ArrayLike, directions: ArrayLike) -> SceneHits: ...
    def measure(
        self,
        *,
        integrator: str | None = None,
        target: float | None = None,
        samples: int | None = None,
        time: float | None = None,
        threads: int | None = None,
    ) -> list[Reading]: ...

@final
class Mesh:
    def __new__(cls, vertices: ArrayLike, triangles: ArrayLike) -> Mesh: ...
    @staticmethod
    def load(path: str | PathLike[str]) -> Mesh: ...
    def intersect(self, origins: ArrayLike, directions: ArrayLike) -> MeshHits: ...
    def winding(self, points: ArrayLike) -> NDArray[np.int64]: ...
    def __len__(self) -> int: ...
    @property
    def warnings(self) -> list[str]: ...

def load(
    source: str | PathLike[str] | bytes | bytearray | memoryview | Mapping[str, Any],
    *,
    overrides: Mapping[str, Any] | None = None,
    size: tuple[int, int] | None = None,
    integrator: str | None = None,
    folder: str | PathLike[str] | None = None,
    allow_outside: bool = False,
    view: str | None = None,
    up: Literal["y", "z"] | None = None,
    ground: bool | None = None,
    studio: bool = False,
) -> Scene: ...
def verify(
    a: Picture | str | PathLike[str],
    b: Picture | str | PathLike[str],
    *,
    scene: Scene | None = None,
    spp: int | None = None,
    time: float | None = None,
    alpha: float = 0.01,
    threads: int | None = None,
    progress: Callable[[Progress], object] | None = None,
) -> Verification: ...
