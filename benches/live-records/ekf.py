"""The rival: an extended Kalman filter (filterpy) with a Matern-3/2 force as part of its state, and Rauch-Tung-Striebel steps back
over the lag at every row. Noise, size and length of the force maximise the likelihood of the first rows.

    python3 ekf.py RECORDS NAME LAG_ROWS [ROWS]
"""
import sys
import time

import numpy as np
from filterpy.kalman import ExtendedKalmanFilter
from scipy.optimize import minimize

from records import accelerations

FIRST = 200


def pendulum(x):
    return np.r_[x[3:6], accelerations(x[:6], x[6])]


def spring(x):
    return np.array([x[1], x[2] - 0.4 * x[1] - 4 * x[0] - 3 * x[0] ** 3])


def rlc(x):
    """In companion form: v = 6 z + z', z'' + 7 z' + 10 z = f."""
    return np.array([x[1], x[2] - 7 * x[1] - 10 * x[0]])


# Right-hand side, states, and what of the state is measured.
MODELS = {
    "pendulum": (pendulum, 6, np.eye(3, 8)),
    "spring": (spring, 2, np.eye(1, 4)),
    "rlc": (rlc, 2, np.array([[6.0, 1.0, 0.0, 0.0]])),
}


class Filter(ExtendedKalmanFilter):
    def __init__(self, model, dt, noise, size, rate):
        self.right, self.count, observe = MODELS[model]
        super().__init__(dim_x=self.count + 2, dim_z=len(observe))
        self.dt, self.observe = dt, observe
        # A Matern force of smoothness 3/2 (Hartikainen and Sarkka 2010).
        decay = np.exp(-rate * dt)
        self.force = decay * np.array([[1 + rate * dt, dt], [-(rate**2) * dt, 1 - rate * dt]])
        stationary = np.diag([size**2, (size * rate) ** 2])
        self.Q = 1e-14 * np.eye(self.count + 2)
        self.Q[-2:, -2:] = stationary - self.force @ stationary @ self.force.T
        self.P = np.eye(self.count + 2)
        self.P[-2:, -2:] = stationary
        self.R = noise**2 * np.eye(len(observe))

    def move(self, x):
        def rate(x):
            return np.r_[self.right(x[: self.count + 1]), x[-1], -0.0]
        a = rate(x)[: self.count]
        def at(state, share):
            force = x[-2] + share * (self.force @ x[-2:] - x[-2:])[0]
            return self.right(np.r_[state, force])
        s, h = x[: self.count], self.dt
        b = at(s + h / 2 * a, 0.5)
        c = at(s + h / 2 * b, 0.5)
        d = at(s + h * c, 1.0)
        return np.r_[s + h / 6 * (a + 2 * b + 2 * c + d), self.force @ x[-2:]]

    def predict(self):
        step = 1e-6
        moved = self.move(self.x)
        self.F = np.column_stack([(self.move(self.x + step * e) - moved) / step for e in np.eye(len(self.x))])
        self.x, self.P = moved, self.F @ self.P @ self.F.T + self.Q

    def take(self, z):
        self.update(z, lambda x: self.observe, lambda x: self.observe @ x)


def start(model, dt, noise, size, rate, rows):
    found = Filter(model, dt, noise, size, rate)
    found.x = np.zeros(found.count + 2)
    found.x[: len(found.observe)] = rows[0] if len(found.observe) > 1 else 0.0
    return found


def unlikely(log, model, dt, rows):
    found, cost = start(model, dt, *np.exp(log), rows), 0.0
    for z in rows:
        found.predict()
        found.take(z)
        cost += 0.5 * (found.y @ np.linalg.solve(found.S, found.y) + np.linalg.slogdet(found.S)[1])
    return cost if np.isfinite(cost) else 1e9


def smooth(model, t, rows, lag):
    dt = t[1] - t[0]
    begin = np.log([0.02, 0.1 if model == "pendulum" else 1.0, 5.0])
    best = minimize(unlikely, begin, args=(model, dt, rows[:FIRST]), method="Nelder-Mead", options={"maxfev": 150})
    found, kept, out, took = start(model, dt, *np.exp(best.x), rows), [], [], []
    for z in rows:
        begun = time.perf_counter()
        found.predict()
        before = found.x.copy(), found.P.copy(), found.F.copy()
        found.take(z)
        kept.append((found.x.copy(), found.P.copy(), before))
        kept = kept[-lag - 1:]
        x, p = kept[-1][0], kept[-1][1]
        for at in range(len(kept) - 2, -1, -1):
            own, cov, (ahead, spread, move) = kept[at][0], kept[at][1], kept[at + 1][2]
            gain = np.linalg.solve(spread, move @ cov).T
            x, p = own + gain @ (x - ahead), cov + gain @ (p - spread) @ gain.T
        if len(kept) == lag + 1:
            out.append((x[found.count], np.sqrt(max(p[found.count, found.count], 0))))
        took.append(time.perf_counter() - begun)
    return np.array(out), np.array(took), np.exp(best.x)


if __name__ == "__main__":
    folder, name, lag = sys.argv[1], sys.argv[2], int(sys.argv[3])
    rows = int(sys.argv[4]) if len(sys.argv) > 4 else None
    data = np.loadtxt(f"{folder}/{name}.csv", delimiter=",", skiprows=1, max_rows=rows)
    truth = np.loadtxt(f"{folder}/{name}_truth.csv", delimiter=",", skiprows=1, max_rows=rows)[:, -1]
    found, took, chosen = smooth(name.split("_")[0], data[:, 0], data[:, 1:], lag)
    inside = slice(FIRST, len(found))
    error = found[inside, 0] - truth[: len(found)][inside]
    print(f"{name}: rms {np.sqrt(np.mean(error**2)):.3e}, cover {np.mean(np.abs(error) < 2 * found[inside, 1]):.3f}, "
          f"median {1e3 * np.median(took):.3f} ms, 99 % {1e3 * np.quantile(took, .99):.3f} ms, chosen {chosen}")
