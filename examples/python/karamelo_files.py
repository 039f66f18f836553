"""Reads dumps, logs and restart files of karamelo-rs. Copy what you need; numpy is optional.

    import karamelo_files
    for snapshot in karamelo_files.dump("rod.100.dump.gz"):
        print(snapshot["step"], snapshot["time"], max(snapshot["columns"]["seq"]))
    run = karamelo_files.log("log.mpm")[-1]
    print(run["Step"][-1], run["Ek"][-1])
    header, columns = karamelo_files.restart("state.1000.rst")
    print(header["step"], header["solids"], columns["particle/position"][0])

Columns are lists, or arrays where numpy is installed. `python3 karamelo_files.py FILE ...` tells what
files hold.
"""

import gzip
import json
import struct
import sys
import zlib

try:
    import numpy
except ImportError:
    numpy = None


def _column(values):
    return numpy.array(values) if numpy else list(values)


def dump(path):
    """The snapshots of a dump of particles or nodes: text, gzip or binary."""
    with open(path, "rb") as file:
        data = file.read()
    if data[:2] == b"\x1f\x8b":
        data = gzip.decompress(data)
    return list(_text(data.decode()) if data.startswith(b"ITEM:") else _binary(data))


def _text(text):
    lines = iter(text.splitlines())
    snapshot = {}
    for line in lines:
        if line == "ITEM: TIME":
            snapshot = {"time": float(next(lines))}
        elif line == "ITEM: TIMESTEP":
            snapshot["step"] = int(next(lines))
        elif line == "ITEM: NUMBER OF ATOMS":
            count = int(next(lines))
        elif line.startswith("ITEM: BOX BOUNDS"):
            snapshot["box"] = [[float(x) for x in next(lines).split()] for _ in range(3)]
        elif line.startswith("ITEM: ATOMS"):
            names = line.split()[2:]
            rows = [[float(x) for x in next(lines).split()] for _ in range(count)]
            columns = zip(*rows) if rows else [[] for _ in names]
            snapshot["columns"] = {n: _column(c) for n, c in zip(names, columns)}
            yield snapshot


def _binary(data):
    place = 0

    def take(form):
        nonlocal place
        values = struct.unpack_from("<" + form, data, place)
        place += struct.calcsize("<" + form)
        return values if len(values) > 1 else values[0]

    while place < len(data):
        magic = take(f"{-take('q')}s")
        if magic != b"DUMPCUSTOM":
            raise ValueError("this is no dump")
        _order, _revision, step, count, _triclinic = take("iiqqi")
        take("6i")
        limits = take("6d")
        width = take("i")
        take(f"{take('i')}s")
        time = take("d") if take("b") else None
        names = take(f"{take('i')}s").decode().split()
        numbers = []
        for _ in range(take("i")):
            size = take("i")
            numbers.extend(struct.unpack_from(f"<{size}d", data, place))
            place += 8 * size
        assert len(numbers) == count * width
        columns = {name: _column(numbers[i::width]) for i, name in enumerate(names)}
        box = [list(limits[i:i + 2]) for i in (0, 2, 4)]
        yield {"step": step, "time": time, "box": box, "columns": columns}


def log(path):
    """The columns of each run of a log, by name; words such as those of `dt_limit` stay words."""
    runs, rows = [], None
    with open(path) as file:
        for words in map(str.split, file):
            if words[:1] == ["Step"]:
                names, rows = words, []
                runs.append((names, rows))
            elif rows is not None and len(words) == len(names) and words[0].isdigit():
                rows.append(words)
            else:
                rows = None
    return [{name: _numbers([row[i] for row in rows]) for i, name in enumerate(names)}
            for names, rows in runs]


def _numbers(words):
    try:
        return _column([float(word) for word in words])
    except ValueError:
        return words


def restart(path):
    """Header and columns of a restart file; a column with several numbers in a row has rows."""
    with open(path, "rb") as file:
        data = file.read()
    if data[:8] != b"\x89MPMRST\n":
        raise ValueError("this is no restart file")
    _version, checksum, length = struct.unpack_from("<IIQ", data, 8)
    if zlib.crc32(data[16:]) != checksum:
        raise ValueError("the file is damaged")
    header, start = json.loads(data[24:24 + length]), 24 + length
    columns = {}
    for name, about in header["columns"].items():
        rows, width, place = about["rows"], about["width"], start + about["offset"]
        if numpy:
            numbers = numpy.frombuffer(data, about["type"], rows * width, place)
            columns[name] = numbers.reshape(rows, width) if width > 1 else numbers
        else:
            letter = {"<f8": "d", "<i8": "q", "<u8": "Q", "<u4": "I", "<u2": "H"}[about["type"]]
            numbers = struct.unpack_from(f"<{rows * width}{letter}", data, place)
            rows = [numbers[i:i + width] for i in range(0, rows * width, width)]
            columns[name] = rows if width > 1 else list(numbers)
    return header, columns


def main(paths):
    for path in paths:
        with open(path, "rb") as file:
            start = file.read(24)
        if start.startswith(b"\x89MPMRST\n"):
            header, columns = restart(path)
            print(path, "restart, step", header["step"], "time", header["time"], *columns)
        elif start.startswith((b"ITEM:", b"\x1f\x8b")) or start[8:18] == b"DUMPCUSTOM":
            for snapshot in dump(path):
                names = snapshot["columns"]
                count = len(names["id"])
                print(path, "step", snapshot["step"], "time", snapshot["time"], count, *names)
        else:
            for run in log(path):
                print(path, "log,", len(run["Step"]), "rows:", *run)


if __name__ == "__main__":
    main(sys.argv[1:])
