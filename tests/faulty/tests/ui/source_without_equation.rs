nisp::pde! {
    mod source_without_equation {
        coordinates: x [m];
        fields: u [m];
        sources: f [m];
        on inside { balance: u == x; }
    }
}

fn main() {}
