"""Files of `make dist`: the same bytes for the same content, and every file that installers expect."""

from __future__ import annotations

import gzip
import hashlib
import io
import re
import sys
import tarfile
import zipfile
from pathlib import Path

import pytest
from conftest import ROOT
from release import FILES

pytest.importorskip("tomllib", reason="make dist needs Python 3.11")

import archive  # noqa: E402
import layout  # noqa: E402
import libraries  # noqa: E402
import licences  # noqa: E402
import packages  # noqa: E402
import place  # noqa: E402
import sums  # noqa: E402
import targets  # noqa: E402
import wheels  # noqa: E402

DATE = 1_700_000_000
CONTENT = {"taotie": b"program" * 1000, "man/taotie.1": b".TH", "LICENSE-MIT": b"MIT"}
# Prints a script per shell and writes pages, as the program does.
FAKE = '#!/bin/sh\nif [ "$1" = man-pages ]; then for page in taotie taotie-bake; do echo .TH >"$2/$page.1"; done; else echo "$@"; fi\n'


@pytest.fixture
def program(tmp_path: Path) -> Path:
    path = tmp_path / "program"
    path.write_text(FAKE)
    path.chmod(0o755)
    return path


@pytest.mark.parametrize("name", ["taotie-1.tar.gz", "taotie-1.zip"])
def test_archives_depend_on_content_and_date_only(tmp_path: Path, name: str) -> None:
    contents = [CONTENT, dict(reversed(CONTENT.items())), CONTENT, {**CONTENT, "man/taotie.1": b".SH"}]
    for at, (content, date) in enumerate(zip(contents, [DATE, DATE, DATE + 2, DATE], strict=True)):
        (tmp_path / str(at)).mkdir()
        archive.write(tmp_path / str(at) / name, content, date)
    first, reordered, later, edited = ((tmp_path / str(at) / name).read_bytes() for at in range(4))
    assert first == reordered
    assert len({first, later, edited}) == 3


def test_tar_entries_have_neither_owner_nor_order_of_creation(tmp_path: Path) -> None:
    path = tmp_path / "taotie-1-x.tar.gz"
    archive.write(path, CONTENT, DATE)
    packed = path.read_bytes()
    # Flags and time of the gzip header: no name, no date.
    assert packed[3:8] == bytes(5)
    with tarfile.open(fileobj=io.BytesIO(gzip.decompress(packed))) as tar:
        entries = tar.getmembers()
    assert [entry.name for entry in entries] == [f"taotie-1-x/{name}" for name in ("LICENSE-MIT", "man/taotie.1", "taotie")]
    assert {(entry.uid, entry.gid, entry.uname, entry.gname, entry.mtime) for entry in entries} == {(0, 0, "", "", DATE)}
    assert [entry.mode for entry in entries] == [0o644, 0o644, 0o755]


@pytest.mark.skipif(sys.platform == "win32", reason="the fake program is a shell script")
@pytest.mark.parametrize("target", targets.ALL, ids=lambda target: target.triple)
def test_archives_are_complete(tmp_path: Path, program: Path, monkeypatch: pytest.MonkeyPatch, target: targets.Target) -> None:
    monkeypatch.setenv("SOURCE_DATE_EPOCH", str(DATE))
    path = layout.write(tmp_path, target, program, layout.shared(b"<html>", program))
    folder = f"taotie-{place.version()}-{target.triple}"
    files = set(FILES) - {"taotie"}
    if target.is_windows:
        assert path.name == f"{folder}.zip"
        packed = zipfile.ZipFile(path)
        assert packed.read(f"{folder}/completions/powershell/_taotie.ps1") == b"completions powershell\n"
        assert set(packed.namelist()) == {f"{folder}/{name}" for name in files | {"taotie.exe"}}
    else:
        assert path.name == f"{folder}.tar.gz"
        with tarfile.open(path) as tar:
            assert set(tar.getnames()) == {f"{folder}/{name}" for name in files | {"taotie"}}


@pytest.mark.parametrize(("tag", "fits"), [("manylinux_2_17", True), ("manylinux_2_5", True), ("manylinux_2_28", False), ("musllinux_1_2", False), ("linux", False)])
def test_wheels_need_no_newer_library_than_they_state(tag: str, fits: bool) -> None:
    report = f'taotie.whl is consistent\nwith the following platform tag: "{tag}_x86_64".\n'
    assert wheels.fits(report, wheels.NEWEST[targets.MANYLINUX]) == fits


def test_checksums_are_those_of_all_files(tmp_path: Path) -> None:
    (tmp_path / "b").write_bytes(b"2")
    (tmp_path / "a").write_bytes(b"1")
    sums.write(tmp_path)
    sums.write(tmp_path)
    lines = (tmp_path / sums.NAME).read_text().splitlines()
    assert lines == [f"{hashlib.sha256(content).hexdigest()}  {name}" for name, content in (("a", b"1"), ("b", b"2"))]


def test_targets_are_chosen_by_name() -> None:
    assert targets.chosen(["all"]) == list(targets.ALL)
    assert [target.triple for target in targets.chosen(["x86_64-pc-windows-gnu"])] == ["x86_64-pc-windows-gnu"]
    with pytest.raises(SystemExit, match="unknown target `x86`; expected all, or some of: x86_64-unknown-linux-musl"):
        targets.chosen(["x86"])


def test_each_licence_text_is_listed_once_with_its_packages() -> None:
    def named(name: str, **more: object) -> packages.Package:
        return packages.Package(name, "1.0", "MIT", f"pkg:cargo/{name}@1.0", **more)  # type: ignore[arg-type]

    page = licences.page([named("a", texts=["Same <text>"]), named("b", texts=["Same <text>"]), named("c", authors=["C <c@x>"])]).decode()
    assert page.count("Same &lt;text&gt;") == 1 and ": a, b</h2>" in page
    assert "Copyright (c) C\n\nPermission is hereby granted" in page
    with pytest.raises(SystemExit, match="d 1.0 has no licence file"):
        licences.page([packages.Package("d", "1.0", "Zlib", "pkg:cargo/d@1.0")])


def test_vendored_libraries_state_version_and_licence(tmp_path: Path) -> None:
    (tmp_path / "LICENSE").write_text("Terms")
    (tmp_path / "x.h").write_text("#define V 30302\n/**\n * Terms of X\n */\n")
    x = libraries.Vendored("x", "x-sys", "MIT", "x.h", r"define V (\d)(\d\d)(\d\d)", "x.h")
    found = libraries.vendored(x, tmp_path)
    assert (found.version, found.texts, found.url) == ("3.3.2", ["Terms of X"], "pkg:generic/x@3.3.2")
    with pytest.raises(SystemExit, match="does not state the version of x"):
        libraries.vendored(libraries.Vendored("x", "x-sys", "MIT", "x.h", "define W", "LICENSE"), tmp_path)


@pytest.mark.parametrize("library", libraries.SCRIPTS, ids=lambda library: library.name)
def test_the_licence_of_a_script_is_that_of_its_package(library: libraries.Script) -> None:
    installed = [*(ROOT / library.project / "node_modules" / library.name).glob("LICENSE*")]
    if not installed:
        pytest.skip(f"npm packages of {library.project} are not installed")
    assert libraries.script(library).texts[0] in [path.read_text(encoding="utf-8") for path in installed]


def test_the_page_covers_every_crate_of_a_release() -> None:
    crates = packages.crates()
    found = {crate.name for crate in crates}
    assert {library.crate for library in libraries.VENDORED} <= found
    assert {"clap", "pyo3", "wgpu", "objc2-metal", "rmcp", "tokio", "web-time"} <= found and not {"snapbox", "criterion", "syn"} & found
    page = licences.page(crates).decode()
    plain = page.replace("</a>", "")
    assert all(f">{crate.name}</td><td>{crate.version}</td>" in plain for crate in crates)
    assert not re.search(r"(?i)<pre>\s*gnu general public", page)
