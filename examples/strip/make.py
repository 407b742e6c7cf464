"""Temperatures T = 323 K + 12 K cos(10 pi x / m) with noise of 0.1 K, and the heat q that the equation asks of them."""
from math import cos, pi
from random import Random

random = Random(1)
places = [0.005 * i for i in range(41)]
with open("probes.csv", "w") as probes, open("truth.csv", "w") as truth:
    print("x,T", file=probes)
    print("x,q", file=truth)
    for x in places:
        wave = 12 * cos(10 * pi * x)
        print(f"{x:.3f},{323 + wave + random.gauss(0, 0.1):.3f}", file=probes)
        print(f"{x:.3f},{16 * 1e-3 * (10 * pi) ** 2 * wave + 2 * 15 * (30 + wave):.3f}", file=truth)
