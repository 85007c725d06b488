"""Tool libraries of made-up tools, shaped like those that CAM programs write."""

from __future__ import annotations

import io
import json
import sqlite3
import zipfile
from contextlib import closing
from typing import Any


def fusion_tool(**changes: Any) -> dict[str, Any]:
    """A 6 mm ball end mill with shaft and holder; keys of ``geometry`` may be changed by name, ``-`` as ``_``."""
    geometry = {
        "DC": 6.0,
        "RE": 3.0,
        "LCF": 18.0,
        "shoulder-length": 22.0,
        "shoulder-diameter": 5.8,
        "LB": 35.0,
        "OAL": 57.0,
        "NOF": 2,
        "SFDM": 6.0,
        "TA": 0,
        "HAND": True,
        "CSP": False,
        "assemblyGaugeLength": 95.0,
    }
    geometry |= {key.replace("_", "-"): changes.pop(key) for key in [*changes] if key.replace("_", "-") in geometry}
    segments = [{"height": 4, "lower-diameter": 18, "upper-diameter": 20}]
    segments.append({"height": 30.0, "lower-diameter": 32, "upper-diameter": 32})
    tool = {
        "type": "ball end mill",
        "unit": "millimeters",
        "description": "6 mm ball",
        "vendor": "",
        "BMC": "carbide",
        "geometry": geometry,
        "holder": {"description": "collet chuck", "gaugeLength": 60, "segments": segments},
        "post-process": {"number": 3, "length-offset": 3, "diameter-offset": 3, "live": True, "turret": 0},
        "start-values": {"presets": [{"name": "default", "n": 12000, "v_f": 1200}]},
    }
    return tool | changes


def fusion_library(*tools: dict[str, Any]) -> bytes:
    """A library as Fusion 360 writes it."""
    return json.dumps({"data": list(tools), "version": 36}).encode()


def zipped(data: bytes, name: str = "tools.json") -> bytes:
    """A packed library."""
    out = io.BytesIO()
    with zipfile.ZipFile(out, "w", zipfile.ZIP_DEFLATED) as packed:
        packed.writestr(name, data)
    return out.getvalue()


#: The first columns of a list that Fusion 360 exports, two presets of one tool.
FUSION_CSV = (
    '"Tool Index (tool_index)","Preset Name (preset_name)","Type (tool_type)","Description (tool_description)",'
    '"Diameter (tool_diameter)","Number (tool_number)","Unit (tool_unit)","Body Length (tool_bodyLength)",'
    '"Flute Length (tool_fluteLength)","Number of Flutes (tool_numberOfFlutes)","Shaft Diameter (tool_shaftDiameter)",'
    '"Shoulder Length (tool_shoulderLength)","Shaft Segments (shaft_segments)","Holder Segments (holder_segments)"\n'
    '1,"Brass","ball end mill","2 mm ball",2,7,"millimeters",20,6,2,4,6,"H3.0 U4.0 L2.0; H11.0 U4.0 L4.0","H5 U9 L8"\n'
    '1,"Steel","ball end mill","2 mm ball",2,7,"millimeters",20,6,2,4,6,"H3.0 U4.0 L2.0; H11.0 U4.0 L4.0","H5 U9 L8"\n'
)


def freecad_bit(name: str = "6 mm bull", shape: str = "bullnose.fcstd", **parameters: Any) -> bytes:
    """A tool bit; a parameter that is None is left out."""
    sizes = {
        "Diameter": "6.0000 mm",
        "CuttingEdgeHeight": "20,0 mm",
        "Length": "60.000 mm",
        "ShankDiameter": "6 mm",
        "Flutes": "3",
        "CornerRadius": "0.5000 mm",
        "Material": "Carbide",
    }
    given = {key: value for key, value in (sizes | parameters).items() if value is not None}
    return json.dumps({"version": 2, "name": name, "shape": shape, "parameter": given, "attribute": {}}).encode()


def freecad_library(*paths: str) -> bytes:
    """A library of bits numbered from 1."""
    return json.dumps({"tools": [{"nr": n, "path": p} for n, p in enumerate(paths, start=1)], "version": 1}).encode()


#: A nut as FreeCAD describes it: radius and height above its face, from the axis back to it.
FREECAD_HOLDER = json.dumps(
    {"version": 1, "name": "nut", "units": "mm", "profile": [[0, 0], [14, 0], [15, 1], [15, 18], [0, 18]]}
).encode()

CAMOTICS = json.dumps(
    {
        "1": {"units": "imperial", "shape": "Cylindrical", "length": 0.5, "diameter": 0.25, "description": "flat"},
        "2": {"units": "metric", "shape": "ballnose", "length": 12, "diameter": 4, "description": "ball"},
        "3": {"units": "metric", "shape": "conical", "length": 5, "diameter": 10, "description": "point"},
        "4": {"units": "metric", "shape": "snubnose", "length": 5, "diameter": 11, "snub_diameter": 1.0},
    }
).encode()

LINUXCNC = (
    "; tools of the mill\nT1 P1 D6.0 Z-12.3 ;6 mm ball end mill\n\nT2 P2 Z40.5 D10 ; face\nT7 P7 D8.5 ;8.5 drill\n"
)


def vectric_database() -> bytes:
    """A database of Vectric: an inch end mill numbered 7, a ball, a V-bit with a flat tip, a tapered ball."""
    with closing(sqlite3.connect(":memory:")) as base:
        base.executescript(
            "CREATE TABLE tool_geometry (id TEXT, name_format TEXT, tool_type INTEGER, units INTEGER, diameter REAL,"
            " included_angle REAL, flat_diameter REAL, num_flutes INTEGER, flute_length REAL, tip_radius REAL);"
            "CREATE TABLE tool_cutting_data (id TEXT, tool_number INTEGER);"
            "CREATE TABLE tool_entity (id TEXT, tool_geometry_id TEXT, tool_cutting_data_id TEXT);"
            "CREATE TABLE tool_tree_entry (id TEXT, tool_geometry_id TEXT, name TEXT);"
            "INSERT INTO tool_geometry VALUES ('a', 'pattern', 1, 1, 0.125, NULL, NULL, 2, 0.5, NULL),"
            " ('b', '4 mm ball', 0, 0, 4, NULL, NULL, 2, 12, NULL), ('c', '60 deg', 3, 0, 10, 60, 0.2, 2, 8, NULL),"
            " ('d', 'tapered', 5, 0, 6, 10, NULL, 2, 20, 0.5);"
            "INSERT INTO tool_cutting_data VALUES ('x', 7), ('y', NULL);"
            "INSERT INTO tool_entity VALUES ('1', 'a', 'x'), ('2', 'a', 'y');"
            "INSERT INTO tool_tree_entry VALUES ('1', 'a', '1/8 end mill');"
        )
        return bytes(base.serialize())


def din_tool(**values: str) -> str:
    """A tool by DIN 4000-82 as manufacturers export it, with a decimal comma; values by code."""
    codes = {"NSM": "DIN4000-82", "BLD": "2", "J22": "Fräser", "J21": "12345", "A1": "5", "A5": "4,6", "B2": "13"}
    codes |= {"B3": "21", "B5": "57", "C3": "6", "F21": "2", "F3": "R", "F4": "40", **values}
    item = "<Property-Data><PropertyName source='din_mk'>{}</PropertyName><Value>{}</Value></Property-Data>"
    return f"<Tool><Properties>{''.join(item.format(*pair) for pair in codes.items())}</Properties></Tool>"


def din_tools(*tools: str) -> bytes:
    """The XML file of some tools."""
    return f"<?xml version='1.0' encoding='utf-8'?>\n<Tool-Data>{''.join(tools)}</Tool-Data>".encode()


CREO = b"""<?xml version="1.0" encoding="UTF-8"?>
<ToolLibrary><Tools><Tool Units="Millimeter">
<Basic><ID>T0002</ID><Pocket>2</Pocket><Teeth>3</Teeth><Type>Milling</Type></Basic>
<Cutter FluteLength="22.0"><Apt ID="Cutter1" Type="APT 7"><Diameter>12.0</Diameter><Radius>1.0</Radius>
<ECorner>5.0</ECorner><FCorner>1.0</FCorner><Alpha>0.0</Alpha><Beta>0.0</Beta><Length>70.0</Length></Apt></Cutter>
</Tool></Tools></ToolLibrary>
"""
