"""Comparison of methods on one scene."""

from __future__ import annotations

import html as _html
import json
import os
import shlex
import tempfile
from collections.abc import Sequence
from pathlib import Path
from typing import Any, Optional

from . import _native
from ._values import Error


class Comparison:
    """Result of `compare`: a table, conclusions in words, and a report.

    Attributes:
        rows: one dict for each method and checkpoint: "method", "integrator", "sampler", "spp", "seconds", "error" (relative error, the root of
            relMSE), "relmse", "relmse_stderr", "mse", and one for each metric.
        prices: one dict for each method and error: "method", "error", "seconds", "low", "high", and "reason" where no time is stated.
        conclusions: sentences: which method is cheapest for which error, and what each leaves out.
        data: everything that was measured, as in the file convergence.json of the report.
        html: the report, a page that needs no other file.
        folder: the folder of the report; None if it was not kept.
    """

    def __init__(self, data: dict[str, Any], html: str, folder: Optional[str]) -> None:
        self.data, self.html, self.folder = data, html, folder
        self.conclusions: list[str] = [conclusion["text"] for conclusion in data["conclusions"]]
        self.rows: list[dict[str, Any]] = [row for method in data["methods"] for row in _rows(method)]
        self.prices: list[dict[str, Any]] = [
            {"method": method["name"]} | {name: price[name] for name in ("error", "seconds", "low", "high", "reason")}
            for method in data["methods"]
            for price in method["prices"]
        ]

    def __str__(self) -> str:
        return "\n".join(self.conclusions)

    def __repr__(self) -> str:
        return f"<pt_renderer.Comparison of {', '.join(method['name'] for method in self.data['methods'])}>"

    def _repr_html_(self) -> str:
        page = _html.escape(self.html, quote=True)
        return f'<iframe srcdoc="{page}" style="width: 100%; height: 720px; border: 1px solid #ccc"></iframe>'


def _rows(method: dict[str, Any]) -> list[dict[str, Any]]:
    plain = {"spp", "seconds", "mse", "relmse", "trimmed"}
    return [
        {
            "method": method["name"],
            "integrator": method["integrator"],
            "sampler": method["sampler"],
            "spp": point["spp"],
            "seconds": point["seconds"],
            "error": max(point["relmse"]["value"], 0.0) ** 0.5,
            "relmse": point["relmse"]["value"],
            "relmse_stderr": point["relmse"]["stderr"],
            "mse": point["mse"]["value"],
        }
        | {name: value["value"] for name, value in point.items() if name not in plain}
        for point in method["points"]
    ]


def compare(
    scene: _native.Scene,
    integrators: Sequence[str] = ("path", "nee", "whitted"),
    *,
    samplers: Sequence[str] = (),
    spp: int | None = None,
    time: float | None = None,
    replicates: int = 4,
    reference: _native.Picture | None = None,
    reference_integrator: str | None = None,
    reference_time: float | None = None,
    metrics: Sequence[str] = (),
    confidence: float = 0.95,
    folder: str | os.PathLike[str] | None = None,
    threads: int | None = None,
) -> Comparison:
    """Measures what accuracy costs in time, for several methods on one scene.

    Every method renders the scene several times with different random numbers; at doubling checkpoints each picture is measured against a
    reference. What the size of the picture is does not matter for the result: a small one is quicker (`load(…, size=…)`).

    Args:
        scene: the scene.
        integrators: names of integrators.
        samplers: names of samplers. Default: that of the scene.
        spp: samples per pixel of each replicate at most; without `time` exactly.
        time: render time of each method in seconds. Default: 8.
        replicates: number of independent renders of each method, 2 to 256.
        reference: picture to measure against, with the pixels of the scene. Default: one is rendered.
        reference_integrator: integrator of a reference that is rendered. Default: nee.
        reference_time: its render time in seconds. Default: as long as each method.
        metrics: additional error measures, see `pt list metrics`.
        confidence: confidence of intervals.
        folder: folder for the report, as `pt compare` writes it. Default: none is kept.
        threads: number of threads. Default: all cores.

    Raises:
        Error: for unknown names, and for a reference that is black or has other pixels.
        KeyboardInterrupt: on Ctrl-C.
    """
    if not isinstance(scene, _native.Scene):
        raise TypeError(f"scene: expected a Scene, as load returns it, found {type(scene).__name__}")
    for what, given in (("integrators", integrators), ("samplers", samplers), ("metrics", metrics)):
        if isinstance(given, str):
            raise Error(f'{what}: expected several names, such as ["{given}"], found a string')
    if not integrators:
        raise Error("integrators: expected at least one name")
    size = f"{scene.width}x{scene.height}"
    words = ["compare", scene.file, "--size", size, "--integrators", ",".join(integrators), "--replicates", str(replicates)]
    given = {"--samplers": ",".join(samplers) or None, "--spp": spp, "--time": time, "--reference-integrator": reference_integrator}
    words += [word for flag, value in given.items() if value is not None for word in (flag, str(value))]

    def made(place: str, kept: bool) -> Comparison:
        _native._compare(
            scene,
            place,
            list(integrators),
            list(samplers),
            spp,
            time,
            replicates,
            reference,
            reference_integrator,
            reference_time,
            list(metrics),
            confidence,
            threads,
            words,
            shlex.join(["pt", *words]),
            shlex.quote(scene.file),
        )
        data = json.loads(Path(place, "convergence.json").read_text(encoding="utf-8"))
        return Comparison(data, Path(place, "index.html").read_text(encoding="utf-8"), place if kept else None)

    if folder is not None:
        return made(os.fspath(folder), True)
    with tempfile.TemporaryDirectory() as place:
        return made(place, False)
