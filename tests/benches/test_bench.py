"""`make bench`: the order and verdicts of rows, busy machines, and the page."""

from __future__ import annotations

import argparse
import os
import subprocess
import sys
import time
from pathlib import Path

import bench
import machine
import page
import pytest
import quiet
import rows
import summary
from quiet import LIMIT, Load, Watch
from rows import Report, Row

LINUX = pytest.mark.skipif(not sys.platform.startswith("linux"), reason="needs /proc")
WINDOWS_LACKS_IT = pytest.mark.skipif(sys.platform == "win32", reason="needs sh")
# Computes for a second of wall time.
BURN = "import time\nend = time.time() + 1\nwhile time.time() < end: pass"
# A second of one processor, in clock ticks.
SECOND = os.sysconf("SC_CLK_TCK") if hasattr(os, "sysconf") else 100


def row(case: str, ratios: list[float], goal: float | None = None, load: float = 0.0, peer: str = "peer") -> Row:
    return Row(case, peer, "s", [1.0] * len(ratios), ratios, goal, load)


WON = row("won", [0.5, 0.7, 0.6])
MISSED = row("missed", [2.9, 2.8, 3.1], goal=3)
MET = row("met", [3.2, 3.1, 3.3], goal=3)
REST = row("rest", [1.5, 1.6, 1.7])
DISTURBED = row("disturbed", [0.1], load=2 * LIMIT)
ALL = [DISTURBED, REST, MET, MISSED, WON]


def test_rows_that_a_peer_wins_are_first_then_missed_goals() -> None:
    assert summary.ordered(ALL) == [WON, MISSED, REST, MET, DISTURBED]


def test_within_a_group_the_lowest_ratio_is_first() -> None:
    worse = row("worse", [0.2])
    assert summary.ordered([WON, worse]) == [worse, WON]


def test_a_ratio_is_the_median_of_the_rounds_with_their_spread() -> None:
    uneven = Row("a", "b", "s", [1.0, 2.0, 4.0], [2.0, 6.0, 6.0])
    assert uneven.ratios() == [2.0, 3.0, 1.5]
    assert uneven.ratio() == 2.0
    assert uneven.spread() == (1.5, 3.0)
    assert uneven.ratio_text() == "2.0 (1.5–3.0)"
    assert row("a", [2.0]).ratio_text() == "2.0"
    assert row("a", [2.0, 2.01]).spread_text() == "2.0"


@pytest.mark.parametrize(
    ("one", "expected"),
    [
        (WON, "the peer wins"),
        (row("", [0.9, 0.95, 1.1]), "the peer wins (rounds disagree)"),
        (row("", [1.9], goal=2), "Taotie wins; goal missed"),
        (row("", [0.5], goal=2), "the peer wins; goal missed"),
        (row("", [2.0], goal=2), "Taotie wins; goal met"),
        (DISTURBED, "busy: no conclusion"),
    ],
)
def test_verdicts(one: Row, expected: str) -> None:
    assert summary.verdict(one) == expected


def test_a_disturbed_row_has_no_ratio() -> None:
    assert summary.cells(DISTURBED)[2:5] == ["–", "–", "–"]
    expected = "Comparisons: 5; won by peers: 1; without a conclusion: 1. Goals: 2; missed: 1."
    assert summary.counts(ALL) == expected


def test_of_the_rest_only_the_nearest_peer_of_a_case_and_goals_are_shown() -> None:
    far, near = row("case", [9.0], peer="far"), row("case", [2.0], peer="near")
    aimed, lost = row("case", [12.0], goal=4, peer="aimed"), row("case", [0.5], peer="lost")
    assert summary.shown([far, near, aimed]) == [near, aimed]
    assert summary.shown([far, near, lost]) == [lost]


def test_figures_have_three_digits() -> None:
    assert [summary.figure(x) for x in (0.0812, 8.5, 15.92, 131.6, 1488)] == ["0.0812", "8.50", "15.9", "132", "1,488"]


@pytest.mark.parametrize(("busy", "measured", "expected"), [(1, 3, False), (2, 3, True), (2, 20, False), (3, 20, True)])
def test_a_page_is_refused_if_more_is_disturbed(busy: int, measured: int, expected: bool) -> None:
    assert summary.is_refused(Report([], {}, "", busy, measured)) == expected


def test_a_report_survives_its_file(tmp_path: Path) -> None:
    report = Report([MET, DISTURBED], {"peer": "1.0"}, "## Größe", 1, 2)
    path = str(tmp_path / "report.json")
    report.save(path)
    assert rows.load(path) == report


def test_ticks_of_the_machine_include_stolen_ones_but_not_waiting() -> None:
    text = "cpu 99 9 9 9 9 9 9 9 9 0\ncpu0 10 1 5 100 20 2 3 4 10 0\ncpu1 1 0 0 9 0 0 0 0 0 0\ncpu10 50 0 0 0 0 0 0 0 0 0\nintr 7\n"
    assert quiet.of_machine(text, {0}) == (145, 25)
    assert quiet.of_machine(text, {0, 1}) == (155, 26)


def test_ticks_of_a_process_whose_name_has_brackets() -> None:
    stat = "7 (a) S 1 b) S 3 7 7 0 -1 0 0 0 0 0 11 12 13 14 20 0 1 0"
    assert quiet.of_process(stat) == (3, 50)


def test_only_descendants_are_own() -> None:
    found = {1: (0, 1000), 5: (1, 1), 6: (5, 2), 7: (6, 4), 8: (1, 8), 9: (99, 16)}
    assert quiet.of_family(found, 5) == 7


def test_a_share_is_a_part_of_all_processors_and_never_negative() -> None:
    assert (Load(400, 30) - Load(200, 20)).share() == 0.05
    assert Load(20, 9).share() == 0.0, "a few ticks are rounding"
    assert Load(200, -3).share() == 0.0
    assert Load().share() == 0.0


def test_a_disturbed_measurement_is_repeated_once(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(quiet, "settle", lambda: 0.0)
    loads = iter([Load(100, 50), Load(100, 40)])
    calls = []

    def attempt(watch: Watch) -> int:
        watch.loads["taotie"] = next(loads)
        calls.append(watch)
        return len(calls)

    result, watch = quiet.undisturbed(attempt)
    assert (result, len(calls), watch.share("taotie")) == (2, 2, 0.4)


@LINUX
def test_the_time_of_a_child_is_own_even_after_it_ended() -> None:
    before = quiet.of_family(quiet.processes(), os.getpid())
    subprocess.run([sys.executable, "-c", BURN], check=True)
    used = quiet.of_family(quiet.processes(), os.getpid()) - before
    # A computing program gets at least a fifth of a processor on a busy machine.
    assert 0.2 * SECOND <= used <= 2 * SECOND


@LINUX
@pytest.mark.parametrize("adopts", [False, True])
def test_a_program_without_its_parent_counts_as_own_if_adopted(adopts: bool) -> None:
    quiet.adopt_orphans(adopts)
    subprocess.run(["sh", "-c", f"{sys.executable} -c '{BURN}' &"], check=True)
    watch = Watch()
    before = quiet.of_family(quiet.processes(), os.getpid())
    with watch.turn("turn"):
        time.sleep(0.8)
    own = quiet.of_family(quiet.processes(), os.getpid()) - before
    used = own if adopts else watch.loads["turn"].others
    assert used >= 0.2 * 0.8 * SECOND


def test_the_page_keeps_what_is_outside_the_marks(tmp_path: Path) -> None:
    path = tmp_path / "page.md"
    begin, end = page.marks(bench.mark("bake"))
    path.write_text(f"# Title\n\n{begin}\nold\n{end}\n\nwritten by hand\n", encoding="utf-8")
    page.write(str(path), bench.mark("bake"), "new")
    assert path.read_text(encoding="utf-8") == f"# Title\n\n{begin}\nnew\n{end}\n\nwritten by hand\n"


def test_the_page_in_the_repository_has_a_place_for_every_part() -> None:
    path = Path(__file__).parents[2] / "docs/benchmarks.md"
    for part in bench.PARTS:
        page.around(str(path), bench.mark(part))
    before, _ = page.around(str(path), "bench")
    assert before == "# Benchmarks\n\n"


class Run:
    """`make bench` with programs that do nothing, and parts that report at once."""

    def __init__(self, folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
        self.folder, self.busy, self.monkeypatch = folder, dict.fromkeys(bench.PARTS, 0), monkeypatch
        for name in ("taotie", "frames"):
            (folder / name).write_text("#!/bin/sh\necho taotie 1.2.3\n")
            (folder / name).chmod(0o755)
        self.page = folder / "page.md"
        marks = [page.marks(target) for target in ("bench", *map(bench.mark, bench.PARTS))]
        self.page.write_text("".join(f"{begin}\n{end}\n" for begin, end in marks))
        monkeypatch.setattr(quiet, "settle", lambda *_: 0.0)
        monkeypatch.setattr(bench, "measure", self.measure)

    def measure(self, args: argparse.Namespace, part: str) -> Report:
        (Path(args.folder) / bench.PLOT).write_text("<svg/>")
        report = Report([row(f"a case of {part}", [2.0])], {}, f"section of {part}", self.busy[part], 3)
        report.save(bench.report_path(args, part))
        return report

    def start(self, *options: str) -> str:
        """The page after a run with these options."""
        folders = ["--programs", str(self.folder), "--folder", str(self.folder), "--page", str(self.page)]
        self.monkeypatch.setattr(sys, "argv", ["bench.py", *folders, *options])
        bench.main()
        return self.page.read_text()


@pytest.fixture
def run(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Run:
    return Run(tmp_path, monkeypatch)


@WINDOWS_LACKS_IT
def test_a_whole_run_writes_the_page(run: Run) -> None:
    text = run.start()
    assert all(f"section of {part}" in text and f"a case of {part}" in text for part in bench.PARTS)
    assert machine.processor() in text and "taotie 1.2.3" in text
    assert (run.folder / "images" / bench.PLOT).exists()


@WINDOWS_LACKS_IT
def test_a_disturbed_run_does_not_write_the_page_until_its_part_is_repeated(run: Run) -> None:
    run.busy["bake"] = 2
    with pytest.raises(SystemExit, match="repeat with --only bake"):
        run.start()
    assert "section" not in run.page.read_text()
    run.busy["bake"] = 0
    assert "section of render" in run.start("--only", "bake")


@WINDOWS_LACKS_IT
def test_parts_measured_with_other_programs_do_not_count(run: Run) -> None:
    run.start()
    run.page.write_text(run.page.read_text().replace("section of bake", "earlier"))
    (run.folder / "frames").write_text("#!/bin/sh\necho another\n")
    assert "earlier" in run.start("--only", "bake")


@WINDOWS_LACKS_IT
def test_a_quick_run_does_not_write_the_page(run: Run) -> None:
    assert "section" not in run.start("--quick")


@WINDOWS_LACKS_IT
def test_a_busy_machine_is_refused_at_the_start(run: Run) -> None:
    run.monkeypatch.setattr(quiet, "settle", lambda *_: 0.4)
    with pytest.raises(SystemExit, match="other programs use 40 %"):
        run.start()


def test_the_widest_instructions_are_named() -> None:
    assert machine.simd(["sse2", "avx2", "fma"]) == "AVX2, "
    assert machine.simd(["sse2", "avx2", "fma", "avx512vl"]) == "AVX2, "
    assert machine.simd(["sse2", "avx2", "fma", *machine.AVX512]) == "AVX-512, "
    assert machine.simd([]) == ""
