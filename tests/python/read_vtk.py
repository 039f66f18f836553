"""Reads files for ParaView with VTK and compares them with the text dumps of the same snapshots."""

import sys
import xml.etree.ElementTree as xml
from pathlib import Path

import numpy
import vtk
from vtk.util.numpy_support import vtk_to_numpy

directory = Path(sys.argv[1])


def text_dump(name):
    lines = (directory / name).read_text().splitlines()
    names = lines[10].split()[2:]
    table = numpy.array([line.split() for line in lines[11:]], dtype=float)
    return float(lines[1]), {column: table[:, place] for place, column in enumerate(names)}


def read(reader, path):
    failures = []
    reader.AddObserver("ErrorEvent", lambda *event: failures.append(event))
    reader.SetFileName(str(path))
    reader.Update()
    assert not failures, f"{path}: VTK complains"
    return reader.GetOutput()


def arrays(data):
    fields = data.GetPointData()
    return {fields.GetArrayName(i): vtk_to_numpy(fields.GetArray(i))
            for i in range(fields.GetNumberOfArrays())}


def equal(found, expected, what):
    assert numpy.array_equal(found, expected), what


series = xml.parse(directory / "p.vtp.pvd").getroot().find("Collection").findall("DataSet")
assert [entry.get("file") for entry in series] == ["p.0.vtp", "p.10.vtp"]
for entry in series:
    data = read(vtk.vtkXMLPolyDataReader(), directory / entry.get("file"))
    time, columns = text_dump(entry.get("file").replace(".vtp", ".dump"))
    assert float(entry.get("timestep")) == time
    assert data.GetFieldData().GetArray("TimeValue").GetValue(0) == time
    found = arrays(data)
    places = vtk_to_numpy(data.GetPoints().GetData())
    count = len(places)
    assert data.GetNumberOfVerts() == count > 0
    equal(places, numpy.stack([columns[a] for a in "xyz"], axis=1), "places")
    equal(found["id"], columns["id"], "id")
    equal(found["type"], columns["type"], "type")
    equal(found["v"], numpy.stack([columns["v" + a] for a in "xyz"], axis=1), "v")
    # VTK's order of a symmetric tensor.
    six = ["s11", "s22", "s33", "s12", "s23", "s13"]
    equal(found["s"], numpy.stack([columns[c] for c in six], axis=1), "s")
    assert abs(found["s"]).max() > 0 or time == 0
    equal(found["seq"], columns["seq"], "seq")
    print(entry.get("file"), "time", time, count, "points", sorted(found))

for name in ["g.10.vti", "g.10.vtp"]:
    image = name.endswith("vti")
    reader = vtk.vtkXMLImageDataReader() if image else vtk.vtkXMLPolyDataReader()
    data = read(reader, directory / name)
    time, columns = text_dump("g.10.dump")
    found = arrays(data)
    places = numpy.array([data.GetPoint(i) for i in range(data.GetNumberOfPoints())])
    order = numpy.argsort(found["id"])
    equal(found["id"][order], columns["id"], "id")
    for place, axis in enumerate("xyz"):
        assert abs(places[order, place] - columns[axis]).max() < 1e-14, axis
    equal(found["mass"][order], columns["mass"], "mass")
    equal(found["v"][order, 0], columns["vx"], "v")
    assert found["mass"].sum() > 0
    print(name, len(places), "points", sorted(found))
assert data is not None

# Total Lagrangian solids have a lattice each.
series = xml.parse(directory / "t.vti.pvd").getroot().find("Collection").findall("DataSet")
entries = [(entry.get("part"), entry.get("file")) for entry in series]
assert entries == [("0", "t.0.1.vti"), ("1", "t.0.2.vti")], entries
_, columns = text_dump("t.0.dump")
for number, (_, name) in enumerate(entries, 1):
    found = arrays(read(vtk.vtkXMLImageDataReader(), directory / name))
    own = columns["type"] == number
    order = numpy.argsort(found["id"])
    equal(found["id"][order], columns["id"][own], "id")
    equal(found["mass"][order], columns["mass"][own], "mass")
