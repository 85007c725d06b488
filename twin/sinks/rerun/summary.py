"""The summary of a run as a text next to its timeline."""

from __future__ import annotations

from twin.record import RunSummary

_AXES = ("x", "y", "z", "resultant")


def summary_text(summary: RunSummary, *, all_samples: bool = True) -> str:
    """A run's summary as Markdown.

    Args:
        all_samples: whether the recording has every force sample.
    """
    state = "" if summary.complete else "\n\n**The run was ended before the end of its program.**"
    lines = [
        f"## {'Run' if summary.complete else 'Part of a run'}{state}",
        "",
        "| | |",
        "|---|---|",
        f"| machine time | {summary.machine_time_s:,.1f} s |",
        f"| cutting time | {summary.cutting_time_s:,.1f} s |",
        f"| removed volume | {summary.removed_volume_mm3:,.0f} mm³ |",
        f"| collisions | {summary.collisions} |",
        "",
        "## Forces on the tool, N",
        "",
        "| | " + " | ".join(_AXES) + " |",
        "|---|" + "---|" * len(_AXES),
        "| peak | " + " | ".join(f"{f:,.1f}" for f in summary.peak_force_n) + " |",
        "| mean | " + " | ".join(f"{f:,.1f}" for f in summary.mean_force_n) + " |",
        "",
        "## Highest forces by NC line",
        "",
        "| line | block | N |",
        "|---|---|---|",
        *(f"| {line} | `{text}` | {force:,.1f} |" for line, text, force in summary.top_lines),
    ]
    if not all_samples:
        lines += ["", "This recording has force samples of some revolutions only; the run's archive has all of them."]
    return "\n".join(lines) + "\n"
