//! The sweep itself: which values are solved, and how their modes are joined to branches.

use std::rc::Rc;

use nalgebra::DMatrix;
use num_complex::Complex64;

use super::diagram::{Branch, Diagram, Hopf, Partner, Point};
use super::homotopy::{Path, follow};
use super::hopf::{Aim, HopfSearch};
use super::matching::State;
use super::node::Node;
use super::transfer::Transfer;
use super::{Family, Options};
use crate::{Error, Result};

/// Follows all modes of a family over `values`, which rise or fall, and brackets every Hopf point of the band by
/// solves. The diagram holds what was found, also where an error ended the work.
///
/// Values at which two modes are one vector (a coalescence that is met exactly) are replaced by a neighbour a tenth of
/// the tolerance away.
///
/// ```
/// use nalgebra::DMatrix;
/// use num_complex::Complex64;
/// use squeal::model::InstabilityCriterion;
/// use squeal::tracking::{Family, Options, track};
///
/// /// One oscillator, `lambda^2 + c lambda + 1 = 0`, whose damping `c = 0.1 - 0.2 mu` becomes negative at mu = 0.5.
/// struct Oscillator;
///
/// struct Modes {
///     c: f64,
///     lambda: [Complex64; 1],
/// }
///
/// impl Family for Oscillator {
///     type Modes = Modes;
///
///     fn solve(&mut self, mu: f64) -> squeal::Result<Modes> {
///         let c = 0.1 - 0.2 * mu;
///         Ok(Modes { c, lambda: [Complex64::new(-0.5 * c, (1.0 - 0.25 * c * c).sqrt())] })
///     }
///
///     fn eigenvalues<'m>(&self, modes: &'m Modes) -> &'m [Complex64] {
///         &modes.lambda
///     }
///
///     fn products(&mut self, left: &Modes, right: &Modes) -> squeal::Result<DMatrix<Complex64>> {
///         Ok(DMatrix::from_element(1, 1, left.lambda[0] + right.lambda[0] + left.c))
///     }
/// }
///
/// let criterion = InstabilityCriterion::default();
/// let options = Options { band: [0.5, 2.0], tolerance: 1e-3, criterion, rigid: 0.0 };
/// let (diagram, outcome) = track(&mut Oscillator, &[0.1, 0.9], &options);
/// outcome?;
/// assert_eq!((diagram.branches.len(), diagram.hopf.len()), (1, 1));
/// assert!((diagram.hopf[0].value - 0.5).abs() < 1e-3 && diagram.hopf[0].onset);
/// # Ok::<(), squeal::Error>(())
/// ```
///
/// # Errors
/// Those of the family; [`Error::Input`] where the values neither rise nor fall; [`Error::NotConverged`] where the
/// modes of two values have nothing in common.
pub fn track<F: Family>(family: &mut F, values: &[f64], options: &Options) -> (Diagram, Result<()>) {
    if !values.is_sorted_by(|a, b| a < b) && !values.is_sorted_by(|a, b| a > b) {
        let disorder = "the values of a sweep must rise or fall for its branches to be followed";
        return (Diagram::default(), Err(Error::input(disorder)));
    }
    let mut diagram = Diagram::default();
    let outcome = follow_all(family, values, options, &mut diagram);
    diagram.finish(|lambda| options.in_band(lambda));
    (diagram, outcome)
}

fn follow_all<F: Family>(family: &mut F, values: &[f64], options: &Options, diagram: &mut Diagram) -> Result<()> {
    let Some((&first, others)) = values.split_first() else { return Ok(()) };
    let inwards = others.first().map_or(1.0, |next| (next - first).signum());
    let start = Rc::new(open(family, first, inwards, options)?);
    let mut tracker = Tracker { family, options, diagram, carried: Carried::default(), start };
    let mut last = tracker.begin();
    for &value in others {
        let next = Rc::new(open(tracker.family, value, -inwards, options)?);
        tracker.link(&last, &next, HopfSearch::default())?;
        last = next;
    }
    Ok(())
}

/// Solves at a value, or beside it where it is a coalescence.
fn open<F: Family>(family: &mut F, value: f64, side: f64, options: &Options) -> Result<Node<F::Modes>> {
    let node = Node::solve(family, value)?;
    if node.is_defective() {
        return Node::solve(family, value + 0.1 * side * options.tolerance);
    }
    Ok(node)
}

/// What goes on from one value to the next.
#[derive(Default)]
struct Carried {
    /// Branch of each mode.
    branches: Vec<usize>,
    /// Vectors of each mode in the basis of the value's own modes: the identity, but for turned doublets.
    vectors: DMatrix<Complex64>,
}

struct Tracker<'f, F: Family> {
    family: &'f mut F,
    options: &'f Options,
    diagram: &'f mut Diagram,
    carried: Carried,
    start: Rc<Node<F::Modes>>,
}

/// Two neighbouring values and the model between them.
struct Span {
    transfer: Transfer,
    path: Option<Path>,
}

/// Two modes whose sharing exceeds this pass a coalescence so closely that the model may err about the side, which
/// decides which of them becomes which. The model's error falls as the step is shortened, and the limit rises
/// accordingly.
const NEAR: f64 = 1.6;

impl<F: Family> Tracker<'_, F> {
    /// Every mode of the first value begins a branch.
    fn begin(&mut self) -> Rc<Node<F::Modes>> {
        let n = self.start.lambdas.len();
        self.carried = Carried { branches: Vec::new(), vectors: DMatrix::identity(n, n) };
        self.diagram.values.push(self.start.value);
        let start = self.start.clone();
        for mode in by_frequency(&start) {
            self.begin_branch(&start, mode);
        }
        self.carried.branches = ranks(&by_frequency(&start));
        start
    }

    fn begin_branch(&mut self, node: &Node<F::Modes>, mode: usize) -> usize {
        self.diagram.branches.push(Branch { points: vec![point(node, mode)] });
        self.diagram.branches.len() - 1
    }

    /// Strings the modes of b on the branches that have reached a; solves in between where that is needed.
    fn link(&mut self, a: &Rc<Node<F::Modes>>, b: &Rc<Node<F::Modes>>, search: HopfSearch) -> Result<()> {
        let transfer = Transfer::new(a, b, self.family, self.options)?;
        let path = self.path(a, b, &transfer);
        let span = Span { transfer, path };
        let width = (b.value - a.value).abs();
        let Some((value, aim)) = self.split(&span, a.value, b.value, search).filter(|_| width > self.options.tolerance)
        else {
            return self.accept(a, b, span);
        };
        let middle = Rc::new(open(self.family, value, (a.value - b.value).signum(), self.options)?);
        let search = HopfSearch { depth: search.depth + 1, aim };
        self.link(a, &middle, search)?;
        self.link(&middle, b, search)
    }

    fn path(&self, a: &Node<F::Modes>, b: &Node<F::Modes>, transfer: &Transfer) -> Option<Path> {
        let of = |node: &Node<F::Modes>, modes: &[usize]| modes.iter().map(|&i| node.lambdas[i]).collect::<Vec<_>>();
        let (from, to) = (of(a, &transfer.from), of(b, &transfer.to));
        let vectors = self.carried.vectors.select_rows(&transfer.from).select_columns(&transfer.from);
        let start = State { values: from.clone(), vectors };
        let resolution = self.options.tolerance / (b.value - a.value).abs();
        follow(start, &from, &to, &transfer.matrix, resolution)
    }

    /// The value between a and b at which one more solve is needed, if any, and the root that it aims at.
    fn split(&self, span: &Span, a: f64, b: f64, search: HopfSearch) -> Option<(f64, Option<Aim>)> {
        let between = |s: f64| a + s * (b - a);
        let Some(path) = span.path.as_ref().filter(|_| span.transfer.complete) else {
            return Some((between(0.5), None));
        };
        let events = (0..path.end.len()).filter_map(|mode| self.event(path, mode).map(|event| (mode, event)));
        let branch = |mode: usize| self.carried.branches[span.transfer.from[mode]];
        // A search for one root ends before another begins.
        let current = |mode: usize| search.aim.is_some_and(|aim| aim.branch == branch(mode));
        if let Some((mode, (is_root, s))) = events.max_by_key(|(mode, _)| (current(*mode), std::cmp::Reverse(*mode))) {
            if !is_root {
                return Some((between(s.clamp(0.05, 0.95)), None));
            }
            let (value, aim) = search.aim(branch(mode), between(s), [a, b], self.options.tolerance);
            return Some((value, Some(aim)));
        }
        let (s, sharing) = path.nearest_coalescence();
        (sharing > NEAR * 1.5_f64.powi(search.depth as i32)).then_some((between(s.clamp(0.3, 0.7)), None))
    }

    /// A growth rate that passes zero, or does so twice: (whether once, where). Modes outside the band do not count.
    fn event(&self, path: &Path, mode: usize) -> Option<(bool, f64)> {
        let (first, last) = (path.samples[0].1[mode], path.end[mode]);
        if !self.options.in_band(first) && !self.options.in_band(last) {
            return None;
        }
        let excess = |lambda| self.options.excess(lambda);
        let before = excess(first) > 0.0;
        if before != (excess(last) > 0.0) {
            return path.first_root(mode, excess).map(|s| (true, s));
        }
        let sign = if before { -1.0 } else { 1.0 };
        let (s, most) = path.maximum(mode, |lambda| sign * excess(lambda));
        (most > 0.0).then_some((false, s))
    }

    fn accept(&mut self, a: &Rc<Node<F::Modes>>, b: &Rc<Node<F::Modes>>, span: Span) -> Result<()> {
        let Span { transfer, path } = span;
        let Some(path) = path else {
            return Err(Error::not_converged(format!(
                "the modes at {} and {} have nothing in common: no branch can be followed from one to the other",
                a.value, b.value
            )));
        };
        if !transfer.complete {
            self.diagram.doubtful.push([a.value.min(b.value), a.value.max(b.value)]);
        }
        self.diagram.values.push(b.value);
        let continued = self.extend(b, &transfer, &path);
        for (mode, &branch) in continued.iter().enumerate() {
            self.cross(a, b, &path, mode, branch)?;
        }
        Ok(())
    }

    /// Puts the modes of b on their branches. Gives the branch of each mode of the path.
    fn extend(&mut self, b: &Node<F::Modes>, transfer: &Transfer, path: &Path) -> Vec<usize> {
        let n = b.lambdas.len();
        let continued: Vec<usize> = transfer.from.iter().map(|&i| self.carried.branches[i]).collect();
        let (mut owners, mut vectors) = (vec![None; n], DMatrix::identity(n, n));
        for (i, &branch) in continued.iter().enumerate() {
            let mode = transfer.to[path.places[i]];
            owners[mode] = Some(branch);
            transfer.to.iter().enumerate().for_each(|(k, &row)| vectors[(row, mode)] = path.vectors[(k, i)]);
            self.diagram.branches[branch].points.push(point(b, mode));
        }
        for mode in by_frequency(b) {
            owners[mode] = owners[mode].or_else(|| Some(self.begin_branch(b, mode)));
        }
        self.carried = Carried { branches: owners.into_iter().flatten().collect(), vectors };
        continued
    }

    /// Records where a growth rate has passed zero between a and b.
    fn cross(
        &mut self,
        a: &Rc<Node<F::Modes>>,
        b: &Rc<Node<F::Modes>>,
        path: &Path,
        mode: usize,
        branch: usize,
    ) -> Result<()> {
        let Some((true, s)) = self.event(path, mode) else { return Ok(()) };
        let gains = self.options.excess(path.end[mode]) > 0.0;
        let partner = self.partner(if gains { b } else { a }, branch)?;
        self.diagram.hopf.push(Hopf {
            branch,
            bracket: [a.value.min(b.value), a.value.max(b.value)],
            value: a.value + s * (b.value - a.value),
            omega: path.value(mode, s).im,
            onset: gains == (b.value > a.value),
            partner,
        });
        Ok(())
    }

    /// Of which modes of the first value a branch's mode is made, but for its own: with `T` and `T'` the coordinates of
    /// the two values' modes in each other's basis, the shares `|T_kj T'_jk|` of a mode j, divided by their sum. None
    /// where the branch was unstable from the start.
    fn partner(&mut self, at: &Rc<Node<F::Modes>>, branch: usize) -> Result<Option<Partner>> {
        let start = self.start.clone();
        let first = self.diagram.branches[branch].points[0];
        if self.options.excess(first.lambda) > 0.0 {
            return Ok(None);
        }
        let points = &self.diagram.branches[branch].points;
        let mode = points.iter().rev().find(|p| p.value == at.value).expect("a branch has passed its Hopf point").mode;
        let forward = start.coordinates_of(at, self.family)?;
        let backward = at.coordinates_of(&start, self.family)?;
        let order = ranks(&by_frequency(&start));
        let shares: Vec<f64> = (0..order.len()).map(|k| (forward[(k, mode)] * backward[(mode, k)]).norm()).collect();
        let total: f64 = shares.iter().sum();
        let others = order.iter().zip(shares).map(|(&branch, share)| Partner { branch, share: share / total });
        let others = others.filter(|partner| partner.branch != branch && partner.share >= PARTNER);
        Ok(others.max_by(|p, q| p.share.total_cmp(&q.share)))
    }
}

/// A smaller share in a mode does not make a partner.
const PARTNER: f64 = 0.1;

fn point<M>(node: &Node<M>, mode: usize) -> Point {
    Point { value: node.value, lambda: node.lambdas[mode], mode }
}

/// Modes in the order of their frequencies.
fn by_frequency<M>(node: &Node<M>) -> Vec<usize> {
    let mut modes: Vec<usize> = (0..node.lambdas.len()).collect();
    modes.sort_by(|&i, &j| node.lambdas[i].im.total_cmp(&node.lambdas[j].im));
    modes
}

/// The inverse of a permutation.
fn ranks(order: &[usize]) -> Vec<usize> {
    let mut ranks = vec![0; order.len()];
    order.iter().enumerate().for_each(|(rank, &i)| ranks[i] = rank);
    ranks
}
