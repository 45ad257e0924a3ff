"""Pages and widgets."""

from __future__ import annotations

import gzip
import json
import os
import re
import shutil
import subprocess
from pathlib import Path

import pytest

import taotie as tt

SHOWN = ("camera", "target", "light", "shadows", "mode", "shading", "surface", "beside", "split")
SCRIPTS = Path(__file__).parents[2] / "tests" / "browser"


def test_the_page_is_the_commands(scan_file: Path, run: object, tmp_path: Path) -> None:
    page, by_command = tmp_path / "page.html", tmp_path / "command.html"
    tt.view(scan_file, light="directional from=-75,10 strength=4", camera=tt.Orbit(30, 15)).save(page)
    run("view", scan_file, "--light", "directional from=-75,10 strength=4", "--orbit", "30,15", "-o", by_command)  # type: ignore[operator]
    assert page.read_bytes() == by_command.read_bytes()
    with pytest.raises(tt.Error, match="page.htm"):
        tt.view(scan_file).save(tmp_path / "page.htm")


def test_a_scan_brings_the_errors_of_the_asset(asset: tt.Asset, scan: tt.Model) -> None:
    plain, proof = tt.view(asset), tt.view(asset, scan=scan, title="Ball & wave")
    assert "errors.bin" not in plain.files() and "scan.glb" not in plain.files()
    assert "errors.bin" in proof.files() and "scan.glb" not in proof.files(), "the scan is not published"
    files = tt.view(asset, scan=scan, publish_scan=True, title="Ball & wave").files()
    assert files["scan.glb"][:4] == files["asset.glb"][:4] == b"glTF"
    data = json.loads(gzip.decompress(files["data.bin"]))
    assert data["title"] == "Ball & wave" and data["errors"]["mean"] < 5.0


def test_notebooks_show_it_without_a_request(ball: tt.Mesh) -> None:
    page = tt.view(ball)
    shown = page._repr_html_()
    assert shown.startswith("<iframe srcdoc=") and "&lt;taotie-viewer&gt;" in shown
    assert "connect-src &#x27;none&#x27;" in shown and page.html().count("<script") >= 2
    assert not re.search(r'(src|href)=&quot;http', shown)


def browser() -> str:
    """Return Chromium, or skip; in CI it must exist."""
    names = [os.environ.get("BROWSER", ""), "chromium", "chromium-browser", "google-chrome", "google-chrome-stable"]
    found = next((path for path in map(shutil.which, filter(None, names)) if path), None)
    if found and shutil.which("node") and (SCRIPTS / "node_modules" / "playwright-core").is_dir():
        return found
    assert os.environ.get("CI") != "true", "node with its packages and a browser are required: make tools"
    pytest.skip("no node with its packages, or no browser: make tools")


def test_the_widget_moves_by_hand_and_from_python(asset: tt.Asset, scan: tt.Model, tmp_path: Path) -> None:
    pytest.importorskip("anywidget")
    widget = tt.view(asset, scan=scan, publish_scan=True).widget(height=300)
    assert (widget.mode, widget.light, widget._said) == ("shaded", None, [])
    widget.light, widget.mode = (-75.0, 10.0), "normals"
    assert sorted(widget._said) == ["light", "mode"]
    with pytest.raises(Exception, match="split"):
        widget.split = 2.0
    traits = {name: getattr(widget, name) for name in (*SHOWN, "height", "_said")}
    (tmp_path / "state.json").write_text(json.dumps({"files": list(widget._files), "traits": traits}))
    (tmp_path / "module.mjs").write_text(widget._esm, encoding="utf-8")
    for name, content in widget._files.items():
        (tmp_path / name).write_bytes(content)
    line = ["node", "--test", str(SCRIPTS / "widget.test.mjs")]
    environment = {**os.environ, "BROWSER": browser(), "FOLDER": str(tmp_path)}
    done = subprocess.run(line, capture_output=True, text=True, env=environment, cwd=SCRIPTS)
    assert done.returncode == 0, done.stdout + done.stderr
