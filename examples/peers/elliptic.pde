/// A source along a line, from the field that it makes.
units: off;
coordinates: x;
fields: u;
sources: q;
on inside { balance: d(u, x, 2) == q; }
on start { left: u == 0; }
on end { right: u == 0; }
on samples { observe u; }
