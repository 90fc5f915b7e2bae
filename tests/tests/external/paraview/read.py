"""Print the content of a folder of fields, as read by VTK, as JSON.

    python read.py FOLDER

Every series with its files in order, and what `open.py` would open.
"""

import json
import runpy
import sys
from pathlib import Path
from xml.etree import ElementTree

from vtkmodules.vtkCommonCore import vtkDataArray
from vtkmodules.vtkFiltersCore import vtkCellCenters
from vtkmodules.vtkIOXML import (
    vtkXMLImageDataReader,
    vtkXMLRectilinearGridReader,
    vtkXMLStructuredGridReader,
    vtkXMLUnstructuredGridReader,
)

TABLE = ("array", "unit", "body", "meaning")
READERS = {
    ".vti": vtkXMLImageDataReader,
    ".vtr": vtkXMLRectilinearGridReader,
    ".vts": vtkXMLStructuredGridReader,
    ".vtu": vtkXMLUnstructuredGridReader,
}


def main() -> None:
    """Read the folder given as argument."""
    folder = Path(sys.argv[1])
    script = folder / "open.py"
    # With this name, unknown to ParaView, the script opens nothing.
    state = runpy.run_path(str(script), run_name="listing")
    opened = state["found"]()
    told = {
        "series": {path.stem: series(path) for path in folder.glob("*.pvd")},
        "opened": {name: array for name, (path, array) in opened.items() if path.is_file()},
        "legends": {array: state["heading"](array) for _, array in opened.values()},
    }
    json.dump(told, sys.stdout)


def series(path: Path) -> list[dict]:
    """Return time [s], file and content of every instant of a series."""
    entries = ElementTree.parse(path).getroot().iter("DataSet")
    files = [(float(entry.attrib["timestep"]), entry.attrib["file"]) for entry in entries]
    return [{"time": time, "file": file, **data(path.parent / file)} for time, file in files]


def data(path: Path) -> dict:
    """Return the content of a file."""
    reader = READERS[path.suffix]()
    errors = []
    reader.AddObserver("ErrorEvent", lambda *_: errors.append(str(path)))
    reader.SetFileName(str(path))
    reader.Update()
    if errors:
        sys.exit(f"VTK cannot read {errors[0]}")
    found = reader.GetOutput()
    centres = vtkCellCenters()
    centres.SetInputData(found)
    centres.Update()
    places = centres.GetOutput()
    cells, fields = found.GetCellData(), found.GetFieldData()
    return {
        "data_time": fields.GetArray("TimeValue").GetValue(0),
        "cells": found.GetNumberOfCells(),
        "extent": list(found.GetExtent()) if path.suffix == ".vti" else None,
        "centres": [places.GetPoint(cell) for cell in range(places.GetNumberOfPoints())],
        "arrays": [array(cells.GetArray(k)) for k in range(cells.GetNumberOfArrays())],
        "table": {name: column(fields.GetAbstractArray(name)) for name in TABLE},
    }


def array(values: vtkDataArray) -> dict:
    """Return an array of cell data."""
    return {
        "name": values.GetName(),
        "unit": values.GetInformation().Get(vtkDataArray.UNITS_LABEL()),
        "components": values.GetNumberOfComponents(),
        "values": [values.GetTuple(cell) for cell in range(values.GetNumberOfTuples())],
    }


def column(strings) -> list[str] | None:
    """Read a column of the table in the field data; None if there is none."""
    return strings and [strings.GetValue(row) for row in range(strings.GetNumberOfValues())]


main()
