"""Draws the particles of a dump (`particle` or `particle/gz`) as an SVG.

    python3 picture.py DUMP FIELD LOW HIGH OUT.svg [XLO XHI YLO YHI] [mirror]

A square for each particle, coloured by FIELD in eight steps from LOW (blue) to HIGH (red). `mirror`
shows the other side of an axis x = 0 too. Needs nothing but Python's own library.
"""

import gzip
import sys

COLOURS = ["#2166ac", "#4393c3", "#92c5de", "#d1e5f0", "#fddbc7", "#f4a582", "#d6604d", "#b2182b"]
WIDTH = 900


def particles(name):
    """Column names and rows of a dump."""
    opened = gzip.open(name, "rt") if name.endswith(".gz") else open(name)
    with opened as lines:
        for line in lines:
            if line.startswith("ITEM: ATOMS"):
                names = line.split()[2:]
                return names, [[float(word) for word in line.split()] for line in lines]
    sys.exit(f"{name} holds no particles")


def main():
    words = sys.argv[1:]
    mirror = words[-1:] == ["mirror"]
    words = words[:-1] if mirror else words
    if len(words) not in (5, 9):
        sys.exit(__doc__)
    dump, field, low, high, out = words[:5]
    low, high = float(low), float(high)
    names, rows = particles(dump)
    x, y, value, radius = (names.index(name) for name in ("x", "y", field, "radius"))
    if len(words) == 9:
        box = [float(word) for word in words[5:]]
    else:
        xs, ys = [row[x] for row in rows], [row[y] for row in rows]
        box = [-max(xs) if mirror else min(xs), max(xs), min(ys), max(ys)]
    scale = WIDTH / (box[1] - box[0])
    height = round((box[3] - box[2]) * scale)
    side = max(1, round(2 * rows[0][radius] * scale))
    paths = [[] for _ in COLOURS]
    for row in rows:
        step = int((row[value] - low) / (high - low) * len(COLOURS))
        path = paths[min(max(step, 0), len(COLOURS) - 1)]
        for sign in (1, -1) if mirror else (1,):
            px = round((sign * row[x] - box[0]) * scale - side / 2)
            py = round((box[3] - row[y]) * scale)
            if 0 <= px < WIDTH and 0 <= py < height:
                path.append(f"M{px} {py}h{side}")
    with open(out, "w") as file:
        size = f'width="{WIDTH}" height="{height}" viewBox="0 0 {WIDTH} {height}"'
        file.write(f'<svg xmlns="http://www.w3.org/2000/svg" {size}>\n')
        file.write(f'<rect width="{WIDTH}" height="{height}" fill="white"/>\n')
        for colour, path in zip(COLOURS, paths):
            if path:
                file.write(f'<path stroke="{colour}" stroke-width="{side}" d="{"".join(path)}"/>\n')
        file.write("</svg>\n")


main()
