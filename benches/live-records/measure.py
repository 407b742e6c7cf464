"""Rows answered by `nisp stream` and by `nisp solve`, beside the truth of records.py.

    python3 measure.py NISP RECORDS NAME [OPTIONS OF THE EQUATION]
"""
import json
import subprocess
import sys
from pathlib import Path

import numpy as np

HERE = Path(__file__).resolve().parent


def main(nisp, folder, name, options):
    equation = name.split("_")[0]
    equation = str(HERE / "spring.pde") if equation == "spring" else equation
    data = [equation, "--data", f"{folder}/{name}.csv", *options]
    truth = np.loadtxt(f"{folder}/{name}_truth.csv", delimiter=",", skiprows=1)
    stream = subprocess.run([nisp, "stream", *data], capture_output=True, text=True, check=True).stdout
    lines = [json.loads(line) for line in stream.splitlines()]
    # A row whose data are missed has no bar.
    live = np.array([[line["t"], line["lag"], *next(iter(line["sources"].values())).values()] for line in lines], float)
    order = [next(iter(lines[0]["sources"].values())).keys()]
    assert list(order[0]) == ["sd", "value"], order
    took = np.array([line["latency_ms"] for line in lines])
    known = np.interp(live[:, 0], truth[:, 0], truth[:, -1])
    # Neither the first rows, which were known together, nor the last, which did not wait.
    lag = np.median(live[:, 1])
    inside = (live[:, 0] > truth[200, 0]) & (live[:, 0] < truth[-1, 0] - 2 * lag)
    rms = lambda error: np.sqrt(np.mean(error[inside] ** 2))
    whole = subprocess.run([nisp, "solve", *data, "--carrier", "splines", "--json", "--budget", "120", "--out", f"{folder}/out"],
                           capture_output=True, text=True).stdout
    batch = np.array(json.loads(whole)["sources"][0]["values"])
    error, bar = live[:, 3] - known, live[:, 2]
    by_batch = np.interp(live[:, 0], truth[:, 0], batch) - known
    states = {status: sum(line["status"] == status for line in lines) for status in {line["status"] for line in lines}}
    print(f"{name}: {len(lines)} rows {states}, lag {lag:.3g}, rms {rms(error):.3e} of {rms(known):.3e}, batch {rms(by_batch):.3e}, "
          f"ratio {rms(error) / rms(by_batch):.3f}, cover {np.mean(np.abs(error) < 2 * bar):.3f}, "
          f"ms: median {np.median(took[inside]):.3f}, 99 % {np.quantile(took[inside], .99):.3f}, most {took[inside].max():.1f}")


if __name__ == "__main__":
    main(sys.argv[1], sys.argv[2], sys.argv[3], sys.argv[4:])
