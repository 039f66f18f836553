"""ParaView opens our series: times, numbers of points, fields, and where the body is."""

import sys

from paraview.simple import PVDReader

FOLDER = sys.argv[1]
TIMES = [0.0, 0.02, 0.04]


def opened(name):
    series = PVDReader(FileName=f"{FOLDER}/{name}")
    series.UpdatePipelineInformation()
    times = list(series.TimestepValues)
    assert len(times) == 3, times
    assert all(abs(a - b) < 1e-12 for a, b in zip(times, TIMES)), times
    return series, times


series, times = opened("p.vtp.pvd")
places = []
for time in times:
    series.UpdatePipeline(time)
    assert series.GetDataInformation().GetNumberOfPoints() == 52
    bounds = series.GetDataInformation().GetBounds()
    places.append((bounds[0] + bounds[1]) / 2)
    low, high = series.PointData.GetArray("v").GetRange(0)
    assert abs(low - 1) < 1e-12 and abs(high - 1) < 1e-12, (low, high)
# At rest in the middle of the box, then 0.02 further each time.
for place, time in zip(places, TIMES):
    assert abs(place - 0.5 - time) < 1e-12, (place, time)

series, times = opened("g.vti.pvd")
series.UpdatePipeline(times[-1])
assert series.GetDataInformation().GetNumberOfPoints() == 11 * 11
low, high = series.PointData.GetArray("mass").GetRange(0)
assert low == 0 and high > 5, (low, high)
print("ParaView reads both series")
