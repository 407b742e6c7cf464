"""Times JAX on the operators of `cargo bench --bench generic`: gradient of the mean squared operator, same network.

    pip install -r benches/peers/requirements.txt
    cargo bench --bench generic -- none | tee generic.txt
    python benches/peers/run.py generic.txt

The network is the gated one with three layers, on 512 points, in double precision. `nested` differentiates `jax.grad`
and `jax.hessian` again; `jet` propagates Taylor series along as few directions as give the operator exactly. With the
table of the Rust benchmark as an argument, ratios to its generated code are printed. Compile time is not counted.
"""

import math
import sys
import time

from ours import rates_of_ours

try:
    import jax
    import jax.numpy as jnp
    from jax.experimental.jet import jet
except ImportError as missing:
    print(f"skipped: {missing}; pip install -r benches/peers/requirements.txt")
    sys.exit(0)

jax.config.update("jax_enable_x64", True)

LAYERS, POINTS, BUDGET = 3, 512, 1.0


def parameters(inputs, outputs, width, key):
    """Glorot-normal weights: first layer, two gates, hidden layers, heads."""
    shapes = [(inputs, width)] * 3 + [(width, width)] * (LAYERS - 1) + [(width, outputs)]
    keys = jax.random.split(key, len(shapes))
    return [
        (jax.random.normal(k, shape) * math.sqrt(2.0 / sum(shape)), jnp.zeros(shape[1]))
        for k, shape in zip(keys, shapes)
    ]


def network(theta, x):
    first, c, d = (jnp.tanh(x @ w + b) for w, b in theta[:3])
    z = c * first + d * (1 - first)
    for w, b in theta[3:-1]:
        z = jnp.tanh(z @ w + b)
        z = c * z + d * (1 - z)
    w, b = theta[-1]
    return z @ w + b


def laplacian_nested(f):
    return lambda x: jnp.trace(jax.hessian(f)(x))


def power_nested(f, power):
    for _ in range(power):
        f = laplacian_nested(f)
    return f


def directional(f, x, direction, order):
    """The derivative of this order along a direction, by Taylor arithmetic."""
    series = [direction] + [jnp.zeros_like(x)] * (order - 1)
    return jet(f, (x,), (series,))[1][order - 1]


def power_jet(f, x, power):
    """The Laplacian's power in the plane: a mean of directional derivatives over `power + 1` directions."""
    angles = [math.pi * j / (power + 1) for j in range(power + 1)]
    total = sum(directional(f, x, jnp.array([math.cos(a), math.sin(a)]), 2 * power) for a in angles)
    return total * 4**power / math.comb(2 * power, power) / (power + 1)


def monge_ampere(gradient, hessian):
    return gradient[0] * gradient[1] + hessian[0, 0] * hessian[1, 1] - hessian[0, 1] ** 2


def navier(hessians):
    """mu Laplacian u + (lambda + mu) grad div u, from the Hessian of every component."""
    return 0.7 * jnp.trace(hessians, axis1=1, axis2=2) + 2.0 * jnp.einsum("iji->j", hessians)


def scalar(u):
    return lambda x: u(x)[0]


def hessians_jet(u, x):
    """Second derivatives from directional ones by polarisation."""
    n = x.size
    axes = jnp.eye(n)
    along = lambda v: directional(u, x, v, 2)
    diagonal = [along(axes[i]) for i in range(n)]
    entry = lambda i, j: diagonal[i] if i == j else (along(axes[i] + axes[j]) - diagonal[i] - diagonal[j]) / 2
    return jnp.moveaxis(jnp.array([[entry(min(i, j), max(i, j)) for j in range(n)] for i in range(n)]), -1, 0)


# name, inputs, outputs, nested, jet
OPERATORS = [
    ("1-D, order 2", 1, 1, lambda u, x: power_nested(scalar(u), 1)(x), lambda u, x: directional(scalar(u), x, jnp.ones(1), 2)),
    ("2-D Laplacian", 2, 1, lambda u, x: power_nested(scalar(u), 1)(x), lambda u, x: power_jet(scalar(u), x, 1)),
    (
        "von Karman's w", 2, 1,
        lambda u, x: power_nested(scalar(u), 2)(x) + monge_ampere(jax.grad(scalar(u))(x), jax.hessian(scalar(u))(x)),
        lambda u, x: power_jet(scalar(u), x, 2) + monge_ampere(jax.grad(scalar(u))(x), hessians_jet(u, x)[0]),
    ),
    ("3-D elasticity", 3, 3, lambda u, x: navier(jax.hessian(u)(x)), lambda u, x: navier(hessians_jet(u, x))),
    ("2-D triharmonic", 2, 1, lambda u, x: power_nested(scalar(u), 3)(x), lambda u, x: power_jet(scalar(u), x, 3)),
]


def rate(operator, theta, points):
    """Points per second of the loss's gradient, best of many."""
    residual = lambda theta, x: operator(lambda x: network(theta, x), x) - 1.0
    loss = lambda theta: jnp.mean(jax.vmap(lambda x: jnp.sum(residual(theta, x) ** 2))(points))
    step = jax.jit(jax.grad(loss))
    jax.block_until_ready(step(theta))
    best, begin = math.inf, time.perf_counter()
    while time.perf_counter() - begin < BUDGET:
        start = time.perf_counter()
        jax.block_until_ready(step(theta))
        best = min(best, time.perf_counter() - start)
    return len(points) / best


def main():
    generated = rates_of_ours(sys.argv)
    print(f"jax {jax.__version__}, {jax.devices()[0]}, f64, {POINTS} points\n")
    print("| operator | width | nested grad, points/s | jet, points/s | generated over nested | generated over jet |")
    print("|---|---|---|---|---|---|")
    for name, inputs, outputs, nested, by_jet in OPERATORS:
        points = jax.random.uniform(jax.random.key(1), (POINTS, inputs), minval=-1.0, maxval=1.0)
        for width in (32, 64, 256):
            theta = parameters(inputs, outputs, width, jax.random.key(0))
            probe = lambda operator: operator(lambda x: network(theta, x), points[0])
            assert jnp.allclose(probe(nested), probe(by_jet), rtol=1e-8, atol=1e-10), name
            rates = [rate(operator, theta, points) for operator in (nested, by_jet)]
            mine = generated.get((name, width))
            ratios = [f"{mine / r:.1f}" if mine else "-" for r in rates]
            print(f"| {name} | {width} | {rates[0]:.3e} | {rates[1]:.3e} | {ratios[0]} | {ratios[1]} |", flush=True)


main()
