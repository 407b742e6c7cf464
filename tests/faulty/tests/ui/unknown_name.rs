nisp::pde! {
    mod unknown_name {
        coordinates: x [m];
        fields: u [m];
        parameters: lambda [m];
        on inside { balance: u == lamda; }
    }
}

fn main() {}
