"""Every kind of input file: sound ones to begin with, how they are mutated, and the function that reads them."""

from __future__ import annotations

import random
import tempfile
from collections.abc import Callable
from dataclasses import dataclass, field
from functools import cache, partial
from pathlib import Path
from typing import TYPE_CHECKING

from support.fuzz.mutations import LIBRARY, STL, TABLE, TOML, Mutation, binary_mutated, mutated, text_mutated

if TYPE_CHECKING:
    from twin.measured.log import ForceLog, RawLog

#: Files next to an input, which it names.
Neighbours = dict[str, bytes]


@dataclass(frozen=True, slots=True, kw_only=True)
class Target:
    """One kind of input.

    Attributes:
        suffix: of the file's name.
        seeds: sound files.
        once: one mutation.
        use: reads a file; raises `TwinError` or `GcodeError` for one that it refuses, and nothing else.
        neighbours: files in the same folder.
    """

    suffix: str
    seeds: Callable[[], list[bytes]]
    once: Mutation
    use: Callable[[Path], object]
    neighbours: Callable[[], Neighbours] = field(default=dict)

    def input(self, name: str, seed: int, number: int) -> bytes:
        """A mutated file, the same for the same numbers."""
        source = random.Random(f"{name}/{seed}/{number}")
        return mutated(source, source.choice(_seeds(name)), self.once)


@cache
def _seeds(name: str) -> list[bytes]:
    return TARGETS[name].seeds()


def _written(*writers: Callable[[Path], object]) -> list[bytes]:
    """The bytes that functions write to a path."""
    made = []
    with tempfile.TemporaryDirectory() as folder:
        for number, write in enumerate(writers):
            path = Path(folder) / f"seed{number}"
            write(path)
            made.append(path.read_bytes())
    return made


def _log(*names: str) -> Callable[[], list[bytes]]:
    from support.measured_files import FORMATS

    return lambda: _written(*(FORMATS[name][1] for name in names))


def _read_log(path: Path) -> object:
    """Read a log and its forces; an error names the file."""
    from twin.errors import MeasuredError
    from twin.measured.read import read_log

    try:
        return assert_sound(read_log(path))
    except MeasuredError as error:
        assert path.name in str(error), f"does not name the file: {error}"
        raise


def assert_sound(log: RawLog) -> ForceLog:
    """Check what holds for every log that was read, and for its forces.

    Raises:
        AssertionError: a law is broken.
        MeasuredError: the log has no forces.
    """
    import numpy as np

    from twin.measured.forces import force_log

    assert len(log.t_s) >= 1 and np.isfinite(log.t_s).all()
    assert (np.diff(log.t_s) > 0.0).all()
    assert 0.0 < log.rate_hz < np.inf
    assert all(len(c.values) == len(log.t_s) for c in log.columns.values())
    forces = force_log(log)
    assert np.isfinite(forces.force_n).all()
    return forces


def _toml(tables: Callable[[], list[dict[str, object]]]) -> Callable[[], list[bytes]]:
    from twin.settings.toml_text import toml_text

    return lambda: [toml_text(data).encode() for data in tables()]


def _jobs() -> list[dict[str, object]]:
    from support.job_files import job_data

    return [job_data(), job_data(tools=[{"from": "shop.json", "number": 3, "library_unit": "mm", "teeth": 2}])]


def _job_neighbours() -> Neighbours:
    from support.job_files import PROGRAM
    from support.tool_libraries import fusion_library, fusion_tool

    log = b"Fx,Fy,Fz\n1,2,3\n1,2,3\n"
    library = fusion_library(fusion_tool())
    return {"slot.nc": PROGRAM.encode(), "mold.stl": _boxes()[0], "a.csv": log, "shop.json": library}


def _load_job(path: Path) -> object:
    from twin.job import load_job

    return load_job(path)


def _cuts() -> list[dict[str, object]]:
    cut = {"name": "A", "log": "a.csv", "axial_depth_mm": 2.0, "radial_depth_mm": 1.5, "feed_mm_min": 100}
    return [
        {
            "tool": {"kind": "ball", "diameter_mm": 8.0, "teeth": 2, "helix_deg": 30.0},
            "defaults": {"direction": "down", "spindle_rpm": 3600, "force_on": "workpiece", "map": "x=-Fy,y=Fx,z=Fz"},
            "fit": {"method": "waveform", "source": "made up"},
            "cuts": [cut, {**cut, "name": "B", "feed_mm_min": 200}, {**cut, "name": "C", "feed_mm_min": 300}],
        }
    ]


def _load_cuts(path: Path) -> object:
    from twin.identification.cuts.load import load_cuts

    return load_cuts(path)


def _molds() -> list[bytes]:
    return [(Path(__file__).parents[3] / "examples" / "mold" / "job.toml").read_bytes()]


def _load_mold(path: Path) -> object:
    from twin.moldmaking import load_mold

    return load_mold(path)


def _boxes() -> list[bytes]:
    """A box as binary and as ASCII STL."""
    import numpy as np

    from support.small_parts import box
    from twin.workpiece.solids.from_mesh import stl_bytes

    part = box((0, 0, 0), (10, 8, 5))
    lines = ["solid box"]
    for triangle in part.triangles:
        corners = part.vertices_mm[triangle]
        normal = np.cross(corners[1] - corners[0], corners[2] - corners[0])
        lines.append("facet normal {:g} {:g} {:g}\n outer loop".format(*(normal / np.linalg.norm(normal))))
        lines += ["  vertex {:g} {:g} {:g}".format(*corner) for corner in corners]
        lines.append(" endloop\nendfacet")
    return [stl_bytes(part.vertices_mm, part.triangles), "\n".join([*lines, "endsolid box", ""]).encode()]


def _mutated_stl(source: random.Random, data: bytes) -> bytes:
    return text_mutated(source, data, STL) if data.startswith(b"solid") else binary_mutated(source, data)


def _load_mesh(path: Path) -> object:
    from twin.workpiece.solids.from_mesh import load_mesh

    return load_mesh(path)


def _runs() -> list[bytes]:
    """A short run without surfaces of the part but the first."""
    from support.slot_run import SlotRun
    from twin.record import WorkpiecePatch
    from twin.sinks.mcap_sink import McapSink

    def write(path: Path) -> None:
        with McapSink(path) as sink:
            for number, record in enumerate(SlotRun(step_mm=36.0, per_turn=1).records()):
                if number < 2 or not isinstance(record, WorkpiecePatch):
                    sink.write(record)

    return _written(write)


def _comparisons() -> list[bytes]:
    import numpy as np

    from twin.archive.comparison_file import ComparedForces, write_comparison

    t_s = np.arange(50) * 1e-3
    force = np.column_stack([np.sin(200.0 * t_s), np.cos(200.0 * t_s), t_s])
    forces = ComparedForces(t_s=t_s, spindle_angle_rad=376.0 * t_s, measured_n=force, simulated_n=0.9 * force)
    return _written(lambda path: write_comparison(path, forces, {"lag_s": 0.1}, {"run": "a"}, "machining-twin 0.1.0"))


def _read_comparison(path: Path) -> object:
    from twin.archive.comparison_file import read_comparison

    return read_comparison(path)


def _inside_mutated(source: random.Random, data: bytes) -> bytes:
    from support.fuzz.mcap_inside import inside_mutated

    return inside_mutated(source, data)


def _read_run(path: Path) -> object:
    from twin.archive import read_run, run_info

    info = run_info(path, verify=True)
    return info, list(read_run(path))


def _programs() -> list[bytes]:
    from support.fuzz_gcode import SEEDS

    return [text.encode() for _, text in sorted(SEEDS.items())]


def _mutated_program(source: random.Random, data: bytes) -> bytes:
    from support.fuzz_gcode import MUTATIONS

    text = source.choice(MUTATIONS)(source, data.decode("utf-8", "surrogatepass"))
    return text[:20_000].encode("utf-8", "surrogatepass")


def _check_program(path: Path) -> object:
    from gcode.dialects import DIALECTS, dialect_named
    from support.fuzz_gcode import assert_laws

    text = path.read_bytes().decode("utf-8", "surrogatepass")
    met = assert_laws(text, dialect_named(sorted(DIALECTS)[len(text) % len(DIALECTS)]))
    if met.error is not None:
        raise met.error
    return met


def _posted() -> list[bytes]:
    from support.nc_programs import SLOT

    stock = "(Material Size)\n(X= 60.0, Y= 20.0, Z= 9.0)\n(1 = V-Bit {60 deg 12 mm})\n(STOCK/BLOCK,60,20,9,0,0,9)\n"
    bull = "( T3 | 10. BULL ENDMILL 1. RAD | H3 | D3 | TOOL DIA. - 10. )\n"
    arcs = f"{bull}G41 D3 G1 X5. F90.\nG3 X9. I2.\nG40 X40.\nG53 G0 Z0.\n"
    return [SLOT.encode(), SLOT.replace("G54\n", stock + "T1 M6\nG55\n" + arcs).encode()]


def _draft(path: Path) -> object:
    from twin.drafting.draft import draft_job

    return draft_job(path, material="Al7075-T6").job()


def _tools() -> list[bytes]:
    return [b"T1 P1 Z50 D10 ;end mill\nT2 P2 Z60.5 D6.8\nT3 P3 X0 Y0 Z70 A0 D8 Q1 I90 J10\n"]


def _read_tools(path: Path) -> object:
    from gcode.tables import read_tool_table

    return read_tool_table(path)


def _parameters() -> list[bytes]:
    return [b"5161\t0.000000\n5162\t0\n5163\t400\n5220\t1.000000\n5221\t10.5\n5222\t-3\n5223\t-40\n100\t1\n"]


def _read_parameters(path: Path) -> object:
    from gcode.tables import read_parameters

    return read_parameters(path)


def _libraries() -> list[bytes]:
    """A library of every format, and one packed."""
    from support import tool_libraries as made
    from twin.settings.toml_text import toml_text

    tapered = made.fusion_tool(type="tapered mill", RE=0.5, DC=1.0, TA=5.0, expressions={"tool_diameter": "1/16 in"})
    fusion = made.fusion_library(made.fusion_tool(), made.fusion_tool(type="chamfer mill", unit="inches"), tapered)
    rows = (
        made.FUSION_CSV,
        made.LINUXCNC,
        "T;Type;Diameter;Corner radius;Z;Flute length;Shank\n4;Bull;12,5;1,5;4;26;12x5",
    )
    bits = (made.freecad_bit(), made.freecad_library("bit.fctb", "gone.fctb"), made.FREECAD_HOLDER, made.CAMOTICS)
    others = (made.vectric_database(), made.din_tools(made.din_tool(), made.din_tool(BLD="6", F3="L")), made.CREO)
    jobs = [toml_text(data).encode() for data in _jobs()]
    return [fusion, made.zipped(fusion), *jobs, *bits, *(text.encode() for text in rows), *others]


def _library_neighbours() -> Neighbours:
    from support.tool_libraries import FREECAD_HOLDER, freecad_bit

    return {"bit.fctb": freecad_bit(ToolHolder="nut", Stickout="30 mm"), "nut.fcholder": FREECAD_HOLDER}


def _mutated_library(source: random.Random, data: bytes) -> bytes:
    return binary_mutated(source, data) if data.startswith((b"PK", b"SQLite")) else text_mutated(source, data, LIBRARY)


def _read_library(path: Path) -> object:
    """Read a library, and write its tools: the CSV reads back as the same tools, the TOML is TOML."""
    import tomllib

    from twin.tool_library import read_tool_library
    from twin.tool_library.formats.plain_csv import csv_text, csv_tools
    from twin.tool_library.write import job_text

    tools = read_tool_library(path).tools
    assert (*csv_tools(csv_text(tools), path, "mm"),) == tools
    return tomllib.loads(job_text(tools, "tools")), [tool.as_job_table() for tool in tools if tool.simulated]


_TOML, _TABLE = partial(text_mutated, pieces=TOML), partial(text_mutated, pieces=TABLE)


def _log_target(suffix: str, once: Mutation, *names: str) -> Target:
    return Target(suffix=suffix, seeds=_log(*names), once=once, use=_read_log)


TARGETS: dict[str, Target] = {
    "NC program": Target(suffix=".nc", seeds=_programs, once=_mutated_program, use=_check_program),
    "NC program, drafted": Target(suffix=".nc", seeds=_posted, once=_mutated_program, use=_draft),
    "tool table": Target(suffix=".tbl", seeds=_tools, once=_TABLE, use=_read_tools),
    "parameter file": Target(suffix=".var", seeds=_parameters, once=_TABLE, use=_read_parameters),
    "job": Target(suffix=".toml", seeds=_toml(_jobs), once=_TOML, use=_load_job, neighbours=_job_neighbours),
    "test cuts": Target(suffix=".toml", seeds=_toml(_cuts), once=_TOML, use=_load_cuts, neighbours=_job_neighbours),
    "mold job": Target(suffix=".toml", seeds=_molds, once=_TOML, use=_load_mold, neighbours=_job_neighbours),
    "tool library": Target(
        suffix=".json",
        seeds=_libraries,
        once=_mutated_library,
        use=_read_library,
        neighbours=_library_neighbours,
    ),
    "STL": Target(suffix=".stl", seeds=_boxes, once=_mutated_stl, use=_load_mesh),
    "run": Target(suffix=".mcap", seeds=_runs, once=_inside_mutated, use=_read_run),
    "comparison": Target(suffix=".mcap", seeds=_comparisons, once=_inside_mutated, use=_read_comparison),
    "log, CSV": _log_target(".csv", _TABLE, "csv"),
    "log, DynoWare": _log_target(".txt", _TABLE, "dynoware"),
    "log, LVM": _log_target(".lvm", _TABLE, "lvm"),
    "log, TDMS": _log_target(".tdms", binary_mutated, "tdms"),
    "log, MATLAB 5": _log_target(".mat", binary_mutated, "mat5"),
    "log, MATLAB 7.3": _log_target(".mat", binary_mutated, "mat73"),
    "log, HDF5": _log_target(".h5", binary_mutated, "hdf5", "hdf5 compound"),
    "log, Parquet": _log_target(".parquet", binary_mutated, "parquet"),
    "log, MCAP": _log_target(".mcap", _inside_mutated, "foreign mcap"),
}
