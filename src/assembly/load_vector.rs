//! The load of a system.

use super::{DofMap, System};
use crate::Result;
use crate::native::Vector;

impl System {
    /// Adds forces (N) at nodes to the load; those at constrained dofs go into the support.
    ///
    /// # Errors
    /// PETSc's.
    pub fn add_load(&mut self, forces: &[(u32, [f64; 3])]) -> Result<()> {
        add_forces(&self.dofs, forces, &mut self.load)
    }

    /// As [`System::add_load`], of forces that no load factor multiplies.
    ///
    /// # Errors
    /// PETSc's.
    pub fn add_constant_load(&mut self, forces: &[(u32, [f64; 3])]) -> Result<()> {
        add_forces(&self.dofs, forces, &mut self.constant_load)?;
        self.add_load(forces)
    }

    /// Multiplies the load, but not its constant part. Collective.
    ///
    /// # Errors
    /// PETSc's.
    pub fn scale_load(&mut self, factor: f64) -> Result<()> {
        self.load.axpy(-1.0, &self.constant_load)?;
        self.load.scale(factor)?;
        self.load.axpy(1.0, &self.constant_load)
    }
}

fn add_forces(dofs: &DofMap, forces: &[(u32, [f64; 3])], load: &mut Vector) -> Result<()> {
    let owned = dofs.owned();
    load.local_mut(|load| {
        for (node, force) in forces {
            for (dof, f) in dofs.node_dofs(*node).into_iter().zip(force) {
                if owned.contains(&dof) {
                    load[(dof - owned.start) as usize] += f;
                }
            }
        }
    })
}

#[cfg(test)]
mod tests {
    use crate::assembly::System;
    use crate::mesh::Numbering;
    use crate::native::Session;

    #[test]
    fn a_factor_multiplies_all_but_the_constant_load() {
        let comm = Session::start(&[]).unwrap();
        let held = [[false; 3], [true, false, true]];
        let mut system = System::assemble(&comm, &Numbering::even(2, 0, 1), &held, &[], &[]).unwrap();
        system.add_load(&[(0, [0.0, 0.0, -100.0]), (1, [5.0, 6.0, 7.0])]).unwrap();
        system.add_constant_load(&[(0, [1.0, 0.0, -3.0])]).unwrap();
        assert_eq!(system.load.to_vec().unwrap(), [1.0, 0.0, -103.0, 6.0]);
        system.scale_load(1.5).unwrap();
        assert_eq!(system.load.to_vec().unwrap(), [1.0, 0.0, -153.0, 9.0]);
    }
}
