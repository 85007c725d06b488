"""Pytest plugin for runs under ``NUMBA_DISABLE_JIT=1``: fails when no test covers a kernel as plain Python.

Plain Python is a hundred times slower. Tests marked ``compiled`` are omitted, and so are those listed in
``slow_in_plain_python.txt``, which are known to take too long. A test that takes longer than `LIMIT_S` of processor
time is skipped; kernels that it called do not count.

NUMBA_DISABLE_JIT=1 python -m pytest -p support.plain_kernels -m "not compiled" tests/twin/tools
"""

from __future__ import annotations

import functools
import importlib
import signal
from collections.abc import Callable, Generator, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import pytest

import twin.jit

ROOT = Path(__file__).parents[2]
KERNELS = sorted(p.relative_to(ROOT) for p in (ROOT / "twin").rglob("*kernels.py"))
#: Processor time for one test, s.
LIMIT_S = 3.0
_OUTPUT = "kernels called"
_SLOW = Path(__file__).with_name("slow_in_plain_python.txt")

defined: set[str] = set()
#: By the test at hand, and by all tests that came to their end.
noted: set[str] = set()
called: set[str] = set()


def njit(function: Callable[..., Any]) -> Callable[..., Any]:
    """In the place of the decorators of `twin.jit`: the function, which notes that it was called."""
    name = f"{function.__module__}.{function.__qualname__}"
    defined.add(name)

    @functools.wraps(function)
    def noting(*arguments: Any, **named: Any) -> Any:
        noted.add(name)
        return function(*arguments, **named)

    return noting


for decorator in twin.jit.__all__:
    setattr(twin.jit, decorator, njit)


def pytest_configure(config: pytest.Config) -> None:
    """Reports from worker processes arrive at the plugin of the process that started them."""
    if config.pluginmanager.hasplugin("xdist"):
        config.pluginmanager.register(Workers())


def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]) -> None:
    """Omit the tests that are known to take too long."""
    slow = set(_SLOW.read_text("utf-8").splitlines())
    config.hook.pytest_deselected(items=[item for item in items if item.nodeid in slow])
    items[:] = [item for item in items if item.nodeid not in slow]


class Workers:
    """Collects what the workers noted."""

    def pytest_testnodedown(self, node: Any) -> None:
        """The names that a worker sent at its end."""
        called.update(getattr(node, "workeroutput", {}).get(_OUTPUT, ()))


@pytest.hookimpl(wrapper=True)
def pytest_runtest_setup(item: pytest.Item) -> Generator[None, object, object]:
    """Make a test's fixtures within the limit."""
    with limited(item):
        return (yield)


@pytest.hookimpl(wrapper=True)
def pytest_pyfunc_call(pyfuncitem: pytest.Function) -> Generator[None, object, object]:
    """Carry out a test within the limit."""
    with limited(pyfuncitem):
        result = yield
    called.update(noted)
    noted.clear()
    return result


@contextmanager
def limited(item: pytest.Item) -> Iterator[None]:
    """Skip a test when the block takes too long."""

    def stop(*_: object) -> None:
        noted.clear()
        pytest.skip(f"more than {LIMIT_S:g} s as plain Python: {item.nodeid}")

    usual = signal.signal(signal.SIGPROF, stop)
    signal.setitimer(signal.ITIMER_PROF, LIMIT_S)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_PROF, 0.0)
        signal.signal(signal.SIGPROF, usual)


@pytest.hookimpl(trylast=True)
def pytest_sessionfinish(session: pytest.Session) -> None:
    """Send the names from a worker; fail in the main process when some are missing."""
    if hasattr(session.config, "workeroutput"):
        session.config.workeroutput[_OUTPUT] = sorted(called)
        return
    for path in KERNELS:
        importlib.import_module(".".join(path.with_suffix("").parts))
    if never_called() and session.exitstatus == pytest.ExitCode.OK:
        session.exitstatus = pytest.ExitCode.TESTS_FAILED


def pytest_terminal_summary(terminalreporter: Any) -> None:
    """One line, and the kernels that are missing."""
    missing = never_called()
    count = f"{len(defined) - len(missing)} of {len(defined)} kernels in {len(KERNELS)} files ran as plain Python"
    terminalreporter.section(count)
    for name in missing:
        terminalreporter.write_line(f"never called: {name}")


def never_called() -> list[str]:
    """Names of kernels that were not called."""
    return sorted(defined - called)
