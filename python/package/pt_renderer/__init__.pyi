from collections.abc import Mapping
from os import PathLike
from typing import Any, Literal

from ._compare import Comparison as Comparison
from ._compare import compare as compare
from ._native import Mesh as Mesh
from ._native import Method as Method
from ._native import Part as Part
from ._native import PathRay as PathRay
from ._native import PathSampler as PathSampler
from ._native import PathScene as PathScene
from ._native import PathSurface as PathSurface
from ._native import Picture as Picture
from ._native import Scene as Scene
from ._native import merge as merge
from ._native import verify as verify
from ._native import __version__ as __version__
from ._values import Error as Error
from ._values import ErrorEstimate as ErrorEstimate
from ._values import Fault as Fault
from ._values import MeshHits as MeshHits
from ._values import Price as Price
from ._values import Progress as Progress
from ._values import Reading as Reading
from ._values import SceneHits as SceneHits
from ._values import Verification as Verification

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
