nisp::pde! {
    mod vector_plus_scalar {
        coordinates: x [m], y [m];
        fields: u: vector [m], v [m];
        on inside { balance: u + v == 0; }
    }
}

fn main() {}
