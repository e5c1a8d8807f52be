//! Predicts disc-brake squeal: contact equilibrium and complex modes of a finite element brake, on PETSc, SLEPc and MUMPS.
//!
//! A brake squeals when friction couples two modes. The model: parts of 10-node tetrahedra, pads pressed against a turning
//! disc by penalty contact with Coulomb friction; its static equilibrium; the linearised, damped quadratic eigenproblem about
//! it; and a sweep of the friction coefficient. Source of the formulation: Fazio, Nacivet and Sinou, *A finite element
//! model reduction based on super-elements for brake squeal study*, ISMA 2014.
//!
//! # The house
//!
//! ```text
//!  model file -> model --> mesh --> assembly: elements (tetrahedra, connectors) -> System { M, C, K, load }
//!                  \        \                                                          |
//!                   `--------`--> contact: search -> gap operator B, laws -> Interface |
//!                                                        \                             |
//!                                    System + Interface --equilibrium (SNES)--> Equilibrium
//!                                                                                |
//!                         Modes <--stability (PEP)-- Pencil { M, C, K } <--linearise
//!                           |
//!             sweep over friction <--> tracking: branches, Hopf points
//!                           |
//!                     cli --> results --> output: tables, CSV, JSON, VTU --> report
//! ```
//!
//! Every stage is one room with one main function from typed input to typed output:
//!
//! | room | what it does | main entry |
//! |---|---|---|
//! | [`model`] | the user's file, checked, in SI units | [`model::read`] |
//! | [`mesh`] | Gmsh meshes of 10-node tetrahedra, checked | [`mesh::read`] |
//! | [`element`] | tetrahedron, facet, quadrature, couplings: pure functions | [`element::tet10`] |
//! | [`contact`] | search, gap operator `g = B u`, contact and friction laws | [`contact::Interface::build`] |
//! | [`assembly`] | equations, pattern, M, C, K on many ranks | [`assembly::System::assemble`] |
//! | [`equilibrium`] | Newton's method, the path from rest, balances | [`equilibrium::Path::advance`] |
//! | [`stability`] | linearisation, modes of a band, none missed; what explains them | [`stability::solve`] |
//! | [`reduction`] | reference nodes for contacts, super-elements and their files | [`reduction::craig_bampton::reduce`] |
//! | [`tracking`] | branches of modes along a parameter, Hopf points: pure | [`tracking::track`] |
//! | [`sweep`] | one friction after the other | [`sweep::Sweep`] |
//! | [`results`] | what a study found, as plain data, and its file | [`results::Results`], [`results::file`] |
//! | [`comparison`] | which modes of two results are the same, and by how much they differ | [`comparison::compare`] |
//! | [`output`] | a run's folder, tables, CSV, JSON, VTU | [`output::results_folder::write`] |
//! | [`report`] | findings, wording, figures, the HTML page | [`report::page`] |
//! | [`cli`] | commands, progress, exit codes | [`cli::main`] |
//! | [`matrices`] | given M, C, K from files and into files | [`matrices::ExternalMatrices::read`] |
//! | [`native`] | the only `unsafe`: MPI, LAPACK, PETSc, SLEPc, MUMPS, METIS | |
//!
//! Imports run one way, from the bottom of this table to its top (`tests/architecture.rs` holds the exact order). To change a
//! friction law, change `contact/law/`; nothing else knows it.
//!
//! # The one idea
//!
//! Whatever adds to M, C or K is an *element* with a list of nodes; one assembly layer scatters them all. Contact sees a body
//! only through its *gap operator* `g = B u`; so contact, equilibrium and stability know nothing of the mesh, and a reduced
//! model is another B and another u.
//!
//! # Ranks
//!
//! Nothing that grows with the model's volume is on one rank alone, but for the seconds in which the first reads the mesh. It cuts the mesh
//! by METIS, numbers the nodes rank by rank, and sends each rank its piece: the nodes that the rank owns, all tetrahedra that
//! touch them, and everything that has a name ([`mesh::Piece`]). So each rank owns a range of rows, computes the elements that touch
//! them without any communication, and writes its own piece of the results. Surfaces are on every rank, and so are the contact points and
//! their state, which grow with the power 2/3 of the volume; ranks divide the search for them and tell each other what they found.
//!
//! Nodes have *local* numbers, those of the piece: a mesh, a gap operator, loads and supports all use them. [`mesh::Numbering`] knows the
//! global ones; local numbers rise with them, so that what is ordered by nodes is ordered alike on all ranks.
//!
//! # Notation
//!
//! | symbol | name in signatures | meaning, unit |
//! |---|---|---|
//! | M, C, K | `m`, `c`, `k` | mass kg, damping N s/m, stiffness N/m |
//! | u | `u` | displacements of the equations, m |
//! | B, g | `gap_operator`, `gap` | relative displacement at the contact points `g = B u`, m |
//! | n, t | `normal`, `direction` | master's outward normal; direction of sliding |
//! | d | `penetration` | `-(gap0 + n.g)`, m |
//! | p | `normal_force` | normal force of a point, N |
//! | mu | `friction` | coefficient of friction |
//! | xi | `correction` | what a reduced contact's penetration gets, m |
//! | Psi, Phi, E | `basis` | constraint, fixed-interface and inertia modes of a super-element |
//! | w | `weight` | area of a contact point, m2 |
//! | k_n, k_t | `stiffness`, `stick` | penalty of contact and of sticking, N/m3 |
//! | D | `tangent` | `-df/dg` of a contact point, N/m |
//! | lambda = a + i omega | `lambda`, `growth_rate`, `frequency` | eigenvalue 1/s; a > 0 squeals |
//! | x, y | `right`, `left` | vectors of a mode, `P(lambda) x = 0`, `y^H P(lambda) = 0` |
//! | alpha, beta | `rayleigh` | `C = alpha M + beta K` of a part |

mod algebra;
pub mod assembly;
pub mod cli;
pub mod comparison;
pub mod contact;
pub mod element;
pub mod equilibrium;
pub mod error;
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
pub mod sweep;
pub mod tracking;

pub use error::{Error, Result};
