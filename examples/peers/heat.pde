/// A conductivity that varies, from noisy temperatures that decay.
units: off;
coordinates: x, y, t: time;
fields: u;
sources: a(x, y);
domains: room = box(-1 .. 1, -1 .. 1) times 0 .. 1;
let S = sin(pi * x) * sin(pi * y);
let known_a = 2 + S;
on inside in room { balance: d(u, t) - div(a * grad(u)) == -exp(-t) * S - exp(-t) * div(known_a * grad(S)); }
on edge boundary of room { known: a == known_a; }
on samples { observe u; }
