/// A conductivity that varies, from a noisy field.
units: off;
coordinates: x, y;
fields: u;
sources: a;
domains: square = box(0 .. 1, 0 .. 1);
let known_a = 1 / (1 + x^2 + y^2 + (x - 1)^2 + (y - 1)^2);
let known_u = sin(pi * x) * sin(pi * y);
on inside in square { balance: div(a * grad(u)) == div(known_a * grad(known_u)); }
on edge boundary of square { known: a == known_a; }
on samples { observe u; }
