"""Collections on a local Ray cluster of several nodes. Without Ray, which is no dependency, these are skipped."""

from __future__ import annotations

import json
import math
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

ray = pytest.importorskip("ray", reason="pip install ray")
cluster_utils = pytest.importorskip("ray.cluster_utils")

pytestmark = pytest.mark.filterwarnings("ignore")

OPTIONS = """
output = "{output}"
[[source]]
folder = "scans"
[bake]
triangles = 60
size = 64
[verify]
points = 1000
distance_points = 500
map = 64
view = 32
[thumbnail]
size = 32
"""


def ball(waves: float) -> str:
    """Return a ball of 16 by 8 quads as OBJ."""
    places = [
        (radius * math.sin(t) * math.cos(p), radius * math.cos(t), -radius * math.sin(t) * math.sin(p))
        for i in range(9)
        for j in range(16)
        for t, p in [(math.pi * (0.02 + 0.96 * i / 8), math.tau * j / 16)]
        for radius in [1 + waves * math.sin(5 * t)]
    ]
    corners = [(i * 16 + j, i * 16 + 16 + j, i * 16 + 16 + (j + 1) % 16, i * 16 + (j + 1) % 16) for i in range(8) for j in range(16)]
    lines = ["v {} {} {}".format(*place) for place in places]
    return "\n".join(lines + ["f " + " ".join(str(corner + 1) for corner in face) for face in corners]) + "\n"


def objects(folder: Path) -> dict[str, bytes]:
    """Return the bytes of all objects by their paths."""
    files = (path for path in (folder / "objects").rglob("*") if path.is_file())
    return {str(path.relative_to(folder)): path.read_bytes() for path in files}


def test_a_cluster_that_loses_a_node_makes_the_files_of_the_command(tmp_path: Path) -> None:
    from taotie import ray as taotie_ray

    (tmp_path / "scans").mkdir()
    for index in range(12):
        (tmp_path / f"scans/{index}.obj").write_text(ball(0.01 * index))
    (tmp_path / "scans/broken.obj").write_text("v 1 2\n")
    for name in ("ray", "command"):
        (tmp_path / f"{name}.toml").write_text(OPTIONS.format(output=name))
    cluster = cluster_utils.Cluster(initialize_head=True, head_node_args={"num_cpus": 1})
    lost = [cluster.add_node(num_cpus=1), cluster.add_node(num_cpus=1)]
    ray.init(address=cluster.address)
    ended: list[dict[str, Any]] = []

    def hear(record: dict[str, Any]) -> None:
        ended.append(record)
        if len(ended) == 4:
            cluster.remove_node(lost[0], allow_graceful=False)

    try:
        summary = taotie_ray.run(tmp_path / "ray.toml", progress=hear)
        assert summary["states"] == {"done": 12, "required-not-met": 0, "refused": 0, "failed": 1}
        assert taotie_ray.run(tmp_path / "ray.toml")["attempts"] == 0
    finally:
        ray.shutdown()
        cluster.shutdown()
    command = [sys.executable, "-m", "taotie", "batch", str(tmp_path / "command.toml"), "-q"]
    assert subprocess.run(command, check=False, stdout=subprocess.DEVNULL).returncode == 2
    assert objects(tmp_path / "ray") == objects(tmp_path / "command")
    records = [json.loads(line) for line in (tmp_path / "ray/manifest.jsonl").read_text().splitlines()]
    assert len(records) == len(ended) == 13
