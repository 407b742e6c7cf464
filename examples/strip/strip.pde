/// A steel strip that leaks heat to the air on both sides, and how strongly it is heated along its length.
coordinates: x [m];
fields: T [K];
sources: q [W/m^2];
parameters:
    k [W/(m K)] = 16,     // conductivity
    d [m] = 1e-3,         // thickness
    h [W/(m^2 K)] = 15,   // heat to the air, on each side
    T_air [K] = 293;
domains: strip = 0 .. 0.2;
on inside in strip { balance: -k * d * d(T, x, 2) + 2 * h * (T - T_air) == q; }
on ends boundary of strip { insulated: d(T, x) == 0; }
on probes { observe T; }
