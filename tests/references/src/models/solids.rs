//! Domains in space, and one from a file; of this scene only the schema is read.

nisp::pde! {
    pub mod solids {
        units: off;
        coordinates: x, y, z;
        fields: u;
        domains: drum = cylinder(0, 1, 2, -1 .. 3) minus ball(0, 1, 0, 0.5), part = solid("part.stl");
        on inside in drum { balance: laplacian(u) == 1; }
        on rim boundary of part { held: u == 0; }
        scene solve { }
    }
}
