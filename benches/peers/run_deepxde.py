"""Times DeepXDE on the operators of `cargo bench --bench generic`: whole steps of its Adam, in double precision.

    pip install -r benches/peers/requirements.txt
    cargo bench --bench generic -- none | tee generic.txt
    python benches/peers/run_deepxde.py generic.txt

DeepXDE runs on JAX, the only one of its backends that needs no other large package, with its own network of three layers,
which has no gates and so less to do than ours. A step of ours is a gradient and an update, which at these sizes costs next to nothing.
With the table of the Rust benchmark as an argument, ratios to its generated code are printed. Compile time is not counted.
"""

import os
import sys
import time

from ours import rates_of_ours

os.environ["DDE_BACKEND"] = "jax"
try:
    import deepxde as dde
    import numpy as np
except ImportError as missing:
    print(f"skipped: {missing}; pip install -r benches/peers/requirements.txt")
    sys.exit(0)

POINTS, STEPS = 512, 20
dde.config.set_default_float("float64")


def combine(parts):
    """A weighted sum of (values, function) pairs, as DeepXDE's JAX backend carries derivatives."""
    value = sum(weight * part[0] for weight, part in parts)
    return value, lambda x: sum(weight * part[1](x) for weight, part in parts)


def second(u, x, i, j, component=0):
    return dde.grad.hessian(u, x, component=component, i=i, j=j)


def laplacian(u, x, inputs, component=0):
    return combine([(1.0, second(u, x, i, i, component)) for i in range(inputs)])


def power(u, x, times):
    for _ in range(times):
        u = laplacian(u, x, 2)
    return u[0]


def von_karman(x, u):
    slope = [dde.grad.jacobian(u, x, i=0, j=j)[0] for j in range(2)]
    bend = second(u, x, 0, 0)[0] * second(u, x, 1, 1)[0] - second(u, x, 0, 1)[0] ** 2
    return power(u, x, 2) + slope[0] * slope[1] + bend - 1.0


def elasticity(x, u):
    def row(i):
        along = [(2.0, second(u, x, i, j, component=j)) for j in range(3)]
        return combine([(0.7, laplacian(u, x, 3, component=i))] + along)[0] - 1.0

    return [row(i) for i in range(3)]


# name, inputs, outputs, residuals
OPERATORS = [
    ("1-D, order 2", 1, 1, lambda x, u: second(u, x, 0, 0)[0] - 1.0),
    ("2-D Laplacian", 2, 1, lambda x, u: power(u, x, 1) - 1.0),
    ("von Karman's w", 2, 1, von_karman),
    ("3-D elasticity", 3, 3, elasticity),
    ("2-D triharmonic", 2, 1, lambda x, u: power(u, x, 3) - 1.0),
]


def rate(inputs, outputs, residuals, width):
    """Points per second through a step, the best of five times STEPS."""
    low, high = [-1.0] * inputs, [1.0] * inputs
    shape = dde.geometry.Interval(-1.0, 1.0) if inputs == 1 else dde.geometry.Hypercube(low, high)
    data = dde.data.PDE(shape, residuals, [], num_domain=POINTS, num_boundary=0)
    model = dde.Model(data, dde.nn.FNN([inputs] + [width] * 3 + [outputs], "tanh", "Glorot normal"))
    model.compile("adam", lr=1e-3, verbose=0)
    best = np.inf
    for attempt in range(6):
        start = time.perf_counter()
        model.train(iterations=STEPS, display_every=10**9, verbose=0)
        # The first one compiles.
        best = min(best, (time.perf_counter() - start) / STEPS) if attempt else np.inf
    return POINTS / best


def main():
    generated = rates_of_ours(sys.argv)
    print(f"DeepXDE {dde.__version__} on JAX, f64, {POINTS} points\n")
    print("| operator | width | steps, points/s | generated over DeepXDE |\n|---|---|---|---|")
    for name, inputs, outputs, residuals in OPERATORS:
        for width in (32, 64, 256):
            found = rate(inputs, outputs, residuals, width)
            mine = generated.get((name, width))
            ratio = f"{mine / found:.1f}" if mine else "-"
            print(f"| {name} | {width} | {found:.3e} | {ratio} |", flush=True)


main()
