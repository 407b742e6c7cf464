"""Seconds and memory of whole runs of `nisp solve` as the work grows, with slopes, as a table and as a figure.

    python3 measure.py NISP [FIGURE.svg]
"""
import json
import os
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import numpy as np

import records

SAMPLE = Path(__file__).resolve().parents[2] / "data" / "membrane" / "flower_1.toml"
BUDGET = ["--budget", "600"]
STEPS = ["--carrier", "network", "--optimizer", "adam", "--iterations", "100"]

# What grows, what carries it: sizes, and (folder, size) -> arguments of `nisp solve`.


def text(folder, lines, *options):
    (folder / "equation.pde").write_text(lines)
    return [folder / "equation.pde", "--data", folder / "data.csv", *options]


def membrane(folder, points):
    records.cloud(folder, SAMPLE, points)
    return ["membrane", "--sample", SAMPLE, "--data", folder / "cloud.npy"]


RUNS = [
    ("rows", "splines over time", [100, 1000, 10_000, 100_000, 1_000_000],
     lambda folder, n: text(folder, records.tanks(folder, n, 1, 0))),
    ("rows", "splines on a lattice", [100, 1000, 10_000, 100_000, 1_000_000],
     lambda folder, n: text(folder, records.heated(folder, n))),
    ("rows", "surface under a cloud", [1000, 10_000, 100_000, 1_000_000], membrane),
    ("rows", "network, 100 steps", [100, 1000, 10_000, 100_000],
     lambda folder, n: text(folder, records.heated(folder, n), *STEPS)),
    ("points of the equations", "network, 100 steps", [1000, 10_000, 100_000, 1_000_000],
     lambda folder, n: text(folder, records.heated(folder, 1000), *STEPS, "--points", f"inside={n}")),
    ("unknown fields", "splines over time", [1, 2, 4, 8, 16, 32],
     lambda folder, n: text(folder, records.tanks(folder, 1000, n, 0))),
    ("learned parameters", "splines over time", [1, 2, 4, 8, 16, 32],
     lambda folder, n: text(folder, records.tanks(folder, 1000, 32, n))),
]


def run(nisp, arguments, threads, out):
    """Wall seconds, processor seconds, megabytes at most, and the status of a run."""
    command = [nisp, "solve", *arguments, *BUDGET, "--threads", threads, "--json", "--out", out]
    most, begun, before = 0, time.monotonic(), os.times()
    with tempfile.TemporaryFile() as said:
        child = subprocess.Popen([str(part) for part in command], stdout=said, stderr=subprocess.DEVNULL)
        while child.poll() is None:
            # The memory that wait4 reports is never less than this process's own.
            lines = Path(f"/proc/{child.pid}/status").read_text().splitlines()
            most = max([most, *(int(line.split()[1]) for line in lines if line.startswith("VmHWM"))])
            time.sleep(.002)
        wall, used = time.monotonic() - begun, os.times()
        said.seek(0)
        status = json.load(said)["status"]
    worked = used.children_user + used.children_system - before.children_user - before.children_system
    return wall, worked, most / 1024, status


def slope(sizes, figures):
    """Slope in a double logarithmic picture over the upper half of the sizes: 1 is linear."""
    half = len(sizes) // 2
    return np.polyfit(np.log(sizes[half:]), np.log(figures[half:]), 1)[0]


def measured(nisp):
    for grows, carrier, sizes, arguments in RUNS:
        rows = []
        for size in sizes:
            with tempfile.TemporaryDirectory() as folder:
                folder = Path(folder)
                given = arguments(folder, size)
                one, two = (run(nisp, given, threads, folder / "out") for threads in (1, 2))
            print(f"| {grows} | {carrier} | {size} | {one[0]:.2f} | {two[0]:.2f} | {two[1]:.2f} | {two[2]:.0f} | {two[3]} |", flush=True)
            rows.append((one[0], two[0], two[2]))
        yield grows, carrier, np.array(sizes), np.array(rows)


def draw(curves, path):
    import matplotlib
    matplotlib.use("svg")
    matplotlib.rcParams["svg.fonttype"] = "none"
    import matplotlib.pyplot as plt
    grown = list(dict.fromkeys(curve[0] for curve in curves))
    colours = {carrier: f"C{i}" for i, carrier in enumerate(dict.fromkeys(curve[1] for curve in curves))}
    _, axes = plt.subplots(2, len(grown), figsize=(3.4 * len(grown), 6), sharey="row", sharex="col", layout="constrained")
    for grows, carrier, sizes, rows in curves:
        time_axis, memory_axis = axes[:, grown.index(grows)]
        time_axis.loglog(sizes, rows[:, 1], "o-", color=colours[carrier], label=carrier)
        time_axis.loglog(sizes, rows[:, 0], "--", color=colours[carrier])
        memory_axis.loglog(sizes, rows[:, 2], "o-", color=colours[carrier])
        memory_axis.set_xlabel(grows)
    axes[0, 0].set_ylabel("seconds, start to files\n(dashed: one thread)")
    axes[1, 0].set_ylabel("MB at most")
    for axis in axes.flat:
        axis.grid(alpha=.3)
    for axis in axes[0]:
        axis.legend(fontsize=8)
    plt.savefig(path)


def main(nisp, figure=None):
    print("| what grows | carrier | size | s, 1 thread | s, 2 threads | processor s | MB | status |\n|---|---|---|---|---|---|---|---|")
    curves = list(measured(nisp))
    print("\n| what grows | carrier | slope of seconds | slope of memory | 2 threads for 1 at the largest |\n|---|---|---|---|---|")
    for grows, carrier, sizes, rows in curves:
        print(f"| {grows} | {carrier} | {slope(sizes, rows[:, 1]):.2f} | {slope(sizes, rows[:, 2]):.2f} | {rows[-1, 0] / rows[-1, 1]:.2f} |")
    if figure:
        draw(curves, figure)


if __name__ == "__main__":
    main(*sys.argv[1:])
