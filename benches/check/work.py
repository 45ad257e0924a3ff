"""The timed cases: whole processes that read, bake and render, and frames by persistent processes."""

import dataclasses
import os
import tempfile

import cases
import cold
import measure
import talk
from jobs import Job, Paths, taotie
from measured import SHADINGS

# These distinguish the programs' own files.
BASE, NOW = "base", "now"
SCAN, MESHES = "1m", ("2k", "200k")
SIZE = (1024, 1024)
FRAMES = 10
BAKES = (
    Job("bake normals", "", SCAN, size=1024, samples=4),
    Job("bake occlusion", "", SCAN, size=1024, kind="ao", samples=16),
    Job("bake onto 5,000 triangles", "", SCAN, size=1024, triangles=5_000),
)


@dataclasses.dataclass(frozen=True)
class Time:
    """Milliseconds: wall time, and CPU time."""

    wall: float
    processor: float


class Build:
    """The programs of a folder, run on the scenes of another. `name` is BASE or NOW."""

    def __init__(self, programs, folder, name):
        self.taotie, self.folder = os.path.join(programs, "taotie"), folder
        self.paths, self.scene = Paths(os.path.join(folder, "bake")), os.path.join(folder, "scene")
        self.renderer = cases.taotie(programs, name)
        self.sessions = {}

    def prepare(self):
        """Stores the environment, filtered by this build, for its frames."""
        measure.run(self.renderer.first(self.scene, MESHES[0]))

    def read(self):
        return timed([self.taotie, "inspect", self.paths.scan(BAKES[0])])

    def bake(self, job):
        return timed(taotie(self.taotie, job, self.paths))

    def cold(self):
        """An image under an environment that is not cached."""
        picture = os.path.join(self.folder, "cold.png")
        with tempfile.TemporaryDirectory() as home:
            command = self.renderer.cold(self.scene, MESHES[0], "ggx", *SIZE, picture)
            return timed(command, cold.environment(home, {}))

    def frames(self, mesh, shading):
        """The median frame, and the CPU time of the whole answer."""
        key = (mesh, shading)
        if key not in self.sessions:
            self.sessions[key] = talk.Session(self.renderer.talks(self.scene, mesh, shading), {})
        session = self.sessions[key]
        before = session.processor()
        frames = sorted(session.ask(*SIZE, FRAMES)["ms"])
        return Time(frames[len(frames) // 2], (session.processor() - before) * 1e3)

    def close(self):
        for session in self.sessions.values():
            session.close()


def timed(command, environment=None):
    run = measure.run(command, environment)
    return Time(run.seconds * 1e3, run.processor * 1e3)


def whole_set():
    """The cases by name."""
    some = {"read a scan": Build.read, "render, caches fresh": Build.cold}
    some |= {job.name: lambda build, job=job: build.bake(job) for job in BAKES}
    for mesh in MESHES:
        for shading in SHADINGS:
            some[f"frame, {shading}, {mesh}"] = lambda build, m=mesh, s=shading: build.frames(m, s)
    return some
