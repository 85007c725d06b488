"""The report: one HTML file that needs no other, and its pictures as PNG next to it."""

from __future__ import annotations

import json
import math
from pathlib import Path
from typing import Any

from gcode.underline import harmless_json
from twin.archive.container.partial import PartialFile
from twin.comparison import plots
from twin.comparison.as_json import comparison_object
from twin.comparison.comparison import Comparison, WindowResult
from twin.comparison.verdict import verdict
from twin.pages.page import page

REPORT = "report.html"


def write_report(found: Comparison, folder: Path) -> Path:
    """Write ``report.html``, its pictures, and ``comparison.json`` into a folder; earlier ones are replaced.

    Raises:
        ArchiveError: they cannot be written.
    """
    pictures = _pictures(found)
    files = {f"{name}.png": data for name, data in pictures.items()}
    files["comparison.json"] = _json(found).encode()
    files[REPORT] = html(found, pictures).encode()
    for name, data in files.items():
        partial = PartialFile(folder / name, force=True)
        partial.write(data)
        partial.commit()
    return folder / REPORT


def html(found: Comparison, pictures: dict[str, bytes]) -> str:
    """The report's text, pictures in it.

    Args:
        pictures: PNG data by name, as `_pictures` makes them.
    """
    log = found.log
    return page(
        "twin.comparison",
        "report.html.j2",
        pictures,
        {"newtons": _newtons, "percent": _percent, "ratio": _ratio, "degrees": _degrees},
        title=f"{found.run.path.name} against {log.source.name}",
        subtitle=_subtitle(found),
        verdict=verdict(found),
        warnings=found.warnings,
        axes=log.axes,
        windows=[_window(k, w) for k, w in enumerate(found.windows, 1)],
        whole=found.windows[0].whole,
        done=[*(("read", note) for note in log.notes), *((c.kind, c.text) for c in found.corrections)],
    )


def _json(found: Comparison) -> str:
    return harmless_json(json.dumps(comparison_object(found), ensure_ascii=False, indent=1))


def _subtitle(found: Comparison) -> str:
    """Program, tools, speed, rate."""
    tools = ", ".join(t.description for t in found.run.header.tools)
    turning = found.run.speed_in(found.run.span_s)
    parts = [found.run.header.program, tools]
    if turning is not None:
        parts.append(f"spindle {abs(turning[0]):g} rpm" + (f" ({found.speed.rpm:.1f} measured)" if found.speed else ""))
    parts += [f"log at {found.log.rate_hz:g} Hz", f"correlation {found.score:.3f} over the whole overlap"]
    return " · ".join(p for p in parts if p)


def _pictures(found: Comparison) -> dict[str, bytes]:
    made = {
        "whole": plots.whole_record(found),
        "spectra": plots.spectra(found),
        "histogram": plots.error_histogram(found),
    }
    for number, window in enumerate(found.windows, 1):
        made[f"window_{number}"] = plots.window_waveforms(found, _close(window) if window.whole else window)
        if window.rpm:
            made[f"polar_{number}"] = plots.polar(found, window)
    return made


def _close(window: WindowResult) -> WindowResult:
    """Three revolutions around the middle of the cut, for a window that is too long to show waveforms."""
    from dataclasses import replace

    import numpy as np

    if not window.rpm:
        return window
    force = np.linalg.norm(window.simulated_n, axis=1)
    middle = float(window.t_s[int(np.searchsorted(np.cumsum(force), 0.5 * force.sum()))])
    half = 1.5 * 60.0 / abs(window.rpm)
    near = np.abs(window.t_s - middle) <= half
    if near.sum() < 8:
        return window
    return replace(
        window,
        t_s=window.t_s[near],
        measured_n=window.measured_n[near],
        simulated_n=window.simulated_n[near],
        spindle_angle_rad=window.spindle_angle_rad[near],
    )


def _window(number: int, window: WindowResult) -> dict[str, Any]:
    """A window's values for the template."""
    begin, end = window.span_s
    name = f"{begin:.2f}–{end:.2f} s" if not window.whole else f"{begin:.2f}–{end:.2f} s (whole overlap)"
    caption = "Three revolutions in the middle of the cut." if window.whole else f"Window {name}."
    shifted = f" Simulation shifted by {1e3 * window.shift_s:+.3f} ms." if window.shift_s else ""
    return {
        "name": name,
        "errors": window.errors,
        "axis_errors": [e for e in window.errors if e.axis in "xyz"],
        "picture": f"window_{number}",
        "caption": caption + shifted,
        "polar": f"polar_{number}" if window.rpm else "",
        "polar_caption": f"{name}: magnitude of the force over one turn of the spindle; 0° has the tip of the first "
        "tooth at +x, angles grow as the spindle turns.",
        "harmonics": _harmonics(window),
    }


def _harmonics(window: WindowResult) -> list[dict[str, Any]]:
    rows = []
    for order in sorted({line.order for line in window.lines}):
        lines = [line for line in window.lines if line.order == order]
        tooth = lines[0].tooth_order
        name = f"{tooth} × tooth passing" if tooth else f"{order} × spindle (runout)"
        rows.append({"hz": lines[0].hz, "name": name, "lines": lines})
    return rows


def _newtons(value: float) -> str:
    return f"{value:.2f}" if abs(value) < 99.995 else f"{value:.1f}"


def _percent(value: float | None) -> str:
    return "–" if value is None else f"{100.0 * value:.1f} %"


def _ratio(value: float | None, decimals: int = 2) -> str:
    return "–" if value is None else f"{value:.{decimals}f}"


def _degrees(value: float | None) -> str:
    return "" if value is None else f"{round(math.degrees(value)) + 0:+d}°".replace("+0°", "0°")
