"""Shared fixtures: a scan built by code, and the command."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

import taotie as tt


def sphere(columns: int, rows: int, relief: float = 0.0) -> tuple[np.ndarray, np.ndarray]:
    """Return the vertices and faces of a ball with waves on it."""
    azimuth, polar = np.meshgrid(
        np.linspace(0, 2 * np.pi, columns, endpoint=False), np.linspace(0, np.pi, rows + 1)[1:-1]
    )
    radius = 1 + relief * np.sin(9 * azimuth) * np.sin(7 * polar)
    ring = radius * np.array([np.sin(polar) * np.sin(azimuth), np.cos(polar), np.sin(polar) * np.cos(azimuth)])
    vertices = np.vstack([ring.reshape(3, -1).T, [[0, 1, 0], [0, -1, 0]]])
    top, bottom, faces = len(vertices) - 2, len(vertices) - 1, []
    for j in range(columns):
        k = (j + 1) % columns
        faces += [[top, j, k], [bottom, (rows - 2) * columns + k, (rows - 2) * columns + j]]
        for i in range(rows - 2):
            a, b, c, d = i * columns + j, i * columns + k, (i + 1) * columns + j, (i + 1) * columns + k
            faces += [[a, c, b], [b, c, d]]
    return vertices, np.array(faces)


@pytest.fixture(scope="session")
def ball() -> tt.Mesh:
    """A coarse ball."""
    return tt.Mesh(*sphere(24, 12))


@pytest.fixture(scope="session")
def scan_file(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A ball with relief as a PLY file, 12,000 triangles."""
    vertices, faces = sphere(120, 52, relief=0.02)
    path = tmp_path_factory.mktemp("scan") / "scan.ply"
    header = (
        f"ply\nformat binary_little_endian 1.0\nelement vertex {len(vertices)}\nproperty float x\nproperty float y\n"
        f"property float z\nelement face {len(faces)}\nproperty list uchar int vertex_indices\nend_header\n"
    )
    listed = np.zeros(len(faces), dtype=[("n", "u1"), ("f", "<i4", 3)])
    listed["n"], listed["f"] = 3, faces
    path.write_bytes(header.encode() + vertices.astype("<f4").tobytes() + listed.tobytes())
    return path


@pytest.fixture(scope="session")
def scan(scan_file: Path) -> tt.Model:
    """The scan, read."""
    return tt.load(scan_file)


@pytest.fixture(scope="session")
def asset(scan: tt.Model) -> tt.Asset:
    """The scan, baked small."""
    return tt.bake(scan, triangles=600, size=128)


def relief(side: int = 48) -> tuple[list[np.ndarray], np.ndarray, np.ndarray]:
    """Return photographs of a matt relief in 16 bits, vectors towards their lights, and its true normals."""
    y, x = (np.mgrid[:side, :side] + 0.5) / side * 2 - 1
    slopes = np.stack([0.3 * np.cos(4 * x), -0.3 * np.sin(3 * y), np.ones_like(x)], axis=-1)
    normals = slopes / np.linalg.norm(slopes, axis=-1, keepdims=True)
    height = np.linspace(0.92, 0.55, 12)
    angle = 2.4 * np.arange(12)
    radius = np.sqrt(1 - height**2)
    lights = np.stack([radius * np.cos(angle), radius * np.sin(angle), height], axis=-1)
    shaded = np.clip(normals @ lights.T, 0, None) * 0.8 * 65535
    return [np.round(shaded[..., k]).astype(np.uint16) for k in range(12)], lights, normals.astype(np.float32)


def command(*arguments: object) -> subprocess.CompletedProcess[str]:
    """Run the command and check that it succeeds."""
    line = [sys.executable, "-m", "taotie", *map(str, arguments)]
    return subprocess.run(line, capture_output=True, text=True, check=True)


@pytest.fixture
def run() -> object:
    """The command."""
    return command
