nisp::pde! {
    mod two_mistakes_and_a_good_term {
        coordinates: x [m];
        fields: u [m];
        on inside {
            first: u == * x;
            second: u == y;
            third: u == x;
        }
    }
}

fn main() {}
