"""The comparison of opencamlib.sh: OpenCAMLib's BatchDropCutter beside Carvegraph's example."""

import array
import math
import os
import subprocess
import sys
import time

import opencamlib as ocl

RADIUS_MM = 3.0
THREADS = 2
# Heights may differ by so much, in mm.
EXACT_MM = 1e-6
# Where the drop is upright a rounding of the place moves the height at will: it is asked how far off
# in place, in mm, the other's height is found.
NEAR_MM = 1e-7
# Far below every mesh.
NOWHERE_MM = -1e4

# Mesh, places along each side with both, and with Carvegraph alone. OpenCAMLib takes milliseconds a
# place on reliefs, so there it gets fewer.
JOBS = [
    ("mount_rush.stl", 100, 676),
    ("spider.stl", 100, 676),
    ("relief119.stl", 60, 676),
    ("relief480.stl", 30, 676),
]


def carve(program, mesh, count, tips=None):
    """Drops with Carvegraph; returns its figures and its tips."""
    call = [program, mesh, str(RADIUS_MM), str(count), str(THREADS)] + ([tips] if tips else [])
    lines = subprocess.run(call, check=True, capture_output=True, text=True).stdout.splitlines()
    figures = {name: float(value) for name, value in (line.split() for line in lines[1:])}
    if not tips:
        return figures, None
    numbers = array.array("d")
    with open(tips, "rb") as file:
        numbers.frombytes(file.read())
    return figures, list(zip(*[iter(numbers)] * 3))


def batch(surface, places):
    """Drops with OpenCAMLib; returns seconds for its tree, seconds for the drop, and heights."""
    drop = ocl.BatchDropCutter()
    drop.setThreads(THREADS)
    begin = time.perf_counter()
    drop.setSTL(surface)
    drop.setCutter(ocl.BallCutter(2 * RADIUS_MM, 100))
    tree_s = time.perf_counter() - begin
    for x, y in places:
        drop.appendPoint(ocl.CLPoint(x, y, NOWHERE_MM))
    begin = time.perf_counter()
    drop.run()
    drop_s = time.perf_counter() - begin
    return tree_s, drop_s, [point.z for point in drop.getCLPoints()]


def compare(surface, tips, heights):
    """The greatest difference, and how many differ by more than is allowed even beside the place."""
    differ, most, upright = 0, 0.0, 0
    for (x, y, ours), theirs in zip(tips, heights):
        ours = NOWHERE_MM if math.isnan(ours) else ours
        off = abs(ours - theirs)
        if off <= EXACT_MM:
            most = max(most, off)
            continue
        around = [(x + NEAR_MM * i, y + NEAR_MM * j) for i in (-1, 0, 1) for j in (-1, 0, 1)]
        near = batch(surface, around)[2]
        if min(near) - EXACT_MM <= ours <= max(near) + EXACT_MM:
            upright += 1
        else:
            differ += 1
            print(f"    at {x:.6f}, {y:.6f}: ours {ours:.9f}, theirs {theirs:.9f}")
    return most, upright, differ


def main():
    program, data, work = sys.argv[1:]
    print(f"ball R = {RADIUS_MM} mm, {THREADS} threads, us per location; the index is counted apart")
    head = ("mesh", "triangles", "places", "theirs", "ours", "ratio", "ours, dense", "index s", "their tree s")
    print("{:<16}{:>10}{:>8}{:>10}{:>8}{:>9}{:>13}{:>9}{:>14}".format(*head))
    failed = False
    for name, count, dense in JOBS:
        mesh = next((p for p in (os.path.join(f, name) for f in (data, work)) if os.path.exists(p)), None)
        if mesh is None:
            print(f"SKIPPED: no {name}")
            continue
        figures, tips = carve(program, mesh, count, os.path.join(work, "tips"))
        more, _ = carve(program, mesh, dense)
        surface = ocl.STLSurf()
        ocl.STLReader(mesh, surface)
        tree_s, drop_s, heights = batch(surface, [(x, y) for x, y, _ in tips])
        theirs = drop_s / len(tips) * 1e6
        row = "{:<16}{:>10}{:>8}{:>10.1f}{:>8.2f}{:>9.0f}{:>13.2f}{:>9.3f}{:>14.3f}"
        print(row.format(name, surface.size(), len(tips), theirs, figures["each_us"],
                         theirs / figures["each_us"], more["each_us"], figures["index_s"], tree_s))
        most, upright, differ = compare(surface, tips, heights)
        print(f"    heights: {differ} differ, greatest difference {most:.1e} mm; "
              f"{upright} at a wall, equal within {NEAR_MM} mm of the place")
        failed |= differ > 0
    sys.exit(failed)


if __name__ == "__main__":
    main()
