"""The layout loads, in a recording and as a file for archives, and a viewer draws it."""

from __future__ import annotations

import os
import signal
import subprocess
import sysconfig
import time
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

import pyarrow as pa
import pytest
from rerun.chunk import RrdReader
from rerun.experimental import ViewerClient

from tests.support.ports import free_port
from tests.support.slot_run import BOX, SlotRun
from twin.archive.schemas import MESSAGES, REVOLUTION, REVOLUTION_TOPIC
from twin.errors import ArchiveError
from twin.sinks.mcap_sink import McapSink
from twin.sinks.rerun import layout
from twin.sinks.rerun.blueprint import SHIPPED, blueprint, save_blueprint
from twin.sinks.rerun.sink import RerunSink

RUN = SlotRun(step_mm=1.0, per_turn=36)
RERUN = Path(sysconfig.get_path("scripts")) / "rerun"
ARCHIVED = (*layout.ENVELOPE.series, *layout.RESULTANT_CURVES.series, *layout.TORQUE_CURVES.series)
VIEWS = {
    "Part, tool and path coloured by resultant force",
    "NC program",
    "Summary",
    "Resultant force: highest and mean of each revolution",
    "Force on the tool: lowest, highest and mean of each revolution",
    "Force around the cursor, ±40 ms",
    "Spindle torque: highest and mean of each revolution",
}


def rows(path: Path) -> str:
    """Everything that a file's blueprint says but the time of its making, as text."""
    reader = RrdReader(path)
    (entry,) = reader.blueprints()
    tables = [chunk.to_record_batch() for chunk in reader.stream(store=entry).to_chunks()]
    columns = [column for table in tables for column in table.columns if not pa.types.is_timestamp(column.type)]
    return "\n".join(str(column.to_pylist()) for column in columns)


def test_a_saved_blueprint_loads_and_maps_the_fields_of_the_archive(tmp_path: Path) -> None:
    save_blueprint(tmp_path / "a.rbl")
    (entry,) = RrdReader(tmp_path / "a.rbl").blueprints()
    assert entry.application_id == layout.APPLICATION_ID
    text = rows(tmp_path / "a.rbl")
    for series in ARCHIVED:
        assert f".{series.archive_field}" in text
        assert series.label in text
    assert layout.ARCHIVE_TIME in text


def test_the_shipped_blueprint_is_the_present_one(tmp_path: Path) -> None:
    save_blueprint(tmp_path / "a.rbl")
    shipped, made = rows(SHIPPED), rows(tmp_path / "a.rbl")
    for word in (*VIEWS, *(f".{s.archive_field}" for s in ARCHIVED), *(s.label for s in ARCHIVED)):
        assert shipped.count(word) == made.count(word) > 0
    assert len(shipped.splitlines()) == len(made.splitlines())


def test_the_mapped_fields_are_fields_of_the_archive() -> None:
    fields = {name for name, _, _ in MESSAGES[REVOLUTION]}
    assert {s.archive_field for s in ARCHIVED} <= fields
    assert f"{REVOLUTION}:message" == layout.ARCHIVE_FORCE_COMPONENT
    assert f"/{layout.ARCHIVE_FORCE}" == REVOLUTION_TOPIC


def test_a_recording_carries_its_blueprint(tmp_path: Path) -> None:
    with RerunSink(rrd=tmp_path / "a.rrd") as sink:
        sink.write(RUN.header())
    text = rows(tmp_path / "a.rrd")
    assert all(view in text for view in VIEWS)


def test_the_camera_looks_at_the_stock() -> None:
    assert blueprint(BOX) is not None


def test_a_blueprint_that_cannot_be_written_is_said(tmp_path: Path) -> None:
    path = tmp_path / "missing" / "a.rbl"
    with pytest.raises(ArchiveError, match=r"a\.rbl: cannot be written: "):
        save_blueprint(path)


@contextmanager
def viewer(*files: Path) -> Iterator[ViewerClient]:
    """A viewer without a window that shows files, or a skip where none can be started."""
    port = free_port()
    if os.name != "posix" or not RERUN.exists():
        pytest.skip("no rerun viewer here")
    command = [str(RERUN), "--headless", "--hide-welcome-screen", "--port", str(port), *map(str, files)]
    quiet = subprocess.DEVNULL
    process = subprocess.Popen(command, stdout=quiet, stderr=quiet, start_new_session=True)
    try:
        yield connect(process, port)
    finally:
        with suppress(ProcessLookupError):  # a viewer that could not start has ended by itself
            os.killpg(process.pid, signal.SIGTERM)
        process.wait()


def connect(process: subprocess.Popen[bytes], port: int) -> ViewerClient:
    for _ in range(150):
        if process.poll() is not None:
            break
        try:
            client = ViewerClient.connect(f"rerun+http://127.0.0.1:{port}/proxy")
            if client.get_state().active_recording:
                return client
        except (ConnectionError, RuntimeError):
            pass
        time.sleep(0.1)
    pytest.skip("the headless rerun viewer does not start here (mesa-vulkan-drivers, libegl1)")


def assert_draws(client: ViewerClient, picture: Path) -> None:
    time.sleep(1.0)
    views = client.get_state().views
    assert {view.name for view in views} == VIEWS
    assert [report for view in views for report in view.reports] == []
    client.save_screenshot(str(picture))
    assert picture.read_bytes().startswith(b"\x89PNG")


def test_a_viewer_draws_a_recording_without_complaint(tmp_path: Path) -> None:
    with RerunSink(rrd=tmp_path / "a.rrd") as sink:
        for record in RUN.records():
            sink.write(record)
    with viewer(tmp_path / "a.rrd") as client:
        assert_draws(client, tmp_path / "a.png")


def test_a_viewer_draws_an_archive_by_the_shipped_blueprint(tmp_path: Path) -> None:
    with McapSink(tmp_path / "a.mcap") as sink:
        for record in RUN.records():
            sink.write(record)
    convert = [str(RERUN), "mcap", "convert", str(tmp_path / "a.mcap"), "-o", str(tmp_path / "a.rrd")]
    options = ["--application-id", layout.APPLICATION_ID, "--timeline-type", "duration"]
    if not RERUN.exists():
        pytest.skip("no rerun viewer here")
    subprocess.run([*convert, *options], check=True, capture_output=True)
    with viewer(tmp_path / "a.rrd", SHIPPED) as client:
        assert_draws(client, tmp_path / "a.png")
