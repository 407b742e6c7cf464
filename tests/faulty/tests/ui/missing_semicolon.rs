nisp::pde! {
    mod missing_semicolon {
        coordinates: x [m];
        fields: u [m];
        let a = u + x
        let b = a * 2;
        on inside { balance: d(b, x) == 1; }
        on edge { fixed: u == 0; }
    }
}

fn main() {}
