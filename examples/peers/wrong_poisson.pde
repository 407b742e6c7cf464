/// The same as `poisson.pde`, with a sign wrong in the source, as its program has it: (2x + 1) for (2x - 1).
units: off;
coordinates: x, y;
fields: u;
sources: a;
domains: square = box(0 .. 1, 0 .. 1);
let known_a = 1 / (1 + x^2 + y^2 + (x - 1)^2 + (y - 1)^2);
let known_u = sin(pi * x) * sin(pi * y);
let slope_x = -2 * known_a^2 * (2 * x + 1);
let slope_y = -2 * known_a^2 * (2 * y + 1);
on inside in square {
    balance: div(a * grad(u)) == slope_x * d(known_u, x) + slope_y * d(known_u, y) + known_a * laplacian(known_u);
}
on edge boundary of square { known: a == known_a; }
on samples { observe u; }
