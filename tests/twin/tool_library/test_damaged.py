"""Files that are not tool libraries, or damaged ones: one message with the file and what was expected."""

from __future__ import annotations

import io
import zipfile
from pathlib import Path

import pytest
from support.tool_libraries import fusion_library, fusion_tool, zipped

from twin.errors import ToolLibraryError
from twin.tool_library import file_text, read_tool_library

LIBRARY = fusion_library(fusion_tool())


@pytest.mark.parametrize(
    ("data", "message"),
    [
        (b"", "library: the file is empty"),
        (b" \n", "library: the file is empty"),
        (b"{", "library:1:2: not valid JSON"),
        (LIBRARY[:-30], "library:1:"),
        (b"[]", "library: JSON without tools is not a tool library"),
        (b'{"a": 1, "b": 2}', "library: JSON with a, b is not a tool library"),
        (b'{"data": []}', "library: the Fusion 360 library has no tools"),
        (b'{"data": [5]}', "library: data[0] is not a tool; expected an object with type and geometry"),
        (b'{"tools": [{"nr": 1}]}', "library: tools[0] names no file of a bit; expected nr and path"),
        (b'{"x": {"shape": "ballnose", "diameter": 3}}', "library: tool 'x': expected a whole number"),
        (b"[" * 100_000, "library: nested too deeply"),
        (b'{"data": [' + b"9" * 5000 + b"]}", "library: a number with too many digits"),
        (b'{"data": "\xff"}', "library: byte 0xff in line 1 is not UTF-8"),
        (b"\xff\xfe\x00", "library: byte 0x00 in line 1 is not UTF-16"),
        (b"\x89PNG\r\n\x1a\n\0\0\0", "library: byte 0x89 in line 1 is not UTF-8"),
        (b"[program]\nfile = 'a.nc'\n", "library: is not a tool library: no row of headings with a diameter"),
        (b"[[tools]]\nnumber = \n", "library:2:10: not valid TOML: invalid value"),
        (zipped(LIBRARY)[:-40], "library: the zip file is damaged or encrypted"),
        (zipped(LIBRARY, "other.json"), "library: the zip file holds other.json; expected tools.json"),
        (zipped(b"[]"), "library: JSON without tools"),
    ],
)
def test_files_that_are_refused(tmp_path: Path, data: bytes, message: str) -> None:
    path = tmp_path / "library"
    path.write_bytes(data)
    with pytest.raises(ToolLibraryError) as caught:
        read_tool_library(path)
    assert str(caught.value).replace(str(path), "library").startswith(message)


def test_a_library_in_utf_16_is_read(tmp_path: Path) -> None:
    path = tmp_path / "library.json"
    path.write_bytes(LIBRARY.decode().encode("utf-16"))
    assert read_tool_library(path).tools[0].number == 3


def test_a_zip_file_that_unpacks_to_gigabytes_is_refused(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(file_text, "_LARGEST", 1_000_000)
    path = tmp_path / "bomb.tools"
    path.write_bytes(zipped(b" " * 3_000_000))
    with pytest.raises(ToolLibraryError, match=r"tools\.json unpacks to more than 1 MB"):
        read_tool_library(path)
    path.write_bytes(b" " * 1_000_002)
    with pytest.raises(ToolLibraryError, match="larger than 1 MB"):
        read_tool_library(path)


def test_an_encrypted_zip_file_is_refused(tmp_path: Path) -> None:
    data = bytearray(zipped(LIBRARY))
    with zipfile.ZipFile(io.BytesIO(bytes(data))) as packed:
        start = packed.start_dir
    data[6] |= 1  # the flag of the member, and of the directory
    data[start + 8] |= 1
    path = tmp_path / "locked.tools"
    path.write_bytes(bytes(data))
    with pytest.raises(ToolLibraryError, match="damaged or encrypted"):
        read_tool_library(path)
