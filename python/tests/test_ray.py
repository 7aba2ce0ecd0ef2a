"""Farms with Ray: the bits of one render, also when a worker dies while it renders. It needs `pip install ray`."""

import os
import signal
import subprocess
import sys
import threading
import time
from pathlib import Path

import pytest

import pt_renderer
from conftest import SCENES, _program

ray = pytest.importorskip("ray", reason="NOT TESTED: farms with Ray; there is no ray")
psutil = pytest.importorskip("psutil")
EXAMPLES = Path(__file__).parents[1] / "examples"
CORNELL = str(SCENES / "cornell-box.json")
# No cluster gets tasks of a test unasked.
ALONE = {name: value for name, value in os.environ.items() if name != "RAY_ADDRESS"}


def test_the_script_of_pt_farm(pt, tmp_path):
    options = ["--size", "48x32", "--spp", "16", "--shards", "5", "-o", "box.exr"]
    script = tmp_path / "farm.py"
    script.write_text(pt("farm", CORNELL, *options, "--for", "ray", cwd=tmp_path).stdout, encoding="utf-8")
    subprocess.run([sys.executable, script], cwd=tmp_path, env={**ALONE, "PT": str(_program().resolve())}, check=True, timeout=120)
    assert pt("image", "hash", tmp_path / "box.exr").stdout.split()[0] == pt_renderer.load(CORNELL, size=(48, 32)).render(16).hash


def test_the_example_as_a_script(pt, tmp_path):
    words = [EXAMPLES / "ray_farm.py", CORNELL, "--spp", "4", "--shards", "3", "--output", "box.exr"]
    settings = {"check": True, "capture_output": True, "text": True, "encoding": "utf-8", "timeout": 120}
    done = subprocess.run([sys.executable, *words], cwd=tmp_path, env=ALONE, **settings)
    assert "nee · 4 spp" in done.stdout
    assert pt("image", "hash", tmp_path / "box.exr").stdout.split()[0] == pt_renderer.load(CORNELL).render(4).hash


@pytest.fixture(scope="module")
def farm():
    sys.path.insert(0, str(EXAMPLES))
    paths = os.pathsep.join([str(EXAMPLES), *sys.path])
    ray.init("local", num_cpus=2, include_dashboard=False, runtime_env={"env_vars": {"PYTHONPATH": paths}})
    import ray_farm

    yield ray_farm
    ray.shutdown()
    sys.path.remove(str(EXAMPLES))


def test_one_picture(farm):
    settings = {"crop": (0, 48, 0, 32), "seed": 3}
    (picture,) = farm.render_until(CORNELL, spp=37, shards=10, **settings)
    whole = pt_renderer.load(CORNELL).render(37, **settings)
    assert picture == whole and picture.error == whole.error


def test_until_the_error_is_small(farm):
    target, crop = 0.1, (0, 96, 0, 64)
    pictures = list(farm.render_until(CORNELL, spp=16, shards=4, target=target, crop=crop))
    assert len(pictures) > 1, "one look is no test of the others"
    assert [picture.spp for picture in pictures] == [16 * 2**k for k in range(len(pictures))]
    *above, last = [picture.error for picture in pictures]
    assert all(error.high is None or error.high > target for error in above) and last.high <= target
    assert [error.confidence for error in [*above, last]] == [1 - 0.05 / 2 ** (k + 1) for k in range(len(pictures))]
    assert pictures[-1] == pt_renderer.load(CORNELL).render(int(pictures[-1].spp), crop=crop)


def renders(process):
    """Whether a process runs the task `render` now; Ray names a worker by its task."""
    return "ray::render" in " ".join(process.cmdline())


def test_a_worker_is_killed(farm):
    """Its task, which takes more than a second, runs again and counts once."""
    killed, done = [], threading.Event()

    def kill():
        while not killed and not done.is_set():
            time.sleep(0.02)
            for process in psutil.Process().children(recursive=True):
                try:
                    if not killed and renders(process):
                        time.sleep(0.3)
                        if renders(process):
                            process.send_signal(signal.SIGKILL)
                            killed.append(process.pid)
                except psutil.NoSuchProcess:
                    pass

    killer = threading.Thread(target=kill)
    killer.start()
    try:
        crop = (0, 256, 0, 256)
        (picture,) = farm.render_until(CORNELL, spp=128, shards=4, crop=crop)
    finally:
        done.set()
        killer.join()
    assert killed, "no task was seen at work"
    assert picture == pt_renderer.load(CORNELL).render(128, crop=crop)
