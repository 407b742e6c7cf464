nisp::pde! {
    mod sine_of_metres {
        coordinates: x [m];
        fields: u [m];
        parameters: l [m];
        on inside { balance: u == l * sin(x) + l * exp(x / l) + l * cos(u * x / l); }
    }
}

fn main() {}
