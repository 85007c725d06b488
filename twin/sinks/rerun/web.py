"""The rerun viewer in a browser: a server on this computer that listens on 127.0.0.1 only."""

from __future__ import annotations

import importlib.util
import socket
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from urllib.parse import quote

import rerun as rr

from twin.errors import TwinError

_HOST = "127.0.0.1"
#: Port of the page, if it is free.
_PAGE_PORT = 9090
#: The server is given up if it does not listen after this time, s; time for it to end.
_START_S, _END_S = 20.0, 5.0
_ASK_S = 0.05
#: Memory for what browsers have not yet asked for.
_MEMORY = "4GB"


class WebServer:
    """A server of the viewer's page and of the data that it shows.

    Attributes:
        url: address for the browser.
    """

    def __init__(self, process: subprocess.Popen[bytes], page_port: int, data_port: int) -> None:
        self._process = process
        self._data = f"rerun+http://{_HOST}:{data_port}/proxy"
        self.url = f"http://{_HOST}:{page_port}/?url={quote(self._data, safe='')}"

    def sink(self) -> rr.GrpcSink:
        """Connection for a recording."""
        return rr.GrpcSink(self._data)

    def wait(self) -> None:
        """Serve until the user ends it by Ctrl-C, or the server ends.

        Raises:
            TwinError: the server has ended by itself.
        """
        try:
            code = self._process.wait()
        except KeyboardInterrupt:
            return
        raise TwinError(f"the server of the viewer has ended with code {code}")


@contextmanager
def web_server() -> Iterator[WebServer]:
    """Start a server; it ends with the block.

    Raises:
        TwinError: it cannot be started.
    """
    if importlib.util.find_spec("rerun_cli") is None:
        raise TwinError("the rerun viewer cannot be served: it is not installed; pip install rerun-sdk")
    page_port, data_port = _free_port(_PAGE_PORT), _free_port()
    ports = ["--bind", _HOST, "--port", str(data_port), "--web-viewer-port", str(page_port)]
    process = subprocess.Popen(
        [sys.executable, "-m", "rerun_cli", "--serve-web", *ports, "--server-memory-limit", _MEMORY],
        stdin=subprocess.DEVNULL,
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
        start_new_session=True,
    )
    try:
        _await(process, page_port, data_port)
        yield WebServer(process, page_port, data_port)
    finally:
        process.terminate()
        try:
            process.wait(_END_S)
        except subprocess.TimeoutExpired:
            process.kill()


def _await(process: subprocess.Popen[bytes], *ports: int) -> None:
    """Wait until a server listens on its ports."""
    give_up = time.monotonic() + _START_S
    while not all(_listens(port) for port in ports):
        if (code := process.poll()) is not None:
            raise TwinError(f"the server of the viewer cannot be started: it ended with code {code}")
        if time.monotonic() > give_up:
            raise TwinError(f"the server of the viewer does not listen after {_START_S:g} s")
        time.sleep(_ASK_S)


def _free_port(wanted: int = 0) -> int:
    """A port that nothing listens on: the one that is wanted, or any."""
    with socket.socket() as probe:
        try:
            probe.bind((_HOST, wanted))
        except OSError:
            probe.bind((_HOST, 0))
        return int(probe.getsockname()[1])


def _listens(port: int) -> bool:
    with socket.socket() as connection:
        connection.settimeout(1.0)
        return connection.connect_ex((_HOST, port)) == 0
