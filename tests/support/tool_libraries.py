"""Tool libraries of made-up tools, shaped like those that CAM programs write."""

from __future__ import annotations

import io
import json
import zipfile
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
