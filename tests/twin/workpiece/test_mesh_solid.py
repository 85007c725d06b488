"""STL files in: what is a solid, and the message where something is not."""

from __future__ import annotations

import re
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
import trimesh

from twin.arrays import FloatArray
from twin.errors import MeshError
from twin.workpiece.solids.from_mesh import load_mesh, solid
from twin.workpiece.solids.solid_check import winding_number


def cube(low: float = 0.0, high: float = 10.0) -> FloatArray:
    """Corners of a cube's 12 triangles, turned outwards."""
    mesh = trimesh.creation.box(bounds=[[low] * 3, [high] * 3])
    return np.array(mesh.triangles)


def refusal(corners: FloatArray) -> str:
    with pytest.raises(MeshError) as caught:
        solid(corners, "part.stl")
    return str(caught.value)


def stl(path: Path, corners: FloatArray, *, ascii_text: bool = False) -> Path:
    mesh = trimesh.Trimesh(corners.reshape(-1, 3), np.arange(3 * len(corners)).reshape(-1, 3), process=False)
    export = trimesh.exchange.stl
    path.write_bytes(export.export_stl_ascii(mesh).encode() if ascii_text else export.export_stl(mesh))
    return path


@pytest.mark.parametrize("ascii_text", [False, True])
def test_binary_and_ascii_files_are_read_scaled_and_moved(tmp_path: Path, ascii_text: bool) -> None:
    mesh = load_mesh(stl(tmp_path / "cube.stl", cube(), ascii_text=ascii_text), scale=25.4, offset_mm=(1, 2, 3))
    assert mesh.vertices_mm.min(axis=0) == pytest.approx([1.0, 2.0, 3.0])
    assert mesh.vertices_mm.max(axis=0) == pytest.approx([255.0, 256.0, 257.0])
    assert mesh.volume_mm3 == pytest.approx(254.0**3)


EXPECTED = "; expected a closed surface, all triangles counter-clockwise seen from outside"


def test_a_hole_is_reported_with_its_width_and_place() -> None:
    keep = np.array([not np.all(t[:, 2] == 10.0) for t in cube()])
    message = refusal(cube()[keep])
    assert message == (
        "part.stl: the surface leaks: 1 hole of 4 open edges, 10 mm wide: (0, 0, 10) to (0, 10, 10), "
        f"(10, 0, 10) to (0, 0, 10), (0, 10, 10) to (10, 10, 10), ...{EXPECTED}"
    )


def test_the_width_of_a_round_hole_is_its_diameter() -> None:
    pipe = np.array(trimesh.creation.cylinder(3.0, 5.0, sections=64).triangles)
    message = refusal(pipe[[not np.all(t[:, 2] == 2.5) for t in pipe]])
    found = re.match(r"part\.stl: the surface leaks: 1 hole of 64 open edges, ([\d.]+) mm wide: ", message)
    assert found is not None and float(found[1]) == pytest.approx(6.0, rel=0.02)


@pytest.mark.parametrize("gap", [0.002, 0.05, 0.3])
def test_a_crack_is_reported_with_its_true_gap_and_length(gap: float) -> None:
    """A corner that one of its triangles misses by a distance."""
    corners = cube()
    corners[0, 0] += np.array([0.6, 0.0, -0.8]) * gap
    message = refusal(corners)
    found = re.match(
        r"part\.stl: the surface leaks: 1 crack of 4 open edges, ([\d.]+) mm wide and ([\d.]+) mm long: \(", message
    )
    assert found is not None and message.endswith(EXPECTED)
    assert 0.6 * gap <= float(found[1]) <= 1.05 * gap
    assert 9.0 < float(found[2]) < 25.0


@pytest.mark.parametrize("gap", [0.0012, 0.05])
def test_a_corner_that_is_missed_along_an_edge_is_a_crack(gap: float) -> None:
    corners = cube()
    corners[0, 0, 2] -= gap
    assert f"leaks: 1 crack of 4 open edges, {gap:g} mm wide and " in refusal(corners)


def test_two_parts_that_miss_each_other_are_a_crack_as_wide_as_their_distance() -> None:
    corners = cube()
    corners[(corners[:, :, 2] == 10.0).all(axis=1), :, 2] += 0.003
    assert "leaks: 2 cracks of 8 open edges, the widest 0.003 mm wide and 20 mm long: " in refusal(corners)


def test_a_sheet_inside_is_named() -> None:
    sheet = np.array([[[5, 1, 1], [5, 9, 1], [5, 9, 9]], [[5, 1, 1], [5, 9, 9], [5, 1, 9]]])
    assert "leaks: 1 loose sheet of 4 open edges, 8 mm wide: (5, " in refusal(np.concatenate((cube(), sheet)))


@pytest.mark.parametrize("gap", [1.5e-5, 2e-4, 9e-4])
def test_a_crack_below_a_micrometre_is_welded_and_stated(gap: float) -> None:
    corners = cube()
    corners[0, 0] += np.array([0.6, 0.0, -0.8]) * gap
    made = solid(corners, "part.stl")
    assert made.volume_mm3 == pytest.approx(1000.0, rel=1e-4)
    (note,) = made.notes
    assert re.fullmatch(
        r"part\.stl: 1 vertex on open edges welded, at most [\d.e-]+ mm apart \(tolerance 0.001 mm\)", note
    )


def with_t_vertices(off: float, points: int) -> FloatArray:
    """A cube with this many T-vertices on each of two sides of a triangle, shifted by a distance."""
    a, b, c = cube()[0]
    ab, bc = (np.linspace(p, q, points + 2)[1:-1] + off for p, q in ((a, b), (b, c)))
    fan = [np.array([c, p, q]) for p, q in pairwise([a, *ab])]
    fan += [np.array([ab[-1], p, q]) for p, q in pairwise([b, *bc, c])]
    return np.concatenate((fan, cube()[1:]))


@pytest.mark.parametrize("points", [1, 3])
def test_edges_are_divided_at_t_vertices(points: int) -> None:
    made = solid(with_t_vertices(0.0, points), "part.stl")
    assert made.volume_mm3 == pytest.approx(1000.0)
    assert made.notes == ("part.stl: 2 edges divided at T-vertices, at most 0 mm off (tolerance 0.001 mm)",)
    assert solid(with_t_vertices(4e-4, points), "part.stl").volume_mm3 == pytest.approx(1000.0, rel=1e-3)
    assert "crack" in refusal(with_t_vertices(0.05, points))


def test_a_repeated_triangle_is_named() -> None:
    """Whatever corner it begins with, and next to other defects."""
    message = refusal(np.concatenate((cube(), cube()[4:5, [1, 2, 0]])))
    wanted = "part.stl: the surface is not closed: 1 triangle is there twice: number 13 repeats 5 at ("
    assert message.startswith(wanted) and message.endswith(f"){EXPECTED}")
    both = refusal(np.concatenate((cube()[1:], cube()[4:6])))
    assert "2 triangles are there twice: number 12 repeats 4 at" in both and "; 1 hole of 3 open edges, " in both


def test_turned_triangles_are_named() -> None:
    corners = cube()
    corners[3] = corners[3, ::-1]
    assert refusal(corners).startswith(
        "part.stl: the surface is not closed: 1 triangle is turned unlike its neighbours (number 4), along 3 edges: ("
    )
    corners[7] = corners[7, ::-1]
    assert "2 triangles are turned unlike their neighbours (number 4, 8), along " in refusal(corners)


def test_a_sheet_that_touches_the_surface_is_named() -> None:
    message = refusal(np.concatenate((cube(), [[[0, 0, 0], [10, 0, 0], [5, -5, 5]]])))
    assert "1 loose sheet of 2 open edges, " in message
    assert "1 edge where the surface touches itself, each of 3 triangles or more: (0, 0, 0) to (10, 0, 0)" in message


def test_bodies_that_share_an_edge_are_closed() -> None:
    made = solid(np.concatenate((cube(), cube() + np.array([10.0, 10.0, 0.0]))), "part.stl")
    assert made.volume_mm3 == pytest.approx(2000.0) and made.notes == ()


def test_a_mesh_turned_inside_out_is_refused_and_not_turned() -> None:
    assert refusal(cube()[:, ::-1]) == (
        "part.stl: the surface is inside out: volume -1000 mm3 at (0, 0, 0); "
        "expected triangles counter-clockwise seen from outside"
    )


def test_one_body_of_two_turned_inside_out_is_found() -> None:
    message = refusal(np.concatenate((cube(), cube(20.0, 22.0)[:, ::-1])))
    assert message.startswith("part.stl: the surface is inside out (body 2 of 2): volume -8 mm3 at (20, 20, 20)")


def test_a_cavity_is_a_body_turned_inwards_inside_another() -> None:
    mesh = solid(np.concatenate((cube(), cube(4.0, 6.0)[:, ::-1])), "part.stl")
    assert mesh.volume_mm3 == pytest.approx(992.0)


def test_corners_that_differ_by_rounding_meet() -> None:
    corners = cube()
    corners[0] += 2e-6
    assert len(solid(corners, "part.stl").vertices_mm) == 8


def test_triangles_without_extent_are_dropped() -> None:
    corners = np.concatenate((cube(), np.full((1, 3, 3), 10.0), [[[0, 0, 0], [10, 10, 10], [0, 0, 0]]]))
    assert len(solid(corners, "part.stl").triangles) == 12


@pytest.mark.parametrize(
    ("corners", "message"),
    [
        (np.empty((0, 3, 3)), "part.stl: holds no triangles; expected a closed surface"),
        (
            np.full((2, 3, 3), 1.0),
            "part.stl: every one of its 2 triangles has no area; expected a closed surface",
        ),
        (
            np.array([[[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 0, 0], [0, 1, 0], [1, 0, 0]]]),
            "part.stl: the surface encloses no volume; expected a solid",
        ),
    ],
)
def test_what_encloses_nothing_is_refused(corners: FloatArray, message: str) -> None:
    assert refusal(corners) == message


def test_a_corner_that_is_no_number_is_named() -> None:
    corners = cube()
    corners[4, 1, 2] = np.nan
    assert refusal(corners) == "part.stl: triangle 5 of 12 has a corner that is not a finite number"


def test_files_that_are_no_stl_are_refused(tmp_path: Path) -> None:
    path = tmp_path / "part.stl"
    with pytest.raises(MeshError, match=r"part\.stl: cannot be read: No such file or directory; expected an STL file$"):
        load_mesh(path)
    path.write_bytes(b"")
    with pytest.raises(MeshError, match=r"part\.stl: is empty; expected an STL file$"):
        load_mesh(path)
    path.write_bytes(b"hello")
    with pytest.raises(MeshError, match=r"part\.stl: is not an STL file: 5 bytes; expected at least 84$"):
        load_mesh(path)
    path.write_bytes(b"solid nothing\nendsolid nothing\n")
    with pytest.raises(MeshError, match=r"holds no triangles; expected binary or ASCII STL with a closed surface$"):
        load_mesh(path)


def test_a_binary_file_that_was_cut_off_is_refused(tmp_path: Path) -> None:
    path = stl(tmp_path / "part.stl", cube())
    path.write_bytes(path.read_bytes()[:-70])
    message = r"is not an STL file: 614 bytes; expected 684 for 12 triangles, as its header states$"
    with pytest.raises(MeshError, match=message):
        load_mesh(path)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (b"solid \xff\xfe\xe9\n", "holds no triangles; expected binary or ASCII STL with a closed surface"),
        (b"solid a\nfacet but no number", 'line 2: "facet but no number"; expected a facet of three vertices: '),
        (b"solid a\n\nkind regards\nendsolid", 'line 3: "kind regards"; expected a facet of three vertices: '),
    ],
)
def test_text_that_is_no_stl_or_was_cut_off_is_refused(tmp_path: Path, text: bytes, message: str) -> None:
    path = tmp_path / "part.stl"
    path.write_bytes(text)
    with pytest.raises(MeshError) as caught:
        load_mesh(path)
    assert str(caught.value).startswith(f"{path}: {message}")


def block_text() -> str:
    """A cube of 1000 mm3 as ASCII STL."""
    mesh = trimesh.Trimesh(cube().reshape(-1, 3), np.arange(36).reshape(-1, 3), process=False)
    return str(trimesh.exchange.stl.export_stl_ascii(mesh)).replace("solid", "solid plate", 1)


VARIANTS = {
    "end solid in two words": lambda text: text.replace("endsolid", "end solid"),
    "all keywords in two words": lambda text: (
        text.replace("endsolid", "end solid").replace("endloop", "end loop").replace("endfacet", "end facet")
    ),
    "UTF-8 mark": lambda text: b"\xef\xbb\xbf" + text.encode(),
    "UTF-16": lambda text: text.encode("utf-16"),
    "UTF-8 mark and upper case": lambda text: b"\xef\xbb\xbf" + text.upper().encode(),
    "name with vertex": lambda text: text.replace("plate", "vertex_plate"),
    "name with every keyword": lambda text: text.replace("plate", "facet normal vertex endsolid outer loop"),
    "name in Latin-1": lambda text: text.replace("plate", "Gehäuse").encode("latin-1"),
    "no name": lambda text: text.replace(" plate", ""),
    "NUL padding": lambda text: text.encode() + b"\0" * 700,
    "NUL padding of the name": lambda text: text.replace("plate", "plate" + "\0" * 69).encode(),
    "no last line": lambda text: text[: text.index("endsolid")].rstrip(),
    "no first line": lambda text: text[text.index("facet") :],
    "CRLF": lambda text: text.replace("\n", "\r\n"),
    "CR": lambda text: text.replace("\n", "\r"),
    "tabs and empty lines": lambda text: "\n\n" + text.replace("\n", "\n\n\t\t"),
    "one line": lambda text: " ".join(text.split()),
    "exponents": lambda text: re.sub(r"(?<=vertex ).*", lambda m: _spelled(m[0], "{:+.7E}"), text),
    "Fortran exponents": lambda text: re.sub(
        r"(?<=vertex ).*", lambda m: _spelled(m[0], "{:.6e}").replace("e", "D"), text
    ),
    "decimal commas": lambda text: re.sub(r"(?<=vertex ).*", lambda m: m[0].replace(".", ","), text),
    "commas between numbers": lambda text: re.sub(r"(?<=vertex ).*", lambda m: ", ".join(m[0].split()), text),
    "normals that are no numbers": lambda text: re.sub(r"(?<=normal ).*", "-nan(ind) -1.#IND nan", text),
    "one number of a normal": lambda text: re.sub(r"(?<=normal )(\S+).*", r"\1", text),
    "no number of a normal": lambda text: re.sub(r"(?<=normal).*", "", text),
    "normals in brackets": lambda text: re.sub(r"(?<=normal ).*", "(0,0,1)", text),
    "no normals": lambda text: re.sub(r"facet normal.*", "facet", text),
    "no normals, no first line, CRLF": lambda text: re.sub(
        r"facet normal.*", "facet", text[text.index("facet") :]
    ).replace("\n", "\r\n"),
    "comments": lambda text: "# by a program\n; in mm\n// 12\n" + text.replace("outer loop", "outer loop # of 3\n#"),
    "colours": lambda text: text.replace("plate", "plate\ncolor 0.5 0.5 0.5"),
    "DOS end of file": lambda text: text.encode() + b"\r\n\x1a",
}


def _spelled(numbers: str, form: str) -> str:
    return " ".join(form.format(float(word)) for word in numbers.split())


@pytest.mark.parametrize("variant", VARIANTS)
def test_every_way_to_write_an_ascii_file_is_read(tmp_path: Path, variant: str) -> None:
    written = VARIANTS[variant](block_text())
    path = tmp_path / "part.stl"
    path.write_bytes(written if isinstance(written, bytes) else written.encode())
    assert load_mesh(path).volume_mm3 == pytest.approx(1000.0)


def test_a_binary_file_may_have_solid_in_its_header_and_padding(tmp_path: Path) -> None:
    path = stl(tmp_path / "part.stl", cube())
    data = path.read_bytes()
    path.write_bytes(b"solid facet normal vertex".ljust(80) + data[80:])
    assert load_mesh(path).volume_mm3 == pytest.approx(1000.0)
    path.write_bytes(data + bytes(300))
    assert load_mesh(path).volume_mm3 == pytest.approx(1000.0)
    path.write_bytes(b"solid".ljust(80) + data[80:-7])
    with pytest.raises(MeshError, match=r"is not an STL file: 677 bytes; expected 684 for 12 triangles"):
        load_mesh(path)


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("vertex 0.0", "vertex O.0", 'line {}: "O.0'),
        ("vertex 0.0", "vertex 1.000,0", 'line {}: "1.000,0'),
        ("endloop", "vertex 1 2 3\nendloop", 'line 2: "facet normal'),
    ],
)
def test_the_line_of_a_mistake_in_a_text_file_is_named(tmp_path: Path, old: str, new: str, message: str) -> None:
    text = block_text()
    path = tmp_path / "part.stl"
    path.write_text(text.replace(old, new, 1))
    line = text.count("\n", 0, text.index(old)) + 1
    with pytest.raises(MeshError) as caught:
        load_mesh(path)
    assert str(caught.value).startswith(f"{path}: {message.format(line)}")


def test_an_ascii_file_that_was_cut_off_is_refused_with_what_can_be_read(tmp_path: Path) -> None:
    """Also where the part before the cut is a solid of its own."""
    path = stl(tmp_path / "part.stl", cube(), ascii_text=True)
    whole = path.read_bytes()
    path.write_bytes(whole + b"\n" + whole[: len(whole) // 2])
    message = r"is not a complete STL file: 18 facets can be read, the one in line 132 is cut off$"
    with pytest.raises(MeshError, match=message):
        load_mesh(path)
    path.write_bytes(whole + b"\n" + whole.replace(b"vertex", b"vertex  "))
    assert len(load_mesh(path).triangles) == 24


def test_a_scale_that_is_no_length_is_refused(tmp_path: Path) -> None:
    with pytest.raises(MeshError, match=r"part\.stl: scale 0; expected a number above 0$"):
        load_mesh(stl(tmp_path / "part.stl", cube()), scale=0.0)


def test_the_winding_number_counts_bodies_round_a_point() -> None:
    mesh = solid(np.concatenate((cube(), cube(4.0, 6.0))), "nested")
    for point, wanted in (((5, 5, 5), 2.0), ((1, 2, 3), 1.0), ((11, 5, 5), 0.0)):
        assert winding_number(np.array(point, float), mesh.vertices_mm, mesh.triangles) == pytest.approx(wanted)
