//! Results for tests: a disc with a pad, four pairs of modes of which two couple, as in Hoffmann's model.

use std::f64::consts::{PI, TAU};

use num_complex::Complex64;

use super::{About, ContactFaces, Kind, ModeData, Pair, Part, Results, Shape, Source, Surface, Value};
use crate::equilibrium::{Counts, Iteration, PairForces, Step};
use crate::stability::{Count, CountedBy, Sensitivity, Share};
use crate::tracking::{Branch, Diagram, Hopf, Partner, Point};

/// A title with markup, which the page must not run.
pub const TITLE: &str = "disc & pad </script><script>alert(1)</script>";

/// Two modes that couple: `lambda = -damping + i sqrt(omega^2 +- sqrt(gap^2 - force(mu)^2))`, Hz where frequencies.
struct Couple {
    frequency: f64,
    gap: f64,
    force: fn(f64) -> f64,
    damping: f64,
    /// Nodal diameters of its shape.
    diameters: f64,
}

const COUPLES: [Couple; 4] = [
    Couple { frequency: 950.0, gap: 30.0, force: |mu| 20.0 * mu, damping: 6.0, diameters: 2.0 },
    Couple { frequency: 2400.0, gap: 40.0, force: |mu| 150.0 * mu, damping: 12.0, diameters: 3.0 },
    Couple {
        frequency: 3700.0,
        gap: 25.0,
        force: |mu| 240.0 * mu * (0.75 - mu).max(0.0),
        damping: 15.0,
        diameters: 4.0,
    },
    Couple { frequency: 5200.0, gap: 60.0, force: |mu| 10.0 * mu, damping: 20.0, diameters: 5.0 },
];

impl Couple {
    /// The two eigenvalues; of a coupled pair the growing one first.
    fn at(&self, mu: f64) -> [Complex64; 2] {
        let (omega, gap, force) = (TAU * self.frequency, TAU * self.gap, TAU * (self.force)(mu));
        // Near the first frequency omega_1,2 = omega +- sqrt(gap^2 - force^2) / 2.
        let split = Complex64::new(gap * gap - force * force, 0.0).sqrt() / 2.0;
        let lambda = |split: Complex64| Complex64::new(-self.damping, omega) + Complex64::i() * split;
        [lambda(-split), lambda(split)]
    }

    /// Values between `low` and `high`, 1e-4 apart, where the growth rate passes zero.
    fn hopf(&self, low: f64, high: f64) -> Vec<[f64; 2]> {
        let n = ((high - low) * 1e4).round() as usize;
        let grows = |i: usize| self.at(low + i as f64 * 1e-4)[0].re > 0.0;
        (1..=n).filter(|&i| grows(i) != grows(i - 1)).map(|i| [i - 1, i].map(|i| low + i as f64 * 1e-4)).collect()
    }
}

/// The results of a study from 0 to 0.8.
pub fn results() -> Results {
    let asked: Vec<f64> = (0..=8).map(|i| f64::from(i) / 10.0).collect();
    let brackets: Vec<(usize, [f64; 2])> = COUPLES
        .iter()
        .enumerate()
        .flat_map(|(c, couple)| couple.hopf(0.0, 0.8).into_iter().map(move |b| (c, b)))
        .collect();
    let between = brackets.iter().flat_map(|(_, bracket)| *bracket);
    let friction_values: Vec<f64> = asked.iter().copied().chain(between).collect();
    let (surface, contact) = (surface(), contact());
    let values =
        friction_values.iter().enumerate().map(|(i, &mu)| value(mu, i < asked.len(), &surface, &contact)).collect();
    Results {
        about: about(asked),
        diagram: Some(diagram(&friction_values, &brackets)),
        values,
        costs: "12.3 s on 2 ranks: equilibria 4.5 s, modes 7.8 s".into(),
        surface,
        contact,
        failure: None,
    }
}

fn about(friction_values: Vec<f64>) -> About {
    let part = |name: &str, material: &str, mass| Part { name: name.into(), material: material.into(), mass };
    let pair = |name: &str, sliding| Pair {
        name: name.into(),
        sliding,
        swept: sliding,
        n_points: 99,
        proposed_stiffness: None,
    };
    About {
        title: TITLE.into(),
        program: "squeal 0.1.0".into(),
        libraries: "PETSc 3.18.5, SLEPc 3.18.2, MUMPS 5.5.1".into(),
        command: "stability disc.toml --friction 0:0.8:0.1".into(),
        model: "disc.toml".into(),
        model_digest: "ab".repeat(32),
        model_text: format!("title = \"{TITLE}\"\n"),
        mesh: "disc.msh".into(),
        mesh_digest: "cd".repeat(32),
        n_nodes: 4000,
        n_elements: 2000,
        n_dofs: 12000,
        n_ranks: 2,
        band: [0.0, 6000.0],
        friction_values,
        parts: vec![part("disc", "iron", 5.5), part("pad", "lining", 0.2)],
        pairs: vec![pair("disc / pad", true), pair("piston / <pad>", false)],
        ..About::default()
    }
}

/// A ring in the plane z with n_r x n_phi cells from an angle on, of two triangles each.
fn ring(radii: [f64; 2], angles: [f64; 2], z: f64, [n_r, n_phi]: [usize; 2]) -> (Vec<[f64; 3]>, Vec<[u32; 3]>) {
    let between = |[a, b]: [f64; 2], i: usize, n: usize| a + (b - a) * i as f64 / n as f64;
    let at = |i: usize, j: usize| {
        let (r, phi) = (between(radii, i, n_r), between(angles, j, n_phi));
        [r * phi.cos(), r * phi.sin(), z]
    };
    let nodes = (0..=n_phi).flat_map(|j| (0..=n_r).map(move |i| at(i, j))).collect();
    let node = |i: usize, j: usize| (j * (n_r + 1) + i) as u32;
    let cell = |(i, j): (usize, usize)| {
        let [a, b, c, d] = [node(i, j), node(i + 1, j), node(i + 1, j + 1), node(i, j + 1)];
        [[a, b, c], [a, c, d]]
    };
    let cells = (0..n_phi).flat_map(|j| (0..n_r).map(move |i| (i, j)));
    (nodes, cells.flat_map(cell).collect())
}

const PAD: [f64; 2] = [PI / 3.0, 2.0 * PI / 3.0];

fn surface() -> Surface {
    let mut surface = Surface::default();
    let mut add = |(nodes, triangles): (Vec<[f64; 3]>, Vec<[u32; 3]>), part: i32, is_lower: bool| {
        let first = surface.nodes.len() as u32;
        let turned = triangles.into_iter().map(|[a, b, c]| if is_lower { [a, c, b] } else { [a, b, c] });
        surface.triangles.extend(turned.map(|triangle| triangle.map(|n| first + n)));
        surface.part.resize(surface.triangles.len(), part);
        surface.nodes.extend(nodes);
    };
    add(ring([0.08, 0.15], [0.0, TAU], 0.0, [6, 72]), 0, false);
    add(ring([0.08, 0.15], [0.0, TAU], -0.02, [6, 72]), 0, true);
    add(ring([0.1, 0.145], PAD, 0.015, [5, 16]), 1, false);
    add(ring([0.1, 0.145], PAD, 0.0, [5, 16]), 1, true);
    surface.samples = (0..surface.nodes.len() as u32).step_by(10).collect();
    surface
}

fn contact() -> ContactFaces {
    let (mut nodes, mut triangles) = ring([0.1, 0.145], PAD, 0.0, [5, 16]);
    let first = nodes.len() as u32;
    let (others, more) = ring([0.11, 0.13], [1.4, 1.7], 0.015, [3, 5]);
    let pair_of_node = nodes.iter().map(|_| 0).chain(others.iter().map(|_| 1)).collect();
    let pair = triangles.iter().map(|_| 0).chain(more.iter().map(|_| 1)).collect();
    nodes.extend(others);
    triangles.extend(more.iter().map(|triangle| triangle.map(|n| first + n)));
    ContactFaces { nodes, triangles, pair, pair_of_node }
}

fn value(mu: f64, asked: bool, surface: &Surface, contact: &ContactFaces) -> Value {
    let pressure: Vec<f64> = contact.nodes.iter().map(|x| (3e6 * (1.0 + 8.0 * mu * x[0])).max(0.0)).collect();
    let forces = |normal: f64, counts| PairForces {
        counts,
        normal,
        tangential: mu * normal,
        on_slave: Default::default(),
        closed_area: 2e-3,
        peak_pressure: pressure.iter().copied().fold(0.0, f64::max),
        peak_force: 120.0,
        rounding: 1e-6,
    };
    let counts = Counts { open: 9, stick: 0, slip: 90 };
    let iterate = |i: i32| Iteration { residual: 10_f64.powi(-3 * i), counts, flips: vec![3, 0] };
    let mut modes: Vec<ModeData> =
        COUPLES.iter().flat_map(|couple| couple.at(mu).map(|lambda| mode(lambda, asked, couple, surface))).collect();
    modes.sort_by(|a, b| a.lambda.im.total_cmp(&b.lambda.im));
    Value {
        friction: mu,
        asked,
        pairs: vec![forces(6000.0, counts), forces(5000.0, Counts { open: 0, stick: 80, slip: 19 })],
        checks: "loads and supports balance to 4.0e-9 N and 6.2e-10 N m\n".into(),
        steps: vec![Step {
            label: format!("friction {mu:.4}"),
            converged: true,
            iterations: (0..5).map(iterate).collect(),
        }],
        status: pressure.iter().map(|&p| i32::from(p > 0.0)).collect(),
        pressure,
        count: Some(Count { below: 6000.0, expected: modes.len(), found: modes.len(), by: CountedBy::SturmCount }),
        modes,
        certificate: None,
        seconds: 1.2,
    }
}

fn mode(lambda: Complex64, asked: bool, couple: &Couple, surface: &Surface) -> ModeData {
    let unstable = lambda.re > 0.0;
    let is_explained = asked && unstable;
    let sampled: Vec<[f64; 3]> = surface.samples.iter().map(|&n| surface.nodes[n as usize]).collect();
    ModeData {
        lambda,
        backward_error: 3e-14,
        unstable,
        sampled: shape(&sampled, couple.diameters),
        shape: is_explained.then(|| shape(&surface.nodes, couple.diameters)),
        sources: if is_explained { sources(lambda, couple) } else { Vec::new() },
    }
}

/// A wave that runs round the disc.
fn shape(nodes: &[[f64; 3]], diameters: f64) -> Shape {
    let wave = |x: &[f64; 3], phase: f64| {
        let (r, phi) = (x[0].hypot(x[1]) / 0.15, x[1].atan2(x[0]));
        [0.0, 0.0, (r.powi(3) * (diameters * phi - phase).cos()) as f32]
    };
    let at = |phase: f64| nodes.iter().map(|x| wave(x, phase)).collect();
    Shape { re: at(0.0), im: at(PI / 2.0) }
}

fn sources(lambda: Complex64, couple: &Couple) -> Vec<Source> {
    let source = |kind, name: &str, kinetic, energy_input, dissipation| Source {
        kind,
        name: name.into(),
        share: Share { kinetic, strain: 1.1 * kinetic - 0.02, energy_input, dissipation },
        sensitivity: Some(Sensitivity {
            mass: Complex64::new(40.0 * kinetic, -900.0),
            damping: Complex64::new(dissipation, 0.1),
            stiffness: Complex64::new(-60.0 * kinetic, 1000.0),
        }),
        friction: (kind == Kind::Contact).then(|| Complex64::new(2.0 * energy_input, 30.0)),
    };
    let damping = couple.damping;
    vec![
        source(Kind::Part, "disc", 0.7, 0.0, -0.5 * damping),
        source(Kind::Part, "pad", 0.3, 0.0, -0.4 * damping),
        source(Kind::Connector, "pin", 0.0, 0.0, -0.1 * damping),
        source(Kind::Contact, "disc / pad", 0.0, lambda.re + damping, 0.0),
        source(Kind::Contact, "piston / <pad>", 0.0, 0.0, 0.0),
    ]
}

fn diagram(friction_values: &[f64], brackets: &[(usize, [f64; 2])]) -> Diagram {
    let mut values = friction_values.to_vec();
    values.sort_by(f64::total_cmp);
    let place = |lambda: Complex64, mu: f64| {
        let all = COUPLES.iter().flat_map(|couple| couple.at(mu));
        all.filter(|other| other.im < lambda.im).count()
    };
    let point = |lambda: Complex64, value: f64| Point { value, lambda, mode: place(lambda, value) };
    let branch = |couple: &Couple, which: usize| Branch {
        points: values.iter().map(|&mu| point(couple.at(mu)[which], mu)).collect(),
    };
    let branches = COUPLES.iter().flat_map(|couple| [branch(couple, 0), branch(couple, 1)]).collect();
    let mut hopf: Vec<Hopf> = brackets
        .iter()
        .map(|&(c, bracket)| Hopf {
            branch: 2 * c,
            bracket,
            value: 0.5 * (bracket[0] + bracket[1]),
            omega: TAU * COUPLES[c].frequency,
            onset: COUPLES[c].at(bracket[1])[0].re > 0.0,
            partner: Some(Partner { branch: 2 * c + 1, share: 0.48 }),
        })
        .collect();
    hopf.sort_by(|a, b| a.value.total_cmp(&b.value));
    Diagram { values, branches, hopf, doubtful: Vec::new() }
}
