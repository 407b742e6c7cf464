/// Two substances that diffuse into a layer and react there: how fast, from both concentrations.
units: off;
coordinates: x, t: time;
fields: a, b;
parameters: kf = 0.05, D = 1;
domains: layer = 0 .. 1 times 0 .. 10;
on inside in layer with 3000 points {
    first: d(a, t) - 1e-3 * D * d(a, x, 2) == -kf * a * b^2;
    second: d(b, t) - 1e-3 * D * d(b, x, 2) == -2 * kf * a * b^2;
}
on ends boundary of layer { held: a == 1 - x; held_too: b == 1 - x; }
on begin start of layer { known: a == exp(-20 * x); known_too: b == exp(-20 * x); }
on samples { observe a, b; }
scene identify { learn kf, D; }
