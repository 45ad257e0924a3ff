"""A folder with inputs, and the jobs that write to it."""

import hashlib
import math
import os
import shutil
import struct
import subprocess
import zlib


class Job:
    """A command in two versions, with the options `old` and `new`, whose files all differ."""

    def __init__(self, name, line, versions, is_fresh=False):
        self.name, self.line, self.versions, self.is_fresh = name, line.split(), versions, is_fresh

    def arguments(self, version):
        return self.line + self.versions[version].split()


JOBS = [
    Job("bake", "bake scan.obj -o out/a.gltf --size 256", ["--triangles 1000", "--triangles 2000"], is_fresh=True),
    Job("re-bake", "bake scan.obj -o out/a.gltf --size 256 --lods 300", ["--triangles 1000", "--triangles 2000"]),
    Job("render", "render scan.obj -o out/p.png --size 1024 --samples 16 --aov depth", ["--orbit 0,0", "--orbit 40,20"]),
    Job("turntable", "render scan.obj -o out/t.png --size 256 --turntable 24", ["--orbit 0,0", "--orbit 40,20"]),
    Job("compare", "compare scan.obj --method facet,smooth --size 512 -o out", ["--orbit 0,0", "--orbit 40,20"]),
]

# A run that writes to the folder, and so cleans it up.
NEXT = ["normals", "flat.png", "--from", "tangent", "-o", "out/next.png"]


def write_inputs(folder, rings=140):
    """Writes a ball with waves as `scan.obj`, and a flat normal map as `flat.png`."""
    lines, columns = [], 2 * rings
    for i in range(rings + 1):
        down = math.pi * i / rings
        for j in range(columns):
            around = 2 * math.pi * j / columns
            radius = 1 + 0.01 * math.sin(12 * around) * math.sin(14 * down) * math.sin(down)
            across = radius * math.sin(down)
            lines.append(f"v {across * math.cos(around)} {radius * math.cos(down)} {-across * math.sin(around)}")
    for i in range(rings):
        for j in range(columns):
            a, b = 1 + i * columns + j, 1 + i * columns + (j + 1) % columns
            c, d = a + columns, b + columns
            lines += [f"f {a} {c} {d}"] * (i + 1 < rings) + [f"f {a} {d} {b}"] * (i > 0)
    with open(os.path.join(folder, "scan.obj"), "w", encoding="ascii") as file:
        file.write("\n".join(lines) + "\n")
    rows = b"".join(b"\0" + b"\x80\x80\xff" * 16 for _ in range(16))
    chunks = [(b"IHDR", struct.pack(">IIBBBBB", 16, 16, 8, 2, 0, 0, 0)), (b"IDAT", zlib.compress(rows)), (b"IEND", b"")]
    with open(os.path.join(folder, "flat.png"), "wb") as file:
        file.write(b"\x89PNG\r\n\x1a\n")
        for kind, data in chunks:
            file.write(struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data)))


def hashes(folder):
    """The SHA-256 of every file by its name; for a folder, the names below it."""
    found = {}
    for root, _, names in os.walk(folder):
        for name in names:
            path = os.path.join(root, name)
            with open(path, "rb") as file:
                found[os.path.relpath(path, folder)] = hashlib.sha256(file.read()).hexdigest()
    return found


class Place:
    """A folder in which jobs run; their files go to its subfolder `out`."""

    def __init__(self, folder, program):
        self.folder, self.program = folder, os.path.abspath(program)
        self.out = os.path.join(folder, "out")
        write_inputs(folder)

    def start(self, arguments, **options):
        return subprocess.Popen(
            [self.program, *arguments], cwd=self.folder, text=True, stdout=subprocess.DEVNULL,
            stderr=subprocess.PIPE, **options,
        )

    def run(self, arguments):
        ended = subprocess.run([self.program, *arguments], cwd=self.folder, capture_output=True, text=True)
        if ended.returncode != 0:
            raise RuntimeError(f"{' '.join(arguments)}: {ended.returncode}\n{ended.stderr}")

    def clear(self):
        shutil.rmtree(self.out, ignore_errors=True)
        os.mkdir(self.out)

    def restore(self, kept):
        """Restores the stored state of `out`."""
        shutil.rmtree(self.out, ignore_errors=True)
        shutil.copytree(kept, self.out)

    def sweep(self):
        """Runs another command that writes to the folder."""
        self.run(NEXT)
        os.remove(os.path.join(self.out, "next.png"))
