"""The steps of action.yml: bakes the scans, or verifies the assets, that a pull request changes."""

from __future__ import annotations

import json
import shlex
import sys
from pathlib import Path

from pairs import Pair, Repository, Unusable, changed_files, is_pointer
from proofs import Program, Result
from runner import annotate, asked, output, prepare, summarise
from summary import table

TITLES = {"passed": "Warning", "not met": "Requirement not met", "failed": "Failed"}
MODES = ("bake", "verify")


def main() -> int:
    """Run the action; return the exit code of its step: 0 passed, 1 requirement not met, 2 failed."""
    prepare()
    try:
        return run(asked("mode"))
    except Unusable as error:
        annotate("error", str(error), title="Taotie")
        output("verdict", "failed")
        return 2


def run(mode: str) -> int:
    if mode not in MODES:
        raise Unusable(f"mode: `{mode}` is not one of {', '.join(MODES)}")
    repository = Repository(lines(asked("scans")), asked("asset"))
    if not repository.pairs:
        raise Unusable(f"scans: no file in the repository matches {' '.join(lines(asked('scans')))}")
    changed = changed_files(asked("base"))
    results_folder = Path(asked("results"))
    results_folder.mkdir(parents=True, exist_ok=True)
    program = Program(asked("program") or "taotie", options(), results_folder)
    if mode == "bake":
        pairs, work = repository.of_changed_scans(changed), program.bake
    else:
        pairs, work = [pair for pair in repository.of_changed(changed) if Path(pair.asset).exists()], program.verify
        for path in repository.without_scan(changed):
            annotate("warning", "not verified: no scan matches it; see the inputs scans and asset", file=path, title="No scan")
    results = [fetched(pair, mode) or work(pair) for pair in pairs]
    for result in results:
        report(result)
    return conclude(mode, results)


def fetched(pair: Pair, mode: str) -> Result | None:
    """Return a failure if a file of the pair is a pointer of git-lfs."""
    paths = [pair.scan] if mode == "bake" else [pair.scan, pair.asset]
    pointers = [path for path in paths if is_pointer(path)]
    why = "is a pointer of git-lfs, not the file itself: check out with `lfs: true`"
    return Result(pair, "failed", errors=[f"{path} {why}" for path in pointers]) if pointers else None


def report(result: Result) -> None:
    """Annotate the asset if it is in the repository, otherwise the scan."""
    file = result.pair.asset if Path(result.pair.asset).exists() else result.pair.scan
    for error in result.errors:
        annotate("error", error, file=file, title=TITLES[result.verdict])
    for warning in result.warnings:
        annotate("warning", warning, file=file, title="Warning")


def conclude(mode: str, results: list[Result]) -> int:
    verdicts = {result.verdict for result in results}
    verdict = next((worst for worst in ("failed", "not met", "passed") if worst in verdicts), "nothing changed")
    if results:
        summarise(table(mode, results))
    else:
        annotate("notice", f"nothing to {mode}: no scan or asset changed", title="Taotie")
    output("verdict", verdict)
    output("assets", json.dumps([result.pair.asset for result in results if result.verdict != "failed"]))
    return {"failed": 2, "not met": 1}.get(verdict, 0)


def options() -> list[str]:
    """Return the options of all runs."""
    try:
        given = shlex.split(asked("options"))
    except ValueError as error:
        raise Unusable(f"options: {error}") from None
    return given + (["--require", asked("require")] if asked("require") else [])


def lines(text: str) -> list[str]:
    return [line.strip() for line in text.splitlines() if line.strip()]


if __name__ == "__main__":
    sys.exit(main())
