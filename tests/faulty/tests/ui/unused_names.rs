#![deny(deprecated)]

nisp::pde! {
    mod unused_names {
        coordinates: x [m], y [m];
        fields: u [m], v [m];
        parameters: k [m];
        let a = x;
        on inside { columns: n; let b = x; balance: u == x; }
    }
}

fn main() {}
