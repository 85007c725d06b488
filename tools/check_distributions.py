"""Checks a wheel and a source archive: data files, types and licence are in them, and no tests in the wheel.

python tools/check_distributions.py dist
"""

from __future__ import annotations

import sys
import tarfile
import zipfile
from pathlib import Path, PurePosixPath

ROOT = Path(__file__).parents[1]
#: Files of the packages that are not Python, and must be in both.
DATA = (".rbl", ".proto", ".j2", ".toml", ".typed")
#: What must not be in a wheel, by first folder.
PRIVATE = {"benchmarks", "docs", "examples", "recordings", "tests", "tools"}


def main() -> None:
    """Check the distributions of a folder."""
    folder = Path(sys.argv[1])
    wheels, archives = list(folder.glob("*.whl")), list(folder.glob("*.tar.gz"))
    if (len(wheels), len(archives)) != (1, 1):
        sys.exit(f"{folder}: {len(wheels)} wheels and {len(archives)} source archives, expected one each")
    in_wheel = set(zipfile.ZipFile(wheels[0]).namelist())
    with tarfile.open(archives[0]) as archive:
        in_archive = {PurePosixPath(*PurePosixPath(name).parts[1:]).as_posix() for name in archive.getnames()}
    wanted = {p.relative_to(ROOT).as_posix() for package in ("gcode", "twin") for p in package_files(ROOT / package)}
    report(wheels[0], missing=wanted - in_wheel, unwanted={n for n in in_wheel if n.split("/")[0] in PRIVATE})
    report(archives[0], missing=(wanted | {"LICENSE", "README.md", "pyproject.toml"}) - in_archive, unwanted=set())


def package_files(folder: Path) -> list[Path]:
    """Sources and data of a package."""
    return [p for p in folder.rglob("*") if p.suffix in (".py", *DATA) or p.name == "py.typed"]


def report(path: Path, *, missing: set[str], unwanted: set[str]) -> None:
    """Print one line, or end with the names."""
    if missing or unwanted:
        sys.exit(f"{path.name}: missing {sorted(missing)}, unwanted {sorted(unwanted)}")
    print(f"{path.name}: complete, {path.stat().st_size / 1e3:.0f} kB")


if __name__ == "__main__":
    main()
