"""Records, fields and clouds of any size, and the texts of their equations. All have the same answer at every size."""
import numpy as np


def table(path, columns):
    np.savetxt(path, np.column_stack(list(columns.values())), delimiter=",", header=",".join(columns), comments="", fmt="%.9g")


def tanks(folder, rows, fields, learned):
    """Tanks in a row, over 20 s. The first is fed by a source, or by a known inflow where rates are learned; each drains to the next."""
    fine = np.linspace(0, 20, max(4 * rows, 4000) + 1)
    step, feed = fine[1], lambda t: 1 + np.sin(0.9 * t) + 0.5 * np.sin(2.3 * t)
    slope = lambda t, x: np.concatenate([[feed(t)], x[:-1]]) - x
    level = np.zeros((len(fine), fields))
    for i, t in enumerate(fine[:-1]):  # Heun's method; its error is far below the noise.
        first = slope(t, level[i])
        level[i + 1] = level[i] + step / 2 * (first + slope(t + step, level[i] + step * first))
    t = np.linspace(0, 20, rows)
    random = np.random.default_rng(rows + fields)
    measured = {f"x{i}": np.interp(t, fine, level[:, i]) + .01 * random.standard_normal(rows) for i in range(fields)}
    table(folder / "data.csv", {"t": t} | measured)
    names = [f"x{i}" for i in range(fields)]
    rate = [f"k{i}" if i < learned else "1" for i in range(fields)]
    inflow = ["1 + sin(0.9 * t) + 0.5 * sin(2.3 * t)" if learned else "u", *names]
    balance = [f"b{i}: d(x{i}, t) == {inflow[i]} - {rate[i]} * x{i};" for i in range(fields)]
    rates = ", ".join(f"k{i} = 1.5" for i in range(learned))
    return "\n".join([
        "units: off;", "coordinates: t;", f"fields: {', '.join(names)};", "" if learned else "sources: u;",
        f"parameters: {rates};" if learned else "", f"on tanks {{ {' '.join(balance)} }}",
        f"on samples {{ observe {', '.join(names)}; }}",
        f"scene rates {{ learn {', '.join(f'k{i}' for i in range(learned))}; }}" if learned else "",
    ])


def heated(folder, rows):
    """A rod that an unknown source heats, measured at random places and times."""
    random = np.random.default_rng(rows)
    x, t = random.random(rows), random.random(rows)
    exact = np.sin(np.pi * x) * (1 - np.exp(-3 * t))
    table(folder / "data.csv", {"x": x, "t": t, "v": exact + .01 * random.standard_normal(rows)})
    return "\n".join([
        "units: off;", "coordinates: x, t: time;", "fields: v;", "sources: q;", "domains: rod = 0 .. 1 times 0 .. 1;",
        "on inside in rod { balance: d(v, t) - 0.1 * d(v, x, 2) == q; }", "on samples { observe v; }",
    ])


def cloud(folder, sample, points):
    """A membrane's surface at any number of places, with 1 mm of noise, from the exact cloud of a sample."""
    from scipy.interpolate import LinearNDInterpolator
    raw = (sample.parent / f"{sample.stem}_cloud_0.ply").read_bytes()
    exact = np.frombuffer(raw[raw.index(b"end_header\n") + 11:], "<f4").reshape(-1, 3).astype(float)
    random = np.random.default_rng(points)
    at = random.uniform(exact[:, :2].min(0), exact[:, :2].max(0), (3 * points, 2))
    height = LinearNDInterpolator(exact[:, :2], exact[:, 2])(at)
    seen = np.column_stack([at, height])[np.isfinite(height)][:points]
    seen[:, 2] += 1e-3 * random.standard_normal(len(seen))
    np.save(folder / "cloud.npy", seen)
