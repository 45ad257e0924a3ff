"""Collections on a local Ray cluster of several nodes. Skipped without Ray, which is not a dependency."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path
from typing import Any

import collection
import pytest

ray = pytest.importorskip("ray", reason="pip install ray")
cluster_utils = pytest.importorskip("ray.cluster_utils")

pytestmark = [pytest.mark.filterwarnings("ignore"), pytest.mark.slow]

def test_a_cluster_that_loses_a_node_makes_the_files_of_the_command(tmp_path: Path) -> None:
    from taotie import ray as taotie_ray

    collection.write(tmp_path, 12, ("ray", "command"))
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
    assert collection.objects(tmp_path / "ray") == collection.objects(tmp_path / "command")
    records = [json.loads(line) for line in (tmp_path / "ray/manifest.jsonl").read_text().splitlines()]
    assert len(records) == len(ended) == 13


def test_a_collection_in_an_object_store_has_the_files_of_the_command(tmp_path: Path) -> None:
    moto = pytest.importorskip("moto.server", reason="pip install 'moto[server]' s3fs")
    s3fs = pytest.importorskip("s3fs")
    from taotie import ray as taotie_ray

    collection.write(tmp_path, 3, ("ray", "command"))
    server = moto.ThreadedMotoServer(port=0)
    server.start()
    host, port = server.get_host_and_port()
    options = {"endpoint_url": f"http://{host}:{port}", "key": "x", "secret": "x"}
    store = s3fs.S3FileSystem(**options)
    try:
        store.mkdir("museum")
        store.put(str(tmp_path / "scans"), "museum/bronzes/scans", recursive=True)
        store.put_file(str(tmp_path / "ray.toml"), "museum/bronzes/ray.toml")
        ray.init(num_cpus=2)
        url = "s3://museum/bronzes/ray.toml"
        summary = taotie_ray.run(url, storage_options=options)
        assert summary["states"] == {"done": 3, "required-not-met": 0, "refused": 0, "failed": 1}
        assert "s3://museum/bronzes/ray/index.html" in summary["files"]
        again = taotie_ray.run(url, storage_options=options)
        assert (again["attempts"], again["known"]) == (0, 4)
        store.get("museum/bronzes/ray", str(tmp_path / "ray"), recursive=True)
    finally:
        ray.shutdown()
        server.stop()
    command = [sys.executable, "-m", "taotie", "batch", str(tmp_path / "command.toml"), "-q"]
    subprocess.run(command, check=False, stdout=subprocess.DEVNULL)
    assert collection.objects(tmp_path / "ray") == collection.objects(tmp_path / "command")


def test_a_scan_that_no_machine_can_read_is_refused(tmp_path: Path) -> None:
    from taotie import ray as taotie_ray

    collection.write(tmp_path, 1, ("ray",))
    ray.init(num_cpus=1, _memory=16 << 20)
    try:
        summary = taotie_ray.run(tmp_path / "ray.toml")
    finally:
        ray.shutdown()
    assert summary["states"]["refused"] == 1 and summary["states"]["done"] == 0
