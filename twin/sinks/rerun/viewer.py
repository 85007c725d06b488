"""The rerun viewer on this computer: the one that is running, or one that is started and listens on 127.0.0.1 only."""

from __future__ import annotations

import importlib.util
import os
import re
import socket
import subprocess
import sys
import time
from pathlib import Path

import rerun as rr

from twin.errors import TwinError

_HOST, _PORT = "127.0.0.1", 9876
#: The viewer is given up if it does not listen after this time, s.
_START_S = 20.0
_ASK_S = 0.05
_CONNECT_S = 1.0
#: TCP port of display 0 of another computer, or of one that ssh forwards.
_X_PORT = 6000
_ADVICE = (
    "show an archive in a browser with 'twin view RUN.mcap --web', or write a recording with --rrd FILE, and open it "
    "with 'rerun FILE' on a computer with a screen"
)


def require_viewer() -> None:
    """Check that a viewer is running or can show a window, before long work.

    Raises:
        TwinError: there is no screen.
    """
    if sys.platform in ("win32", "darwin") or _listens():
        return
    display, wayland = os.environ.get("DISPLAY", ""), os.environ.get("WAYLAND_DISPLAY", "")
    if os.environ.get("WAYLAND_SOCKET") or (wayland and _wayland(wayland)) or (display and _x11(display)):
        return
    if display or wayland:
        raise TwinError(f"the display {display or wayland} for the viewer cannot be reached; {_ADVICE}")
    raise TwinError(f"there is no screen for the viewer (DISPLAY and WAYLAND_DISPLAY are not set); {_ADVICE}")


def viewer_sink() -> rr.GrpcSink:
    """Connection to the viewer, which is started if none is running.

    Raises:
        TwinError: there is no screen, or the viewer cannot be started.
    """
    require_viewer()
    if not _listens():
        _start()
    return rr.GrpcSink(f"rerun+http://{_HOST}:{_PORT}/proxy")


def _start() -> None:
    """Start a viewer that goes on when this program ends, and wait until it listens."""
    if importlib.util.find_spec("rerun_cli") is None:
        raise TwinError("the rerun viewer cannot be started: it is not installed; pip install rerun-sdk")
    command = [sys.executable, "-m", "rerun_cli", "--bind", _HOST, "--port", str(_PORT)]
    viewer = subprocess.Popen(
        [*command, "--hide-welcome-screen", "--expect-data-soon"],
        stdin=subprocess.DEVNULL,
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
        start_new_session=True,
        env={**os.environ, "RERUN_APP_ONLY": "true"},
    )
    give_up = time.monotonic() + _START_S
    while not _listens():
        if (code := viewer.poll()) is not None:
            raise TwinError(f"the rerun viewer cannot be started: it ended with code {code}; {_ADVICE}")
        if time.monotonic() > give_up:
            raise TwinError(f"the rerun viewer does not listen on {_HOST}:{_PORT} after {_START_S:g} s; {_ADVICE}")
        time.sleep(_ASK_S)


def _listens() -> bool:
    """Whether something listens on the viewer's port of this computer."""
    return _answers(socket.AF_INET, (_HOST, _PORT))


def _x11(display: str) -> bool:
    """Whether the X server of a display answers."""
    found = re.fullmatch(r"(?:unix|([^:/]*)):(\d+)(?:\.\d+)?", display)
    if found is None:  # a path, as on other systems
        return True
    host, number = found[1], int(found[2])
    if host:
        return _answers(socket.AF_INET, (host, _X_PORT + number))
    path = f"/tmp/.X11-unix/X{number}"
    return any(_answers(socket.AF_UNIX, name) for name in (path, f"\0{path}"))


def _wayland(display: str) -> bool:
    """Whether the Wayland compositor of a display answers."""
    return _answers(socket.AF_UNIX, str(Path(os.environ.get("XDG_RUNTIME_DIR", "/")) / display))


def _answers(family: int, address: str | tuple[str, int]) -> bool:
    with socket.socket(family, socket.SOCK_STREAM) as connection:
        connection.settimeout(_CONNECT_S)
        try:
            connection.connect(address)
        except OSError:
            return False
        return True
