//! Brakes as decks: written of a model file, and as an instance of a part.

use std::path::Path;

use squeal::contact::search::Alone;
use squeal::deck;
use squeal::mesh::{Numbering, Piece};
use squeal::model::UnitSystem;
use squeal::structure::{FullModel, ModelFiles};

/// The brake of a model file or deck.
pub fn brake(file: &Path) -> FullModel {
    let ModelFiles { model, mesh, .. } = ModelFiles::read(file, None).unwrap_or_else(|error| panic!("{error}"));
    let nodes = Numbering::even(mesh.nodes.len(), 0, 1);
    FullModel::new(model, Piece { mesh, nodes }, &Alone).unwrap_or_else(|error| panic!("{error}"))
}

/// A model as the text of a deck.
pub fn deck_of(file: &Path, units: UnitSystem) -> String {
    let ModelFiles { model, mesh, .. } = ModelFiles::read(file, None).unwrap();
    let mut out = Vec::new();
    let losses = deck::write(&model, &mesh, units, "a test", &mut out).unwrap();
    assert!(
        losses.iter().all(|loss| ["sweep", "search", "reduction", "wear"].iter().any(|word| loss.contains(word))),
        "{losses:?}"
    );
    String::from_utf8(out).unwrap()
}

/// The brake that a deck's text means.
pub fn brake_of(deck: &str) -> FullModel {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("brake.inp");
    std::fs::write(&file, deck).unwrap();
    brake(&file)
}

/// A flat deck as a part with one instance, moved along z and turned about it.
pub fn as_instance(deck: &str) -> String {
    const OF_PART: [&str; 6] = ["*NODE", "*ELEMENT", "*NSET", "*SURFACE", "*SOLID SECTION", "*SPRING"];
    const WITH_NAMES: [&str; 4] = ["*CONTACT PAIR", "*BOUNDARY", "*CLOAD", "*MOTION"];
    let (mut part, mut rest) = (String::new(), String::new());
    for block in deck.split("\n*").skip(1).filter(|block| !block.starts_with('*')) {
        let (head, data) = block.split_once('\n').unwrap_or((block, ""));
        let head = format!("*{head}");
        let keyword = head.split(',').next().unwrap();
        let out = if OF_PART.contains(&keyword) { &mut part } else { &mut rest };
        let names = ["REF NODE=", "SURFACE="].into_iter().filter(|_| keyword == "*COUPLING");
        *out += &names.fold(format!("{head}\n"), |head, name| head.replace(name, &format!("{name}B-1.")));
        for line in data.lines() {
            let line = match keyword {
                "*CONTACT PAIR" => line.split(',').map(|name| format!("B-1.{name}")).collect::<Vec<_>>().join(","),
                _ if WITH_NAMES.contains(&keyword) => format!("B-1.{line}"),
                _ => line.to_owned(),
            };
            *out += &format!("{line}\n");
        }
    }
    let place = "0., 0., 7.\n0.,0.,0., 0.,0.,1., 37.";
    format!(
        "*PART, NAME=BRAKE\n{part}*END PART\n*ASSEMBLY, NAME=A\n*INSTANCE, NAME=B-1, PART=BRAKE\n{place}\n*END INSTANCE\n\
         *END ASSEMBLY\n{rest}"
    )
}
