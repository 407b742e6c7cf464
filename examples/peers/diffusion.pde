/// A diffusivity, from temperatures at one time.
units: off;
coordinates: x, t: time;
fields: u;
parameters: C = 2;
domains: bar = -1 .. 1 times 0 .. 1;
on inside in bar { balance: d(u, t) - C * d(u, x, 2) == -exp(-t) * (sin(pi * x) - pi^2 * sin(pi * x)); }
on ends boundary of bar { held: u == 0; }
on begin start of bar { known: u == sin(pi * x); }
on samples { observe u; }
scene identify { learn C; }
