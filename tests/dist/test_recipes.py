"""The recipes of package managers, filled for a release of all targets."""

from __future__ import annotations

import re
import shutil
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest
import targets
from conftest import ROOT

FILL = ROOT / "dist/recipes/fill.py"
VERSION = re.search(r'^version = "(.*)"', (ROOT / "Cargo.toml").read_text(), re.MULTILINE)[1]  # type: ignore[index]
TARGETS = [target.triple for target in targets.ALL if not target.is_windows]
NAMES = [f"taotie-{VERSION}-{target}.tar.gz" for target in TARGETS] + [f"taotie-{VERSION}-x86_64-pc-windows-gnu.zip", f"taotie-{VERSION}.tar.gz"]
# What winget's schema 1.10.0 requires of each kind of file.
NEEDED = {"version": {"DefaultLocale"}, "installer": {"Installers"},
          "defaultLocale": {"PackageLocale", "Publisher", "PackageName", "License", "ShortDescription"}}

# The part of conda-forge's variants that the recipe uses.
VARIANTS = {"c_stdlib": ["sysroot"], "c_stdlib_version": ["2.17"], "c_compiler": ["gcc"], "cxx_compiler": ["gxx"],
            "rust_compiler": ["rust"], "python": ["3.12.* *_cpython"]}


def checksum(name: str) -> str:
    return f"{NAMES.index(name) + 1:064x}"


@pytest.fixture
def recipes(tmp_path: Path) -> Path:
    sums = tmp_path / "SHA256SUMS"
    sums.write_text("".join(f"{checksum(name)}  {name}\n" for name in NAMES))
    subprocess.run([sys.executable, FILL, sums, tmp_path / "recipes"], check=True)
    for path in (tmp_path / "recipes").rglob("*.*"):
        assert "@" not in path.read_text(), path
    return tmp_path / "recipes"


def read(path: Path) -> dict[str, Any]:
    yaml = pytest.importorskip("yaml")
    return dict(yaml.safe_load(path.read_text()))


def test_conda(recipes: Path) -> None:
    recipe = read(recipes / "recipe.yaml")
    assert recipe["source"]["sha256"] == checksum(NAMES[-1])
    assert recipe["source"]["url"].endswith(f"/releases/download/v{VERSION}/{NAMES[-1]}")
    assert recipe["requirements"]["run"] == ["python", "numpy >=1.24"]
    assert recipe["requirements"]["host"][2] == "maturin >=1.16,<2"
    builder = pytest.importorskip("rattler_build")
    variants = builder.VariantConfig(VARIANTS)
    rendered = builder.Stage0Recipe.from_file(str(recipes / "recipe.yaml")).render(variants)
    assert [(made.recipe.package.name, str(made.recipe.package.version)) for made in rendered] == [("taotie", VERSION)]


def test_homebrew(recipes: Path) -> None:
    formula = (recipes / "taotie.rb").read_text()
    sums = dict(re.findall(r'url ".*/(.*)"\n\s*sha256 "(.*)"', formula))
    assert sums == {name: checksum(name) for name in NAMES[:4]}
    summary = re.search(r'desc "(.*)"', formula)
    assert summary and len(summary[1]) <= 80 and not summary[1].endswith(".")
    if shutil.which("ruby"):
        subprocess.run(["ruby", "-wc", recipes / "taotie.rb"], check=True, capture_output=True)


def test_winget(recipes: Path) -> None:
    files = sorted((recipes / "winget").iterdir())
    assert len(files) == 3
    for path in files:
        manifest = read(path)
        common = {"PackageIdentifier", "PackageVersion", "ManifestType", "ManifestVersion"}
        assert manifest.keys() >= common | NEEDED[manifest["ManifestType"]]
        assert (manifest["PackageVersion"], manifest["ManifestVersion"]) == (VERSION, "1.10.0")
        assert path.name.startswith(manifest["PackageIdentifier"])
    installer = read(recipes / "winget/Taotie.Taotie.installer.yaml")
    archive = f"taotie-{VERSION}-x86_64-pc-windows-gnu"
    assert installer["NestedInstallerFiles"][0]["RelativeFilePath"] == f"{archive}\\taotie.exe"
    assert installer["Installers"][0]["InstallerSha256"] == checksum(f"{archive}.zip")


def test_a_missing_archive_is_named(tmp_path: Path) -> None:
    sums = tmp_path / "SHA256SUMS"
    sums.write_text("")
    done = subprocess.run([sys.executable, FILL, sums, tmp_path], capture_output=True, text=True, check=False)
    assert done.returncode == 1 and f"does not list taotie-{VERSION}" in done.stderr
