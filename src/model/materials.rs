//! Materials: which keys a kind has, which constants are possible, and the elasticity in global axes.

#![allow(non_snake_case)] // symbols of the formulas

use super::elasticity::{self, Transverse};
use super::item::{Item, Number, Vector};
use super::keys::{self, OneOrThree, Text};
use super::source::{ModelText, Span};
use super::viscoelastic::{self, ViscoelasticLaw};
use super::{Material, names};
use crate::Result;
use nalgebra::{Matrix3, Matrix6};
use toml::Spanned;

/// The kinds of material and the keys that belong to each, besides `kind`, `density`, `loss_factor` and
/// `viscoelastic`.
const KINDS: [(&str, &[&str]); 4] = [
    ("isotropic", &["young", "poisson"]),
    ("transverse", &["axis", "young", "young_axial", "poisson", "poisson_axial", "shear_axial"]),
    ("orthotropic", &["young", "poisson", "shear", "x_axis", "y_axis"]),
    ("full", &["elasticity", "x_axis", "y_axis"]),
];

const YOUNG: &str = "Give Pa, such as 110e9";
const THREE_YOUNG: &str = "Give three moduli in Pa, along x, y, z";
const THREE_POISSON: &str = "Give three ratios, xy, yz, zx";
const SHEAR: &str = "Give a shear modulus in Pa, such as 2e9";

/// All materials of the file.
///
/// # Errors
/// Input errors for keys of another kind and for constants that no material can have.
pub fn materials(source: ModelText, raw: &keys::Named<keys::MaterialTable>) -> Result<Vec<Material>> {
    raw.iter().map(|(name, material)| MaterialReader::new(source, name, material).read()).collect()
}

struct MaterialReader<'a> {
    item: Item<'a>,
    name: &'a str,
    raw: &'a keys::MaterialTable,
}

impl<'a> MaterialReader<'a> {
    fn new(source: ModelText<'a>, name: &'a Text, raw: &'a keys::MaterialTable) -> Self {
        let item = Item::new(source, format!("material {:?}", name.get_ref()), name.span());
        MaterialReader { item, name: name.get_ref(), raw }
    }

    fn read(&self) -> Result<Material> {
        let density = self.item.positive(&self.raw.density, "density", "Give kg/m3, such as 7850")?;
        let kind = self.kind()?;
        let viscoelastic = self.viscoelastic(kind)?;
        let elasticity = match (kind, &viscoelastic) {
            (_, Some((young, _))) => self.isotropic(*young)?,
            ("transverse", _) => self.transverse()?,
            ("orthotropic", _) => self.orthotropic()?,
            ("full", _) => self.full()?,
            _ => self.isotropic(self.young()?)?,
        };
        let elasticity = std::array::from_fn(|i| std::array::from_fn(|j| elasticity[(i, j)]));
        let loss_factor = self.item.loss_factor(&self.raw.loss_factor)?;
        let viscoelastic = viscoelastic.map(|(_, law)| law);
        Ok(Material { name: self.name.to_owned(), density, elasticity, loss_factor, viscoelastic })
    }

    /// Young's modulus at rest (Pa) and the viscoelastic law, where there is one.
    fn viscoelastic(&self, kind: &str) -> Result<Option<(f64, ViscoelasticLaw)>> {
        let Some(raw) = &self.raw.viscoelastic else { return Ok(None) };
        let require = |holds: bool, what: &str, advice: &str| self.item.require_at(&raw.span(), holds, what, advice);
        require(
            kind == "isotropic",
            "viscoelastic is for isotropic materials",
            "Leave kind out, or give a loss_factor",
        )?;
        let has_loss = self.raw.loss_factor.is_some();
        require(
            !has_loss,
            "viscoelastic and loss_factor are both given",
            "Leave loss_factor out: the law has the loss",
        )?;
        let young = self.raw.young.as_ref().map(|_| self.young()).transpose()?;
        viscoelastic::law(&self.item, raw, young).map(Some)
    }

    /// The material's kind, once all keys given belong to it.
    fn kind(&self) -> Result<&'static str> {
        let &(kind, known) = match &self.raw.kind {
            None => &KINDS[0],
            Some(wanted) => self.item.find("kind of material", wanted, &KINDS, |(kind, _)| kind)?,
        };
        match self.given().into_iter().find(|(key, _)| !known.contains(key)) {
            None => Ok(kind),
            Some((key, span)) => {
                let what = format_args!("{key} is no constant of the kind {kind:?}");
                let advice = format!("Leave it out, or give kind = one of {}", names::list(&owners(key)));
                Err(self.item.error(&span, what, advice))
            }
        }
    }

    /// The constants that the file gives, and where.
    fn given(&self) -> Vec<(&'static str, Span)> {
        fn place<T>(key: &'static str, value: &Option<Spanned<T>>) -> Option<(&'static str, Span)> {
            value.as_ref().map(|value| (key, value.span()))
        }
        let raw = self.raw;
        let places = [
            place("young", &raw.young),
            place("poisson", &raw.poisson),
            place("axis", &raw.axis),
            place("young_axial", &raw.young_axial),
            place("poisson_axial", &raw.poisson_axial),
            place("shear_axial", &raw.shear_axial),
            place("shear", &raw.shear),
            place("x_axis", &raw.x_axis),
            place("y_axis", &raw.y_axis),
            place("elasticity", &raw.elasticity),
        ];
        places.into_iter().flatten().collect()
    }

    fn isotropic(&self, young: f64) -> Result<Matrix6<f64>> {
        self.invert(&elasticity::isotropic_compliance(young, self.poisson(0.5, "Give Poisson's ratio, such as 0.3")?))
    }

    fn young(&self) -> Result<f64> {
        self.item.positive(&self.one(&self.raw.young, "young", YOUNG)?, "young", YOUNG)
    }

    fn transverse(&self) -> Result<Matrix6<f64>> {
        let (item, raw) = (&self.item, self.raw);
        let axis = item.required(&raw.axis, "axis", "Give the axis, such as [0, 0, 1]")?;
        let axis = item.direction(axis, "axis")?;
        let advice = "Give the contraction across the axis over the stretch along it";
        let ratio = item.required(&raw.poisson_axial, "poisson_axial", advice)?;
        let modulus = |value, key, advice| item.positive(item.required(value, key, advice)?, key, advice);
        let constants = Transverse {
            young: self.young()?,
            young_axial: modulus(&raw.young_axial, "young_axial", YOUNG)?,
            // Within a plane the ratio may come up to 1.
            poisson: self.poisson(1.0, "Give Poisson's ratio within the plane, such as 0.3")?,
            poisson_axial: item.check(ratio, true, "poisson_axial", "must be finite", advice)?,
            shear_axial: modulus(&raw.shear_axial, "shear_axial", SHEAR)?,
        };
        let local = self.invert(&elasticity::transverse_compliance(&constants))?;
        Ok(elasticity::rotate(&local, &elasticity::axes_about(axis)))
    }

    fn orthotropic(&self) -> Result<Matrix6<f64>> {
        let (item, raw) = (&self.item, self.raw);
        let shear = item.required(&raw.shear, "shear", "Give three moduli in Pa, xy, yz, zx")?;
        let young = self.three(&raw.young, "young", THREE_YOUNG)?;
        let young = item.each(&young, |x| x > 0.0, "young", "must be above 0", THREE_YOUNG)?;
        let poisson = item.finite(&self.three(&raw.poisson, "poisson", THREE_POISSON)?, "poisson")?;
        let shear = item.each(shear, |x| x > 0.0, "shear", "must be above 0", SHEAR)?;
        let local = self.invert(&elasticity::orthotropic_compliance(young, poisson, shear))?;
        Ok(elasticity::rotate(&local, &self.axes()?))
    }

    fn full(&self) -> Result<Matrix6<f64>> {
        let advice = "Give six rows of six numbers in Pa, in the order xx yy zz xy yz zx";
        let rows = self.item.required(&self.raw.elasticity, "elasticity", advice)?;
        let C = Matrix6::from_fn(|i, j| rows.get_ref()[i][j]);
        let require = |holds, what: &str, advice: &str| self.item.require_at(&rows.span(), holds, what, advice);
        require(C.iter().all(|c| c.is_finite()), "elasticity is not finite", advice)?;
        let differs = |&(i, j): &(usize, usize)| (C[(i, j)] - C[(j, i)]).abs() > 1e-6 * C.amax();
        if let Some((i, j)) = (0..6).flat_map(|i| (0..i).map(move |j| (j, i))).find(differs) {
            let (row, column) = (i + 1, j + 1);
            let what = format!(
                "elasticity is not symmetric: {:e} in row {row}, column {column}, {:e} in row {column}, column {row}",
                C[(i, j)],
                C[(j, i)]
            );
            return Err(self.item.error(&rows.span(), what, advice));
        }
        let C = elasticity::symmetric(&C);
        let what = "elasticity is not positive definite: some strain would have no or negative energy";
        let advice = "Look at signs, powers of ten and the order xx yy zz xy yz zx";
        require(elasticity::is_positive_definite(&C), what, advice)?;
        Ok(elasticity::rotate(&C, &self.axes()?))
    }

    /// Inverts a compliance, or says that the constants do not go together.
    fn invert(&self, compliance: &Matrix6<f64>) -> Result<Matrix6<f64>> {
        elasticity::from_compliance(compliance).ok_or_else(|| {
            self.item.error_here(
                "no material has these constants: the elasticity is not positive definite",
                "Make the Poisson's ratios smaller: nu_ij^2 < E_i / E_j, where j contracts under a stress along i",
            )
        })
    }

    /// Poisson's ratio, between -1 and a limit.
    fn poisson(&self, limit: f64, advice: &str) -> Result<f64> {
        let poisson = self.one(&self.raw.poisson, "poisson", advice)?;
        let nu = *poisson.get_ref();
        let must = format!("must be above -1 and below {limit}");
        self.item.check(&poisson, -1.0 < nu && nu < limit, "poisson", &must, advice)
    }

    /// The single number that this kind of material has under a key.
    fn one(&self, value: &Option<Spanned<OneOrThree>>, key: &str, advice: &str) -> Result<Number> {
        let value = self.item.required(value, key, advice)?;
        match *value.get_ref() {
            OneOrThree::One(number) => Ok(Spanned::new(value.span(), number)),
            OneOrThree::Three(_) => {
                let what = format_args!("{key} is one number here, not three");
                Err(self.item.error(&value.span(), what, "Three of them need kind = \"orthotropic\""))
            }
        }
    }

    /// The three numbers that this kind of material has under a key.
    fn three(&self, value: &Option<Spanned<OneOrThree>>, key: &str, advice: &str) -> Result<Vector> {
        let value = self.item.required(value, key, advice)?;
        match *value.get_ref() {
            OneOrThree::Three(numbers) => Ok(Spanned::new(value.span(), numbers)),
            OneOrThree::One(_) => {
                let what = format_args!("{key} is three numbers here, not one");
                Err(self.item.error(&value.span(), what, advice))
            }
        }
    }

    /// The material's axes as columns: those of the mesh, unless given.
    fn axes(&self) -> Result<Matrix3<f64>> {
        let axes = axes(&self.item, &self.raw.x_axis, &self.raw.y_axis)?;
        Ok(axes.unwrap_or_else(Matrix3::identity))
    }
}

/// Axes as columns, where `x_axis` and `y_axis` are given.
pub fn axes(item: &Item, x_axis: &Option<Vector>, y_axis: &Option<Vector>) -> Result<Option<Matrix3<f64>>> {
    let (x, y) = match (x_axis, y_axis) {
        (None, None) => return Ok(None),
        (Some(x), Some(y)) => (x, y),
        (Some(given), None) | (None, Some(given)) => {
            let what = "one of x_axis and y_axis alone does not fix the axes";
            return Err(item.error(&given.span(), what, "Give both, or neither"));
        }
    };
    let axes = elasticity::axes_from(item.direction(x, "x_axis")?, item.direction(y, "y_axis")?);
    axes.map(Some)
        .ok_or_else(|| item.error(&y.span(), "x_axis and y_axis are parallel", "Give two different directions"))
}

/// The kinds that have a key.
fn owners(key: &str) -> Vec<&'static str> {
    KINDS.iter().filter(|(_, keys)| keys.contains(&key)).map(|(kind, _)| *kind).collect()
}
