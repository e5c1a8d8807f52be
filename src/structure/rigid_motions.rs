//! One part of a brake, free.

use std::path::Path;

use nalgebra::{Matrix6, SMatrix};

use super::FullModel;
use crate::assembly::System;
use crate::mesh::Mesh;
use crate::native::{Block, Comm};
use crate::stability::Mode;
use crate::{Error, Result};

impl FullModel {
    /// Reads one part of a model, without constraints and loads. Collective.
    ///
    /// # Errors
    /// [`Error::Input`] where there is no such part, or see [`FullModel::read`].
    pub fn read_part(comm: &Comm, path: &Path, part: &str) -> Result<FullModel> {
        let one = |mesh: Mesh| {
            mesh.only(part).ok_or_else(|| Error::input(format!("{}: the mesh has no part {part:?}", path.display())))
        };
        FullModel::from_files(comm, path, &mut |_| (), |model, mesh| {
            Ok((model.only(part)?, mesh.map(one).transpose()?))
        })
    }
}

/// The six rigid motions of a free structure, in the norm of its mass.
pub struct RigidMotions {
    /// `M R` by columns.
    image: Block,
    /// `(R^T M R)^-1`
    inverse: Matrix6<f64>,
}

impl RigidMotions {
    /// Those of a brake of which nothing is held: translations along and rotations about the axes through the mean of
    /// its nodes. Collective.
    ///
    /// # Errors
    /// PETSc's; [`Error::Input`] where the nodes lie on a line.
    pub fn new(brake: &FullModel, system: &System) -> Result<RigidMotions> {
        let comm = system.k.comm();
        let own: Vec<[f64; 3]> = system.dofs.owned_nodes().map(|n| brake.mesh.nodes[n as usize]).collect();
        let mut sums = [0, 1, 2, 3].map(|i| own.iter().map(|x| x.get(i).copied().unwrap_or(1.0)).sum::<f64>());
        comm.sum_all(&mut sums);
        let centre = [0, 1, 2].map(|i| sums[i] / sums[3]);
        let mut motions = Block::zeros(comm, system.dofs.n_local(), 6);
        for (node, x) in own.iter().enumerate() {
            let [x, y, z] = [0, 1, 2].map(|i| x[i] - centre[i]);
            let rotations = [[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]];
            for i in 0..3 {
                motions.column_mut(i)[3 * node + i] = 1.0;
                (0..3).for_each(|axis| motions.column_mut(3 + axis)[3 * node + i] = rotations[axis][i]);
            }
        }
        let image = motions.multiplied_by(&system.m)?;
        let gram: SMatrix<f64, 6, 6> = Matrix6::from_column_slice(&motions.gram(&image));
        let inverse =
            gram.try_inverse().ok_or_else(|| Error::input("the part has no extent: its nodes lie on a line"))?;
        Ok(RigidMotions { image, inverse })
    }

    /// The part of a mode's `x^H M x` that is rigid motion. Collective.
    ///
    /// # Errors
    /// PETSc's.
    pub fn share(&self, system: &System, mode: &Mode) -> Result<f64> {
        let x: Vec<f64> = [mode.re.to_vec()?, mode.im.to_vec()?].concat();
        let x = if x.is_empty() {
            Block::zeros(system.k.comm(), 0, 2)
        } else {
            Block::from_columns(system.k.comm(), x.len() / 2, x)
        };
        let whole = x.gram(&x.multiplied_by(&system.m)?);
        let with = SMatrix::<f64, 6, 2>::from_column_slice(&self.image.gram(&x));
        let rigid = with.transpose() * self.inverse * with;
        Ok(rigid.trace() / (whole[0] + whole[3]))
    }
}
