nisp::pde! {
    mod heat {
        units: off;
        coordinates: x;
        fields: T;
        sources: q;
        on inside { balance: d(T, x, 2) == q; }
        on probes { observe T; }
        scene recover { }
    }
}

fn main() {
    let bound = heat::recover::bind(heat::recover::Parameters {}).inside(vec![0.0, 0.5, 1.0]);
    let _ = bound.problem();
}
