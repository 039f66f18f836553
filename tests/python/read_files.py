"""Reads dumps, log and restart of a directory with the example reader, with and without numpy."""

import importlib.util
import sys
from pathlib import Path

directory, reader = Path(sys.argv[1]), sys.argv[2]
if "without-numpy" in sys.argv:
    sys.modules["numpy"] = None  # importing it fails


def load(path):
    spec = importlib.util.spec_from_file_location("karamelo_files", path)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


files = load(reader)
assert (files.numpy is None) == ("without-numpy" in sys.argv)

text, packed, binary = [files.dump(directory / name)
                        for name in ["p.10.dump", "p.10.dump.gz", "p.10.bin"]]
for other in [packed, binary]:
    assert len(other) == len(text) == 1
    for key in ["step", "time", "box"]:
        assert other[0][key] == text[0][key], key
    for name, column in other[0]["columns"].items():
        assert list(column) == list(text[0]["columns"][name]), name
columns = text[0]["columns"]
count = len(columns["id"])
assert text[0]["step"] == 10 and count > 40 and list(columns["id"]) == list(range(1, count + 1))
grown = files.dump(directory / "all.bin")
assert [snapshot["step"] for snapshot in grown] == [0, 10]

first, second = files.log(directory / "log.mpm")
assert list(first["Step"]) == [0, 5, 10] and list(second["Step"]) == [15]
assert list(first["Ek"])[0] > 0 and all(isinstance(word, str) for word in first["dt_limit"])

header, state = files.restart(directory / "end.rst")
assert header["step"] == 15 and header["solids"] == ["ball"]
assert len(state["particle/position"]) == count and len(state["particle/position"][0]) == 4
masses = sum(float(row[3]) for row in state["particle/position"])
assert abs(masses - 1000 * (0.1 / 2) ** 2 * count) < 1e-9
damaged = (directory / "end.rst").read_bytes()[:-1]
(directory / "damaged.rst").write_bytes(damaged)
try:
    files.restart(directory / "damaged.rst")
    sys.exit("a damaged file is read")
except ValueError as reason:
    assert "damaged" in str(reason)
files.main([str(directory / name) for name in ["p.10.bin", "log.mpm", "end.rst"]])
