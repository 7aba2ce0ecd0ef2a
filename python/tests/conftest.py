"""The program `pt`, the scenes of the project, and small scenes in memory."""

import os
import subprocess
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
SCENES = ROOT / "scenes"
BALL = {
    "pt": 1,
    "camera": {"look_at": {"from": [0, 0, 4], "to": [0, 0, 0]}, "fov": 40},
    "film": {"width": 24, "height": 18},
    "sampler": {"spp": 16},
    "materials": {"grey": {"type": "diffuse", "albedo": 0.5}},
    "shapes": [{"type": "sphere", "radius": 1, "material": "grey"}],
    "background": {"radiance": 1},
}


def _program():
    """The binary that the pictures are compared with: PT_BINARY, or the newest one that is built."""
    named = os.environ.get("PT_BINARY")
    if named:
        return Path(named)
    built = [ROOT / "target" / profile / "pt" for profile in ("release", "fast", "debug")]
    return max((path for path in built if path.exists()), key=lambda path: path.stat().st_mtime, default=None)


@pytest.fixture(scope="session")
def pt():
    """Runs the program and returns what it did, with its output as text."""
    program = _program()
    if program is None:
        pytest.fail("there is no binary to compare with: `cargo build --release` makes one, and PT_BINARY names another")

    def run(*arguments, check=True, **options):
        words = [str(program), *map(str, arguments)]
        done = subprocess.run(words, capture_output=True, text=True, encoding="utf-8", **options)
        assert not check or done.returncode == 0, f"{words}: {done.stderr}"
        return done

    return run


@pytest.fixture
def ball():
    """A grey ball that reflects half of the light, under a sky of radiance 1: it shows one half, whatever the method."""
    import copy

    return copy.deepcopy(BALL)


@pytest.fixture(autouse=True)
def signals():
    """Ctrl-C as in a terminal: a shell starts jobs in the background with SIGINT ignored."""
    import signal

    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    yield
    signal.signal(signal.SIGINT, before)
