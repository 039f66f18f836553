"""Reads dumps and log of a directory with OVITO and lammps-logfile, as users do."""

import sys
from pathlib import Path

import lammps_logfile
import numpy
from ovito.io import import_file

directory = Path(sys.argv[1])


def check_boxes(particles):
    """The set `ovito` is mapped to OVITO's own properties, and F = R U holds between them."""
    x, y, z, w = particles["Orientation"][...].T
    turn = numpy.array([
        [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
        [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
        [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
    ]).transpose(2, 0, 1)
    # OVITO's components go down the columns: XX YX ZX XY ...
    gradient = particles["Deformation Gradient"][...].reshape(-1, 3, 3).transpose(0, 2, 1)
    single = 8 * numpy.finfo(numpy.float32).eps  # OVITO keeps orientations and sizes in 32 bits
    stretch = turn.transpose(0, 2, 1) @ gradient
    assert abs(stretch - stretch.transpose(0, 2, 1)).max() < single
    assert abs(turn[:, 0, 1]).max() > 0.01, "the body turns"
    half = 0.1 / 2 / 2
    diagonal = numpy.diagonal(stretch, axis1=1, axis2=2)
    assert abs(particles["Aspherical Shape"][...] - half * diagonal).max() < single * half
    volume = numpy.linalg.det(gradient) * (2 * half) ** 2
    assert abs(particles["Radius"][...] - volume ** 0.5 / 2).max() < single * half
    stress = particles["Stress Tensor"][...]  # XX YY ZZ XY XZ YZ
    xx, yy, zz, xy, xz, yz = stress.T
    seq = numpy.sqrt(0.5 * ((xx - yy) ** 2 + (yy - zz) ** 2 + (zz - xx) ** 2)
                     + 3 * (xy ** 2 + xz ** 2 + yz ** 2))
    assert seq.max() > 0 and numpy.allclose(seq, particles["seq"][...], rtol=single)
    assert "ep" not in particles, "an elastic body has no plastic strain"


counts = set()
for name in ["p.10.dump", "p.10.dump.gz", "p.10.bin"]:
    data = import_file(str(directory / name)).compute(0)
    particles = data.particles
    counts.add(particles.count)
    print(name, particles.count, "particles, step", data.attributes["Timestep"],
          "time", data.attributes["Time"], sorted(particles.keys()))
    assert data.attributes["Timestep"] == 10
    assert data.attributes["Time"] > 0
    assert "Position" in particles and "Velocity" in particles
    assert abs(particles["Velocity"][:, 0].mean() - 0.1) < 1e-9
    assert list(particles["Particle Identifier"]) == list(range(1, particles.count + 1))
    box = data.cell[...]
    assert abs(box[2, 2] - 0.1) < 1e-12, "a plane scene is one cell thick"
    if name == "p.10.dump":
        check_boxes(particles)
assert len(counts) == 1 and counts.pop() > 0

log = lammps_logfile.File(str(directory / "log.mpm"))
print("log", log.get_keywords(), list(log.get("Step")))
assert list(log.get("Step")) == [0, 5, 10]
assert len(log.get("Ek")) == 3
