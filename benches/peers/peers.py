"""Renders seven scenes with pt and with Mitsuba 3, alternately, and prints the time and the noise of both.

    pip install mitsuba numpy        (Mitsuba's fast variant needs LLVM 19 or later, see DRJIT_LIBLLVM_PATH)
    cargo build --release
    python3 benches/peers/peers.py [cornell blob glass lights outdoors fog smoke] [--seeds 4] [--spp 64] [--pt target/release/pt]

Both programs get the same geometry, two-sided materials, depth of paths and box filter, and one thread. Noise is the variance of a pixel
between renders with different seeds, divided by its squared mean plus 0.01, in the mean over pixels and colours: the relative mean square
error of methods without bias, with no need of a reference. The column `mean` shows whether the two agree. Time is CPU seconds for a
picture of 256 x 256 pixels without loading; for pt it is the difference between a render of all samples and one of a single sample.
Times differ between machines: quote only the ratios of one run.
"""

import argparse
import json
import math
import os
import random
import resource
import statistics
import subprocess
import sys
import time

import mitsuba as mi

for variant in ["llvm_ad_rgb", "scalar_rgb"]:
    try:
        mi.set_variant(variant)
        mi.Float(0.0) + mi.Float(1.0)
        break
    except Exception as error:
        print(f"{variant}: {error}", file=sys.stderr)

import drjit as dr
import numpy as np

SIZE = 256
FOLDER = "target/peers"
WHITE, RED, GREEN = [0.73, 0.72, 0.68], [0.61, 0.06, 0.05], [0.12, 0.44, 0.09]


def rotation(axis, degrees):
    """Matrix of a rotation about a coordinate axis."""
    c, s = math.cos(math.radians(degrees)), math.sin(math.radians(degrees))
    m = np.eye(4)
    i, j = [(1, 2), (2, 0), (0, 1)][axis]
    m[i, i], m[i, j], m[j, i], m[j, j] = c, -s, s, c
    return m


def place(translation, turn=np.eye(4), scale=(1, 1, 1)):
    m = turn @ np.diag([*scale, 1.0])
    m[:3, 3] = translation
    return m


def quad(size, translation, turn, material, emission=None):
    """Rectangle whose normal is +z before it is turned."""
    return dict(kind="quad", matrix=place(translation, turn, (*size, 1)), material=material, emission=emission)


def block(size, translation, degrees):
    return dict(kind="box", matrix=place(translation, rotation(1, degrees), size), material="white", emission=None)


DOWN, UP = rotation(0, 90), rotation(0, -90)


def room(lamp=True):
    walls = [
        quad((2, 2), (0, -1, 0), UP, "white"),
        quad((2, 2), (0, 1, 0), DOWN, "white"),
        quad((2, 2), (0, 0, -1), np.eye(4), "white"),
        quad((2, 2), (-1, 0, 0), rotation(1, 90), "red"),
        quad((2, 2), (1, 0, 0), rotation(1, -90), "green"),
        block((0.6, 1.2, 0.6), (-0.33, -0.4, -0.3), 17),
    ]
    return walls + ([quad((0.46, 0.38), (0, 0.99, 0), DOWN, "white", [18, 14, 7])] if lamp else [])


def cornell():
    return dict(shapes=room() + [block((0.6, 0.6, 0.6), (0.34, -0.7, 0.36), -17)], depth=7)


def glass():
    balls = [dict(kind="sphere", matrix=place((0.3, -0.6, 0.35), scale=(0.35,) * 3), material="glass", emission=None)]
    pane = [dict(kind="box", matrix=place((-0.45, -0.4, 0.6), scale=(0.8, 1.2, 0.02)), material="glass", emission=None)]
    return dict(shapes=room() + balls + pane, depth=15)


def lights():
    """A thousand small lamps that shine down, in the air of the room."""
    dice = random.Random(1)
    lamps = [
        quad((0.016, 0.016), [dice.uniform(-0.95, 0.95) for _ in range(3)], DOWN, "white", [dice.uniform(2, 11) for _ in range(3)])
        for _ in range(1000)
    ]
    return dict(shapes=room(lamp=False) + [block((0.6, 0.6, 0.6), (0.34, -0.7, 0.36), -17)] + lamps, depth=7)


def blob():
    """A bumpy ball of a million triangles on a plane, under a sky and a lamp."""
    n_u, n_v = 1024, 512
    u, v = np.meshgrid(np.arange(n_u) / n_u * 2 * np.pi, (np.arange(n_v + 1)) / n_v * np.pi)
    d = np.stack([np.sin(v) * np.cos(u), np.cos(v), np.sin(v) * np.sin(u)], -1)
    dice, bumps = np.random.default_rng(7), np.zeros(u.shape)
    for octave in range(7):
        w, phase = dice.normal(size=3), dice.uniform(0, 6.28)
        bumps += 0.15 * 0.55**octave * np.sin(3 * 1.9**octave * (d @ (w / np.linalg.norm(w))) + phase)
    # The bumps vanish at the poles, where a row of the grid is one point.
    points = (d * (1 + bumps * np.sin(v) ** 2)[..., None]).reshape(-1, 3).astype("<f4")
    a = (np.arange(n_v)[:, None] * n_u + np.arange(n_u)[None, :]).ravel()
    b = (np.arange(n_v)[:, None] * n_u + (np.arange(n_u)[None, :] + 1) % n_u).ravel()
    faces = np.concatenate([np.stack([a, b, b + n_u], -1), np.stack([a, b + n_u, a + n_u], -1)]).astype("<i4")
    rows = np.zeros(len(faces), dtype=[("n", "u1"), ("i", "<i4", 3)])
    rows["n"], rows["i"] = 3, faces
    with open(f"{FOLDER}/blob.ply", "wb") as file:
        properties = "".join(f"property float {axis}\n" for axis in "xyz")
        head = f"ply\nformat binary_little_endian 1.0\nelement vertex {len(points)}\n{properties}"
        file.write(f"{head}element face {len(faces)}\nproperty list uchar int vertex_indices\nend_header\n".encode())
        file.write(points.tobytes() + rows.tobytes())
    shapes = [
        dict(kind="mesh", matrix=place((0, 0.2, 0), scale=(0.9,) * 3), material="white", emission=None),
        quad((20, 20), (0, -1, 0), UP, "white"),
        quad((1.5, 1.5), (0, 3, 0), DOWN, "white", [10, 10, 10]),
    ]
    return dict(shapes=shapes, depth=7, sky=[1, 1, 1])


def surroundings(directions):
    """Radiance from directions: a sky with a bright spot of 3 degrees, and a lit window to the right."""
    x, y, z = np.moveaxis(directions, -1, 0)
    sky = np.exp(-2.5 * np.abs(y))[..., None] * [0.35, 0.3, 0.25] + np.clip(y, 0, 1)[..., None] * [0.1, 0.25, 0.6]
    toward = directions @ (np.array([-0.6, 0.5, 0.62]) / np.linalg.norm([-0.6, 0.5, 0.62]))
    spot = np.exp((toward - 1) / (1 - math.cos(math.radians(3))))[..., None] * [400, 330, 240]
    window = (1 / (1 + np.exp(40 * (np.maximum(np.abs(y - 0.3), np.abs(z)) - 0.2))) * (x > 0))[..., None] * [9, 10, 12]
    return (sky + spot + window).astype("<f4")


def outdoors():
    """Boxes and a ball on a plane, in the light of a picture. Each program gets the picture by its own convention."""
    width, height = 1024, 512
    turn = (np.arange(width) + 0.5) / width * 2 * np.pi - np.pi

    def picture(down, middle, right):
        """A picture with +y at its top: angles from +y of the rows, the direction in the middle, and the direction to its right."""
        across = np.cos(turn)[:, None] * middle + np.sin(turn)[:, None] * right
        return surroundings(np.sin(down)[:, None, None] * across + np.cos(down)[:, None, None] * np.array([0, 1, 0]))

    maps = {
        # Rows from pole to pole: pt has the borders of the picture at the poles, Mitsuba the centres of the first and last row.
        "pt": picture((np.arange(height) + 0.5) / height * np.pi, np.array([0, 0, -1]), np.array([1, 0, 0])),
        "mitsuba": picture(np.arange(height) / (height - 1) * np.pi, np.array([0, 0, 1]), np.array([-1, 0, 0])),
    }
    mi.Bitmap(maps["pt"]).write(f"{FOLDER}/map.exr")
    shapes = [
        quad((20, 20), (0, -1, 0), UP, "white"),
        block((0.6, 1.2, 0.6), (-0.33, -0.4, -0.3), 17),
        block((0.6, 0.6, 0.6), (0.34, -0.7, 0.36), -17),
        dict(kind="sphere", matrix=place((-0.5, -0.65, 0.6), scale=(0.35,) * 3), material="red", emission=None),
    ]
    return dict(shapes=shapes, depth=7, map=maps["mitsuba"])


def fog():
    """The room of `cornell` in fog: a path scatters about every fourth time on its way through the room."""
    return dict(shapes=cornell()["shapes"], depth=16, fog=dict(scattering=0.15, absorption=0.02))


def smoke():
    """A column of smoke on a grid of 256^3 values in the room."""
    n = 256
    z, y, x = np.meshgrid(*[(np.arange(n, dtype="<f4") + 0.5) / n] * 3, indexing="ij")
    dice, swirls = np.random.default_rng(3), np.zeros((n,) * 3, dtype="<f4")
    for octave in range(5):
        for _ in range(3):
            w, phase = dice.normal(size=3) * 9 * 1.9**octave, dice.uniform(0, 6.28)
            swirls += 0.4 * 0.6**octave * np.sin(w[0] * x + w[1] * y + w[2] * z + phase).astype("<f4")
    radius = np.hypot(x - 0.5 + 0.06 * np.sin(9 * y), z - 0.5 + 0.06 * np.cos(7 * y)) / (0.12 + 0.25 * y)
    density = np.clip((1 - radius + 0.5 * swirls) * np.minimum(1, 8 * (1 - y)), 0, 1).astype("<f4")
    mi.VolumeGrid(density).write(f"{FOLDER}/smoke.vol")
    column = dict(kind="smoke", matrix=place((0, -0.15, 0), scale=(0.8,) * 3), material=None, emission=None)
    return dict(shapes=[s for s in room() if s["kind"] == "quad"] + [column], depth=32, smoke=dict(extinction=20.0, albedo=0.9))


SCENES = dict(cornell=cornell, blob=blob, glass=glass, lights=lights, outdoors=outdoors, fog=fog, smoke=smoke)


def for_pt(scene, path):
    """Writes a scene file of pt."""

    def shape(s):
        keys = dict(quad=dict(type="quad", size=1), box=dict(type="box", size=1), sphere=dict(type="sphere", radius=1))
        keys["mesh"] = dict(type="mesh", file="blob.ply")
        emission = {"emission": s["emission"]} if s["emission"] else {}
        if s["kind"] == "smoke":
            # The cube from -1 to 1, without a surface; the box of the density is in the world.
            low, high = s["matrix"][:3, 3] - s["matrix"].diagonal()[:3], s["matrix"][:3, 3] + s["matrix"].diagonal()[:3]
            density = {"type": "grid", "file": "smoke.vol", "bounds": {"low": low.tolist(), "high": high.tolist()}}
            extinction, albedo = scene["smoke"]["extinction"], scene["smoke"]["albedo"]
            medium = {"type": "heterogeneous", "scattering": extinction * albedo, "absorption": extinction * (1 - albedo), "density": density}
            return {"type": "box", "size": 2, "medium": medium, "transform": [{"matrix": s["matrix"].flatten().tolist()}]}
        return {**keys[s["kind"]], "material": s["material"], **emission, "transform": [{"matrix": s["matrix"].flatten().tolist()}]}

    materials = {name: {"type": "diffuse", "albedo": color} for name, color in [("white", WHITE), ("red", RED), ("green", GREEN)]}
    written = {
        "pt": 1,
        "camera": {"look_at": {"from": [0, 0, 3.9], "to": [0, 0, 0]}, "fov": 39},
        "film": {"width": SIZE, "height": SIZE, "filter": {"type": "box", "radius": 0.5}},
        "integrator": {"type": "nee", "max_depth": scene["depth"]},
        "materials": {**materials, "glass": {"type": "dielectric", "eta": 1.5}},
        "shapes": [shape(s) for s in scene["shapes"]],
        **({"background": {"radiance": scene["sky"]}} if "sky" in scene else {}),
        **({"background": {"image": "map.exr"}} if "map" in scene else {}),
        **({"medium": {"type": "homogeneous", **scene["fog"]}} if "fog" in scene else {}),
    }
    with open(path, "w") as file:
        json.dump(written, file)


def for_mitsuba(scene):
    """Loads a scene in Mitsuba."""
    bsdfs = {"glass": {"type": "dielectric", "int_ior": 1.5, "ext_ior": 1.0}}
    for name, color in [("white", WHITE), ("red", RED), ("green", GREEN)]:
        bsdfs[name] = {"type": "twosided", "bsdf": {"type": "diffuse", "reflectance": {"type": "rgb", "value": color}}}
    loaded = {
        "type": "scene",
        "integrator": {"type": "volpath" if "fog" in scene or "smoke" in scene else "path", "max_depth": scene["depth"] + 1},
        **{f"bsdf_{name}": {**bsdf, "id": name} for name, bsdf in bsdfs.items()},
    }
    half = np.diag([0.5, 0.5, 1, 1])
    for k, s in enumerate(scene["shapes"]):
        matrix = {"quad": s["matrix"] @ half, "box": s["matrix"] @ np.diag([0.5, 0.5, 0.5, 1])}.get(s["kind"], s["matrix"])
        if s["kind"] == "smoke":
            to_world = mi.ScalarTransform4f(s["matrix"])
            # The grid fills the unit cube, the shape is the cube from -1 to 1.
            fill = to_world @ mi.ScalarTransform4f().translate([-1, -1, -1]).scale([2, 2, 2])
            grid = {"type": "gridvolume", "filename": f"{FOLDER}/smoke.vol", "to_world": fill}
            medium = {"type": "heterogeneous", "sigma_t": grid, "scale": scene["smoke"]["extinction"], "albedo": scene["smoke"]["albedo"]}
            loaded[f"shape{k}"] = {"type": "cube", "to_world": to_world, "bsdf": {"type": "null"}, "interior": medium}
            continue
        kind = {"quad": "rectangle", "box": "cube", "sphere": "sphere", "mesh": "ply"}[s["kind"]]
        shape = {"type": kind, "to_world": mi.ScalarTransform4f(matrix), "bsdf": {"type": "ref", "id": s["material"]}}
        if s["kind"] == "mesh":
            shape.update(filename=f"{FOLDER}/blob.ply", face_normals=True)
        if s["emission"]:
            shape["emitter"] = {"type": "area", "radiance": {"type": "rgb", "value": [float(x) for x in s["emission"]]}}
        loaded[f"shape{k}"] = shape
    if "sky" in scene:
        loaded["sky"] = {"type": "constant", "radiance": {"type": "rgb", "value": [float(x) for x in scene["sky"]]}}
    if "map" in scene:
        loaded["map"] = {"type": "envmap", "bitmap": mi.Bitmap(scene["map"])}
    return mi.load_dict(loaded)


def read_pfm(path):
    with open(path, "rb") as file:
        kind, size, scale = file.readline().strip(), file.readline().split(), float(file.readline())
        width, height = int(size[0]), int(size[1])
        pixels = np.frombuffer(file.read(), "<f4" if scale < 0 else ">f4").reshape(height, width, 3 if kind == b"PF" else 1)
    return pixels[::-1].astype(float)


# How pt samples: with error bars, which it has by default, and without, as Mitsuba does.
SAMPLING = {
    "independent": ["--sampler", "independent"],
    "sobol": ["--sampler", "sobol"],
    "sobol, no error bars": ["--sampler", "sobol", "--scramblings", "1"],
}


def pt_seconds(program, name, sampling, seed, spp):
    """CPU seconds of a run of pt, which leaves its picture in pt.pfm."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime
    options = ["--spp", str(spp), *SAMPLING[sampling], "--seed", str(seed), "--threads", "1", "-q", "-o", f"{FOLDER}/pt.pfm"]
    subprocess.run([program, f"{FOLDER}/{name}.json", *options], check=True)
    return resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime - before


def sensor(scene, sampler, spp):
    """Camera of Mitsuba with a sampler, in the scene's fog."""
    camera = mi.ScalarTransform4f().look_at(origin=[0, 0, 3.9], target=[0, 0, 0], up=[0, 1, 0])
    film = {"type": "hdrfilm", "width": SIZE, "height": SIZE, "rfilter": {"type": "box"}}
    numbers = {"type": sampler, "sample_count": spp}
    medium = {}
    if "fog" in scene:
        extinction = scene["fog"]["scattering"] + scene["fog"]["absorption"]
        medium["medium"] = {"type": "homogeneous", "sigma_t": extinction, "albedo": scene["fog"]["scattering"] / extinction}
    return mi.load_dict({"type": "perspective", "fov": 39, "to_world": camera, "film": film, "sampler": numbers, **medium})


def mitsuba_picture(scene, camera, seed, spp):
    """CPU seconds of a render, and the picture."""
    start = time.process_time()
    picture = mi.render(scene, sensor=camera, spp=spp, seed=seed)
    dr.eval(picture)
    dr.sync_thread()
    return time.process_time() - start, np.array(picture, dtype=float)[..., :3]


def main():
    arguments = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    arguments.add_argument("scenes", nargs="*", default=list(SCENES))
    arguments.add_argument("--seeds", type=int, default=4)
    arguments.add_argument("--spp", type=int, default=64)
    arguments.add_argument("--pt", default="target/release/pt")
    options = arguments.parse_args()
    os.makedirs(FOLDER, exist_ok=True)
    # Before the limit to one thread, with which Mitsuba never ends writing an EXR picture.
    scenes = {name: SCENES[name]() for name in options.scenes}
    dr.set_thread_count(1)
    print(f"Mitsuba {mi.__version__} {mi.variant()}, {options.spp} samples per pixel, {options.seeds} seeds, one thread")
    for name, scene in scenes.items():
        for_pt(scene, f"{FOLDER}/{name}.json")
        peer = for_mitsuba(scene)
        rows = {("pt", s): ([], []) for s in SAMPLING}
        rows |= {("Mitsuba", s): ([], []) for s in ["independent", "ldsampler"]}
        cameras = {sampler: sensor(scene, sampler, options.spp) for sampler in ["independent", "ldsampler"]}
        for camera in cameras.values():
            mitsuba_picture(peer, camera, 0, options.spp)  # compiles its kernels
        for seed in range(1, options.seeds + 1):
            for (program, sampler), (times, pictures) in rows.items():
                if program == "pt":
                    single = pt_seconds(options.pt, name, sampler, seed, 1)
                    all_samples = pt_seconds(options.pt, name, sampler, seed, options.spp)
                    times.append((all_samples - single) * options.spp / (options.spp - 1))
                    pictures.append(read_pfm(f"{FOLDER}/pt.pfm"))
                else:
                    seconds, picture = mitsuba_picture(peer, cameras[sampler], seed, options.spp)
                    times.append(seconds)
                    pictures.append(picture)
        print(f"\n{name:24}{'seconds':>9}{'noise':>10}{'product':>10}{'mean':>9}")
        for (program, sampler), (times, pictures) in rows.items():
            stack = np.stack(pictures)
            mean = stack.mean(0)
            noise = float((stack.var(0, ddof=1) / (mean**2 + 0.01)).mean())
            seconds = statistics.median(times)
            print(f"{program + ' ' + sampler:24}{seconds:9.2f}{noise:10.5f}{seconds * noise:10.5f}{mean.mean():9.4f}")


if __name__ == "__main__":
    main()
