"""Collections on fsspec file systems, here a local folder: the files fetched, uploaded and known."""

from __future__ import annotations

import json
import struct
import subprocess
import sys
from datetime import datetime, timezone
from pathlib import Path
from typing import Any

import collection
import pytest

from taotie._jobs import Book, work
from taotie._stored import Keeper, Stored, _seconds, _within, is_url

pytest.importorskip("fsspec")


def run(stored: Stored, folder: Path) -> dict[str, Any]:
    """Run a collection as `taotie.ray` does, one job after another."""
    stored.look()
    outline = stored.outline(folder)
    keeper = Keeper(stored, folder)
    with Book([str(outline), "--jobs", "1"], None) as book:
        for planned in book.planned:
            report = {"id": planned["job"]["id"], "outcome": None, "error": None, "forecast": None}
            estimated = stored.work(planned, None, None, None)
            book.add(report | stored.work({**planned, "address": estimated["address"]}, 1, None, None))
            keeper.recorded()
        summary = book.close()
    keeper.end()
    return summary


def test_a_stored_collection_has_the_files_of_the_command(tmp_path: Path) -> None:
    place = tmp_path / "far"
    collection.write(place, 2, ("stored", "command"))
    (place / "scans/0.obj").write_text("mtllib a b.mtl\n" + (place / "scans/0.obj").read_text())
    (place / "scans/a b.mtl").write_text("newmtl x\nKd 0.5 0.4 0.3\n")
    stored = Stored(f"file://{place}/stored.toml")
    for name in ("first", "second"):
        (tmp_path / name).mkdir()
    first = run(stored, tmp_path / "first")
    assert first["states"] == {"done": 2, "required-not-met": 0, "refused": 0, "failed": 1}
    assert not [path for path in (tmp_path / "first").rglob("*.glb") if path.exists()], "the planner holds no asset"
    command = [sys.executable, "-m", "taotie", "batch", str(place / "command.toml"), "-q"]
    subprocess.run(command, check=False, stdout=subprocess.DEVNULL)
    assert collection.objects(place / "stored") == collection.objects(place / "command")
    assert (place / "stored/index.html").is_file() and (place / "stored/manifest.jsonl").is_file()
    second = run(stored, tmp_path / "second")
    assert (second["attempts"], second["known"]) == (0, 3)
    (place / "scans/1.obj").write_text(collection.ball(0.05))
    (tmp_path / "third").mkdir()
    assert run(stored, tmp_path / "third")["attempts"] == 1


def test_photographs_are_fetched_with_all_files_next_to_them(tmp_path: Path) -> None:
    place = tmp_path / "far"
    collection.write_photographs(place, ("stored", "command"))
    stored = Stored(f"file://{place}/stored.toml")
    (tmp_path / "near").mkdir()
    assert run(stored, tmp_path / "near")["states"]["done"] == 1
    subprocess.run([sys.executable, "-m", "taotie", "batch", str(place / "command.toml"), "-q"], check=True)
    objects = collection.objects(place / "stored")
    assert objects == collection.objects(place / "command")
    assert any(str(path).endswith("openlime/info.json") for path in objects)


def test_another_thumbnail_bakes_nothing_again(tmp_path: Path) -> None:
    place = tmp_path / "far"
    collection.write(place, 1, ("stored",))
    stored = Stored(f"file://{place}/stored.toml")
    text = (place / "stored.toml").read_text()
    for name, size in (("first", 32), ("second", 48)):
        (place / "stored.toml").write_text(text.replace("[thumbnail]\nsize = 32", f"[thumbnail]\nsize = {size}"))
        (tmp_path / name).mkdir()
        run(stored, tmp_path / name)
    lines = (place / "stored/manifest.jsonl").read_text().splitlines()
    done = [record for record in map(json.loads, lines) if record.get("state") == "done"]
    reused = [{part["kind"]: part["reused"] for part in record["parts"]} for record in done]
    assert reused == [{"asset": False, "thumbnail": False}, {"asset": True, "thumbnail": False}]


def test_a_scan_fetches_only_the_files_it_references(tmp_path: Path) -> None:
    place = tmp_path / "far"
    (place / "maps").mkdir(parents=True)
    (place / "c.toml").write_text("")
    texts = {
        "a.gltf": '{"images": [{"uri": "maps/a%20e.png"}]}',
        "b.obj": "v 0 0 0\nmtllib b.mtl\n# maps/other.png",
        "b.mtl": "map_Kd maps\\b.png\n",
        "c.ply": "ply\ncomment TextureFile maps/c.png\n",
        "d.gltf": json.dumps({"buffers": [{"uri": "data:,maps/other.png"}], "images": [{"uri": "maps\\ü.png"}]}),
        "e.FBX": 'Video: 5, "Video::other" {\n RelativeFilename: "C:\\art\\Body_f.PNG"\n}',
    }
    for name, text in texts.items():
        (place / name).write_text(text, encoding="utf-8")
    document = texts["a.gltf"].encode()
    (place / "f.glb").write_bytes(struct.pack("<4s4I", b"glTF", 2, 0, len(document), 0x4E4F534A) + document + b"maps/other.png")
    for name in ("a e", "b", "c", "ü", "body_f", "f", "other"):
        (place / f"maps/{name}.png").write_text("")
    stored = Stored(f"file://{place}/c.toml")
    stored.look()
    models = ("a.gltf", "b.obj", "c.ply", "d.gltf", "e.FBX", "f.glb")
    named = {name: sorted(stored._named_by(name, tmp_path / "near")) for name in models}
    assert named == {
        "a.gltf": ["maps/a e.png"],
        "b.obj": ["b.mtl", "maps/b.png"],
        "c.ply": ["maps/c.png"],
        "d.gltf": ["maps/ü.png"],
        "e.FBX": ["maps/body_f.png"],
        "f.glb": ["maps/a e.png"],
    }


def test_files_that_settings_name_are_fetched_in_full(tmp_path: Path) -> None:
    place = tmp_path / "far"
    collection.write(place, 1, ("stored", "command"))
    (place / "low").mkdir()
    corners = "v -1 1.2 1\nv 1 1.2 1\nv 1 1.2 -1\nv -1 1.2 -1\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\n"
    (place / "low/low.obj").write_text(f"mtllib low.mtl\n{corners}usemtl m\nf 1/1 2/2 3/3 4/4\n")
    (place / "low/low.mtl").write_text("newmtl m\nKd 0.5 0.4 0.3\n")
    (place / "rights.json").write_text('{"dc:title": "Jue"}')
    (place / "lists").mkdir()
    (place / "lists/all.NDJSON").write_text('{"path": "../scans/0.obj", "id": "zero"}\n')
    for name in ("stored", "command"):
        text = (place / f"{name}.toml").read_text().replace('folder = "scans"', 'list = "lists/all.NDJSON"')
        text = text.replace("triangles = 60", 'low = { file = "./low/low.obj" }')
        (place / f"{name}.toml").write_text(text + '[packing]\nprovenance = "rights.json"\n')
    stored = Stored(f"file://{place}/stored.toml")
    (tmp_path / "near").mkdir()
    assert run(stored, tmp_path / "near")["states"]["done"] == 1
    subprocess.run([sys.executable, "-m", "taotie", "batch", str(place / "command.toml"), "-q"], check=True)
    assert collection.objects(place / "stored") == collection.objects(place / "command")


def test_names_stay_in_the_folder_and_times_are_read(tmp_path: Path) -> None:
    for name in ("../x", "/etc/x", "a/../../x"):
        with pytest.raises(ValueError, match="leads out"):
            _within(tmp_path, name)
    moment = datetime(2026, 1, 2, 3, 4, 5, tzinfo=timezone.utc)
    abouts = [{"LastModified": moment}, {"updated": "2026-01-02T03:04:05Z"}, {"mtime": moment.timestamp()}]
    assert [_seconds(about) for about in abouts] == [moment.timestamp()] * 3 and _seconds({}) == 0
    assert is_url("s3://museum/c.toml") and not is_url("museum/c.toml")
    with pytest.raises(FileNotFoundError, match=r"none\.toml"):
        Stored(f"file://{tmp_path}/none.toml").look()


def test_a_failed_job_reports_why(tmp_path: Path) -> None:
    planned = {"folder": str(tmp_path), "job": {"not": "a job"}}
    assert "crashed" in work(planned, 1, None, None)["error"]
