//! What each part, connector and contact pair has in `y^H M x`, `y^H C x`, `y^H K x` and `y^H G x`.

use nalgebra::DMatrix;
use num_complex::Complex64;

use crate::Result;
use crate::assembly::{ElementMatrices, Elements, System};
use crate::equilibrium::{Contacts, Equilibrium};
use crate::native::{Mck, Vector};

/// The share of one source in the forms of two vectors: `y^H M x`, `y^H C x`, `y^H K x`, `y^H G x`.
pub type Forms = Mck<Complex64>;

/// A complex vector in two real ones.
#[derive(Clone, Copy)]
pub struct Complex<'a> {
    /// Real part.
    pub re: &'a Vector,
    /// Imaginary part.
    pub im: &'a Vector,
}

/// A family of elements and the source that each member counts for.
pub type Sources<'a> = (&'a dyn Elements, &'a dyn Fn(usize) -> usize);

/// The forms of `n` sources of elements. Collective.
///
/// # Errors
/// PETSc's.
pub fn of_elements(system: &System, families: &[Sources], n: usize, [y, x]: [Complex; 2]) -> Result<Vec<Forms>> {
    let nodal = system.nodal(&[y.re, y.im, x.re, x.im])?;
    let nodal = &nodal;
    let gathered = |k: usize, nodes: &[u32]| {
        let at = move |n: &u32| {
            let n = *n as usize;
            (0..3).map(move |i| Complex64::new(nodal[k][n][i], nodal[k + 1][n][i]))
        };
        nodes.iter().flat_map(at).collect::<Vec<_>>()
    };
    let mut sums = vec![Forms::default(); n];
    let mut element = ElementMatrices::default();
    for (family, source) in families {
        for e in 0..family.len() {
            let nodes = family.nodes(e);
            // One rank counts an element that several compute.
            if system.dofs.owns(nodes[0]) {
                family.matrices(e, &mut element);
                let (y, x) = (gathered(0, nodes), gathered(2, nodes));
                let sum = &mut sums[source(e)];
                sum.m += hermitian(&element.mass_on_all_axes(), &y, &x);
                sum.c += hermitian(&element.c, &y, &x);
                sum.k += hermitian(&element.k, &y, &x);
                if family.has_structural_damping() {
                    *sum.g.get_or_insert_default() += hermitian(&element.g, &y, &x);
                }
            }
        }
    }
    Ok(summed(system, sums))
}

/// `y_i^H A x_j` of complex vectors from the products of all their real and imaginary parts, which take turns; a
/// conjugate (`true`) has the other sign of its imaginary part.
pub fn complex_product(a: &DMatrix<f64>, (i, left): (usize, bool), (j, right): (usize, bool)) -> Complex64 {
    let [s, t] = [left, right].map(|conjugate| if conjugate { -1.0 } else { 1.0 });
    let [rr, ri, ir, ii] = [(0, 0), (0, 1), (1, 0), (1, 1)].map(|(row, column)| a[(2 * i + row, 2 * j + column)]);
    // (y_r - i s y_i)^T A (x_r + i t x_i)
    Complex64::new(rr + s * t * ii, t * ri - s * ir)
}

/// `y^H A x` of a real row-major matrix; 0 of one without entries.
fn hermitian(a: &[f64], y: &[Complex64], x: &[Complex64]) -> Complex64 {
    let row = |row: &[f64]| row.iter().zip(x).map(|(a, x)| x * *a).sum::<Complex64>();
    a.chunks(x.len()).zip(y).map(|(a, y)| y.conj() * row(a)).sum()
}

fn summed(system: &System, sums: Vec<Forms>) -> Vec<Forms> {
    let all = |sum: Forms| [sum.m, sum.c, sum.k, sum.g.unwrap_or_default()];
    let mut values: Vec<f64> = sums.into_iter().flat_map(all).flat_map(|z| [z.re, z.im]).collect();
    system.k.comm().sum_all(&mut values);
    let complex = |at: &[f64]| {
        let [m, c, k, g] = [0, 2, 4, 6].map(|i| Complex64::new(at[i], at[i + 1]));
        Forms { m, c, k, g: system.g.is_some().then_some(g) }
    };
    values.chunks(8).map(complex).collect()
}

/// The forms of the contact pairs, linearised about an equilibrium with a friction for each pair: `g_y^H D g_x`, and
/// friction damping in C where that is in the problem. Collective.
///
/// # Errors
/// PETSc's.
pub fn of_contacts(
    contacts: &Contacts,
    equilibrium: &Equilibrium,
    frictions: &[f64],
    friction_damping: bool,
    [y, x]: [Complex; 2],
) -> Result<Vec<Forms>> {
    let interface = contacts.interface();
    let at = contacts.gaps(&equilibrium.u)?;
    let gaps = |v: Complex| {
        let (re, im) = (contacts.gaps(v.re)?, contacts.gaps(v.im)?);
        let complex = |(re, im): (&[f64; 3], &[f64; 3])| [0, 1, 2].map(|i| Complex64::new(re[i], im[i]));
        Ok(re.iter().zip(&im).map(complex).collect::<Vec<_>>())
    };
    let (y, x): (Vec<_>, Vec<_>) = (gaps(y)?, gaps(x)?);
    let mut sums = vec![Forms::default(); interface.pairs.len()];
    for (a, response) in equilibrium.responses.iter().enumerate() {
        let sum = &mut sums[interface.points[a].pair];
        let stiffness = interface.linearise(a, at[a], response.status, frictions);
        sum.k += hermitian(stiffness.as_flattened(), &y[a], &x[a]);
        if friction_damping {
            let damping = interface.friction_damping(a, response.normal_force, frictions);
            sum.c += hermitian(damping.as_flattened(), &y[a], &x[a]);
        }
    }
    Ok(sums)
}
