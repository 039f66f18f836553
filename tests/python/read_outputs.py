"""Reads dumps and log of a directory with OVITO and lammps-logfile, as users do."""

import sys
from pathlib import Path

import lammps_logfile
from ovito.io import import_file

directory = Path(sys.argv[1])
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
    assert abs(particles["Velocity"][:, 0] - 0.1).max() < 1e-9
    assert list(particles["Particle Identifier"]) == list(range(1, particles.count + 1))
    box = data.cell[...]
    assert abs(box[2, 2] - 0.1) < 1e-12, "a plane scene is one cell thick"
    if name == "p.10.dump":
        for mapped in ["Radius", "Orientation", "Aspherical Shape", "Stress Tensor"]:
            assert mapped in particles, mapped
assert len(counts) == 1 and counts.pop() > 0

log = lammps_logfile.File(str(directory / "log.mpm"))
print("log", log.get_keywords(), list(log.get("Step")))
assert list(log.get("Step")) == [0, 5, 10]
assert len(log.get("Ek")) == 3
