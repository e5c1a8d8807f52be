//! Tables of gaps and stiffness factors at contact points, which the model file of a point names.

use std::io::Write;

use toml_edit::{DocumentMut, Item, value};

use super::field::FieldQuantity;
use crate::{Error, Result};

/// A model file with the tables that its contacts name.
#[derive(Debug, Clone)]
pub struct PointModel {
    /// Its text, in which the contacts do not name these tables yet.
    pub text: String,
    /// The tables.
    pub tables: Vec<ContactTable>,
}

/// What the points of a contact have.
#[derive(Debug, Clone)]
pub struct ContactTable {
    /// The contact's place in the model file's list.
    pub contact: usize,
    /// Its name.
    pub name: String,
    /// What the numbers are.
    pub quantity: FieldQuantity,
    /// Positions (m) of the points with their gaps (m) or factors.
    pub rows: Vec<([f64; 3], f64)>,
}

impl PointModel {
    /// The quantities of its tables, each once.
    pub fn quantities(&self) -> impl Iterator<Item = FieldQuantity> {
        let is_there = |quantity: &FieldQuantity| self.tables.iter().any(|table| table.quantity == *quantity);
        [FieldQuantity::Gap, FieldQuantity::Stiffness].into_iter().filter(is_there)
    }

    /// The files of its tables.
    pub fn files(&self) -> Vec<&'static str> {
        self.quantities().map(FieldQuantity::file).collect()
    }
}

impl FieldQuantity {
    /// The file of the tables beside the model file.
    pub fn file(self) -> &'static str {
        match self {
            FieldQuantity::Gap => "worst-gap.csv",
            FieldQuantity::Stiffness => "worst-stiffness.csv",
        }
    }

    /// The key of a contact that names the file.
    fn key(self) -> &'static str {
        match self {
            FieldQuantity::Gap => "gap",
            FieldQuantity::Stiffness => "stiffness_factor",
        }
    }

    /// The column of the numbers.
    fn column(self) -> &'static str {
        match self {
            FieldQuantity::Gap => "gap_m",
            FieldQuantity::Stiffness => "factor",
        }
    }
}

/// The text of a model file whose contacts name the files of their tables, in place of files and images that they had:
/// the tables contain those.
///
/// # Errors
/// [`Error::Input`] where the text is no model file with these contacts.
pub fn with_tables(text: &str, tables: &[ContactTable]) -> Result<String> {
    let mut document: DocumentMut = text.parse().map_err(|reason| Error::input(format!("no model file: {reason}")))?;
    for table in tables {
        let contact = document.get_mut("contact").and_then(|list| list.get_mut(table.contact));
        let contact = contact.and_then(Item::as_table_like_mut);
        let contact = contact.ok_or_else(|| Error::input(format!("there is no contact {:?}", table.name)))?;
        contact.insert(table.quantity.key(), value(table.quantity.file()));
        if table.quantity == FieldQuantity::Gap {
            contact.remove("gap_image");
        }
    }
    Ok(document.to_string())
}

/// Writes the tables of one quantity: a row a point, all digits.
///
/// # Errors
/// The system's.
pub fn write_tables(out: &mut dyn Write, quantity: FieldQuantity, tables: &[ContactTable]) -> std::io::Result<()> {
    let mut table = csv::Writer::from_writer(out);
    table.write_record(["contact", "x_m", "y_m", "z_m", quantity.column()])?;
    for own in tables.iter().filter(|own| own.quantity == quantity) {
        for (x, number) in &own.rows {
            let [x, y, z] = x.map(|x| x.to_string());
            table.write_record([&own.name, &x, &y, &z, &number.to_string()])?;
        }
    }
    table.flush()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn table(contact: usize, quantity: FieldQuantity) -> ContactTable {
        let rows = vec![([0.1, 1.0 / 3.0, -1e-9], 1.0 / 7.0)];
        ContactTable { contact, name: "a, b".into(), quantity, rows }
    }

    #[test]
    fn contacts_name_their_tables_in_place_of_what_they_had() {
        let text =
            "[[contact]]\nslave = \"a\"\n[[contact]]\nslave = \"b\"\ngap = \"a.png\"\ngap_image = { black = 0 }\n";
        let tables = [table(1, FieldQuantity::Gap), table(0, FieldQuantity::Stiffness)];
        let expected = "[[contact]]\nslave = \"a\"\nstiffness_factor = \"worst-stiffness.csv\"\n\
                        [[contact]]\nslave = \"b\"\ngap = \"worst-gap.csv\"\n";
        assert_eq!(with_tables(text, &tables).unwrap(), expected);
        assert!(with_tables(text, &[table(2, FieldQuantity::Gap)]).is_err());
    }

    #[test]
    fn a_table_has_all_digits() {
        let mut out = Vec::new();
        let tables = [table(0, FieldQuantity::Gap), table(0, FieldQuantity::Stiffness)];
        write_tables(&mut out, FieldQuantity::Gap, &tables).unwrap();
        let expected = "contact,x_m,y_m,z_m,gap_m\n\"a, b\",0.1,0.3333333333333333,-0.000000001,0.14285714285714285\n";
        assert_eq!(String::from_utf8(out).unwrap(), expected);
    }
}
