//! scratch
nisp::pde! {
    /// c
    pub mod rlc {
        coordinates: t [s];
        fields: v [V];
        sources: f [V];
        parameters: a [1/s] = 7, b [1/s^2] = 10, c [1/s] = 1, e [1/s^2] = 6, f0 [V] = 6;
        on circuit { balance: d(v, t, 2) + a * d(v, t) + b * v == c * d(f, t) + e * f; }
        on samples { observe v; }
        on start { known: f == f0; }
        scene recover { }
    }
}
nisp::pde! {
    /// c
    pub mod pendulum {
        coordinates: t [s];
        fields: q [m], psi [rad], phi [rad];
        sources: f [N];
        parameters: m0 [kg] > 0 = 0.005, m1 [kg] > 0 = 0.005, m2 [kg] > 0 = 0.005, l1 [m] > 0 = 0.5, l2 [m] > 0 = 0.5, g [m/s^2] = 9.81;
        let h1 = m0 + m1 + m2; let h2 = l1 * (m1 + m2); let h3 = l2 * m2; let h4 = l1^2 * (m1 + m2); let h5 = l1 * l2 * m2; let h6 = l2^2 * m2; let h7 = g * l1 * (m1 + m2); let h8 = g * l2 * m2;
        let dpsi = d(psi, t); let dphi = d(phi, t);
        on motion {
            cart: h1 * d(q, t, 2)
                - h2 * (d(psi, t, 2) * cos(psi) - dpsi^2 * sin(psi))
                - h3 * (d(phi, t, 2) * cos(phi) - dphi^2 * sin(phi)) == f;
            link_1: h4 * d(psi, t, 2) - h2 * d(q, t, 2) * cos(psi)
                + h5 * (d(phi, t, 2) * cos(psi - phi) + dphi^2 * sin(psi - phi)) == h7 * sin(psi);
            link_2: h6 * d(phi, t, 2) - h3 * d(q, t, 2) * cos(phi)
                + h5 * (d(psi, t, 2) * cos(psi - phi) - dpsi^2 * sin(psi - phi)) == h8 * sin(phi);
        }
        on samples { observe q, psi, phi; }
        scene recover { }
    }
}
use nisp::{Settings, Carrier, recover};
use std::time::{Duration, Instant};
fn main() {
    let args: Vec<String> = std::env::args().collect();
    let text = std::fs::read_to_string(&args[2]).unwrap();
    let mut cols: Vec<Vec<f64>> = vec![Vec::new(); 4];
    for line in text.lines().skip(1) { for (i, x) in line.split(',').enumerate() { cols[i].push(x.parse().unwrap()); } }
    let n = cols[0].len();
    let budget: f64 = args[3].parse().unwrap();
    let t = &cols[0];
    let last = t[n - 1];
    let eq: Vec<f64> = (0..300).map(|i| last * i as f64 / 299.0).collect();
    let now = Instant::now();
    let problem = if args[1] == "rlc" {
        rlc::recover::bind(rlc::recover::Parameters { a: 7.0, b: 10.0, c: 1.0, e: 6.0, f0: 6.0 }).circuit(&eq[..]).samples(&t[..], rlc::recover::SamplesData { v: cols[1].clone() }).start(&[0.0][..]).problem()
    } else {
        pendulum::recover::bind(pendulum::recover::Parameters { m0: 0.005, m1: 0.005, m2: 0.005, l1: 0.5, l2: 0.5, g: 9.81 }).motion(&eq[..]).samples(&t[..], pendulum::recover::SamplesData { q: cols[1].clone(), psi: cols[2].clone(), phi: cols[3].clone() }).problem()
    };
    let settings = Settings { budget: Some(Duration::from_secs_f64(budget)), carrier: if args.len() > 4 { Carrier::Splines } else { Carrier::Auto }, threads: 2, ..Settings::default() };
    let mut s = recover(&problem, &settings, &mut |_| nisp::solve::driver::Flow::Continue).unwrap();
    println!("recover {:.2} s, {:?} wall {:.2} steps {} loss {:.4e} {}", now.elapsed().as_secs_f64(), s.status, s.wall_s, s.iterations, s.loss, s.carrier_reason);
    for check in s.verdict.failed() { println!("  {}", check.message); }
    for term in s.terms() { println!("  {} rms {:.3e} noise {:?}", term.name, term.rms, term.noise); }
    let now = Instant::now();
    let e = s.evaluate_with_errors(&t[..]);
    println!("evaluate {:.2} s", now.elapsed().as_secs_f64());
    let truth: Vec<f64> = if args[1] == "rlc" {
        t.iter().map(|&t| if args[2].contains("dense") { 6.0 * (-3.0 * t).exp() } else { 3.0 * t.cos() + 1.5 * (2.7 * t).cos() + (6.3 * t).cos() + 0.5 * (11.0 * t).cos() }).collect()
    } else {
        std::fs::read_to_string(args[2].replace(".csv", "_truth.csv")).map_or(vec![0.0; n], |text| text.lines().skip(1).map(|line| line.split(',').nth(1).unwrap().parse().unwrap()).collect())
    };
    let f = e.iter().find(|h| h.name == "f").unwrap();
    let err: Vec<f64> = f.values.iter().zip(&truth).map(|(a, b)| a - b).collect();
    let rms = |x: &[f64]| (x.iter().map(|x| x * x).sum::<f64>() / x.len() as f64).sqrt();
    println!("  f off by {:.4e} of {:.4e}, inside {:.4e}; covered {:?}", rms(&err), rms(&truth), rms(&err[n / 10..n - n / 10]), f.deviations.as_ref().map(|d| err.iter().zip(d).filter(|(e, d)| e.abs() < 2.0 * **d).count() as f64 / n as f64));
    for h in &e { println!("  {} rms {:.4e} sd {:?}", h.name, (h.values.iter().map(|x| x * x).sum::<f64>() / n as f64).sqrt(), h.deviations.as_ref().map(|d| d[n / 2])); }
}
