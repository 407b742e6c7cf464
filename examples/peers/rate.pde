/// A rate of reaction along a line, from the field that diffuses and reacts.
units: off;
coordinates: x;
fields: u;
sources: k;
parameters: l = 0.01;
on inside { balance: l * d(u, x, 2) - k * u == sin(2 * pi * x); }
on start { left: u == 0; }
on end { right: u == 0; }
on samples { observe u; }
