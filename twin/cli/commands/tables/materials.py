"""``twin materials``."""

from __future__ import annotations

from typing import Annotated

import typer


def materials(
    text: Annotated[
        str | None,
        typer.Argument(
            metavar="[NAME]",
            help="Name of a material, to print its whole row; or a text to search in names, sources and tools.",
            show_default=False,
        ),
    ] = None,
    as_json: Annotated[bool, typer.Option("--json", help="Print JSON: one object, or a list of objects.")] = False,
) -> None:
    """List cutting coefficients of materials with their sources, or print one of them.

    A job uses a row with ``material = "NAME"`` in its table [cutting]; twin replay takes --material NAME. Rows of the
    kind "order of magnitude" are catalogue values by material group.
    """
    from twin.cli.console import print_json, results
    from twin.cli.show.material_tables import listing_objects, print_rows, row_lines, row_object
    from twin.materials import find_material, load_materials
    from twin.materials.library import is_name, matching

    if text is not None and is_name(text):
        row = find_material(text)
        if as_json:
            print_json(row_object(row))
        else:
            results().print(row_lines(row))
        return
    rows = list(load_materials().values()) if text is None else matching(text)
    if not rows and text is not None:
        find_material(text)
    if as_json:
        print_json(listing_objects(rows))
    else:
        print_rows(results(), rows)
