nisp::pde! {
    pub mod bar {
        coordinates: x [m];
        fields: u [m];
        sources: f [N];
        parameters: E [Pa], A [m^2];
        on inside { balance: E * d(u, x, 2) == f / A; }
        on samples { observe u; }
        scene recover { }
    }
}

fn main() {
    // What the macro would have declared is declared, so that nothing else is at fault.
    let _ = nisp::scene::<bar::recover::Scene>();
}
