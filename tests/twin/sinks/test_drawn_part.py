"""A recording shows the part as it is at the cursor."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from scipy.ndimage import maximum_filter, minimum_filter

from tests.support.drawn_part import DrawnPart, Plan, milled
from tests.support.recording import Recording
from twin.job import load_job
from twin.record import Record, Step
from twin.simulation.replay import Replay
from twin.sinks.rerun.sink import RerunSink

ROOT = Path(__file__).parents[3]
TOOLS = {1: ("flat", 6.0), 2: ("flat", 4.0), 3: ("ball", 3.0)}
#: How far the drawn part may be behind, s.
LAG_S = 0.3
#: After the end, where the surface of the slices is drawn.
ENDED_S = 1e9
#: In plan, walls are drawn within one cell of 0.4 mm; heights within a twentieth of it.
WALL, HEIGHT_MM = 3, 0.03


@pytest.fixture(scope="module")
def pocket(tmp_path_factory: pytest.TempPathFactory) -> tuple[list[Record], DrawnPart]:
    """The pocket without forces, on a coarse grid."""
    job = load_job(ROOT / "examples" / "pocket" / "job.toml").without_forces()
    job = job.with_simulation(slice_pitch_mm=0.4, step_mm=1.5)
    path = tmp_path_factory.mktemp("drawn") / "pocket.rrd"
    records = []
    with Replay(job) as replay, RerunSink(rrd=path) as sink:
        for record in replay:
            records.append(record)
            sink.write(record)
    return records, DrawnPart(Recording(path))


def test_at_any_cursor_the_drawn_part_is_less_than_a_third_of_a_second_behind(
    pocket: tuple[list[Record], DrawnPart],
) -> None:
    records, drawn = pocket
    steps = [r for r in records if isinstance(r, Step)]
    end_s = steps[-1].t_s + steps[-1].duration_s
    # among them times just before the part is drawn again, when it is furthest behind
    redrawn = np.array(drawn.times)
    cursors = np.linspace(0.03, 0.97, 10) * end_s
    cursors = np.sort([*cursors[::2], *(redrawn[np.searchsorted(redrawn, cursors[1::2])] - 1e-6)])
    plan = Plan((0.0, 0.0), (80.0, 60.0), 0.2)
    times = sorted({*cursors.tolist(), *(cursors - LAG_S).tolist(), *(cursors - 2.0).tolist(), ENDED_S})
    exact = dict(zip(times, milled(plan, 0.0, steps, TOOLS, times), strict=True))
    stale = 0
    for cursor in cursors.tolist():
        seen = drawn.heights(plan, cursor)
        least = minimum_filter(exact[cursor], 2 * WALL + 1) - HEIGHT_MM
        most = maximum_filter(exact[cursor - LAG_S], 2 * WALL + 1) + HEIGHT_MM
        assert np.all(seen >= least), cursor
        assert np.all(seen <= most), cursor
        stale += bool(np.any(maximum_filter(exact[cursor - 2.0], 2 * WALL + 1) > most))
    assert stale >= 5  # so a part two seconds behind would have been noticed
    seen = drawn.heights(plan, ENDED_S)
    assert np.all(seen >= minimum_filter(exact[ENDED_S], 2 * WALL + 1) - HEIGHT_MM)
    assert np.all(seen <= maximum_filter(exact[ENDED_S], 2 * WALL + 1) + HEIGHT_MM)
    assert np.median(np.abs(seen - exact[ENDED_S])) < 1e-5
