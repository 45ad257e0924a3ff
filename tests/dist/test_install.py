"""install.sh against a release on a local server, with each shell found."""

from __future__ import annotations

import os
import platform
import re
import shutil
import subprocess
from collections.abc import Iterator
from pathlib import Path

import pytest
from conftest import ROOT
from release import Release

SCRIPT = ROOT / "dist/install.sh"
SHELLS = {"sh": ["sh"], "dash": ["dash"], "bash": ["bash", "--posix"], "busybox": ["busybox", "sh"]}
# All programs that the script runs.
TOOLS = ["uname", "mktemp", "rm", "mkdir", "dirname", "cp", "mv", "tar", "gzip", "sha256sum", "curl"]
SHARED = ["man/man1/taotie.1", "bash-completion/completions/taotie", "fish/vendor_completions.d/taotie.fish",
          "zsh/site-functions/_taotie"]
pytestmark = pytest.mark.skipif(platform.system() != "Linux", reason="the release of the test is for Linux")


@pytest.fixture
def release(tmp_path: Path, program: Path) -> Iterator[Release]:
    folder = tmp_path / "release"
    folder.mkdir()
    with Release(folder, program).serving() as made:
        yield made


def install(release: Release, home: Path, shell: str = "sh", **variables: str) -> subprocess.CompletedProcess[str]:
    command = SHELLS[shell]
    if not shutil.which(command[0]):
        pytest.skip(f"{command[0]} is not installed")
    home.mkdir(exist_ok=True)
    environment = {**os.environ, "HOME": str(home), "SHELL": "/bin/zsh", "TMPDIR": str(home), "TAOTIE_DOWNLOADS": release.address, **variables}
    path = shutil.which(command[0])
    assert path
    done = subprocess.run([path, *command[1:], str(SCRIPT)], env=environment, capture_output=True, text=True, check=False)
    assert not list(home.glob("tmp*")), "the temporary folder is left"
    return done


def tools(folder: Path, *without: str) -> str:
    """Return a search path with all programs the script needs except some."""
    folder.mkdir()
    for name in [*TOOLS, "sh"]:
        found = shutil.which(name)
        if found and name not in without:
            (folder / name).symlink_to(os.path.realpath(found) if name != "sh" else found)
    return str(folder)


@pytest.mark.parametrize("shell", SHELLS)
def test_it_installs_everything(release: Release, tmp_path: Path, shell: str) -> None:
    home = tmp_path / "a home's folder"
    done = install(release, home, shell)
    assert done.returncode == 0, done.stderr
    assert "installed taotie" in done.stderr
    assert f"export PATH=\"{home}/.local/bin:$PATH\"" in done.stderr
    assert f"fpath=('{home}/.local/share/zsh/site-functions' $fpath)" in done.stderr
    subprocess.run([home / ".local/bin/taotie", "--version"], check=True, capture_output=True)
    assert all((home / ".local/share" / name).is_file() for name in [*SHARED, "man/man1/taotie-bake.1"])
    assert not list(home.rglob("*.new"))
    again = install(release, home, shell, PATH=f"{home}/.local/bin:{os.environ['PATH']}", SHELL="/bin/bash")
    assert again.returncode == 0 and "PATH" not in again.stderr, "an update, found already"


def test_a_folder_not_called_bin_gets_only_the_program(release: Release, tmp_path: Path) -> None:
    done = install(release, tmp_path / "home", TAOTIE_INSTALL_DIR=str(tmp_path / "home/tools"))
    assert done.returncode == 0 and "no man pages or completions" in done.stderr
    assert [path.name for path in (tmp_path / "home").rglob("*") if path.is_file()] == ["taotie"]


def test_a_wrong_checksum_installs_nothing(release: Release, tmp_path: Path) -> None:
    release.list("1" * 64)
    done = install(release, tmp_path / "home")
    assert done.returncode == 1 and "nothing was installed" in done.stderr
    assert not list((tmp_path / "home").iterdir())


@pytest.mark.parametrize(("without", "message"), [
    (["curl"], "neither curl nor wget was found"),
    (["sha256sum"], "none of sha256sum, shasum and openssl was found"),
    (["tar"], "tar was not found"),
    (["gzip"], "gzip was not found"),
])
def test_missing_tools_are_named(release: Release, tmp_path: Path, without: list[str], message: str) -> None:
    done = install(release, tmp_path / "home", PATH=tools(tmp_path / "tools", *without))
    assert done.returncode == 1 and message in done.stderr


def test_wget_does_too(release: Release, tmp_path: Path) -> None:
    path = Path(tools(tmp_path / "tools", "curl"))
    for name, program in (("wget", shutil.which("wget")), ("env", shutil.which("env"))):
        if not program:
            pytest.skip(f"{name} is not installed")
        (path / name).symlink_to(program)
    done = install(release, tmp_path / "home", PATH=str(path))
    assert done.returncode == 0, done.stderr


@pytest.mark.parametrize(("variables", "message"), [
    ({"TAOTIE_TARGET": "riscv64-unknown-linux-musl"}, "the release has no archive for riscv64-unknown-linux-musl"),
    ({"TAOTIE_DOWNLOADS": "http://127.0.0.1:9"}, "cannot download http://127.0.0.1:9/SHA256SUMS"),
])
def test_errors_say_why(release: Release, tmp_path: Path, variables: dict[str, str], message: str) -> None:
    done = install(release, tmp_path / "home", **variables)
    assert done.returncode == 1 and f"install.sh: error: {message}" in done.stderr


def test_a_folder_that_cannot_be_written_is_named(release: Release, tmp_path: Path) -> None:
    home = tmp_path / "home"
    home.mkdir()
    (home / ".local").write_text("a file")
    done = install(release, home)
    assert done.returncode == 1 and "TAOTIE_INSTALL_DIR" in done.stderr


def test_a_script_cut_off_does_nothing(release: Release, tmp_path: Path) -> None:
    text = SCRIPT.read_text()
    for share in range(1, 20):
        part = tmp_path / "part.sh"
        part.write_text(text[: len(text) * share // 20])
        home = tmp_path / "home"
        home.mkdir(exist_ok=True)
        subprocess.run(["sh", part], env={**os.environ, "HOME": str(home), "TAOTIE_DOWNLOADS": release.address}, capture_output=True, check=False)
        assert not list(home.iterdir())


def test_pages_and_scripts_name_the_declared_repository_and_version() -> None:
    declared = dict(re.findall(r'^(repository|version) = "(.*)"', (ROOT / "Cargo.toml").read_text(), re.MULTILINE))
    owner = declared["repository"].split("/")[-2]
    texts = {path.name: path.read_text() for path in
             (SCRIPT, ROOT / "dist/install.ps1", ROOT / "docs/install.md", ROOT / "docs/action.md")}
    for name, text in texts.items():
        assert set(re.findall(r"([\w.-]+)/taotie(?:/releases|@v|$|'|\n)", text)) <= {owner, "bin", "programs", "recipes"}, name
        assert set(re.findall(r"https://github\.com/[^/\s']+/[^/\s']+", text)) <= {declared["repository"]}, name
    for name in ("install.md", "action.md"):
        assert set(re.findall(r"\bv?(\d+\.\d+\.\d+)\b", texts[name])) == {declared["version"]}, name
