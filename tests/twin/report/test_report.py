"""The report of a run: its numbers are those of the samples, and the page is one file that says what there is."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from support.slot_run import SlotRun

import twin
from twin.cli import run as command
from twin.errors import ArchiveError
from twin.record import Attachment, Record, RunHeader, Step
from twin.report import pictures
from twin.report.bins import COLUMNS, TimeBins
from twin.report.contents import ReportContents, report_contents
from twin.report.page import assumed_values, report_html, write_run_report
from twin.report.track import MOST_PIECES, TrackKeeper
from twin.sinks.mcap_sink import McapSink

REFERENCE = Path(__file__).parents[3] / "recordings" / "reference" / "slot.mcap"
JOB = """
[[tools]]
number = 1
helix_deg = 30.0  # assumed: the program does not state it
[stock]
margin = 1  # by hand
"""


def with_job(records: Iterator[Record]) -> Iterator[Record]:
    for record in records:
        if isinstance(record, RunHeader):
            record = replace(record, attachments=(Attachment(name="job.toml", media_type="", data=JOB.encode()),))
        yield record


@pytest.fixture(scope="module")
def synthetic(tmp_path_factory: pytest.TempPathFactory) -> twin.Run:
    path = tmp_path_factory.mktemp("synthetic") / "slot.mcap"
    with McapSink(path) as sink:
        for record in with_job(SlotRun(step_mm=1.0).records()):
            sink.write(record)
    return twin.open_run(path)


@pytest.fixture(scope="module")
def contents() -> ReportContents:
    return report_contents(twin.open_run(REFERENCE))


@pytest.fixture(scope="module")
def page(synthetic: twin.Run) -> str:
    return report_html(report_contents(synthetic))


def test_lines_have_the_peaks_of_their_samples(contents: ReportContents) -> None:
    forces = contents.run.forces
    resultant = np.sqrt(forces["fx_n"] ** 2 + forces["fy_n"] ** 2 + forces["fz_n"] ** 2)
    assert contents.lines
    for line in contents.lines:
        here = (forces["nc_line"] == line.nc_line) & (forces["tool"] == line.tool)
        assert line.peak_n == pytest.approx(resultant[here].max(), rel=1e-12)
        assert line.peak_n == pytest.approx(resultant[np.argmin(np.abs(forces["t_s"] - line.t_s))], rel=1e-12)
        assert line.peak_power_w == pytest.approx(forces["power_w"][here].max(), rel=1e-12)
    assert [line.peak_n for line in contents.lines] == sorted((line.peak_n for line in contents.lines), reverse=True)


def test_the_worst_position_is_on_the_path_and_shows_two_revolutions(contents: ReportContents) -> None:
    worst = contents.worst[0]
    x, y, z = worst.forces.point_mm
    assert 0.0 <= x <= 4.0 and y == pytest.approx(0.0, abs=1e-9) and z == pytest.approx(-2.0, abs=1e-9)
    assert np.ptp(worst.t_s) == pytest.approx(2.0 * 60.0 / 3600.0, rel=0.05)
    assert np.linalg.norm(worst.force_n, axis=1).max() == pytest.approx(contents.summary.peak_force_n[3], rel=2e-6)


def test_positions_are_a_diameter_apart(contents: ReportContents) -> None:
    points = [np.array(w.forces.point_mm) for w in contents.worst]
    assert all(np.linalg.norm(a - b) >= 8.0 for i, a in enumerate(points) for b in points[:i])


def test_bins_hold_all_samples_and_the_envelope_holds_the_bins(contents: ReportContents) -> None:
    bins, forces = contents.bins, contents.run.forces
    column = np.minimum((forces["t_s"] / bins.end_s * COLUMNS).astype(int), COLUMNS - 1)
    for i, name in enumerate(("fx_n", "fy_n", "fz_n")):
        assert (forces[name] >= bins.low_n[column, i]).all() and (forces[name] <= bins.high_n[column, i]).all()
        assert np.nanmax(bins.high_n[:, i]) == forces[name].max()
    low, high = bins.envelope(bins.low_n[:, 3], bins.high_n[:, 3])
    known = ~np.isnan(bins.low_n[:, 3])
    assert (low[known] <= bins.low_n[known, 3]).all() and (high[known] >= bins.high_n[known, 3]).all()
    steady = (bins.t_s > 2.5) & (bins.t_s < 3.2)
    assert np.ptp(high[steady]) < 1.0  # no teeth in the envelope of a steady cut


def test_bins_longer_than_a_revolution_are_left_alone() -> None:
    bins = TimeBins(1e6)
    bins.turn_s = 1.0
    values = np.arange(float(COLUMNS))
    assert bins.envelope(values, values) == (values, values)


def test_a_long_path_is_thinned_and_keeps_its_ends_and_its_highest_force() -> None:
    keeper, steps = TrackKeeper(), [s for s in SlotRun(step_mm=0.5).records() if isinstance(s, Step)]
    count = MOST_PIECES + MOST_PIECES // 8
    for i in range(count):
        step = replace(steps[1], start_mm=(i * 1e-3, 0.0, 0.0), end_mm=((i + 1) * 1e-3, 0.0, 0.0))
        keeper.add(step, 77.0 if i == 12345 else 1.0)
    track = keeper.track()
    assert len(track.rapid) <= MOST_PIECES
    assert track.resultant_n.max() == 77.0
    assert track.start_mm[0, 0] == 0.0 and track.end_mm[-1, 0] == pytest.approx(count * 1e-3)
    assert np.allclose(track.end_mm[:-1], track.start_mm[1:])


def test_pieces_that_do_not_follow_each_other_are_bounded_too() -> None:
    keeper, step = TrackKeeper(), next(s for s in SlotRun().records() if isinstance(s, Step))
    for i in range(MOST_PIECES + 1):
        keeper.add(replace(step, start_mm=(2.0 * i, 0.0, 0.0), end_mm=(2.0 * i + 1.0, 0.0, 0.0), rapid=False), 1.0)
    assert len(keeper.track().rapid) <= MOST_PIECES


def test_the_page_is_one_file(page: str) -> None:
    assert not re.search(r"""(src|href)=["'](?!data:image/png;base64,)""", page)
    assert page.count("<img") == page.count("</figure>") >= 3
    assert "http://" not in page.replace("http://www.w3.org", "") and "<script" not in page


def test_the_page_says_what_happened(page: str) -> None:
    assert "The whole program was replayed: 0:07.6 of machine time" in page
    assert "1 collision." in page and "rapid through the stock" in page
    assert "M98 has no effect here" in page
    assert "helix_deg = 30.0" in page and "the program does not state it" in page and "by hand" not in page
    assert "N40 G1 X66 F600" in page


def test_assumptions_are_read_from_the_attached_job(synthetic: twin.Run) -> None:
    assert list(assumed_values(synthetic.header)) == [("T1: helix_deg = 30.0", "the program does not state it")]


def test_assumptions_about_a_table_and_a_tool(synthetic: twin.Run) -> None:
    text = "[machine]\nx = 1\n# assumed: around\n[stock]\ny = 2\n[[tools]]\nnumber = 7\nteeth = 2  # assumed: few\n"
    job = Attachment(name="job.toml", media_type="application/toml", data=text.encode())
    header = replace(synthetic.header, attachments=(job,))
    assert list(assumed_values(header)) == [("stock", "around"), ("T7: teeth = 2", "few")]


def test_text_of_the_program_is_harmless(synthetic: twin.Run, monkeypatch: pytest.MonkeyPatch) -> None:
    for name in ("overview", "over_time", "position"):
        monkeypatch.setattr(pictures, name, lambda *_: b"")
    found = report_contents(synthetic)
    evil = replace(found, blocks={4: "G1 <script>alert(1)</script> \x1b[31m \u202e"})
    text = report_html(evil)
    assert "<script>" not in text and "\x1b" not in text and "\u202e" not in text


def test_files_are_not_replaced_and_have_their_suffix(synthetic: twin.Run, tmp_path: Path) -> None:
    with pytest.raises(ArchiveError, match=r"expected a file name that ends in \.html"):
        write_run_report(synthetic, tmp_path / "a.pdf")
    (tmp_path / "a.html").write_text("mine")
    with pytest.raises(ArchiveError, match="already exists; replace it with --force"):
        write_run_report(synthetic, tmp_path / "a.html")
    assert (tmp_path / "a.html").read_text() == "mine"


def test_the_command_writes_next_to_the_run(
    synthetic: twin.Run, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    here = tmp_path / "slot.mcap"
    here.write_bytes(synthetic.path.read_bytes()[:-2000])  # cut off: what is there is shown, and said to be a part
    assert command(["report", str(here)]) == 0
    text = (tmp_path / "slot.html").read_text()
    assert "The run ended early" in text or "the archive is incomplete" in text
    assert "report written to" in capsys.readouterr().out


def test_a_run_without_forces(tmp_path: Path) -> None:
    path = tmp_path / "air.mcap"
    with McapSink(path) as sink:
        for record in SlotRun(step_mm=2.0, collision=False, per_turn=0).records():
            sink.write(record)
    text = report_html(report_contents(twin.open_run(path)))
    assert "Positions with the highest force" not in text and "Lines with the highest force" not in text
