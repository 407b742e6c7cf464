/// A damped spring that hardens, pulled by an unknown force.
coordinates: t [s];
fields: y [m];
sources: u [m/s^2];
parameters: c [1/s] = 0.4, k [1/s^2] = 4, h [1/(m^2 s^2)] = 3;
on motion { balance: d(y, t, 2) + c * d(y, t) + k * y + h * y^3 == u; }
on samples { observe y; }
scene recover { }
