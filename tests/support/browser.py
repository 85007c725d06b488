"""Pictures of web pages by a headless Chromium, driven through its debugging pipe."""

from __future__ import annotations

import base64
import json
import os
import shutil
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Any, BinaryIO

CHROMIUM = next(filter(None, map(shutil.which, ("chromium", "chromium-browser", "google-chrome"))), None)
_OPTIONS = ("--headless=new", "--no-sandbox", "--use-angle=swiftshader", "--enable-unsafe-swiftshader")
#: Runs a program whose files 3 and 4 are those with the numbers given.
_AS_3_AND_4 = """
import fcntl, os, sys
high = [fcntl.fcntl(int(number), fcntl.F_DUPFD, 10) for number in sys.argv[1:3]]
for file, number in zip(high, (3, 4)):
    os.dup2(file, number)
os.execv(sys.argv[3], sys.argv[3:])
"""


class Page:
    """A page in a browser; the browser reads commands from its file 3 and writes answers to its file 4."""

    def __init__(self, commands: int, answers: BinaryIO, url: str) -> None:
        self._commands, self._answers = commands, answers
        self._number, self._session = 0, ""
        target = self._call("Target.createTarget", url=url)["targetId"]
        self._session = self._call("Target.attachToTarget", targetId=target, flatten=True)["sessionId"]

    def picture(self) -> bytes:
        """The page now, as PNG."""
        return base64.b64decode(self._call("Page.captureScreenshot", format="png")["data"])

    def _call(self, method: str, **params: Any) -> Any:
        self._number += 1
        message: dict[str, Any] = {"id": self._number, "method": method, "params": params}
        if self._session:
            message["sessionId"] = self._session
        os.write(self._commands, json.dumps(message).encode() + b"\0")
        while True:
            answer = json.loads(self._read())
            if answer.get("id") == self._number:
                assert "error" not in answer, answer
                return answer["result"]

    def _read(self) -> bytes:
        data = bytearray()
        while (byte := self._answers.read(1)) not in (b"\0", b""):
            data += byte
        return bytes(data)


@contextmanager
def page(url: str, folder: Path, *, size: tuple[int, int] = (1400, 900)) -> Iterator[Page]:
    """Open a page; `CHROMIUM` must not be None."""
    assert CHROMIUM is not None
    (read_commands, commands), (answers, write_answers) = os.pipe(), os.pipe()
    options = [*_OPTIONS, "--remote-debugging-pipe", f"--user-data-dir={folder}", f"--window-size={size[0]},{size[1]}"]
    browser = subprocess.Popen(
        [sys.executable, "-c", _AS_3_AND_4, str(read_commands), str(write_answers), CHROMIUM, *options],
        pass_fds=(read_commands, write_answers),
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
        start_new_session=True,
    )
    os.close(read_commands)
    os.close(write_answers)
    try:
        with os.fdopen(answers, "rb") as messages:
            yield Page(commands, messages, url)
    finally:
        os.close(commands)
        with suppress(ProcessLookupError):
            os.killpg(browser.pid, signal.SIGKILL)
        browser.wait()


def seen(opened: Page, good: Any, within_s: float = 40.0) -> bytes:
    """The first picture that is as wanted; the last one after a time."""
    end = time.monotonic() + within_s
    while True:
        picture = opened.picture()
        if good(picture) or time.monotonic() > end:
            return picture
        time.sleep(0.5)
