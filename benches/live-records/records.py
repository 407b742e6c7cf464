"""Long records with known sources: DIR/NAME.csv with noise, DIR/NAME_truth.csv without.

    python3 records.py DIR [ROWS]
"""
import sys
import tomllib
from pathlib import Path

import numpy as np
from scipy.integrate import solve_ivp

ROOT = Path(__file__).resolve().parents[2]


def course(seed, rates, size):
    """A sum of sines, and its derivative."""
    rng = np.random.default_rng(seed)
    rates = np.asarray(rates) * rng.uniform(0.9, 1.1, len(rates))
    phases, sizes = rng.uniform(0, 2 * np.pi, len(rates)), size * rng.uniform(0.5, 1, len(rates))
    value = lambda t: np.sum(sizes * np.sin(rates * t + phases))
    slope = lambda t: np.sum(sizes * rates * np.cos(rates * t + phases))
    return value, slope


def accelerations(state, f, m=(0.005, 0.005, 0.005), l=(0.5, 0.5), g=9.81):
    """Of the cart and both links (equations/src/pendulum.rs)."""
    _, a, b, _, da, db = state
    h1, h2, h3 = sum(m), l[0] * (m[1] + m[2]), l[1] * m[2]
    h4, h5, h6 = l[0] ** 2 * (m[1] + m[2]), l[0] * l[1] * m[2], l[1] ** 2 * m[2]
    mass = np.array([
        [h1, -h2 * np.cos(a), -h3 * np.cos(b)],
        [-h2 * np.cos(a), h4, h5 * np.cos(a - b)],
        [-h3 * np.cos(b), h5 * np.cos(a - b), h6],
    ])
    right = np.array([
        f - h2 * da**2 * np.sin(a) - h3 * db**2 * np.sin(b),
        g * h2 * np.sin(a) - h5 * db**2 * np.sin(a - b),
        g * h3 * np.sin(b) + h5 * da**2 * np.sin(a - b),
    ])
    return np.linalg.solve(mass, right)


def pendulum(rows):
    gain = np.array(tomllib.loads((ROOT / "data/pendulum/pendulum.toml").read_text())["lqr_gain"], float).ravel()
    push, _ = course(1, [1.1, 2.3, 4.1, 6.7], 0.03)
    force = lambda t, x: -gain @ x + push(t)
    t = np.arange(rows) * 0.02
    found = solve_ivp(lambda t, x: np.r_[x[3:], accelerations(x, force(t, x))], (0, t[-1]), np.zeros(6), t_eval=t,
                      method="DOP853", rtol=1e-10, atol=1e-12)
    f = np.array([force(t, x) for t, x in zip(t, found.y.T)])
    return t, {"q": found.y[0], "psi": found.y[1], "phi": found.y[2]}, {"f": f}


def rlc(rows):
    drive, rate = course(2, [0.7, 1.9, 3.7], 2.0)
    t = np.arange(rows) * 0.02
    right = lambda t, x: [x[1], rate(t) + 6 * drive(t) - 7 * x[1] - 10 * x[0]]
    found = solve_ivp(right, (0, t[-1]), [0, 0], t_eval=t, method="DOP853", rtol=1e-10, atol=1e-12)
    return t, {"v": found.y[0]}, {"f": np.array([drive(t) for t in t])}


def spring(rows):
    drive, _ = course(3, [0.9, 2.1, 3.9, 5.3], 1.5)
    t = np.arange(rows) * 0.05
    right = lambda t, x: [x[1], drive(t) - 0.4 * x[1] - 4 * x[0] - 3 * x[0] ** 3]
    found = solve_ivp(right, (0, t[-1]), [0, 0], t_eval=t, method="DOP853", rtol=1e-10, atol=1e-12)
    return t, {"y": found.y[0]}, {"u": np.array([drive(t) for t in t])}


UNITS = {"q": "m", "psi": "rad", "phi": "rad", "f": "N", "v": "V", "y": "m", "u": "m/s^2"}
RECORDS = {
    "pendulum_01": (pendulum, 0.01), "pendulum_03": (pendulum, 0.03), "rlc_01": (rlc, 0.01), "spring_01": (spring, 0.01),
}


def write(path, t, columns, units):
    head = ",".join(["t_s"] + [f"{name} [{units[name.split('.')[0]]}]" for name in columns])
    np.savetxt(path, np.column_stack([t, *columns.values()]), delimiter=",", header=head, comments="", fmt="%.9g")


if __name__ == "__main__":
    folder, rows = Path(sys.argv[1]), int(sys.argv[2]) if len(sys.argv) > 2 else 10000
    folder.mkdir(parents=True, exist_ok=True)
    made = {}
    for at, (name, (make, noise)) in enumerate(RECORDS.items()):
        t, state, source = made.get(make) or made.setdefault(make, make(rows))
        rng = np.random.default_rng(100 + at)
        write(folder / f"{name}.csv", t, {k: v + noise * rng.standard_normal(rows) for k, v in state.items()}, UNITS)
        write(folder / f"{name}_truth.csv", t, {**state, **source}, UNITS)
