//! Kinds of element: a shape and how it is integrated.
//!
//! | kind | nodes | stiffness | mass |
//! |---|---|---|---|
//! | C3D4 | 4 | 1 point; constant strain | 4 points |
//! | C3D10 | 10 | 4 points | 14 points |
//! | C3D6 | 6 | 2 points | 21 points |
//! | C3D15 | 15 | 9 points | 21 points |
//! | C3D8 | 8 | 2 x 2 x 2 points | 2 x 2 x 2 points |
//! | C3D8I | 8 | 2 x 2 x 2 points, with incompatible modes | as C3D8 |
//! | C3D8R | 8 | mean strain, with hourglass stiffness | as C3D8 |
//! | C3D20 | 20 | 3 x 3 x 3 points | 3 x 3 x 3 points |
//! | C3D20R | 20 | 2 x 2 x 2 points | as C3D20 |
//!
//! Names are those of Abaqus and CalculiX. Stiffnesses are CalculiX's (`e_c3d.f`); its C3D8 is integrated in full,
//! without selective reduction of the volumetric strain. Masses are consistent and exact where `detJ` is constant.

use super::Shape;
use serde::{Deserialize, Serialize};

/// A kind of element.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
pub enum ElementKind {
    /// 4-node tetrahedron.
    C3D4,
    /// 6-node wedge.
    C3D6,
    /// 8-node hexahedron, integrated in full.
    C3D8,
    /// 8-node hexahedron with incompatible modes.
    C3D8I,
    /// 8-node hexahedron of mean strain, with hourglass stiffness.
    C3D8R,
    /// 10-node tetrahedron.
    C3D10,
    /// 15-node wedge.
    C3D15,
    /// 20-node hexahedron, integrated in full.
    C3D20,
    /// 20-node hexahedron of reduced integration.
    C3D20R,
}

use ElementKind::{C3D4, C3D6, C3D8, C3D8I, C3D8R, C3D10, C3D15, C3D20, C3D20R};

impl ElementKind {
    /// All kinds.
    pub const ALL: [ElementKind; 9] = [C3D4, C3D6, C3D8, C3D8I, C3D8R, C3D10, C3D15, C3D20, C3D20R];

    /// Name in Abaqus and CalculiX.
    pub const fn name(self) -> &'static str {
        match self {
            C3D4 => "C3D4",
            C3D6 => "C3D6",
            C3D8 => "C3D8",
            C3D8I => "C3D8I",
            C3D8R => "C3D8R",
            C3D10 => "C3D10",
            C3D15 => "C3D15",
            C3D20 => "C3D20",
            C3D20R => "C3D20R",
        }
    }

    /// The kind of a name; none where there is no such kind.
    pub fn from_name(name: &str) -> Option<ElementKind> {
        ElementKind::ALL.into_iter().find(|kind| kind.name() == name)
    }

    /// The geometry.
    pub const fn shape(self) -> Shape {
        match self {
            C3D4 => Shape::Tetrahedron4,
            C3D6 => Shape::Wedge6,
            C3D8 | C3D8I | C3D8R => Shape::Hexahedron8,
            C3D10 => Shape::Tetrahedron10,
            C3D15 => Shape::Wedge15,
            C3D20 | C3D20R => Shape::Hexahedron20,
        }
    }

    /// The kind that a shape has where a mesh does not say: hexahedra that bend well and have no hourglass modes.
    pub const fn default_for(shape: Shape) -> ElementKind {
        match shape {
            Shape::Tetrahedron4 => C3D4,
            Shape::Tetrahedron10 => C3D10,
            Shape::Wedge6 => C3D6,
            Shape::Wedge15 => C3D15,
            Shape::Hexahedron8 => C3D8I,
            Shape::Hexahedron20 => C3D20,
        }
    }

    /// Number of nodes.
    pub const fn n_nodes(self) -> usize {
        self.shape().n_nodes()
    }

    /// Why the kind is too stiff for modes of a brake, whose parts bend; none where it is not.
    pub const fn too_stiff(self) -> Option<&'static str> {
        match self {
            C3D4 => Some("its strain is constant, so bending takes many layers of elements"),
            C3D6 => Some("the strain of its triangles is constant, so bending takes many layers of elements"),
            C3D8 => Some("it locks in shear where it bends"),
            _ => None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_lead_back_to_their_kinds_and_defaults_to_their_shapes() {
        for kind in ElementKind::ALL {
            assert_eq!(ElementKind::from_name(kind.name()), Some(kind));
            assert_eq!(ElementKind::ALL[kind as usize], kind);
            assert_eq!(ElementKind::default_for(kind.shape()).shape(), kind.shape());
        }
        assert_eq!(ElementKind::from_name("C3D5"), None);
    }
}
