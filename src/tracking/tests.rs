//! Families whose branches and Hopf points are known, at coarse and fine steps.

use proptest::prelude::*;

use super::testing::{Model, Real, options, rows, undamped, values};
use super::{Branch, Diagram, Family, Options, track};
use num_complex::Complex64;

/// The upper half plane; conjugates are what lies beyond the band.
fn upper() -> Options {
    Options { band: [0.0, f64::INFINITY], ..options() }
}

fn followed(family: &mut impl Family, values: &[f64], options: &Options) -> Diagram {
    let (diagram, outcome) = track(family, values, options);
    outcome.unwrap();
    assert_eq!(diagram.doubtful, Vec::<[f64; 2]>::new());
    for hopf in &diagram.hopf {
        assert!(hopf.bracket[1] - hopf.bracket[0] <= options.tolerance * (1.0 + 1e-9), "{hopf:?}");
        assert!(hopf.bracket[0] <= hopf.value && hopf.value <= hopf.bracket[1], "{hopf:?}");
    }
    diagram
}

fn at(branch: &Branch, value: f64) -> Complex64 {
    branch.points.iter().find(|point| point.value == value).unwrap().lambda
}

/// `lambda^2 = -2 +- sqrt(1 - 4 mu / 3)`: the two modes meet at mu = 3/4 (Hoffmann et al., Mech. Res.
/// Commun. 29, 2002).
/// The lower one goes on as the one that decays. Steps of 0.25 and 0.05 meet the defective point itself.
#[test]
fn hoffmann_couples_at_three_quarters_whatever_the_step() {
    for step in [1.0, 0.5, 0.25, 0.1, 0.05, 0.01] {
        let mut family = undamped(|mu| [[2.0, 1.0 - 4.0 * mu / 3.0], [1.0, 2.0]]);
        let diagram = followed(&mut family, &values(0.0, 1.0, step), &upper());
        assert_eq!((diagram.branches.len(), diagram.hopf.len()), (2, 1), "{step}: {:?}", diagram.hopf);
        let hopf = diagram.hopf[0];
        assert!((hopf.value - 0.75).abs() < 1e-3 && (hopf.omega - 2_f64.sqrt()).abs() < 0.02 && hopf.onset, "{hopf:?}");
        assert_eq!((hopf.branch, hopf.partner.unwrap().branch), (1, 0));
        let root = Complex64::new(1.0 - 4.0 / 3.0, 0.0).sqrt();
        let growth = (root - 2.0).sqrt().re.abs();
        let ends = [0, 1].map(|b| at(&diagram.branches[b], 1.0).re);
        assert!((ends[0] + growth).abs() < 1e-12 && (ends[1] - growth).abs() < 1e-12, "{ends:?}");
    }
}

/// Down from mu = 1 the same point is met from the other side.
#[test]
fn hoffmann_is_the_same_downwards() {
    let mut family = undamped(|mu| [[2.0, 1.0 - 4.0 * mu / 3.0], [1.0, 2.0]]);
    let diagram = followed(&mut family, &values(1.0, 0.0, 0.1), &upper());
    assert_eq!(diagram.hopf.len(), 1);
    assert!((diagram.hopf[0].value - 0.75).abs() < 1e-3 && diagram.hopf[0].onset);
}

/// Damping can advance the instability (Sinou and Jezequel, Eur. J. Mech. A 26, 2007). Exact Hopf points.
#[test]
fn hulten_sinou_passes_its_hopf_points() {
    let (w1, w2) = (std::f64::consts::TAU * 100.0, std::f64::consts::TAU * 75.0);
    for (e1, e2, mu, hertz) in [(0.02, 0.02, 0.28936713, 86.60254), (0.02, 0.06, 0.27179003, 93.02605)] {
        let matrices = |mu: f64| {
            let k = [[w1 * w1, -mu * w2 * w2], [mu * w1 * w1, w2 * w2]];
            [Real::identity(2, 2), rows([[e1 * w1, 0.0], [0.0, e2 * w2]]), rows(k)]
        };
        for step in [0.1, 0.01] {
            let diagram = followed(&mut Model::new(matrices), &values(0.0, 0.5, step), &upper());
            let [hopf] = diagram.hopf[..] else { panic!("{:?}", diagram.hopf) };
            assert!((hopf.value - mu).abs() < 1e-4 && hopf.onset, "{hopf:?}");
            assert!((hopf.omega / std::f64::consts::TAU - hertz).abs() < 1e-2, "{hopf:?}");
            assert_eq!(hopf.partner.unwrap().branch, 1 - hopf.branch);
        }
    }
}

/// The bicycle of Meijaard et al. (Proc. R. Soc. A 463, 2007): two real eigenvalues meet at 0.684 m/s and weave, which
/// ends at 4.292 m/s; a real eigenvalue passes zero at 6.024 m/s (capsize), where no two modes couple.
#[test]
fn bicycle_weaves_and_capsizes_where_it_should() {
    let m = [[80.81722, 2.31941332208709], [2.31941332208709, 0.29784188199686]];
    let k0 = [[-80.95, -2.59951685249872], [-2.59951685249872, -0.80329488458618]];
    let k2 = [[0.0, 76.59734589573222], [0.0, 2.65431523794604]];
    let c1 = [[0.0, 33.86641391492494], [-0.85035641456978, 1.68540397397560]];
    let matrices = |v: f64| [rows(m), v * rows(c1), 9.81 * rows(k0) + v * v * rows(k2)];
    for step in [1.0, 0.5, 0.1] {
        let diagram = followed(&mut Model::new(matrices), &values(0.0, 10.0, step), &upper());
        let found: Vec<(f64, bool)> = diagram.hopf.iter().map(|h| (h.value, h.onset)).collect();
        let [(weave, false), (capsize, true)] = found[..] else { panic!("step {step}: {:?}", diagram.hopf) };
        assert!((weave - 4.29238253634111).abs() < 1e-4 && (capsize - 6.02426201538837).abs() < 1e-4, "{found:?}");
        assert!(diagram.hopf[1].omega.abs() < 1e-9 && diagram.hopf[0].omega > 3.0, "{:?}", diagram.hopf);
    }
}

/// A shaft with internal damping c_i and external damping c_e whirls from `Omega = omega (1 + c_e / c_i)` on: forward
/// and backward whirl have fixed shapes, (1, -i) and (1, i), and nothing couples. (The threshold of 1e-6 of omega is
/// reached 1e-4 later.)
#[test]
fn a_whirling_shaft_needs_no_partner() {
    let (ci, ce) = (0.02, 0.03);
    let matrices = |speed: f64| {
        let k = [[1.0, ci * speed], [-ci * speed, 1.0]];
        [Real::identity(2, 2), (ci + ce) * Real::identity(2, 2), rows(k)]
    };
    let diagram = followed(&mut Model::new(matrices), &values(0.5, 4.5, 1.0), &upper());
    let [hopf] = diagram.hopf[..] else { panic!("{:?}", diagram.hopf) };
    assert!((hopf.value - 2.5).abs() < 1.1e-4 && (hopf.omega - 1.0).abs() < 1e-6 && hopf.onset, "{hopf:?}");
    assert_eq!(hopf.partner, None);
}

/// Without coupling the branches are straight, also where a value is the crossing itself.
#[test]
fn modes_that_do_not_couple_cross() {
    for step in [1.0, 0.5, 0.25, 0.1, 0.03] {
        let mut family = undamped(|p| [[1.0 + p, 0.0, 0.0], [0.0, 2.0 - p, 0.0], [0.0, 0.0, 1.4]]);
        let diagram = followed(&mut family, &values(0.0, 1.0, step), &upper());
        for point in diagram.branches.iter().flat_map(|b| &b.points) {
            assert!(point.lambda.re.abs() < 1e-12);
        }
        let exact: [fn(f64) -> f64; 3] = [|p| 1.0 + p, |_| 1.4, |p| 2.0 - p];
        for (branch, exact) in diagram.branches.iter().zip(exact) {
            let error = |p: &super::Point| (p.lambda.im - exact(p.value).sqrt()).abs();
            assert!(branch.points.iter().all(|p| error(p) < 1e-12), "step {step}: {branch:?}");
        }
        assert!(family.solved.len() <= diagram.values.len(), "no extra solves");
    }
}

/// With a weak coupling they turn away from each other: the lower stays lower. A veering narrower than the tolerance is
/// a crossing, unless a value falls into it.
#[test]
fn weakly_coupled_modes_veer() {
    for (coupling, veers) in [(0.05, true), (0.01, true), (1e-5, false)] {
        for n_steps in [1.0, 3.0, 9.0, 33.0, 99.0] {
            let step = 1.0 / n_steps;
            let mut family = undamped(|p| [[1.0 + p, coupling], [coupling, 2.0 - p]]);
            let diagram = followed(&mut family, &values(0.0, 1.0, step), &upper());
            let [lower, upper] = [0, 1].map(|b| at(&diagram.branches[b], 1.0).im);
            assert_eq!(lower < upper, veers, "coupling {coupling}, step {step}");
        }
    }
}

/// A doublet stays together while another mode crosses it; the basis of its plane is the solver's.
#[test]
fn a_doublet_is_followed_as_a_plane() {
    let mut turn = 0.0_f64;
    let stiffness = move |p: f64| {
        turn += 1.0;
        let (sin, cos) = turn.sin_cos();
        let axes = rows([[cos, -sin, 0.0], [sin, cos, 0.0], [0.0, 0.0, 1.0]]);
        let k = Real::from_diagonal(&nalgebra::dvector![2.0 - 0.1 * p, 2.0 - 0.1 * p, 1.5 + p]);
        [Real::identity(3, 3), Real::zeros(3, 3), &axes * k * axes.transpose()]
    };
    let diagram = followed(&mut Model::new(stiffness), &values(0.0, 1.0, 0.1), &upper());
    assert_eq!(diagram.branches.len(), 3);
    for (branch, exact) in diagram.branches.iter().zip([2.5_f64, 1.9, 1.9]) {
        assert!((at(branch, 1.0).im - exact.sqrt()).abs() < 1e-12, "{branch:?}");
    }
}

/// The growing pair lives only between mu = 0.4 and 0.5, which steps of 0.3 pass over.
#[test]
fn an_instability_between_two_values_is_found() {
    // (k_11 - k_22)^2 = 4 c^2 at mu = 0.4 and 0.5
    let mut family = undamped(|mu| [[2.0 + mu - 0.45, 0.025], [-0.025, 2.0 - mu + 0.45]]);
    let diagram = followed(&mut family, &values(0.0, 0.9, 0.3), &upper());
    let found: Vec<(f64, bool)> = diagram.hopf.iter().map(|h| (h.value, h.onset)).collect();
    let [(on, true), (off, false)] = found[..] else { panic!("{:?}", diagram.hopf) };
    assert!((on - 0.425).abs() < 1e-3 && (off - 0.475).abs() < 1e-3, "{found:?}");
}

/// Modes come and go at the band's edges without a solve more, and no branch of the band is lost.
#[test]
fn branches_begin_and_end_at_the_edges_of_the_band() {
    let k = |p: f64| Real::from_fn(8, 8, |i, j| if i == j { (1.0 + 0.25 * i as f64 - p).powi(2) } else { 0.0 });
    let mut family = Model::new(|p| [Real::identity(8, 8), Real::zeros(8, 8), k(p)]);
    family.window = [0.85, 2.15];
    let options = Options { band: [1.0 - 1e-9, 2.0], ..options() };
    let diagram = followed(&mut family, &values(0.0, 0.7, 0.1), &options);
    assert_eq!(family.solved.len(), 8);
    // First frequencies 1 to 2.75 in steps of 0.25, less 0.7 at the end: the last does not come down to 2, the others
    // are met.
    assert_eq!(diagram.branches.len(), 7);
    for branch in &diagram.branches {
        for w in branch.points.windows(2) {
            assert!((w[0].lambda.im - w[1].lambda.im - (w[1].value - w[0].value)).abs() < 1e-12);
        }
    }
}

/// A band may be empty at first, and at last.
#[test]
fn a_band_may_be_empty() {
    let mut family = undamped(|p| [[(1.0 + p).powi(2), 0.0], [0.0, (4.0 + p).powi(2)]]);
    family.window = [1.85, 2.65];
    let options = Options { band: [1.95, 2.55], ..options() };
    let diagram = followed(&mut family, &values(0.0, 3.0, 0.1), &options);
    let [branch] = &diagram.branches[..] else { panic!("{:?}", diagram.branches) };
    assert_eq!(branch.points.len(), 8);
    assert!(diagram.hopf.is_empty());
}

#[test]
fn values_in_disorder_are_refused() {
    let mut family = undamped(|p| [[1.0 + p]]);
    assert!(track(&mut family, &[0.0, 0.4, 0.2], &options()).1.is_err());
}

/// A random family `M = I`, `C = C_0`, `K = K_0 + p K_1 + p^2 K_2` of six modes with unsymmetric couplings.
fn random(entries: &[f64], damping: f64, bend: f64) -> Model<impl FnMut(f64) -> [Real; 3] + use<>> {
    const N: usize = 6;
    let matrix = |k: usize| Real::from_column_slice(N, N, &entries[k * N * N..(k + 1) * N * N]);
    let [moves, couples, bends] = [matrix(0), matrix(1), matrix(2)];
    let k0 =
        Real::from_fn(N, N, |i, j| if i == j { 4.0 + i as f64 + 0.5 * moves[(0, i)] } else { 0.1 * moves[(i, j)] });
    let (k0, k1) =
        (0.5 * (&k0 + k0.transpose()), Real::from_fn(N, N, |i, j| couples[(i, j)] * if i == j { 2.0 } else { 0.4 }));
    let c = Real::from_fn(N, N, |i, j| if i == j { damping * (1.0 + 0.5 * bends[(0, i)]) } else { 0.0 });
    Model::new(move |p| [Real::identity(N, N), c.clone(), &k0 + p * &k1 + p * p * bend * &bends])
}

/// Growth rates of all modes at a value that both diagrams have, in the order of the branches.
fn ends(diagram: &Diagram, value: f64) -> Vec<Complex64> {
    diagram.branches.iter().map(|branch| at(branch, value)).collect()
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    /// Where the problem depends on p linearly, the model between two values is exact: one step finds what a hundred
    /// find.
    #[test]
    fn linear_families_are_followed_in_one_step(
        entries in prop::collection::vec(-1.0..1.0, 108),
        damping in 0.0..0.1,
    ) {
        let coarse = followed(&mut random(&entries, damping, 0.0), &[0.0, 1.0], &upper());
        let fine = followed(&mut random(&entries, damping, 0.0), &values(0.0, 1.0, 0.01), &upper());
        compare(&coarse, &fine)?;
    }

    /// Otherwise solves in between repair it.
    #[test]
    fn coarse_and_fine_steps_give_the_same_branches(
        entries in prop::collection::vec(-1.0..1.0, 108),
        damping in 0.0..0.1,
        bend in -0.5..0.5,
    ) {
        let coarse = followed(&mut random(&entries, damping, bend), &values(0.0, 1.0, 0.1), &upper());
        let fine = followed(&mut random(&entries, damping, bend), &values(0.0, 1.0, 0.01), &upper());
        compare(&coarse, &fine)?;
    }
}

fn compare(coarse: &Diagram, fine: &Diagram) -> Result<(), TestCaseError> {
    prop_assert_eq!(coarse.branches.len(), fine.branches.len());
    for value in coarse.values.iter().copied().filter(|v| fine.values.contains(v)) {
        for (a, b) in ends(coarse, value).iter().zip(ends(fine, value)) {
            prop_assert!((a - b).norm() < 1e-6, "at {}: {} {}", value, a, b);
        }
    }
    let told = |d: &Diagram| d.hopf.iter().map(|h| (h.branch, h.onset)).collect::<Vec<_>>();
    prop_assert_eq!(told(coarse), told(fine));
    for (a, b) in coarse.hopf.iter().zip(&fine.hopf) {
        prop_assert!((a.value - b.value).abs() < 1e-3, "{:?} {:?}", a, b);
    }
    Ok(())
}
