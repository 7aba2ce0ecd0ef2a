"""Renders a scene with Ray, on one machine or many, until the error of the picture is small enough.

    pip install ray                  # and pt_renderer, see docs/python.md
    python ray_farm.py cornell-box.json --spp 256 --shards 64 --target 0.01 -o box.exr

Each task renders some samples of the whole picture and returns them as a part; further tasks add parts, a few at a time. If a worker dies, Ray
runs its task again, and what the dead worker made is lost, so that nothing counts twice. The picture has the bits of one render with as many
samples. All machines see the scene under the same path. Exit code 7: the error is still above the target after all rounds.
"""

import argparse

import ray

import pt_renderer

# Parts that one task adds.
PARTS_PER_MERGE = 8
# How often a task runs again whose worker died.
RETRIES = 5
# Scenes that this worker has loaded.
SCENES = {}


def loaded(path):
    """The scene, which each worker loads once."""
    if path not in SCENES:
        SCENES[path] = pt_renderer.load(path)
    return SCENES[path]


@ray.remote(max_retries=RETRIES)
def render(path, first, end, settings):
    """The samples first, ..., end - 1 of every pixel. A task of Ray has one core."""
    return loaded(path).part(first, end, threads=1, **settings)


@ray.remote(max_retries=RETRIES)
def add(*parts):
    """The sum of parts. It uses the cores that are idle."""
    return pt_renderer.merge(parts)


def total(parts):
    """Adds parts, some at a time, until there is one."""
    while len(parts) > 1:
        parts = [add.remote(*parts[i : i + PARTS_PER_MERGE]) for i in range(0, len(parts), PARTS_PER_MERGE)]
    return parts[0]


def render_until(path, *, spp, shards, target=None, confidence=0.95, rounds=8, **settings):
    """Yields pictures, each with twice as many samples as the one before, until the relative error is at most `target`, or `rounds` of them.

    The first has `spp` samples per pixel; without a target it is the only one. Each look at the error takes half of the risk that is left, so
    that all of them together keep the confidence. `settings` are those of `Scene.part`.
    """
    whole, end = [], 0
    for k in range(rounds if target is not None else 1):
        size = max(spp, end)
        ends = [end + size * i // shards for i in range(shards + 1)]
        parts = [render.remote(path, first, last, settings) for first, last in zip(ends, ends[1:]) if first < last]
        whole, end = [total(whole + parts)], end + size
        risk = (1 - confidence) / 2 ** (k + 1) if target is not None else 1 - confidence
        picture = ray.get(whole[0]).picture(confidence=1 - risk)
        yield picture
        if is_met(picture, target):
            return


def is_met(picture, target):
    """Whether the upper end of the interval of the error is at most the target."""
    return target is not None and picture.error.high is not None and picture.error.high <= target


def main():
    parser = argparse.ArgumentParser(description="Renders a scene with Ray until the error of the picture is small enough.")
    parser.add_argument("scene", help="path of the scene, the same on all machines")
    parser.add_argument("--spp", type=int, default=64, help="samples per pixel of the first look at the error (default: %(default)s)")
    parser.add_argument("--shards", type=int, default=64, help="tasks for each look (default: %(default)s)")
    parser.add_argument("--target", type=float, help="relative error, such as 0.01; without it there is one look")
    parser.add_argument("--confidence", type=float, default=0.95, help="of the error, over all looks at it (default: %(default)s)")
    parser.add_argument("--rounds", type=int, default=8, help="looks at most (default: %(default)s)")
    parser.add_argument("-o", "--output", default="picture.exr", help="file of the picture (default: %(default)s)")
    given = parser.parse_args()
    ray.init()
    options = {"target": given.target, "confidence": given.confidence, "rounds": given.rounds}
    for picture in render_until(given.scene, spp=given.spp, shards=given.shards, **options):
        print(picture, flush=True)
        picture.save(given.output)
    return 0 if given.target is None or is_met(picture, given.target) else 7


if __name__ == "__main__":
    raise SystemExit(main())
