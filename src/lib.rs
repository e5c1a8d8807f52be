//! Predicts disc-brake squeal: contact equilibrium and complex modes of a finite element brake, on PETSc, SLEPc and
//! MUMPS.
//!
//! A brake squeals when friction couples two modes. The model: parts of solid elements, pads pressed against a
//! turning disc by penalty contact with Coulomb friction; its static equilibrium; the linearised, damped quadratic
//! eigenproblem about it; and a sweep of the friction coefficient. Source of the formulation: Fazio, Nacivet and Sinou,
//! *A finite element model reduction based on super-elements for brake squeal study*, ISMA 2014.
//!
//! # A first program
//!
//! ```no_run
//! use squeal::analysis::{StabilityOptions, stability};
//! use squeal::structure::StructureOptions;
//! use squeal::{Session, Structure};
//!
//! # fn main() -> squeal::Result<()> {
//! let comm = Session::start(&[])?;
//! let brake = Structure::read(&comm, "brake.toml".as_ref(), &StructureOptions::default())?;
//! let options = StabilityOptions { friction_values: Some(vec![0.2, 0.5]), ..StabilityOptions::default() };
//! let results = stability(&comm, &brake, &options, &mut ())?;
//! for (mu, _, mode) in results.modes().filter(|(_, _, mode)| mode.unstable) {
//!     println!("mu = {mu}: {:.1} Hz grows by {:.1} 1/s", mode.frequency(), mode.growth_rate());
//! }
//! # Ok(())
//! # }
//! ```
//!
//! # Modules
//!
//! ```text
//!  model file + mesh --> FullModel ---\
//!                                      Structure --assemble--> System { M, C, K, load } + Interface { B, laws }
//!  super-element file -> ReducedModel /                                      |
//!                                                        equilibrium (SNES) --> Equilibrium
//!                                                                            |
//!                         Modes <--stability (PEP, MUMPS)-- { M, C, K } <--linearise
//!                           |
//!      analysis: Modes over the friction coefficient <--> tracking: branches, Hopf points
//!                           |
//!                        Results --> output: results folder, tables, VTU --> report: HTML page
//! ```
//!
//! Each module may import the modules above it in this table, and no other:
//!
//! | module | what it does | main entry |
//! |---|---|---|
//! | [`error`] | typed errors and exit codes | [`Error`] |
//! | `hdf` | what all HDF5 files of the program share | |
//! | `algebra` | vectors of three and matrices of 3 x 3 | |
//! | [`native`] | the only `unsafe`: MPI, LAPACK, PETSc, SLEPc, MUMPS, METIS | [`native::Session::start`] |
//! | [`element`] | solid elements, facets, quadrature, couplings: pure functions | [`element::solid`] |
//! | [`mesh`] | nodes, elements by part, surfaces; Gmsh meshes | [`mesh::read`] |
//! | [`model`] | what is analysed, from the user's file, checked, in SI units | [`model::read`] |
//! | [`tracking`] | branches of modes along a parameter, Hopf points: pure | [`tracking::track`] |
//! | [`explore`] | studies of many parameters: points, probabilities, Sobol indices: pure | [`explore::read`] |
//! | [`contact`] | search, gap operator `g = B u`, contact and friction laws | [`contact::Interface::build`] |
//! | [`deck`] | input files of Abaqus and CalculiX, read and written | [`deck::read`] |
//! | [`matrices`] | external M, C, K from files and into files | [`matrices::ExternalMatrices::read`] |
//! | [`assembly`] | dofs, pattern, M, C, K on many ranks | [`assembly::System::assemble`] |
//! | [`equilibrium`] | Newton's method, the path from rest, balances | [`equilibrium::Path::advance`] |
//! | [`stability`] | modes of a band, none missed; energies, sensitivities | [`stability::BandSolver::solve_band`] |
//! | [`reduction`] | reference nodes, super-elements and their files | [`reduction::craig_bampton::reduce`] |
//! | [`results`] | what an analysis found, as plain data, and its file | [`results::Results`], [`results::file`] |
//! | [`structure`] | a brake, full or reduced: reading, assembly, surface | [`structure::Structure::read`] |
//! | [`comparison`] | which modes of two results are the same, and by how much they differ | [`comparison::compare`] |
//! | [`output`] | results folders, tables, JSON, VTU | [`output::results_folder::write`] |
//! | [`analysis`] | statics, stability, reduction, external matrices, free modes, study | [`analysis::stability`] |
//! | [`report`] | the HTML page: findings, wording, figures | [`report::page::page`] |
//! | [`cli`] | arguments, progress, exit codes | [`cli::main`] |
//!
//! To change a friction law, change `contact/law/`; nothing else depends on it.
//!
//! # The one idea
//!
//! Whatever contributes to M, C or K is an *element* with a list of nodes; one assembly layer scatters them all.
//! Contact laws see a body only through its *gap operator* `g = B u`; so a reduced model is another B and another u,
//! and equilibrium, stability and analysis exist once.
//!
//! # Ranks
//!
//! The first rank reads the mesh and cuts it
//! by METIS, numbers the nodes rank by rank, and sends each rank its piece: the nodes that the rank owns, all
//! elements that touch them, and everything that has a name ([`mesh::Piece`]). So each rank owns a range of rows,
//! computes the elements that touch them without any communication, and writes its own piece of the results. Surfaces
//! are on every rank, and so are the contact points and their state, which grow with the power 2/3 of the volume; ranks
//! divide the search for them and exchange what they found.
//!
//! Nodes have *local* numbers, those of the piece: a mesh, a gap operator, loads and supports all use them.
//! [`mesh::Numbering`] knows the global ones; local numbers rise with them, so that what is ordered by nodes is ordered
//! alike on all ranks.
//!
//! # Notation
//!
//! | symbol | name in signatures | meaning, unit |
//! |---|---|---|
//! | M, C, K | `m`, `c`, `k` | mass kg, damping N s/m, stiffness N/m |
//! | G | `g` | structural damping N/m, `sum g_e K_e` with the loss factors g_e |
//! | u | `u` | displacements of the equations, m |
//! | B, g | `gap_operator`, `gap` | relative displacement at the contact points `g = B u`, m |
//! | n, t | `normal`, `direction` | master's outward normal; direction of sliding |
//! | d | `penetration` | `-(gap0 + n.g)`, m |
//! | p | `normal_force` | normal force of a point, N |
//! | mu | `friction` | coefficient of friction |
//! | xi | `correction` | what a reduced contact's penetration gets, m |
//! | Psi, Phi, E | `basis` | constraint, fixed-interface and residual modes of a super-element |
//! | w | `weight` | area of a contact point, m2 |
//! | k_n, k_t | `stiffness`, `stick` | penalty of contact and of sticking, N/m3 |
//! | D | `tangent` | `-df/dg` of a contact point, N/m |
//! | lambda = a + i omega | `lambda`, `growth_rate`, `frequency` | eigenvalue 1/s; a > 0 squeals |
//! | x, y | `right`, `left` | vectors of a mode, `P(lambda) x = 0`, `y^H P(lambda) = 0` |
//! | alpha, beta | `rayleigh` | `C = alpha M + beta K` of a part |

mod algebra;
pub mod analysis;
pub mod assembly;
pub mod cli;
pub mod comparison;
pub mod contact;
pub mod deck;
pub mod element;
pub mod equilibrium;
pub mod error;
pub mod explore;
mod hdf;
pub mod matrices;
pub mod mesh;
pub mod model;
pub mod native;
pub mod output;
pub mod reduction;
pub mod report;
pub mod results;
pub mod stability;
pub mod structure;
pub mod tracking;

pub use error::{Error, ErrorKind, Result};
pub use model::Model;
pub use native::{Comm, Session};
pub use results::Results;
pub use structure::Structure;
