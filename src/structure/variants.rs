//! One model with other numbers: model file and mesh are read once.

use std::path::{Path, PathBuf};

use crate::mesh::Piece;
use crate::model::{self, Model};
use crate::native::Comm;
use crate::{Error, Result};

use super::FullModel;
use super::distribution::distribute;
use super::files::{ModelFiles, SharedFiles};

/// A model file and this rank's piece of its mesh, of which brakes with other numbers are made.
pub struct ModelVariants {
    /// The model file.
    pub file: PathBuf,
    /// Its text.
    pub text: String,
    /// The model as it stands in the file.
    pub model: Model,
    /// Names of the contacts whose friction coefficient a sweep changes.
    pub swept: Vec<String>,
    piece: Piece,
}

impl ModelVariants {
    /// Reads and checks a model file and its mesh. Collective.
    ///
    /// # Errors
    /// [`Error::Input`] for whatever is wrong with the files, and for decks.
    pub fn read(comm: &Comm, file: &Path) -> Result<ModelVariants> {
        let SharedFiles { model, mesh, text, .. } = ModelFiles::shared(comm, file)?;
        let Some(text) = text else {
            let what = "a study changes the numbers of a model file with a Gmsh mesh, and this is a deck or has one";
            return Err(Error::input(format!("{}: {what}. Write it as one by squeal convert", file.display())));
        };
        let piece = distribute(comm, || Ok(mesh.expect("the root has read it")))?;
        comm.agree(model.check_against(&piece.mesh))?;
        let swept = model.swept_contacts(&piece.mesh).into_iter().map(|i| model.contacts[i].name.clone()).collect();
        Ok(ModelVariants { file: file.to_owned(), text, model, swept, piece })
    }

    /// The brake of another text of the model file with the same mesh, with so many reference pairs in place of the
    /// contact points of the sliding pairs where `contacts` asks for them. Collective: all ranks fail together.
    ///
    /// # Errors
    /// [`Error::Input`] for whatever is wrong with the text, and a part that can move freely.
    pub fn brake(&self, comm: &Comm, text: &str, contacts: Option<usize>) -> Result<FullModel> {
        let model = comm.agree(model::parse(text, &self.file))?;
        self.brake_of(comm, model, contacts)
    }

    /// As [`ModelVariants::brake`], of a model in place of its text. Collective: all ranks fail together.
    ///
    /// # Errors
    /// As [`ModelVariants::brake`].
    pub fn brake_of(&self, comm: &Comm, model: Model, contacts: Option<usize>) -> Result<FullModel> {
        let mut full = comm.agree(FullModel::new(model, self.piece.clone(), comm))?;
        contacts.map_or(Ok(()), |n| full.reduce_contacts(n))?;
        full.require_constrained(comm)?;
        Ok(full)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::native::Session;

    #[test]
    fn a_variant_is_the_model_with_other_numbers() {
        let comm = Session::start(&[]).unwrap();
        let variants = ModelVariants::read(&comm, "tests/data/pads_on_disc.toml".as_ref()).unwrap();
        assert_eq!(variants.swept, ["disc / inner pad", "disc / outer pad"]);
        let brake = variants.brake(&comm, &variants.text.replace("young = 8e9", "young = 4e9"), None).unwrap();
        let young = |model: &Model| format!("{:?}", model.parts[1].material);
        assert_ne!(young(&brake.model), young(&variants.model));
        assert_eq!(brake.interface.points.len(), 236);
        assert_eq!(variants.brake(&comm, &variants.text, Some(12)).unwrap().interface.points.len(), 12);
        let free = variants.text.replace("axes = \"xy\"", "axes = \"x\"");
        assert!(variants.brake(&comm, &free, None).err().unwrap().to_string().contains("unconstrained"));
    }
}
