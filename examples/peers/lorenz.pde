/// Lorenz's equations with all three coefficients unknown.
units: off;
coordinates: t;
fields: x, y, z;
parameters: C1 = 8, C2 = 10, C3 = 2;
on flow {
    first: d(x, t) == C1 * (y - x);
    second: d(y, t) == x * (C2 - z) - y;
    third: d(z, t) == x * y - C3 * z;
}
on samples { observe x, y, z; }
scene identify { learn C1, C2, C3; }
