"""The path tracers: each renders an image with a number of paths per pixel and reports only the seconds for that."""

import dataclasses
import json
import os
import statistics
import sys

import measure
import numpy as np
import OpenEXR
import scenes
import surroundings
import talk

HERE = os.path.dirname(os.path.abspath(__file__))
# The maximum time for an image, in seconds.
PATIENCE = 600.0
# Images with one path; their median is Taotie's start.
STARTS = 5


@dataclasses.dataclass(frozen=True)
class Stage:
    """A scene in the folder of its files, the side of its images in pixels, and the threads of each program."""

    folder: str
    scene: scenes.Scene
    side: int
    threads: int

    @property
    def model(self):
        return os.path.join(self.folder, f"{self.scene.name}.glb")

    @property
    def environment(self):
        return os.path.join(self.folder, "environment.hdr")

    def make(self):
        """Writes the files, which are few and small."""
        os.makedirs(self.folder, exist_ok=True)
        scenes.write(self.model, self.scene)
        with open(self.environment, "wb") as file:
            file.write(surroundings.radiance_hdr(surroundings.picture()))

    def file(self, *names):
        return os.path.join(self.folder, "-".join([self.scene.name, str(self.side), *map(str, names)]))


class Taotie:
    """A process for each image. Its time with one path is its start: above all the tree of the triangles."""

    name, title, kind = "taotie", "Taotie", "taotie"
    ending = ".exr"

    def __init__(self, program, stage):
        self.program, self.stage, self.start = program, stage, None

    def picture(self, paths, seed, path):
        """Seconds of the paths only."""
        if self.start is None:
            self.start = statistics.median(self.rendered(1, seed, path) for _ in range(STARTS))
        return (self.rendered(paths, seed, path) - self.start) * paths / (paths - 1)

    def rendered(self, paths, seed, path):
        stage, scene = self.stage, self.stage.scene
        command = [self.program, "render", stage.model, "-o", path, "--json", "--quiet", "--camera", "camera"]
        command += ["--integrator", "reference", "--spp", str(paths), "--seed", str(seed)]
        command += ["--bounces", str(scene.bounces), "--size", str(stage.side), "--threads", str(stage.threads)]
        command += ["--shading", "ggx", "--energy", "single", "--grazing-normals", "keep"]
        command += ["--env", stage.environment] if scene.environment else ["--shadows"]
        return json.loads(measure.run(command).output)["seconds"]["render"]

    def close(self):
        """Nothing to close."""


class Mitsuba:
    """A persistent process, whose tree is built and whose code is compiled before anything is timed."""

    kind = "mitsuba"
    ending = ".npy"

    def __init__(self, variant, stage):
        self.name, self.title = variant, f"Mitsuba, `{variant}`"
        command = [sys.executable, os.path.join(HERE, "mitsuba_paths.py"), stage.scene.name, variant]
        command += [stage.environment, str(stage.side), str(stage.threads)]
        self.session = talk.Session(command, {})
        # The largest excess of the first image with a number of paths over the next, in seconds.
        self.start = 0.0

    def picture(self, paths, seed, path):
        """Seconds of the paths only."""
        answer = self.session.request(f"{paths} {seed} {path}", PATIENCE)
        self.start = max(self.start, answer["first"] - answer["seconds"])
        return answer["seconds"]

    def close(self):
        self.session.close()


def read(path):
    """Linear radiance (rows, columns, 3)."""
    if path.endswith(".npy"):
        return np.load(path)[..., :3].astype(np.float64)
    return OpenEXR.File(path).channels()["RGBA"].pixels[..., :3].astype(np.float64)
