nisp::pde! {
    mod pascal_and_newton {
        coordinates: x [m];
        fields: p [Pa], f [N];
        on inside { balance: p + f == 0; }
    }
}

fn main() {}
