"""The action's steps in a repository with two commits, with the runner's environment variables."""

from __future__ import annotations

import json
import os
import re
import subprocess
import sys
from dataclasses import dataclass
from html.parser import HTMLParser
from pathlib import Path
from urllib.parse import unquote

import pytest
from conftest import ROOT
from release import Release

ACTION = ROOT / "dist/action"
# Names that annotations, outputs, tables and commands of the runner could trip over.
ODD = ['two "quoted" words.obj', "line\nbreak.obj", "100%25, done: yes.obj", "-o 銅鼎 ü.obj", "::error::x ##[error]<i>|`x`.obj"]
QUICK = "--proof-points 400 --proof-view 32"


@dataclass
class Step:
    """What a step left behind."""

    code: int
    log: str
    annotations: list[tuple[str, dict[str, str], str]]
    summary: str
    outputs: dict[str, str]
    results: Path


class Checkout:
    """A repository, and the runner's files next to it."""

    def __init__(self, folder: Path, program: Path) -> None:
        self.folder = folder / "repository"
        self.program = program
        self.folder.mkdir()
        self.git("init", "-q")
        self.git("config", "core.protectNTFS", "false")

    def git(self, *arguments: str) -> str:
        command = ["git", "-c", "user.name=T", "-c", "user.email=t@example.org", *arguments]
        return subprocess.run(command, cwd=self.folder, check=True, capture_output=True, text=True).stdout.strip()

    def commit(self, files: dict[str, str | bytes]) -> str:
        for name, content in files.items():
            path = self.folder / name
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_bytes(content.encode() if isinstance(content, str) else content)
        self.git("add", "--all")
        self.git("commit", "-qm", "Change", "--allow-empty")
        return self.git("rev-parse", "HEAD")

    def run(self, **inputs: str) -> Step:
        """Run the step with the defaults of action.yml and these inputs."""
        runner = self.folder.parent / f"runner-{len(list(self.folder.parent.iterdir()))}"
        runner.mkdir()
        inputs = {"scans": "scans/**/*.obj", "asset": "assets/{stem}.glb", "require": "standard", "program": str(self.program),
                  "results": str(runner / "results"), **inputs}
        files = {name: runner / name for name in ("GITHUB_OUTPUT", "GITHUB_STEP_SUMMARY")}
        done = subprocess.run(
            [sys.executable, str(ACTION)], cwd=self.folder, capture_output=True, check=False,
            env={**environment(), **{f"INPUT_{key.upper()}": value for key, value in inputs.items()},
                 **{name: str(path) for name, path in files.items()}})
        assert not done.stderr, done.stderr.decode()
        texts = {name: path.read_text() if path.exists() else "" for name, path in files.items()}
        log = done.stdout.decode()
        return Step(done.returncode, log, obeyed(log), texts["GITHUB_STEP_SUMMARY"], read_outputs(texts["GITHUB_OUTPUT"]),
                    runner / "results")


def environment() -> dict[str, str]:
    return {name: value for name, value in os.environ.items() if not name.startswith(("GITHUB_", "INPUT_", "GIT_"))}


def obeyed(log: str) -> list[tuple[str, dict[str, str], str]]:
    """Return the annotations that the runner reads: it also takes `##[…]` anywhere in a line, unless it was stopped."""
    found, stopped = [], None
    for line in log.split("\n"):
        if stopped:
            stopped = None if line == f"::{stopped}::" else stopped
            continue
        command = re.match(r"::([a-z-]+)( [^:]*)?::(.*)", line) or re.search(r"##\[([a-z-]+)( [^\]]*)?\](.*)", line)
        if not command:
            continue
        name, properties, message = command.groups()
        if name == "stop-commands":
            stopped = message
        elif name in ("error", "warning", "notice"):
            pairs = (part.split("=", 1) for part in (properties or "").strip().split(","))
            found.append((name, {key: unquote(value) for key, value in pairs}, unquote(message)))
    return found


def read_outputs(text: str) -> dict[str, str]:
    return {name: value for name, _, value in re.findall(r"^(\w+)<<(\w+)\n(.*?)\n\2$", text, re.MULTILINE | re.DOTALL)}


class Cells(HTMLParser):
    """Texts of the cells of a table, and all tags."""

    def __init__(self, page: str) -> None:
        super().__init__()
        self.tags: set[str] = set()
        self.texts: list[str] = []
        self.feed(page)

    def handle_starttag(self, tag: str, attrs: object) -> None:
        self.tags.add(tag)
        if tag == "td":
            self.texts.append("")

    def handle_data(self, data: str) -> None:
        if self.texts:
            self.texts[-1] += data


@pytest.fixture
def checkout(tmp_path: Path, program: Path) -> Checkout:
    return Checkout(tmp_path, program)


def test_the_steps_of_action_yml_run_in_a_shell(checkout: Checkout, scan: str, program: Path, tmp_path: Path) -> None:
    yaml = pytest.importorskip("yaml")
    action = yaml.safe_load((ROOT / "action.yml").read_text())
    checkout.commit({"scans/x.obj": scan})
    given = {"mode": "bake", "scans": "scans/*.obj", "options": f"--triangles 60 --size 64 {QUICK}", "require": "", "base": "",
             "asset": "assets/{stem}.glb"}
    inputs = {name: given.get(name, declared.get("default", "")) for name, declared in action["inputs"].items()}
    temporary = tmp_path / "runner temp"
    (tmp_path / "release").mkdir()
    with Release(tmp_path / "release", program).serving() as release:
        for step in action["runs"]["steps"][:2]:
            variables = {name: evaluated(value, inputs, temporary) for name, value in step["env"].items()}
            subprocess.run(["bash", "-eo", "pipefail", "-c", step["run"]], cwd=checkout.folder, check=True, env={
                **environment(), **variables, "GITHUB_ACTION_PATH": str(ROOT), "RUNNER_OS": "Linux", "TAOTIE_DOWNLOADS": release.address,
                "GITHUB_OUTPUT": str(tmp_path / "output")})
    assert read_outputs((tmp_path / "output").read_text()) == {"verdict": "passed", "assets": '["assets/x.glb"]'}
    upload = action["runs"]["steps"][2]["with"]
    results = Path(evaluated(upload["path"], inputs, temporary))
    assert sorted(path.name for path in results.rglob("*.*")) == ["x.glb", "x.report.html", "x.report.json"]


def evaluated(text: str, inputs: dict[str, str], temporary: Path) -> str:
    """Return a value of action.yml with its expressions evaluated; without the input `program`."""
    known = {"runner.temp": str(temporary), **{f"inputs.{name}": value for name, value in inputs.items()},
             "inputs.program || format('{0}/taotie/bin/taotie', runner.temp)": f"{temporary}/taotie/bin/taotie"}
    return re.sub(r"\$\{\{ (.*?) \}\}", lambda found: known[found[1]], text)


def errors(step: Step) -> list[str]:
    return [message for level, _, message in step.annotations if level == "error"]


def test_baked_scans_verify(checkout: Checkout, scan: str) -> None:
    base = checkout.commit({"scans/old.obj": scan, "notes.txt": "x"})
    checkout.commit({f"scans/deep/{name}": scan for name in ODD})
    baked = checkout.run(mode="bake", base=base, options=f"--triangles 400 --size 64 {QUICK}", require="mean-angle=30")
    assets = [f"assets/{name.removesuffix('.obj')}.glb" for name in ODD]
    assert (baked.code, baked.outputs["verdict"], errors(baked)) == (0, "passed", []), baked.log
    assert sorted(json.loads(baked.outputs["assets"])) == sorted(assets), "old.obj did not change"
    for asset in assets:
        assert (checkout.folder / asset).read_bytes()[:4] == b"glTF"
    # Upload refuses these characters. Asset, page and figures of each.
    names = [path.relative_to(baked.results).as_posix() for path in baked.results.rglob("*") if path.is_file()]
    assert len(names) == 3 * len(ODD)
    assert not any(set(name) & set('\r\n":<>|*?\\') for name in names), names
    assert not list(checkout.folder.rglob("*.html")), "proofs are results only"

    head = checkout.commit({})
    checked = checkout.run(mode="verify", base=base, options=QUICK, require="mean-angle=30")
    assert (checked.code, errors(checked)) == (0, []), checked.log
    assert sorted(json.loads(checked.outputs["assets"])) == sorted(assets)
    cells = Cells(checked.summary)
    assert cells.tags - {"br", "b"} == {"h3", "table", "tr", "th", "td", "code"}
    for asset in assets:
        assert (asset if asset.isprintable() else json.dumps(asset)[1:-1]) in cells.texts
    assert len(cells.texts) == 4 * len(ODD)
    assert all(re.match(r"mean-angle [\d.]+° \(at most 30°\)", text) for text in cells.texts[3::4]), cells.texts

    nothing = checkout.run(mode="verify", base=head)
    assert (nothing.code, nothing.outputs["verdict"], nothing.summary) == (0, "nothing changed", "")


def test_failures_are_annotated(checkout: Checkout, scan: str) -> None:
    checkout.commit({"scans/good, 5%25.obj": scan, "scans/coarse.obj": scan})
    assert checkout.run(mode="bake", options=f"--triangles 60 --size 64 {QUICK}", require="").code == 0
    base = checkout.commit({})
    checkout.commit({"scans/good, 5%25.obj": scan + "# more\n", "scans/coarse.obj": scan + "# more\n",
                     "scans/broken ##[error]x.obj": "this is not a scan", "assets/broken ##[error]x.glb": b"glTF",
                     "scans/pointer.obj": "version https://git-lfs.github.com/spec/v1\noid sha256:0\nsize 1\n",
                     "assets/pointer.glb": b"glTF", "assets/orphan.glb": b"glTF"})
    step = checkout.run(mode="verify", base=base, require="mean-angle=0.001,completeness=1%")
    assert (step.code, step.outputs["verdict"]) == (2, "failed")
    # Errors come last and replace warnings about the same file.
    by_file = {properties["file"]: (level, properties["title"], message)
               for level, properties, message in sorted(step.annotations, key=lambda found: found[0] == "error")}
    assert set(by_file) == {f"assets/{name}.glb" for name in ("good, 5%25", "coarse", "broken ##[error]x", "pointer", "orphan")}
    level, title, message = by_file["assets/good, 5%25.glb"]
    assert (level, title) == ("error", "Requirement not met")
    assert re.match(r"requirement not met: mean-angle [\d.]+° \(at most 0.001°\)", message)
    assert by_file["assets/broken ##[error]x.glb"][:2] == ("error", "Failed") and "broken" in by_file["assets/broken ##[error]x.glb"][2]
    assert "lfs: true" in by_file["assets/pointer.glb"][2]
    assert by_file["assets/orphan.glb"][:2] == ("warning", "No scan")
    assert json.loads(step.outputs["assets"]) == ["assets/coarse.glb", "assets/good, 5%25.glb"]
    texts = Cells(step.summary).texts
    assert [texts[row] for row in range(2, len(texts), 4)] == ["failed", "requirement not met", "requirement not met", "failed"]
    assert any(re.search(r"completeness [\d.]+ % \(at least 1 %\)", text) for text in texts)

    only_unmet = checkout.run(mode="verify", base=base, scans="scans/good*.obj", require="mean-angle=0.001")
    assert (only_unmet.code, only_unmet.outputs["verdict"]) == (1, "not met")


def test_files_of_a_model_count_as_changes_of_it(checkout: Checkout, scan: str) -> None:
    base = checkout.commit({"scans/a/x.obj": "mtllib x.mtl\n" + scan, "scans/a/x.mtl": "newmtl m\n", "scans/b/y.obj": scan})
    checkout.commit({"scans/a/x.mtl": "newmtl n\n", "unrelated.mtl": ""})
    step = checkout.run(mode="bake", base=base, options=f"--triangles 60 --size 64 {QUICK}", require="")
    assert (step.code, step.outputs["assets"]) == (0, '["assets/x.glb"]'), step.log


@pytest.mark.parametrize(("inputs", "message"), [
    ({"mode": "paint"}, "mode: `paint` is not one of bake, verify"),
    ({"scans": "none/*.obj"}, "scans: no file in the repository matches none/*.obj"),
    ({"asset": "all.glb"}, "asset: `all.glb` gives all scans the same asset: include {stem}, such as {dir}/{stem}.glb"),
    ({"asset": "{dir}/{stem}.obj"}, "asset: `{dir}/{stem}.obj` is the scan itself for scans/a/x.obj"),
    ({}, "asset: scans/a/x.obj and scans/b/x.obj have the same asset assets/x.glb: include {dir}"),
    ({"asset": "{dir}/{stem}.glb", "program": "./none"}, "program: cannot run `./none`: No such file or directory"),
    ({"asset": "{dir}/{stem}.glb", "options": "'"}, "options: No closing quotation"),
])
def test_unusable_inputs_are_errors(checkout: Checkout, scan: str, inputs: dict[str, str], message: str) -> None:
    checkout.commit({"scans/a/x.obj": scan, "scans/b/x.obj": scan})
    step = checkout.run(**{"mode": "bake", **inputs})
    assert (step.code, errors(step)) == (2, [message])


def test_a_program_that_proves_nothing_is_a_failure(checkout: Checkout, scan: str) -> None:
    checkout.commit({"scans/x.obj": scan})
    other = checkout.folder.parent / "other"
    other.write_text("#!/bin/sh\nexit 1\n")
    other.chmod(0o755)
    step = checkout.run(mode="bake", program=str(other))
    assert (step.code, errors(step), step.outputs["assets"]) == (2, [f"{other} ended with exit code 1"], "[]")


def test_a_bake_without_a_proof_passes(checkout: Checkout, scan: str) -> None:
    checkout.commit({"scans/x.obj": scan})
    step = checkout.run(mode="bake", options="--triangles 60 --size 64 --no-verify", require="")
    assert (step.code, errors(step), step.outputs) == (0, [], {"verdict": "passed", "assets": '["assets/x.glb"]'}), step.log
    assert Cells(step.summary).texts[:3] == ["assets/x.glb", "scans/x.obj", "passed"]
    assert [path.name for path in step.results.rglob("*.*")] == ["x.glb"]


def test_a_base_that_is_not_here_is_fetched(checkout: Checkout, scan: str, tmp_path: Path) -> None:
    base = checkout.commit({"scans/old.obj": scan})
    checkout.commit({"scans/new.obj": scan})
    checkout.git("config", "uploadpack.allowAnySHA1InWant", "true")
    shallow = tmp_path / "shallow"
    checkout.git("clone", "-q", "--depth=1", f"file://{checkout.folder}", str(shallow))
    checkout.folder = shallow
    step = checkout.run(mode="bake", base=base, options=f"--triangles 60 --size 64 {QUICK}", require="")
    assert (step.code, step.outputs["assets"]) == (0, '["assets/new.glb"]'), step.log


def test_units_are_the_program_s(scan: str, program: Path, tmp_path: Path) -> None:
    sys.path.insert(0, str(ACTION))
    from figures import in_words

    limits = ("mean-angle=0.00001,p95-angle=0.00001,max-angle=0.00001,patch-angle=0.00001,surface-mean-angle=0.00001,"
              "hausdorff=0.0000001%,silhouette=0.01,flip=0.0000001,worst-view=0.0000001,ssim=1,completeness=100%,"
              "missed=0.0000001%,within-0.01deg=99%,within-0.000001%=99%,within-0.1dE=99%,mean-color=0.1,patch-color=0.1")
    # Red on one side, and an asset without colours.
    colored = re.sub(r"^(v (-?)[^\n]*)", lambda found: f"{found[1]} {0.8 if found[2] else 0.2} 0.2 0.2", scan, flags=re.MULTILINE)
    (tmp_path / "scan.obj").write_text(colored)
    asset = tmp_path / "asset.glb"
    subprocess.run([program, "bake", tmp_path / "scan.obj", "-o", asset, "--triangles", "60", "--size", "64", "--maps", "normal", "--no-verify", "-q"], check=True)
    done = subprocess.run([program, "verify", asset, "--scan", tmp_path / "scan.obj", "--json", "--require", limits],
                          capture_output=True, text=True, check=False)
    required = json.loads(done.stdout)["certificate"]["required"]
    ours = {without_numbers(in_words(figure)) for figure in required if not figure["met"]}
    listed = re.findall(r"requirements? not met: ([^;\n]*)", done.stderr)
    assert len(ours) > 15, done.stderr
    assert ours == {without_numbers(text) for line in listed for text in line.split(", ")}


def without_numbers(text: str) -> str:
    """Return text without values, which the program states with other numbers of digits."""
    return re.sub(r" [\d.]+", " #", text)
