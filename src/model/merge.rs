//! A model file that names a deck as its mesh: what the file has stands above what the deck has.

use super::{Model, names};
use crate::Result;

impl Model {
    /// This model file on top of the model of its deck.
    ///
    /// Parts, contacts, connectors, ties, rigid sets, masses, equations and loads of the file take the place of those
    /// of the same name, rotations of those of the same part; fixes are added; band, sweep, reduction and title are the
    /// file's; prestress, too, where it has it.
    ///
    /// # Errors
    /// [`Error::Input`](crate::Error::Input) for a rotation of no part, and a sweep of no contact.
    pub fn over(mut self, mut deck: Model) -> Result<Model> {
        let n_files = self.files.len() as u16;
        deck.shift_places(n_files);
        self.files.append(&mut deck.files);
        replace(&mut deck.parts, &mut self.parts, |a, b| a.name == b.name);
        replace(&mut deck.contacts, &mut self.contacts, |a, b| a.name == b.name);
        replace(&mut deck.connectors, &mut self.connectors, |a, b| a.name == b.name);
        replace(&mut deck.ties, &mut self.ties, |a, b| a.name == b.name);
        replace(&mut deck.rigid_sets, &mut self.rigid_sets, |a, b| a.name == b.name);
        replace(&mut deck.masses, &mut self.masses, |a, b| a.name == b.name);
        replace(&mut deck.equations, &mut self.equations, |a, b| a.name == b.name);
        replace(&mut deck.loads, &mut self.loads, |a, b| a.name == b.name);
        replace(&mut deck.rotations, &mut self.rotations, |a, b| a.part == b.part);
        deck.fixes.append(&mut self.fixes);
        let Model { parts, contacts, connectors, ties, rigid_sets, masses, equations, loads, rotations, fixes, .. } =
            deck;
        let prestress = self.prestress.or(deck.prestress);
        let model = Model {
            parts,
            contacts,
            connectors,
            ties,
            rigid_sets,
            masses,
            equations,
            loads,
            rotations,
            fixes,
            prestress,
            ..self
        };
        model.check_names()?;
        Ok(model)
    }

    /// Names within the model that a file alone could not check.
    fn check_names(&self) -> Result<()> {
        let parts = || self.parts.iter().map(|part| part.name.as_str());
        if let Some(rotation) = self.rotations.iter().find(|rotation| !parts().any(|part| part == rotation.part)) {
            let advice = names::advice(&rotation.part, parts());
            return Err(
                self.error(rotation.place, format_args!("there is no part {:?} to turn. {advice}", rotation.part))
            );
        }
        let contacts = || self.contacts.iter().map(|contact| contact.name.as_str());
        match self.swept.iter().find(|name| !contacts().any(|contact| contact == *name)) {
            None => Ok(()),
            Some(name) => {
                let advice = names::advice(name, contacts());
                Err(self.error(self.sweep_place, format_args!("unknown contact {name:?} (sweep). {advice}")))
            }
        }
    }

    /// Moves all places by a number of files.
    fn shift_places(&mut self, n_files: u16) {
        self.parts.iter_mut().for_each(|item| item.place.file += n_files);
        self.fixes.iter_mut().for_each(|item| item.place.file += n_files);
        self.rotations.iter_mut().for_each(|item| item.place.file += n_files);
        self.contacts.iter_mut().for_each(|item| item.place.file += n_files);
        self.connectors.iter_mut().for_each(|item| item.place.file += n_files);
        self.ties.iter_mut().for_each(|item| item.place.file += n_files);
        self.rigid_sets.iter_mut().for_each(|item| item.place.file += n_files);
        self.masses.iter_mut().for_each(|item| item.place.file += n_files);
        self.equations.iter_mut().for_each(|item| item.place.file += n_files);
        self.loads.iter_mut().for_each(|item| item.place.file += n_files);
    }
}

/// Puts items into the places of those that are the same, and the others behind them.
fn replace<T>(base: &mut Vec<T>, items: &mut Vec<T>, is_same: impl Fn(&T, &T) -> bool) {
    for item in items.drain(..) {
        match base.iter_mut().find(|known| is_same(known, &item)) {
            Some(known) => *known = item,
            None => base.push(item),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::parse;
    use super::*;
    use std::path::Path;

    const DECK: &str = "[mesh]\nfile = \"a.msh\"\nunit = \"mm\"\n[material.a]\nyoung = 1e9\npoisson = 0.3\ndensity = 1e3\n\
                        [part.disc]\nmaterial = \"a\"\n[part.pad]\nmaterial = \"a\"\n[[contact]]\nname = \"pair\"\n\
                        slave = \"s\"\nmaster = \"m\"\nlaw = { linear = 1e12 }\nfriction = 0.1\n[stability]\nband = [0, 1]\n";
    const FILE: &str = "[mesh]\nfile = \"a.inp\"\nunit = \"mm\"\n[[rotation]]\npart = \"disc\"\naxis = [0, 0, 1]\nspeed = 5\n\
                        [[contact]]\nname = \"pair\"\nslave = \"s\"\nmaster = \"m\"\nlaw = { linear = 2e12 }\nfriction = 0.5\n\
                        [[fix]]\nnodes = \"hub\"\naxes = \"xyz\"\n[stability]\nband = [0, 9]\n\
                        [sweep]\nfriction = { contacts = [\"pair\"], values = [0.1] }\n";

    fn merged(file: &str) -> Result<Model> {
        let deck = parse(DECK, Path::new("b.toml")).unwrap();
        parse(file, Path::new("brake.toml")).and_then(|model| model.over(deck))
    }

    #[test]
    fn the_file_stands_above_the_deck() {
        let model = merged(FILE).unwrap();
        assert_eq!((model.parts.len(), model.contacts.len(), model.fixes.len()), (2, 1, 1));
        assert_eq!((model.contacts[0].friction, model.contacts[0].place.file), (0.5, 0));
        assert_eq!((model.parts[0].place.file, model.files[1].as_path()), (1, Path::new("b.toml")));
        assert_eq!(model.band, [0.0, 9.0]);
    }

    #[test]
    fn prestress_is_the_files_where_it_has_it() {
        let both = |file: &str, deck: &str| {
            let with = |text: &str, key: &str| text.replace("[stability]\n", &format!("[stability]\n{key}\n"));
            let deck = parse(&with(DECK, deck), Path::new("b.toml")).unwrap();
            parse(&with(FILE, file), Path::new("brake.toml")).unwrap().over(deck).unwrap().prestress
        };
        assert_eq!(both("", "prestress = true"), Some(true));
        assert_eq!(both("prestress = false", "prestress = true"), Some(false));
        assert_eq!(both("", ""), None);
    }

    #[test]
    fn names_are_those_of_both() {
        let message = merged(&FILE.replace("part = \"disc\"", "part = \"disk\"")).unwrap_err().to_string();
        assert!(
            message.starts_with("brake.toml:4: there is no part \"disk\" to turn. Did you mean \"disc\"?"),
            "{message}"
        );
        let message = merged(&FILE.replace("contacts = [\"pair\"]", "contacts = [\"pear\"]")).unwrap_err().to_string();
        assert!(message.starts_with("brake.toml:20: unknown contact \"pear\""), "{message}");
    }
}
