nisp::pde! {
    mod strict_inequality {
        coordinates: x [m];
        fields: u [m];
        on inside { balance: u < x; other: u == x; }
    }
}

fn main() {}
