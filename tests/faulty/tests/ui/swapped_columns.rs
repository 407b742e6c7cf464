nisp::pde! {
    mod heat {
        units: off;
        coordinates: x;
        fields: T;
        sources: q;
        on inside { balance: d(T, x, 2) == q; }
        on edge {
            columns: gain, air;
            cooled: d(T, x) == gain * (T - air), T == air;
        }
        scene solve { }
    }
}

fn main() {
    let (gain, air) = (vec![2.0, 2.0], vec![293.0, 293.0]);
    let bound = heat::solve::bind(heat::solve::Parameters {}).inside(vec![0.0, 0.5, 1.0]);
    let _ = bound.edge(vec![0.0, 1.0], air, gain);
}
