/// A body that an unknown heater warms while it cools.
mod NAME {
    coordinates:
        /// time
        t [s];
    fields:
        /// temperature above that of the room
        T [K];
    sources:
        /// power of the heater
        P [W];
    parameters:
        /// heat capacity
        C [J/K] > 0 = 420,
        /// heat lost to the room
        h [W/K] > 0 = 1.2;

    on body { balance: C * d(T, t) + h * T == P; }
    on samples { observe T; }
    on start { cold: T == 0; }
}
