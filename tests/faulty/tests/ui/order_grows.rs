nisp::pde! {
    mod order_grows {
        coordinates: x [m], y [m];
        fields: u [m];
        let a = biharmonic(u);
        on inside { balance: biharmonic(a) == 0; }
    }
}

fn main() {}
