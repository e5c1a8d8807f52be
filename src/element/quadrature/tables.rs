//! The rules as orbits in barycentric coordinates.
//!
//! An orbit is one point together with all its images under permutation of the corners; one parameter and one weight
//! describe it. Parameters are the double nearest to the source's 20 digits.

use super::QuadraturePoint;

/// The centroid, degree 1.
pub const TETRAHEDRON_1: [QuadraturePoint<3>; 1] = [QuadraturePoint { at: [0.25; 3], weight: 1.0 / 6.0 }];

/// Four points on the lines from the corners to the centroid, degree 2.
///
/// Barycentric `(b, a, a, a)` with `a = (5 - sqrt 5)/20`, `b = 1 - 3 a`; point `c` is the one nearest to corner `c`.
/// Source: Hammer, Marlowe and Stroud, *Numerical integration over simplexes and cones*, MTAC 10 (1956), p. 136.
pub const TETRAHEDRON_4: [QuadraturePoint<3>; 4] = corner_orbit(0.1381966011250105, 1.0 / 24.0);

/// Fourteen points, degree 5: two corner orbits of four points and one edge orbit of six.
///
/// Source: Walkington, *Quadrature on simplices of arbitrary dimension*, Carnegie Mellon University report 00-CNA-023
/// (2000), degree 5 on the tetrahedron.
pub const TETRAHEDRON_14: [QuadraturePoint<3>; 14] = {
    let near = corner_orbit(0.09273525031089122, 0.012248840519393659);
    let far = corner_orbit(0.3108859192633006, 0.018781320953002643);
    let edge = edge_orbit(0.04550370412564965, 0.007091003462846911);
    [
        near[0], near[1], near[2], near[3], far[0], far[1], far[2], far[3], edge[0], edge[1], edge[2], edge[3],
        edge[4], edge[5],
    ]
};

/// The centroid, degree 1.
const TRIANGLE_1: [QuadraturePoint<2>; 1] = [QuadraturePoint { at: [1.0 / 3.0; 2], weight: 0.5 }];

/// Three points inside, degree 2.
///
/// Source: Hammer, Marlowe and Stroud, as [`TETRAHEDRON_4`].
pub const TRIANGLE_3: [QuadraturePoint<2>; 3] = triangle_orbit(1.0 / 6.0, 1.0 / 6.0);

/// Seven points, degree 5: the centroid and two corner orbits, `a = (6 -+ sqrt 15)/21`, `w = (155 -+ sqrt 15)/2400`.
///
/// Source: Radon, *Zur mechanischen Kubatur*, Monatshefte fuer Mathematik 52 (1948), p. 286.
pub const TRIANGLE_7: [QuadraturePoint<2>; 7] = {
    let near = triangle_orbit(0.10128650732345634, 0.06296959027241357);
    let far = triangle_orbit(0.4701420641051151, 0.0661970763942531);
    let centre = QuadraturePoint { at: [1.0 / 3.0, 1.0 / 3.0], weight: 9.0 / 80.0 };
    [near[0], near[1], near[2], far[0], far[1], far[2], centre]
};

/// Gauss's two points from -1 to 1, `1/sqrt 3`.
const LINE_2: [QuadraturePoint<1>; 2] = [
    QuadraturePoint { at: [-0.5773502691896258], weight: 1.0 },
    QuadraturePoint { at: [0.5773502691896258], weight: 1.0 },
];

/// Gauss's three points from -1 to 1, `sqrt 0.6`.
const LINE_3: [QuadraturePoint<1>; 3] = [
    QuadraturePoint { at: [-0.7745966692414834], weight: 5.0 / 9.0 },
    QuadraturePoint { at: [0.0], weight: 8.0 / 9.0 },
    QuadraturePoint { at: [0.7745966692414834], weight: 5.0 / 9.0 },
];

/// 2 x 2 points of Gauss.
pub const QUADRILATERAL_4: [QuadraturePoint<2>; 4] = square(&LINE_2);
/// 3 x 3 points of Gauss.
pub const QUADRILATERAL_9: [QuadraturePoint<2>; 9] = square(&LINE_3);
/// 2 x 2 x 2 points of Gauss.
pub const HEXAHEDRON_8: [QuadraturePoint<3>; 8] = prism(&QUADRILATERAL_4, &LINE_2);
/// 3 x 3 x 3 points of Gauss.
pub const HEXAHEDRON_27: [QuadraturePoint<3>; 27] = prism(&QUADRILATERAL_9, &LINE_3);
/// The triangle's centroid by two points of Gauss.
pub const WEDGE_2: [QuadraturePoint<3>; 2] = prism(&TRIANGLE_1, &LINE_2);
/// The triangle's three points by three of Gauss.
pub const WEDGE_9: [QuadraturePoint<3>; 9] = prism(&TRIANGLE_3, &LINE_3);
/// The triangle's seven points by three of Gauss.
pub const WEDGE_21: [QuadraturePoint<3>; 21] = prism(&TRIANGLE_7, &LINE_3);

/// A rule on the square: `Q = L^2` points, the first coordinate fastest.
const fn square<const L: usize, const Q: usize>(line: &[QuadraturePoint<1>; L]) -> [QuadraturePoint<2>; Q] {
    assert!(Q == L * L);
    let mut rule = [QuadraturePoint { at: [0.0; 2], weight: 0.0 }; Q];
    let mut q = 0;
    while q < Q {
        let (x, y) = (line[q % L], line[q / L]);
        rule[q] = QuadraturePoint { at: [x.at[0], y.at[0]], weight: x.weight * y.weight };
        q += 1;
    }
    rule
}

/// A rule on a prism over a plane element: `Q = B L` points, those of the base fastest.
const fn prism<const B: usize, const L: usize, const Q: usize>(
    base: &[QuadraturePoint<2>; B],
    line: &[QuadraturePoint<1>; L],
) -> [QuadraturePoint<3>; Q] {
    assert!(Q == B * L);
    let mut rule = [QuadraturePoint { at: [0.0; 3], weight: 0.0 }; Q];
    let mut q = 0;
    while q < Q {
        let (b, z) = (base[q % B], line[q / B]);
        rule[q] = QuadraturePoint { at: [b.at[0], b.at[1], z.at[0]], weight: b.weight * z.weight };
        q += 1;
    }
    rule
}

/// The four images of barycentric `(1 - 3a, a, a, a)`.
const fn corner_orbit(a: f64, weight: f64) -> [QuadraturePoint<3>; 4] {
    let b = 1.0 - 3.0 * a;
    [
        QuadraturePoint { at: [a, a, a], weight },
        QuadraturePoint { at: [b, a, a], weight },
        QuadraturePoint { at: [a, b, a], weight },
        QuadraturePoint { at: [a, a, b], weight },
    ]
}

/// The six images of barycentric `(a, a, b, b)`, `b = 1/2 - a`.
const fn edge_orbit(a: f64, weight: f64) -> [QuadraturePoint<3>; 6] {
    let b = 0.5 - a;
    [
        QuadraturePoint { at: [a, b, b], weight },
        QuadraturePoint { at: [b, a, b], weight },
        QuadraturePoint { at: [b, b, a], weight },
        QuadraturePoint { at: [b, a, a], weight },
        QuadraturePoint { at: [a, b, a], weight },
        QuadraturePoint { at: [a, a, b], weight },
    ]
}

/// The three images of barycentric `(1 - 2a, a, a)`.
const fn triangle_orbit(a: f64, weight: f64) -> [QuadraturePoint<2>; 3] {
    let b = 1.0 - 2.0 * a;
    [
        QuadraturePoint { at: [a, a], weight },
        QuadraturePoint { at: [b, a], weight },
        QuadraturePoint { at: [a, b], weight },
    ]
}
