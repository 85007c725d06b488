"""Text for other controls, and files that are no programs, are refused by name; our own programs never are."""

from __future__ import annotations

import pytest

from gcode.flow.interpreter import check
from gcode.language.foreign import recognise

FOREIGN = {
    "SINUMERIK": {
        "%_N_POCKET_MPF\n;$PATH=/_N_WKS_DIR\nG0 X10": (1, 1),
        "; pocket\n;$PATH=/_N_MPF_DIR\nG0 X10": (2, 1),
        "G17 G54\nDEF REAL DEPTH\nG0 X10": (2, 1),
        "N10 G17 G90\nN20 CYCLE81(10,0,2,-5)\n": (2, 5),
        'N10 MSG("first side")': (1, 5),
        "G1 X=IC(5) F100": (1, 4),
        "G2 X10 Y0 CR=12.5": (1, 11),
        "N10 G0 X0\nN20 TRANS X10 Y20": (2, 1),
        "N30 R1=12.5": (1, 1),
        "G0 SUPA Z0\nTRAORI\n": (1, 4),
        'T="MILL_10" M6': (1, 1),
        'N10 WORKPIECE(,"",,"BOX",112,0,-20,-80,0,0,100,50)': (1, 5),
    },
    "Heidenhain": {
        "0 BEGIN PGM PLATE MM\n1 BLK FORM 0.1 Z X+0 Y+0 Z-20": (1, 3),
        "3 TOOL CALL 1 Z S3000": (1, 3),
        "7 L X+10 Y-5 R0 FMAX M3": (1, 1),
        "8 CC X+50 Y+50\n9 C X+0 Y+50 DR+ ": (1, 1),
        "12 CYCL DEF 200 DRILLING": (1, 4),
        "5 FN 0: Q1 = +5": (1, 1),
        "LBL 1\nCALL LBL 1 REP 3": (1, 1),
    },
    "Heidenhain (DIN/ISO)": {
        "%PLATE G71 *\nN10 G30 G17 X+0 Y+0 Z-20 *": (1, 1),
        "N50 G00 G40 G90 Z+250 *\nN60 G30 G17 X+0 Y+0 Z-40 *": (1, 1),
    },
    "Okuma OSP": {
        "$PLATE.MIN%\nG15 H1": (1, 1),
        "G15 H1\nG0 X10 Y10\nG56 H2 Z50\n": (1, 1),
        "N1 G0 X0\nCALL OABC Q3": (2, 1),
        "VC1=10\nG0 X=VC1": (1, 1),
        "IF [VC1 EQ 5] N100": (1, 1),
    },
    "Fagor": {"%PLATE,MX,\nN10 G0 X0": (1, 1), "N10 G0 X0\nN20 #HSC ON": (2, 1)},
    "APT cutter location data": {"PARTNO/PLATE\nGOTO/1,2,3": (1, 1), "$$ tool path\nGOTO / 0.0, 1.0, 2.0": (2, 1)},
    "a plotter (HPGL)": {"IN;SP1;PU0,0;PD100,0;": (1, 1)},
    "a drilling machine for circuit boards (Excellon)": {"M48\nMETRIC,TZ\nT01C0.800": (2, 1)},
    "a 3D printer": {
        "; a slicer\nM140 S60\nM104 S210\nG28": (2, 1),
        "G1 F1500 E-0.8": (1, 1),
        ";FLAVOR:Marlin\nG28": (1, 1),
    },
    "an STL file": {"solid part\n facet normal 0 0 1": (1, 1)},
    "a STEP file": {"ISO-10303-21;\nHEADER;": (1, 1)},
    "a DXF drawing": {"  0\nSECTION\n  2\nHEADER": (1, 3)},
    "a PDF document": {"%PDF-1.7\n": (1, 1)},
    "a ZIP archive": {"PK\x03\x04": (1, 1)},
    "a text in UTF-16": {"\xff\xfeG\x002\x001\x00": (1, 1), "G\x002\x001\x00": (1, 1)},
    "a JSON file": {'{"data": []}': (1, 1), "{\n": (1, 1)},
    "a settings file (TOML)": {"# Drafted\n[program]": (1, 1), "[program]\n": (1, 1), 'file = "a.nc"\n': (1, 1)},
    "an XML or HTML document": {"<!DOCTYPE html>\n<html>": (1, 1)},
    "a Gerber drawing": {"%FSLAX46Y46*%": (1, 1)},
}

OURS = {
    "fanuc": (
        "%\nO1234 (PLATE, CYCLE81 OF THE OLD PROGRAM)\nG0 X0 Y0\nM30\n%",
        "O0001\n#1=5\nIF[#1EQ2]GOTO5\nWHILE[#1LT7]DO1\n#1=#1+1\nEND1\nN5M30",
        "O0002 (MSG: TOOL CALL 5, BEGIN PGM)\nM98 P31000 L2 ;\nM30",
        "G1 X10. (CALL 3 TIMES) F100\nG56 H1\nG15\nM30",
        "O10\nG65 P9010 R5. D3 S2\nM99",
        ":0001\nM82\nM30",
    ),
    "haas": ("%\nO00010 (T = 1)\nT1 M06\nG187 P3 E0.01\nM30\n%", "M97 P100 L2\nG0 G53 Z0\nM30\nN100 M99"),
    "linuxcnc": (
        "o<cut> sub\n#<r>=[#1*2]\no<cut> endsub\no<cut> call [3]\nM2",
        "(PARTNO 5)\n(GOTO/ is not ours)\nG0 X1\nM67 E0 Q1.5\nM2",
        "o100 if [#1 GT 5]\no100 endif\n; Q1 = 5 FMAX\nM2",
    ),
    "grbl": ("G0X1Y2\nM3S1000\nG1X5F100\nM30",),
}


@pytest.mark.parametrize(("control", "text", "place"), [(c, t, p) for c, of in FOREIGN.items() for t, p in of.items()])
def test_other_controls_are_recognised_by_their_first_mark(control: str, text: str, place: tuple[int, int]) -> None:
    found = recognise(text)
    assert found is not None
    assert (found.control, found.line, found.column) == (control, *place)


@pytest.mark.parametrize(("dialect", "text"), [(d, t) for d, texts in OURS.items() for t in texts])
def test_our_own_programs_are_not(dialect: str, text: str) -> None:
    assert recognise(text) is None, dialect


def test_one_likely_mark_is_not_enough() -> None:
    assert recognise("G0 X1\nM104 S5\nM30") is None


def test_the_refusal_names_the_control_and_the_mark() -> None:
    (error,) = check("(SIDE 1)\nN10 G0 X0\nN20 CYCLE81(10,0,2,-5)\n", file="part.mpf")
    assert str(error) == (
        "part.mpf:3:5: a program for SINUMERIK: 'CYCLE81(' is a SINUMERIK cycle; "
        "expected a program for fanuc, haas, linuxcnc or grbl [foreign-control]"
    )
