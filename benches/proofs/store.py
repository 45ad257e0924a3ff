"""Assets and proofs, cached by their inputs, so that an interrupted run resumes."""

import dataclasses
import hashlib
import json
import os

import inspected
import measure
import subject
from command import say
from programs import SIDES, content_hash, resizer


@dataclasses.dataclass(frozen=True)
class Asset:
    path: str
    bytes: int
    triangles: int


class Store:
    """Makes and proves assets, or finds them in `folder`."""

    def __init__(self, folder, taotie, node):
        self.folder, self.taotie, self.resizer = folder, taotie, resizer(node)
        self.judge = content_hash(taotie)
        os.makedirs(folder, exist_ok=True)

    def asset(self, program, order):
        """The program's asset for the order; raises `measure.Failed` if it makes none."""
        source = order.scan.path
        if program.keeps_textures and order.scan.is_textured and order.side < SIDES[0]:
            source = self.made(self.resizer, order, source)
        path = self.made(program, order, source)
        return Asset(path, os.path.getsize(path), inspected.triangles(self.taotie, path))

    def made(self, program, order, source):
        is_sided = program.has_own_maps or order.scan.is_textured
        order = order if is_sided else dataclasses.replace(order, side=0)
        words = [list(map(os.path.basename, line)) for line in program.commands(order, "IN", "OUT")]
        path = self.place(program.identity, content_hash(*subject.parts(source)), words)
        if not os.path.exists(path):
            part = path.replace(".glb", ".part.glb")
            for line in program.commands(order, source, part):
                measure.run(line)
            os.replace(part, path)
            size = os.path.getsize(path)
            say(f"{order.scan.name:12} {program.name:20} {order.triangles:7} {order.side:5} {size:9} bytes")
        return path

    def place(self, *parts):
        return os.path.join(self.folder, hashlib.sha256(json.dumps(parts).encode()).hexdigest()[:24] + ".glb")

    def proof(self, asset, scan):
        """The JSON report printed by `taotie verify`."""
        hashes = [content_hash(asset.path), content_hash(*subject.parts(scan.path))]
        path = self.place(self.judge, *hashes).replace(".glb", ".json")
        if not os.path.exists(path):
            line = [self.taotie, "verify", asset.path, "--scan", scan.path, "--json", "--require", "standard"]
            run = measure.run(line, accepted=(0, 1))  # 1: a requirement is not met
            with open(f"{path}.part", "w", encoding="utf-8") as file:
                file.write(run.output)
            os.replace(f"{path}.part", path)
            say(f"{scan.name:12} proof of {os.path.basename(asset.path)} in {run.seconds:.1f} s")
        with open(path, encoding="utf-8") as file:
            return json.load(file)
