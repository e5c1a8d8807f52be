//! Studies of many parameters: which points are analysed, and probabilities and indices from their modes.
//! Pure.
//!
//! ```text
//! explore.toml --read--> Study { parameters, design } --points--> values of the parameters, point by point
//! model file + values --Template--> text of another model file --(analysis)--> PointResult { modes }
//! PointResult of all points --Answers::new--> probabilities, quantiles, Sobol indices, tornado, worst point
//! ```
//!
//! A study has a file of its own, which names the model or super-element. So a model file contains what is analysed and
//! nothing else, one model has many studies, and one study is made of a model and of its super-element.

mod adaptive;
mod answers;
mod contact_table;
mod correlation;
mod design;
mod design_table;
mod distribution;
mod field;
mod gradient;
mod hopf;
mod instability;
mod key;
mod linking;
mod predicted;
mod random_field;
mod refinement;
mod result;
mod sensitivity;
mod shapes;
mod states;
mod statistics;
mod study;
mod template;

pub use adaptive::{BoundaryPair, BoundarySearch};
pub use answers::{Answers, Bin, quantity};
pub use contact_table::{ContactTable, PointModel, with_tables, write_tables};
pub use correlation::Correlation;
pub use design::{AdaptiveRule, Design, DesignKind};
pub use distribution::Distribution;
pub use field::{Field, FieldQuantity};
pub use gradient::{Difference, Gradient, Influence, MissingDerivative, Tornado, missing_derivatives, tornados};
pub use hopf::{HopfCurves, HopfPoint, HopfSearch};
pub use instability::Instability;
pub use key::KeyPath;
pub use linking::{ModeProducts, link};
pub use random_field::{Kernel, RandomField};
pub use refinement::Refinement;
pub use result::{Link, Outcome, PointMode, PointResult};
pub use sensitivity::{Bar, Estimate, Indices, sobol_indices, tornado};
pub use shapes::{ModePlace, by_weight, keeps_shapes, shaped_modes};
pub use states::{State, StateWear, States};
pub use statistics::{Probability, quantile};
pub use study::{Parameter, Study, read};
pub use template::{Nominal, Template, standing_alone};
