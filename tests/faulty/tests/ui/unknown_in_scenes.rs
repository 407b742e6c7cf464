nisp::pde! {
    mod unknown_in_scenes {
        coordinates: x [m];
        fields: u [m];
        sources: f [m];
        parameters: E = 2;
        constants: k = 3;
        on inside { balance: u * E * k == f; }
        on edge { fixed: u == 0; }
        scene one { without insid.balance; only edge.fixd; weight edge.none = 2; }
        scene two { learn EE; learn u; learn k; learn x; }
        scene three { k = 2; g = 3; f = u; f == 0; }
        scene four { E = 2; learn E; E = 3; f = 0; f = 0; }
    }
}

fn main() {}
