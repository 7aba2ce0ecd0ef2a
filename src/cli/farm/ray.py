#!/usr/bin/env python3
@HEAD@
import argparse
import os
import subprocess
import tempfile

import ray

PT = os.environ.get("PT", "pt")
FOLDER = os.getcwd()
RENDER = @RENDER@
MERGE = @MERGE@
PICTURE = @PICTURE@
SAMPLES, SHARDS = @SAMPLES@, @SHARDS@

# Parts that one task adds.
PARTS_PER_MERGE = 8
# A task whose worker dies runs again, so many times; what the dead worker made is lost, so that nothing counts twice.
RETRIES = 5


def pt(words):
    """Runs pt and returns what it writes to stdout."""
    return subprocess.run([PT, *words], cwd=FOLDER, check=True, stdout=subprocess.PIPE).stdout


@ray.remote(max_retries=RETRIES)
def render(first, end):
    """The part with the samples first, ..., end - 1."""
    return pt([*RENDER, "--samples", f"{first}..{end}", "-q", "-o", "-"])


@ray.remote(max_retries=RETRIES)
def merge(*parts):
    """The sum of parts."""
    return with_files(parts, lambda files: pt(["merge", *files, "-q", "-o", "-"]))


def with_files(parts, use):
    """Calls use with the names of files that have these parts."""
    with tempfile.TemporaryDirectory() as folder:
        files = [os.path.join(folder, f"{i}.ptc") for i in range(len(parts))]
        for name, part in zip(files, parts):
            with open(name, "wb") as file:
                file.write(part)
        return use(files)


def tree(parts):
    """Adds parts, some at a time, until there is one."""
    while len(parts) > 1:
        parts = [merge.remote(*parts[i : i + PARTS_PER_MERGE]) for i in range(0, len(parts), PARTS_PER_MERGE)]
    return parts[0]


def upper_bound():
    """Upper end of the interval of the picture's relative error; None if pt states none."""
    for line in pt(["image", "info", PICTURE]).decode().splitlines():
        if line.strip().startswith("pt/relativeErrorHigh "):
            return float(line.split()[-1])
    return None


def main():
    parser = argparse.ArgumentParser(description="Renders shards with Ray and merges them.")
    parser.add_argument("--target", type=float, help="go on, with as many samples again each time, until the relative error is at most this, such as 0.01")
    parser.add_argument("--confidence", type=float, default=@CONFIDENCE@, help="of the error, over all looks at it (default: %(default)s)")
    parser.add_argument("--rounds", type=int, default=8, help="looks at most (default: %(default)s)")
    given = parser.parse_args()
    ray.init()
    whole, end = [], 0
    for k in range(given.rounds if given.target else 1):
        size = max(SAMPLES, end)
        shards = [render.remote(end + size * i // SHARDS, end + size * (i + 1) // SHARDS) for i in range(SHARDS)]
        whole = [tree(whole + shards)]
        end += size
        # Each look takes half of the risk that is left, so that all of them together keep the confidence.
        confidence = 1 - (1 - given.confidence) / 2 ** (k + 1) if given.target else given.confidence
        with_files([ray.get(whole[0])], lambda files: pt(["merge", *files, *MERGE, "--confidence", str(confidence)]))
        bound = upper_bound()
        print(f"{end} samples per pixel, relative error at most {bound} with a confidence of {confidence}", flush=True)
        if given.target and bound is not None and bound <= given.target:
            return 0
    return 7 if given.target else 0


if __name__ == "__main__":
    raise SystemExit(main())
