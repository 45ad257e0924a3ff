"""Measures assets of one model and stores the results, so that an interrupted run resumes.

A result is stored under hashes of the model, the judge and the setting, which includes the version of its tool. So
another build of Taotie does not affect the results of the other tools.
"""

import dataclasses
import functools
import json
import os
import time

import hashes
import inspected
import judge
import measure
import metadata
from command import say
from point import Point

JUDGE = hashes.of_files(judge.__file__)


class Store:
    """The results for a model, in `folder`; `program` is the Taotie that renders for the judge."""

    def __init__(self, folder, program, model):
        self.folder, self.program, self.model = folder, program, model
        self.results, self.sources = (os.path.join(folder, name) for name in ("results", "sources"))
        for path in (self.results, self.sources):
            os.makedirs(path, exist_ok=True)
        self.begin, self.count = time.monotonic(), 0

    @functools.cached_property
    def eye(self):
        """Renders the model, which takes a moment; not needed if everything was measured before."""
        return judge.Judge(self.program, self.folder, self.model.path)

    def point(self, setting):
        """The measured asset of a setting, or None if it cannot be made."""
        path = os.path.join(self.results, f"{self.key(setting)}.json")
        if os.path.exists(path):
            return kept(path)
        try:
            point = self.measured(setting)
        except measure.Failed as failed:
            self.report(setting, f"failed: {str(failed).strip().splitlines()[-1]}")
            return None
        keep(path, self.model.name, point)
        self.report(setting, figures(point))
        return point

    def key(self, setting):
        fields = [field.name for field in dataclasses.fields(Point)]
        return hashes.of_value([self.model.content, JUDGE, fields, setting.identity()])[:24]

    def measured(self, setting):
        out = os.path.join(self.folder, "asset.glb")
        source = self.source(setting)
        start = time.monotonic()
        measure.run(setting.command(source, out))
        seconds = time.monotonic() - start
        verdict = self.eye.verdict(out)
        return Point(
            tool=setting.tool.name,
            label=setting.label(),
            bytes=metadata.bytes_without(out),
            triangles=inspected.triangles(self.program, out),
            degrees=verdict.degrees,
            degrees_p95=verdict.degrees_p95,
            color=verdict.albedo,
            color_p95=verdict.albedo_p95,
            image=verdict.image,
            missed=verdict.missed,
            seconds=round(seconds, 2),
        )

    def source(self, setting):
        """The input file of the setting's tool: the model, or the result of the previous setting."""
        if setting.before is None:
            return self.model.path
        path = os.path.join(self.sources, f"{self.key(setting.before)}.glb")
        if not os.path.exists(path):
            part = path.replace(".glb", ".part.glb")
            measure.run(setting.before.command(self.source(setting.before), part))
            os.replace(part, path)
        return path

    def report(self, setting, text):
        self.count += 1
        elapsed = time.monotonic() - self.begin
        say(f"{elapsed:6.0f} s {self.model.name} {self.count:3}  {setting.tool.name} {setting.label()}: {text}")


def figures(point):
    return f"{point.bytes:,} bytes, {point.degrees:.2f}°, ΔE {point.color:.2f}; made in {point.seconds:.1f} s"


def kept(path):
    with open(path, encoding="utf-8") as file:
        return Point(**json.load(file)["point"])


def keep(path, model, point):
    """Writes a result under its name only once it is complete."""
    with open(f"{path}.part", "w", encoding="utf-8") as file:
        json.dump({"model": model, "point": dataclasses.asdict(point)}, file, indent=1)
    os.replace(f"{path}.part", path)
