"""The pictures of the README and of docs/: replays of the examples as the rerun viewer shows them.

    python tools/make_pictures.py            # all
    python tools/make_pictures.py pocket     # one

Needs no screen; without a graphics card, Mesa's software Vulkan (Debian: mesa-vulkan-drivers, libegl1).
"""

from __future__ import annotations

import os
import signal
import socket
import subprocess
import sys
import sysconfig
import tempfile
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from PIL import Image
from rerun.experimental import ViewerClient

from twin.drafting.draft import draft_job
from twin.job import Job, load_job
from twin.simulation.replay import Replay
from twin.sinks.rerun.layout import TIME
from twin.sinks.rerun.sink import RerunSink

ROOT = Path(__file__).parents[1]
PICTURES = ROOT / "docs" / "pictures"
#: Picture, and the machine time that it shows as a share of the whole.
EXAMPLES = {"ball_slot": 0.8, "pocket": 0.33, "casting": 0.45}
#: The picture of the NC program that the README replays without a job file.
PROGRAMS = {"plate": 0.8}
SIZE = (1600, 1000)
#: Height of the viewer's own bar, which says nothing of a run.
BAR = 37


@contextmanager
def viewer() -> Iterator[ViewerClient]:
    """A viewer without a window."""
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        port = probe.getsockname()[1]
    program = Path(sysconfig.get_path("scripts")) / "rerun"
    size = "x".join(map(str, SIZE))
    command = [str(program), "--headless", "--hide-welcome-screen", "--port", str(port), "--window-size", size]
    process = subprocess.Popen(command, stderr=subprocess.DEVNULL, start_new_session=True)
    try:
        yield connected(port)
    finally:
        os.killpg(process.pid, signal.SIGTERM)
        process.wait()


def connected(port: int) -> ViewerClient:
    """Wait until the viewer answers."""
    end = time.monotonic() + 30.0
    while True:
        try:
            client = ViewerClient.connect(f"rerun+http://127.0.0.1:{port}/proxy")
            client.get_state()
        except (ConnectionError, RuntimeError):
            if time.monotonic() > end:
                raise
            time.sleep(0.2)
        else:
            return client


def make(name: str, at: float, folder: Path) -> None:
    """Replay an example and take its picture."""
    rrd = folder / f"{name}.rrd"
    with Replay(_job(name)) as replay, RerunSink(rrd=rrd) as sink:
        for record in replay:
            sink.write(record)
    with viewer() as client:
        client.open(str(rrd))
        client.set_time(TIME, duration=at * replay.planned_time_s, play_state="paused")
        time.sleep(8.0)
        client.save_screenshot(str(folder / "shot.png"))
    with Image.open(folder / "shot.png") as shot:
        scale = shot.width / SIZE[0]
        plain = shot.crop((0, round(BAR * scale), shot.width, shot.height)).convert("RGB")
        plain.save(PICTURES / f"{name}.png", optimize=True)


def _job(name: str) -> Job:
    """The job of an example."""
    if name in PROGRAMS:
        return draft_job(ROOT / "examples" / "from_nc" / f"{name}.nc", material="Al7075-T6", angle_step_deg=4.0).job()
    return load_job(ROOT / "examples" / name / "job.toml")


def main() -> None:
    """Make the pictures named on the command line, or all."""
    PICTURES.mkdir(exist_ok=True)
    with tempfile.TemporaryDirectory() as folder:
        shares = EXAMPLES | PROGRAMS
        for name in sys.argv[1:] or shares:
            make(name, shares[name], Path(folder))
            print(PICTURES / f"{name}.png")


if __name__ == "__main__":
    main()
