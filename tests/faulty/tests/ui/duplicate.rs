nisp::pde! {
    mod duplicate {
        coordinates: x [m];
        fields: u [m], u [m];
        parameters: x [s];
        on inside { balance: u == x; }
    }
}

fn main() {}
