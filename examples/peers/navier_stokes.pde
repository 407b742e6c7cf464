/// A vortex that decays while a stream carries it: what multiplies convection and viscosity, from velocities alone.
units: off;
coordinates: x, y, t: time;
fields: u, v, p;
parameters: C1 = 0.5, C2 = 0.05 > 0;
domains: flow = box(0 .. pi, 0 .. pi) times 0 .. 1;
on inside in flow {
    along: d(u, t) + C1 * (u * d(u, x) + v * d(u, y)) == -d(p, x) + C2 * laplacian(u);
    across: d(v, t) + C1 * (u * d(v, x) + v * d(v, y)) == -d(p, y) + C2 * laplacian(v);
    mass: d(u, x) + d(v, y) == 0;
}
on samples { observe u, v; }
scene identify { learn C1, C2; }
