/// Flow through a porous channel: its effective viscosity and its permeability, from the velocity.
units: off;
coordinates: x;
fields: u;
parameters: ve in 1e-4 .. 1e-1 = 1e-2, K in 1e-4 .. 1e-1 = 1e-2, nu = 1e-3, e = 0.4;
on inside { balance: -ve / e * d(u, x, 2) + nu * u / K == 1; }
on start { lower: u == 0; }
on end { upper: u == 0; }
on samples { observe u; }
scene identify { learn ve, K; }
