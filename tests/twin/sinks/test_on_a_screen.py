"""``twin view`` on a screen, and in a browser: what a user sees is there."""

from __future__ import annotations

import os
import re
import shutil
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from io import BytesIO
from pathlib import Path

import numpy as np
import pytest
from PIL import Image
from rerun.experimental import ViewerClient

from tests.support.browser import CHROMIUM, page, seen
from tests.support.ports import free_port
from twin.cli import run
from twin.sinks.rerun import viewer

ROOT = Path(__file__).parents[3]
ARCHIVE = ROOT / "recordings" / "reference" / "slot.mcap"
VIEW = "Resultant force: highest and mean of each revolution"


@contextmanager
def screen() -> Iterator[str]:
    """A screen in memory; its name."""
    read, write = os.pipe()
    server = subprocess.Popen(
        ["Xvfb", "-displayfd", str(write), "-screen", "0", "1400x900x24", "-nolisten", "tcp"],
        pass_fds=(write,),
        stderr=subprocess.DEVNULL,
    )
    os.close(write)
    try:
        with os.fdopen(read) as number:
            yield f":{number.readline().strip()}"
    finally:
        server.terminate()
        server.wait()


def drawn(client: ViewerClient, picture: Path) -> Image.Image:
    """The viewer's picture once it has drawn the views."""
    for _ in range(100):
        state = client.get_state()
        if any(view.name == VIEW for view in state.views) and not state.loading:
            break
        time.sleep(0.2)
    time.sleep(1.0)
    client.save_screenshot(str(picture))
    return Image.open(picture)


def colors(picture: Image.Image) -> int:
    """Number of different colours: few in an empty window."""
    return len(np.unique(np.asarray(picture.convert("RGB")).reshape(-1, 3), axis=0))


@pytest.mark.skipif(shutil.which("Xvfb") is None, reason="no Xvfb here")
def test_a_window_opens_on_the_screen(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(viewer, "_PORT", free_port())
    monkeypatch.delenv("WAYLAND_DISPLAY", raising=False)
    started: list[subprocess.Popen[bytes]] = []
    popen = subprocess.Popen

    def noted(*args: object, **options: object) -> subprocess.Popen[bytes]:
        started.append(popen(*args, **options))  # type: ignore[call-overload]
        return started[-1]

    with screen() as name:
        monkeypatch.setenv("DISPLAY", name)
        monkeypatch.setattr(viewer.subprocess, "Popen", noted)
        try:
            if run(["view", str(ARCHIVE)]) != 0:
                pytest.skip("the rerun viewer does not start here (mesa-vulkan-drivers, libegl1)")
            client = ViewerClient.connect(f"rerun+http://127.0.0.1:{viewer._PORT}/proxy")
            assert colors(drawn(client, tmp_path / "a.png")) > 500
        finally:
            for process in started:
                process.kill()
                process.wait()


@pytest.mark.skipif(CHROMIUM is None, reason="no Chromium here")
def test_a_browser_shows_the_run_until_ctrl_c(tmp_path: Path) -> None:
    arguments = [sys.executable, "-m", "twin", "view", str(ARCHIVE), "--web"]
    with subprocess.Popen(arguments, stdout=subprocess.PIPE, stderr=subprocess.PIPE) as command:
        assert command.stdout is not None
        try:
            first = command.stdout.readline().decode()
            (url,) = re.findall(r"http://127\.0\.0\.1:\d+/\S+", first)
            with page(url, tmp_path) as opened:
                picture = seen(opened, lambda png: colors(Image.open(BytesIO(png))) > 500)
            assert colors(Image.open(BytesIO(picture))) > 500
            command.send_signal(signal.SIGINT)
            _, errors = command.communicate(timeout=20.0)
        finally:
            command.kill()
    assert command.returncode == 0
    assert b"Traceback" not in errors
