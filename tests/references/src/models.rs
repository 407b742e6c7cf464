//! Scenes, each beside its equations written by hand. Their kernels are built here, since `scene` is inlined nowhere: crates that
//! inlined it would each build them again.

// In two of them nothing is measured, which the macro warns of: they are differentiated here, and not solved.
#![allow(deprecated)]

use nisp::scene_in_both_precisions as scene;

use crate::dense_jet::Jet;
use crate::number::Number;
use crate::reference::{Data, Model, Point};

nisp::pde! {
    mod cart {
        units: off;
        coordinates: t;
        fields: q, psi;
        sources: f;
        parameters: m = 0.7, h = 0.4, g = 9.81;
        on motion {
            cart: m * d(q, t, 2) - h * (d(psi, t, 2) * cos(psi) - d(psi, t)^2 * sin(psi)) == f;
            link: h * d(psi, t, 2) - m * d(q, t, 2) * cos(psi) == h * g * sin(psi);
        }
        on samples { columns: late; observe q, psi; observe later: q + psi ~ late; }
        scene recover { }
    }
}

nisp::pde! {
    pub mod poisson {
        units: off;
        coordinates: x, y;
        fields: u;
        sources: s;
        domains:
            square = box(-1 .. 1, -1 .. 1), round = disc(0, 0, 2), three = polygon([0, 0], [1, 0], [0, 1]),
            strip = 0 .. 1 times -1 .. 3, holed = box(0 .. 2, 0 .. 2) plus disc(2, 1, 1) minus polygon("hole.csv");
        on inside in square { balance: laplacian(u) == s; }
        on rim boundary of round { held: u == x * y; }
        on corner in three { held: u == 1 within 5; }
        on early start of strip { held: u == 2 within 5; }
        on late end of strip { held: u == 3 within 5; }
        on around boundary of holed with 500 points { held: u == 4 within 5; }
        scene solve { only inside.balance, rim.held; }
        scene everywhere { }
    }
}

nisp::pde! {
    mod karman {
        units: off;
        coordinates: a, b;
        fields: u, v, w;
        sources: f;
        parameters: D = 0.3, C = 1.4, nu = 0.4, p = 2;
        let E_aa = d(u, a) + d(w, a)^2 / 2;
        let E_bb = d(v, b) + d(w, b)^2 / 2;
        let E_ab = (d(u, b) + d(v, a) + d(w, a) * d(w, b)) / 2;
        let N_a = C * (E_aa + nu * E_bb);
        let N_b = C * (E_bb + nu * E_aa);
        let N_ab = C * (1 - nu) * E_ab;
        on interior {
            balance: D * biharmonic(w)
                - (N_a * d(w, a, 2) + 2 * N_ab * d(w, a, b) + N_b * d(w, b, 2)) == p - f;
            inplane_a: d(N_a, a) + d(N_ab, b) == 0;
            inplane_b: d(N_ab, a) + d(N_b, b) == 0;
        }
        on rim { clamp: u == 0, v == 0, w == 0; no_contact: f == 0; }
        scene contact { }
    }
}

nisp::pde! {
    mod sponge {
        units: off;
        coordinates: x, y, z;
        fields: u: vector;
        sources: f in -1 .. 4;
        parameters: E in 0.5 .. 5 = 2, nu in 0.1 .. 0.45 = 0.3;
        let mu = E / (2 * (1 + nu));
        let lambda = E * nu / ((1 + nu) * (1 - 2 * nu));
        let eps = sym(grad(u));
        let sigma = lambda * tr(eps) * I + 2 * mu * eps;
        on volume { balance: div(sigma) + [0, 0, -1] == 0; }
        on surface {
            columns: n: vector;
            traction: sigma * n == -f * n with huber(0.4) weight 3;
            total: integral(f * dot(n, n)) == E * nu;
        }
        scene identify { learn E, nu; }
    }
}

nisp::pde! {
    mod triharmonic {
        units: off;
        coordinates: x, y;
        fields: w;
        on inside { balance: laplacian(laplacian(laplacian(w))) == sin(x); }
        on rim { held: w == 0; slope: d(w, x) == 0; bent: laplacian(w) == 0; }
        on seam pairs { kink: d(laplacian(laplacian(w)), x) == partner(d(laplacian(laplacian(w)), x)); }
        on whole { flux: integral(laplacian(laplacian(laplacian(w)))) == 1; }
        scene solve { }
    }
}

nisp::pde! {
    mod heat {
        units: off;
        coordinates: x, t;
        fields: T;
        sources: q;
        parameters: k = 0.7;
        on inside { balance: d(T, t) == d(k * d(T, x) * (1 + T^2), x) + q; }
        on probes { observe T with welsch(0.8) weight 2; }
        on whole { energy: integral(T * q) == 1.5 * k; }
        scene recover { learn k; }
    }
}

nisp::pde! {
    mod shape {
        units: off;
        coordinates: a, b;
        fields: u, w;
        on patch {
            cloud: symmetric chamfer [a + u, b + u * w, w] with huber(0.3) weight 2;
            flat: laplacian(w) == 0;
        }
        on line { cloud: chamfer [a + w, u] with tukey(0.9); }
        scene fit { }
    }
}

nisp::pde! {
    mod ring {
        units: off;
        coordinates: x, y;
        fields: u, v;
        parameters: k = 0.8;
        on inside { balance: laplacian(u) + k * v == sin(x); }
        on seam pairs {
            columns: jump;
            value: u == partner(u) + jump * v, v == k * partner(v);
            slope: d(u, x) == partner(d(u, x)) * partner(x);
        }
        scene wrap { learn k; }
    }
}

nisp::pde! {
    mod held {
        units: off;
        coordinates: x, y;
        fields: w;
        sources: s;
        hard w = x * y by 1 - x^2 - y^2;
        on inside { balance: laplacian(w) == s; }
        on samples { observe w; }
        scene solve { }
    }
}

nisp::pde! {
    mod partial {
        units: off;
        coordinates: x, t;
        fields: u, a(x);
        sources: r(t), c;
        on inside { balance: d(u, t) + d(a, t) == d(a * d(u, x), x) + r * c + d(r, t); }
        on seam pairs { both: a == r * partner(a) + partner(r * u); }
        on probes { observe u; }
        scene solve { }
    }
}

nisp::pde! {
    pub mod solids {
        units: off;
        coordinates: x, y, z;
        fields: u;
        domains: drum = cylinder(0, 1, 2, -1 .. 3) minus ball(0, 1, 0, 0.5), part = solid("part.stl");
        on inside in drum { balance: laplacian(u) == 1; }
        on rim boundary of part { held: u == 0; }
        scene solve { }
    }
}

/// Points that fill a box evenly: multiples of the golden ratio's generalisation (Roberts).
fn scatter(count: usize, dimension: usize, low: f64, high: f64) -> Vec<f64> {
    let ratio = (0..60).fold(2.0_f64, |g, _| (1.0 + g).powf(1.0 / (dimension as f64 + 1.0)));
    let step = |i: usize| ratio.powi(-(i as i32 + 1));
    (1..=count).flat_map(|n| (0..dimension).map(move |i| low + (high - low) * (n as f64 * step(i)).fract())).collect()
}

fn wave(count: usize, rate: f64) -> Vec<f64> {
    (0..count).map(|i| (i as f64 * rate).sin()).collect()
}

fn group(name: &'static str, points: Vec<f64>) -> Data {
    Data { name, points, ..Data::default() }
}

/// A pendulum on a cart, two equations of the second order that are linked.
pub struct Cart;

impl Model for Cart {
    const ORDER: usize = 2;
    #[inline(never)]
    fn scene(&self) -> nisp::SceneRef {
        scene::<cart::recover::Scene>()
    }
    fn groups(&self) -> Vec<Data> {
        let columns = vec![wave(37, 0.3), wave(37, 0.2), wave(37, 0.5)];
        vec![group("motion", scatter(101, 1, 0.5, 3.5)), Data { columns, ..group("samples", scatter(37, 1, 0.5, 3.5)) }]
    }
    fn rows<T: Number>(&self, group: &str, at: &Point<'_, '_, T>) -> Vec<T> {
        let [q, psi, f] = [0, 1, 2].map(|head| at.heads[head].value());
        if group == "samples" {
            // Columns in the scene's order: declared, then observed.
            return vec![q - T::of(at.columns[1]), psi - T::of(at.columns[2]), q + psi - T::of(at.columns[0])];
        }
        let [m, h, g] = [0.7, 0.4, 9.81].map(T::of);
        let (q_tt, psi_t, psi_tt) = (at.d(0, &[2]), at.d(1, &[1]), at.d(1, &[2]));
        vec![
            m * q_tt - h * (psi_tt * psi.cos() - psi_t * psi_t * psi.sin()) - f,
            h * psi_tt - m * q_tt * psi.cos() - h * g * psi.sin(),
        ]
    }
}

/// Poisson's equation, and conditions in domains of every kind.
pub struct Poisson;

impl Model for Poisson {
    const ORDER: usize = 2;
    #[inline(never)]
    fn scene(&self) -> nisp::SceneRef {
        scene::<poisson::solve::Scene>()
    }
    fn groups(&self) -> Vec<Data> {
        vec![group("inside", scatter(75, 2, -2.0, 3.0)), group("rim", scatter(22, 2, -2.0, 3.0))]
    }
    fn rows<T: Number>(&self, group: &str, at: &Point<'_, '_, T>) -> Vec<T> {
        match group {
            "rim" => vec![at.heads[0].value() - T::of(at.x[0] * at.x[1])],
            _ => vec![at.heads[0].laplacian(2).value() - at.heads[1].value()],
        }
    }
}

/// Von Karman's plate: three fields, products of their derivatives.
pub struct Karman;

impl Model for Karman {
    const ORDER: usize = 4;
    #[inline(never)]
    fn scene(&self) -> nisp::SceneRef {
        scene::<karman::contact::Scene>()
    }
    fn groups(&self) -> Vec<Data> {
        vec![group("interior", scatter(70, 2, -1.0, 1.5)), group("rim", scatter(19, 2, -1.0, 1.5))]
    }
    fn rows<T: Number>(&self, group: &str, at: &Point<'_, '_, T>) -> Vec<T> {
        if group == "rim" {
            return at.heads.iter().map(|head| head.value()).collect();
        }
        let [d, c, nu] = [0.3, 1.4, 0.4].map(T::of);
        let [u, v, w, f] = [0, 1, 2, 3].map(|head| at.heads[head].clone());
        let half = T::of(0.5);
        let e_aa = u.by(0) + (w.by(0) * w.by(0)).scale(half);
        let e_bb = v.by(1) + (w.by(1) * w.by(1)).scale(half);
        let e_ab = (u.by(1) + v.by(0) + w.by(0) * w.by(1)).scale(half);
        let n_a = (e_aa.clone() + e_bb.clone().scale(nu)).scale(c);
        let n_b = (e_bb + e_aa.scale(nu)).scale(c);
        let n_ab = e_ab.scale(c * (T::of(1.0) - nu));
        let tension = n_a.value() * at.d(2, &[2, 0])
            + T::of(2.0) * n_ab.value() * at.d(2, &[1, 1])
            + n_b.value() * at.d(2, &[0, 2]);
        vec![
            d * w.laplacian(2).laplacian(2).value() - tension - T::of(2.0) + f.value(),
            n_a.by(0).value() + n_ab.by(1).value(),
            n_ab.by(0).value() + n_b.by(1).value(),
        ]
    }
}

/// An elastic body in space: vectors, tensors, learned moduli.
pub struct Sponge;

impl Model for Sponge {
    const ORDER: usize = 2;
    #[inline(never)]
    fn scene(&self) -> nisp::SceneRef {
        scene::<sponge::identify::Scene>()
    }
    fn groups(&self) -> Vec<Data> {
        let normals = vec![wave(29, 0.3), wave(29, 0.7), wave(29, 1.1)];
        let surface = group("surface", scatter(29, 3, 0.0, 2.0));
        let weights = (0..29).map(|i| 0.02 + 0.001 * f64::from(i)).collect();
        vec![group("volume", scatter(53, 3, 0.0, 2.0)), Data { columns: normals, weights, ..surface }]
    }
    fn learned<T: Number>(&self, theta: &[T]) -> Vec<T> {
        let between = |theta: T, low: f64, start: f64, high: f64| {
            let shift = ((start - low) / (high - start)).ln();
            T::of(low) + T::of(high - low) / ((-(theta + T::of(shift))).exp() + T::of(1.0))
        };
        vec![between(theta[0], 0.5, 2.0, 5.0), between(theta[1], 0.1, 0.3, 0.45)]
    }
    fn rows<T: Number>(&self, group: &str, at: &Point<'_, '_, T>) -> Vec<T> {
        let (one, two) = (T::of(1.0), T::of(2.0));
        let [e, nu] = [at.learned[0], at.learned[1]];
        let mu = e / (two * (one + nu));
        let lambda = e * nu / ((one + nu) * (one - two * nu));
        let u = &at.heads[..3];
        let trace = u[0].by(0) + u[1].by(1) + u[2].by(2);
        let sigma = |i: usize, j: usize| {
            let shear = (u[i].by(j) + u[j].by(i)).scale(mu);
            if i == j { shear + trace.clone().scale(lambda) } else { shear }
        };
        if group == "volume" {
            let load = [0.0, 0.0, -1.0];
            let balance = |i: usize| (0..3).fold(T::of(load[i]), |sum, j| sum + sigma(i, j).by(j).value());
            return (0..3).map(balance).collect();
        }
        let n: Vec<T> = at.columns.iter().map(|&n| T::of(n)).collect();
        let f = T::of(-1.0) + T::of(5.0) / ((-at.heads[3].value()).exp() + one);
        let traction = |i: usize| (0..3).fold(f * n[i], |sum, j| sum + sigma(i, j).value() * n[j]);
        let square = n[0] * n[0] + n[1] * n[1] + n[2] * n[2];
        vec![traction(0), traction(1), traction(2), f * square]
    }
    fn target<T: Number>(&self, _: usize, learned: &[T]) -> T {
        learned[0] * learned[1]
    }
}

/// Derivatives of the sixth order, pairs of points, an integral.
pub struct Triharmonic;

impl Model for Triharmonic {
    const ORDER: usize = 6;
    #[inline(never)]
    fn scene(&self) -> nisp::SceneRef {
        scene::<triharmonic::solve::Scene>()
    }
    fn groups(&self) -> Vec<Data> {
        let seam = Data { partners: scatter(15, 2, -0.9, 0.8), ..group("seam", scatter(15, 2, -1.0, 1.0)) };
        let whole = Data { weights: vec![0.05; 20], ..group("whole", scatter(20, 2, -1.0, 1.0)) };
        vec![group("inside", scatter(45, 2, -1.0, 1.0)), group("rim", scatter(9, 2, -1.0, 1.0)), seam, whole]
    }
    fn rows<T: Number>(&self, group: &str, at: &Point<'_, '_, T>) -> Vec<T> {
        let w = &at.heads[0];
        let fifth = |w: &Jet<'_, T>| w.laplacian(2).laplacian(2).by(0).value();
        let sixth = w.laplacian(2).laplacian(2).laplacian(2).value();
        match group {
            "rim" => vec![w.value(), w.by(0).value(), w.laplacian(2).value()],
            "seam" => vec![fifth(w) - fifth(&at.partner[0])],
            "whole" => vec![sixth],
            _ => vec![sixth - T::of(at.x[0].sin())],
        }
    }
    fn target<T: Number>(&self, _: usize, _: &[T]) -> T {
        T::of(1.0)
    }
}

/// A conductivity that goes with the temperature, a robust loss, a learned factor.
pub struct Heat;

impl Model for Heat {
    const ORDER: usize = 2;
    #[inline(never)]
    fn scene(&self) -> nisp::SceneRef {
        scene::<heat::recover::Scene>()
    }
    fn groups(&self) -> Vec<Data> {
        let probes = group("probes", scatter(31, 2, 0.0, 1.0));
        let whole = group("whole", scatter(40, 2, 0.0, 1.0));
        vec![
            group("inside", scatter(60, 2, 0.0, 1.0)),
            Data { columns: vec![wave(31, 0.9)], ..probes },
            Data { weights: vec![0.025; 40], ..whole },
        ]
    }
    fn learned<T: Number>(&self, theta: &[T]) -> Vec<T> {
        vec![T::of(0.7) * theta[0].exp()]
    }
    fn rows<T: Number>(&self, group: &str, at: &Point<'_, '_, T>) -> Vec<T> {
        let (temperature, q) = (at.heads[0].clone(), at.heads[1].value());
        match group {
            "probes" => vec![temperature.value() - T::of(at.columns[0])],
            "whole" => vec![temperature.value() * q],
            _ => {
                let slope = temperature.by(0);
                let rising = temperature.clone() * temperature.clone();
                let flux = (slope * rising.shift(T::of(1.0))).scale(at.learned[0]);
                vec![temperature.by(1).value() - flux.by(0).value() - q]
            }
        }
    }
    fn target<T: Number>(&self, _: usize, learned: &[T]) -> T {
        T::of(1.5) * learned[0]
    }
}

/// A surface and its cloud.
pub struct Shape;

impl Model for Shape {
    const ORDER: usize = 2;
    #[inline(never)]
    fn scene(&self) -> nisp::SceneRef {
        scene::<shape::fit::Scene>()
    }
    fn groups(&self) -> Vec<Data> {
        // More and fewer points than the surfaces have, some far away.
        vec![
            Data { cloud: scatter(130, 3, -0.6, 1.7), ..group("patch", scatter(48, 2, 0.0, 1.0)) },
            Data { cloud: scatter(9, 2, 0.0, 1.2), ..group("line", scatter(21, 2, 0.0, 1.0)) },
        ]
    }
    fn rows<T: Number>(&self, group: &str, at: &Point<'_, '_, T>) -> Vec<T> {
        let [a, b] = [0, 1].map(|i| T::of(at.x[i]));
        let [u, w] = [0, 1].map(|head| at.heads[head].value());
        match group {
            "line" => vec![a + w, u],
            _ => vec![a + u, b + u * w, w, at.heads[1].laplacian(2).value()],
        }
    }
}

/// Points in pairs, whose equations read both.
pub struct Ring;

impl Model for Ring {
    const ORDER: usize = 2;
    #[inline(never)]
    fn scene(&self) -> nisp::SceneRef {
        scene::<ring::wrap::Scene>()
    }
    fn groups(&self) -> Vec<Data> {
        let left: Vec<f64> = (0..23).flat_map(|i| [-1.0, i as f64 * 0.1]).collect();
        let right = left.chunks_exact(2).flat_map(|p| [1.0, p[1] + 0.05]).collect();
        let seam = Data { partners: right, columns: vec![wave(23, 0.4)], ..group("seam", left) };
        vec![group("inside", scatter(60, 2, -1.0, 1.0)), seam]
    }
    fn learned<T: Number>(&self, theta: &[T]) -> Vec<T> {
        vec![T::of(0.8) * theta[0].exp()]
    }
    fn rows<T: Number>(&self, group: &str, at: &Point<'_, '_, T>) -> Vec<T> {
        let [u, v] = [0, 1].map(|head| at.heads[head].clone());
        if group == "inside" {
            return vec![u.laplacian(2).value() + at.learned[0] * v.value() - T::of(at.x[0].sin())];
        }
        let [u_far, v_far] = [0, 1].map(|head| at.partner[head].clone());
        vec![
            u.value() - u_far.value() - T::of(at.columns[0]) * v.value(),
            v.value() - at.learned[0] * v_far.value(),
            // Partners lie on the line x = 1.
            u.by(0).value() - u_far.by(0).value(),
        ]
    }
}

/// A field that is what it has to be on a boundary.
pub struct Held;

impl Model for Held {
    const ORDER: usize = 2;
    #[inline(never)]
    fn scene(&self) -> nisp::SceneRef {
        scene::<held::solve::Scene>()
    }
    fn groups(&self) -> Vec<Data> {
        let samples = Data { columns: vec![wave(25, 0.6)], ..group("samples", scatter(25, 2, -1.0, 1.0)) };
        vec![group("inside", scatter(60, 2, -1.0, 1.0)), samples]
    }
    fn rows<T: Number>(&self, group: &str, at: &Point<'_, '_, T>) -> Vec<T> {
        let [x, y] = [0, 1].map(|i| T::of(at.x[i]));
        let distance = T::of(1.0) - x * x - y * y;
        let inner = &at.heads[0];
        if group == "samples" {
            return vec![x * y + distance * inner.value() - T::of(at.columns[0])];
        }
        // The product rule, by hand; x y is harmonic.
        let along = x * inner.by(0).value() + y * inner.by(1).value();
        let laplacian = distance * inner.laplacian(2).value() - T::of(4.0) * (along + inner.value());
        vec![laplacian - at.heads[1].value()]
    }
}

/// Fields and sources of some of the coordinates.
pub struct Partial;

impl Model for Partial {
    const ORDER: usize = 2;
    #[inline(never)]
    fn scene(&self) -> nisp::SceneRef {
        scene::<partial::solve::Scene>()
    }
    fn held(&self, head: usize) -> &'static [usize] {
        [&[] as &[usize], &[1], &[0], &[]][head]
    }
    fn groups(&self) -> Vec<Data> {
        let seam = Data { partners: scatter(17, 2, -0.8, 0.9), ..group("seam", scatter(17, 2, -1.0, 1.5)) };
        let probes = Data { columns: vec![wave(25, 0.6)], ..group("probes", scatter(25, 2, -1.0, 1.0)) };
        vec![group("inside", scatter(60, 2, -1.0, 1.0)), seam, probes]
    }
    fn rows<T: Number>(&self, group: &str, at: &Point<'_, '_, T>) -> Vec<T> {
        let [u, a, r, c] = [0, 1, 2, 3].map(|head| at.heads[head].clone());
        match group {
            "probes" => vec![u.value() - T::of(at.columns[0])],
            "seam" => {
                let [far_u, far_a, far_r] = [0, 1, 2].map(|head| at.partner[head].value());
                vec![a.value() - r.value() * far_a - far_r * far_u]
            }
            // The product rule, by hand: `a` has no derivative by time.
            _ => {
                let flux = a.by(0).value() * u.by(0).value() + a.value() * at.d(0, &[2, 0]);
                vec![u.by(1).value() - flux - r.value() * c.value() - r.by(1).value()]
            }
        }
    }
}

/// Runs a generic check on every model.
#[macro_export]
macro_rules! each_model {
    ($check:ident!) => {
        $check!(&$crate::models::Cart);
        $check!(&$crate::models::Poisson);
        $check!(&$crate::models::Karman);
        $check!(&$crate::models::Sponge);
        $check!(&$crate::models::Triharmonic);
        $check!(&$crate::models::Heat);
        $check!(&$crate::models::Shape);
        $check!(&$crate::models::Ring);
        $check!(&$crate::models::Held);
        $check!(&$crate::models::Partial);
    };
    ($check:ident) => {
        $check(&$crate::models::Cart);
        $check(&$crate::models::Poisson);
        $check(&$crate::models::Karman);
        $check(&$crate::models::Sponge);
        $check(&$crate::models::Triharmonic);
        $check(&$crate::models::Heat);
        $check(&$crate::models::Shape);
        $check(&$crate::models::Ring);
        $check(&$crate::models::Held);
        $check(&$crate::models::Partial);
    };
}
