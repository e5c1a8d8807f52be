//! Which keywords are read, which change no result and are listed as ignored, and which are refused.
//!
//! A keyword that is in none of the tables is refused as unknown; so is a parameter of a keyword that is read.

use super::card::Card;
use crate::Result;
use crate::model::names;

/// What happens to a keyword.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Treatment {
    /// Read, with the parameters that count and those that change no result.
    Read(&'static [&'static str], &'static [&'static str]),
    /// Changes no result.
    Ignored,
}

use Treatment::{Ignored, Read};

const FLUID: &str = "fluids are not analysed";
const HEAT: &str = "temperatures are not analysed";
const THIN: &str = "shells, beams and membranes are not analysed: solid elements only";
const NONLINEAR: &str = "the material must be linear elastic";
const PROCEDURE: &str = "the procedures are *STATIC, *FREQUENCY and *COMPLEX FREQUENCY";
const MADE: &str = "nodes and elements are not generated. Write them out, such as by an input file of the preprocessor";
const OPTIMUM: &str = "designs are not optimised";
const CONNECTOR: &str = "connectors are elastic and damped, by components";
const LAW: &str = "the laws of contact are pressure over overlap and Coulomb friction";

/// Keywords that are read.
const READ: &[(&str, Treatment)] = &[
    ("*HEADING", Read(&[], &["SPARSE"])),
    ("*INCLUDE", Read(&["INPUT"], &[])),
    ("*PART", Read(&["NAME"], &[])),
    ("*END PART", Read(&[], &[])),
    ("*ASSEMBLY", Read(&["NAME"], &[])),
    ("*END ASSEMBLY", Read(&[], &[])),
    ("*INSTANCE", Read(&["NAME", "PART"], &[])),
    ("*END INSTANCE", Read(&[], &[])),
    ("*NODE", Read(&["NSET", "SYSTEM"], &[])),
    ("*SYSTEM", Read(&[], &[])),
    ("*ELEMENT", Read(&["TYPE", "ELSET"], &[])),
    ("*NSET", Read(&["NSET", "GENERATE", "INSTANCE", "ELSET"], &["INTERNAL", "FREQUENCY"])),
    ("*ELSET", Read(&["ELSET", "GENERATE", "INSTANCE"], &["INTERNAL", "UNSORTED"])),
    ("*SURFACE", Read(&["NAME", "TYPE", "INSTANCE"], &["INTERNAL", "DEFINITION"])),
    ("*MATERIAL", Read(&["NAME"], &[])),
    ("*ELASTIC", Read(&["TYPE"], &["MODULI"])),
    ("*DENSITY", Read(&[], &[])),
    ("*DAMPING", Read(&["ALPHA", "BETA", "STRUCTURAL", "COMPOSITE"], &[])),
    ("*ORIENTATION", Read(&["NAME", "SYSTEM", "DEFINITION"], &[])),
    ("*SOLID SECTION", Read(&["ELSET", "MATERIAL", "ORIENTATION"], &["CONTROLS"])),
    ("*AMPLITUDE", Read(&["NAME", "DEFINITION", "VALUE"], &["TIME", "SMOOTH"])),
    ("*SURFACE INTERACTION", Read(&["NAME"], &[])),
    ("*SURFACE BEHAVIOR", Read(&["PRESSURE-OVERCLOSURE", "NOSEPARATION"], &["PENALTY", "AUGMENTEDLAGRANGE", "DIRECT"])),
    (
        "*FRICTION",
        Read(&["ROUGH", "TAUMAX", "ANISOTROPIC", "EXPONENTIALDECAY"], &["SLIPTOLERANCE", "ELASTICSLIP", "LAGRANGE"]),
    ),
    (
        "*CONTACT PAIR",
        Read(
            &["INTERACTION", "ADJUST", "TIED"],
            &[
                "TYPE",
                "SMALLSLIDING",
                "CPSET",
                "EXTENSIONZONE",
                "HCRIT",
                "SMOOTH",
                "TRACKING",
                "NOTHICKNESS",
                "MECHANICALCONSTRAINT",
                "SUPPLEMENTARYCONSTRAINTS",
                "GEOMETRICCORRECTION",
                "IGNORESHELLTHICKNESS",
            ],
        ),
    ),
    ("*CHANGE FRICTION", Read(&["INTERACTION"], &["AMPLITUDE"])),
    ("*COUPLING", Read(&["REFNODE", "SURFACE", "CONSTRAINTNAME"], &[])),
    ("*KINEMATIC", Read(&[], &[])),
    ("*DISTRIBUTING", Read(&[], &["WEIGHTINGMETHOD", "COUPLING"])),
    (
        "*TIE",
        Read(
            &["NAME", "POSITIONTOLERANCE", "ADJUST"],
            &["TYPE", "NOROTATION", "CONSTRAINTRATIO", "NOTHICKNESS", "DEFINITION"],
        ),
    ),
    ("*RIGID BODY", Read(&["NSET", "ELSET", "TIENSET", "PINNSET", "REFNODE", "ROTNODE"], &["ISOTHERMAL"])),
    ("*EQUATION", Read(&[], &[])),
    ("*MPC", Read(&[], &[])),
    ("*TRANSFORM", Read(&["NSET", "TYPE"], &[])),
    ("*CLEARANCE", Read(&["VALUE", "MASTER", "SLAVE"], &[])),
    ("*SPRING", Read(&["ELSET", "ORIENTATION", "COMPLEXSTIFFNESS"], &[])),
    ("*DASHPOT", Read(&["ELSET", "ORIENTATION"], &[])),
    ("*MASS", Read(&["ELSET"], &[])),
    ("*ROTARY INERTIA", Read(&["ELSET"], &[])),
    ("*CONNECTOR SECTION", Read(&["ELSET", "BEHAVIOR"], &[])),
    ("*CONNECTOR BEHAVIOR", Read(&["NAME"], &[])),
    ("*CONNECTOR ELASTICITY", Read(&["COMPONENT"], &[])),
    ("*CONNECTOR DAMPING", Read(&["COMPONENT"], &[])),
    ("*BOUNDARY", Read(&["OP", "AMPLITUDE", "FIXED", "USER", "TYPE"], &["LOADCASE"])),
    ("*CLOAD", Read(&["OP", "AMPLITUDE", "FOLLOWER", "USER", "SECTOR"], &["REGION"])),
    ("*DLOAD", Read(&["OP", "AMPLITUDE", "USER"], &["REGION"])),
    ("*DSLOAD", Read(&["OP", "AMPLITUDE", "FOLLOWER"], &["REGION", "CONSTANTRESULTANT"])),
    ("*MOTION", Read(&["ROTATION", "TRANSLATION", "OP", "USER"], &["AMPLITUDE"])),
    (
        "*STEP",
        Read(
            &["NAME", "NLGEOM", "PERTURBATION", "UNSYMM"],
            &["INC", "INCF", "EXTRAPOLATION", "CONVERTSDI", "AMPLITUDE"],
        ),
    ),
    (
        "*STATIC",
        Read(&[], &["DIRECT", "SOLVER", "STABILIZE", "ALLSDTOL", "CONTINUE", "FULLYPLASTIC", "TIMERESET", "FACTOR"]),
    ),
    (
        "*FREQUENCY",
        Read(
            &[],
            &[
                "EIGENSOLVER",
                "SOLVER",
                "STORAGE",
                "NORMALIZATION",
                "ACOUSTICCOUPLING",
                "GLOBAL",
                "SIM",
                "DAMPINGPROJECTION",
                "RESIDUALMODES",
            ],
        ),
    ),
    ("*COMPLEX FREQUENCY", Read(&["FRICTIONDAMPING", "CORIOLIS"], &["PROPERTYEVALUATION", "NORMALIZATION"])),
    ("*END STEP", Read(&[], &[])),
];

/// Keywords that change no result.
const IGNORED: &[&str] = &[
    "*OUTPUT",
    "*NODE OUTPUT",
    "*ELEMENT OUTPUT",
    "*CONTACT OUTPUT",
    "*ENERGY OUTPUT",
    "*MODAL OUTPUT",
    "*NODE PRINT",
    "*EL PRINT",
    "*CONTACT PRINT",
    "*ENERGY PRINT",
    "*MODAL PRINT",
    "*SECTION PRINT",
    "*NODE FILE",
    "*EL FILE",
    "*ELEMENT FILE",
    "*CONTACT FILE",
    "*ENERGY FILE",
    "*MODAL FILE",
    "*FILE FORMAT",
    "*FILE OUTPUT",
    "*PREPRINT",
    "*PRINT",
    "*MONITOR",
    "*RESTART",
    "*CONTROLS",
    "*CONTACT CONTROLS",
    "*SECTION CONTROLS",
    "*SOLVER CONTROLS",
    "*TIME POINTS",
    "*DIAGNOSTICS",
    "*SELECT EIGENMODES",
    "*EXPANSION",
    "*CONDUCTIVITY",
    "*SPECIFIC HEAT",
    "*GAP CONDUCTANCE",
    "*GAP HEAT GENERATION",
    "*PHYSICAL CONSTANTS",
    "*PARAMETER DEPENDENCE",
];

/// Keywords that are refused.
const REFUSED: &[(&str, &str)] = &[
    ("*CONTACT INTERFERENCE", "gaps of contacts are those of the mesh. Move the nodes and remove the keyword"),
    ("*CONTACT", "general contact is not supported. Write a *CONTACT PAIR for each pair of surfaces"),
    ("*CONTACT DAMPING", LAW),
    ("*CHANGE SURFACE BEHAVIOR", LAW),
    ("*NO ANALYSIS", "the deck asks for no analysis. Put *STATIC or *FREQUENCY in its place"),
    ("*CHANGE SOLID SECTION", "materials are the same in all steps"),
    ("*MODEL CHANGE", "parts and contacts are there in all steps"),
    ("*KINEMATIC COUPLING", "this form is not supported. Write *COUPLING with *KINEMATIC"),
    ("*DISTRIBUTING COUPLING", "this form is not supported. Write *COUPLING with *DISTRIBUTING"),
    ("*CONNECTOR FRICTION", CONNECTOR),
    ("*CONNECTOR STOP", CONNECTOR),
    ("*CONNECTOR LOCK", CONNECTOR),
    ("*CONNECTOR PLASTICITY", CONNECTOR),
    ("*CONNECTOR LOAD", CONNECTOR),
    ("*CONNECTOR MOTION", CONNECTOR),
    ("*PRE-TENSION SECTION", "bolt pretension is not supported"),
    ("*GAP", "gap elements are not supported. Write a *CONTACT PAIR"),
    ("*GAPUNI", "gap elements are not supported. Write a *CONTACT PAIR"),
    ("*SUBMODEL", "submodels are not supported"),
    ("*CYCLIC SYMMETRY MODEL", "cyclic symmetry is not supported"),
    ("*SELECT CYCLIC SYMMETRY MODES", "cyclic symmetry is not supported"),
    ("*INITIAL CONDITIONS", "initial stresses, temperatures and velocities are not supported"),
    ("*BASE MOTION", "motions of the base are not supported"),
    ("*DISTRIBUTION", "axes that change within a part are not supported"),
    ("*NODAL THICKNESS", THIN),
    ("*NORMAL", THIN),
    ("*SHELL SECTION", THIN),
    ("*BEAM SECTION", THIN),
    ("*BEAM GENERAL SECTION", THIN),
    ("*MEMBRANE SECTION", THIN),
    ("*MEMBRANE", THIN),
    ("*SHELL TO SOLID COUPLING", THIN),
    ("*FLUID SECTION", FLUID),
    ("*FLUID SECTIONS", FLUID),
    ("*FLUID CONSTANTS", FLUID),
    ("*SPECIFIC GAS CONSTANT", FLUID),
    ("*MASS FLOW", FLUID),
    ("*CFD", FLUID),
    ("*BOUNDARYF", FLUID),
    ("*VALUES AT INFINITY", FLUID),
    ("*TURBULENCE MODEL", FLUID),
    ("*ELECTRICAL CONDUCTIVITY", "electromagnetic fields are not analysed"),
    ("*MAGNETIC PERMEABILITY", "electromagnetic fields are not analysed"),
    ("*ELECTROMAGNETICS", "electromagnetic fields are not analysed"),
    ("*TEMPERATURE", HEAT),
    ("*CFLUX", HEAT),
    ("*DFLUX", HEAT),
    ("*FILM", HEAT),
    ("*RADIATE", HEAT),
    ("*HEAT TRANSFER", HEAT),
    ("*COUPLED TEMPERATURE-DISPLACEMENT", HEAT),
    ("*UNCOUPLED TEMPERATURE-DISPLACEMENT", HEAT),
    ("*PLASTIC", NONLINEAR),
    ("*CYCLIC HARDENING", NONLINEAR),
    ("*CREEP", NONLINEAR),
    ("*VISCO", NONLINEAR),
    ("*VISCOELASTIC", NONLINEAR),
    ("*HYPERELASTIC", NONLINEAR),
    ("*HYPERFOAM", NONLINEAR),
    ("*DEFORMATION PLASTICITY", NONLINEAR),
    ("*MOHR COULOMB", NONLINEAR),
    ("*USER MATERIAL", NONLINEAR),
    ("*DEPVAR", NONLINEAR),
    ("*GASKET SECTION", NONLINEAR),
    ("*DYNAMIC", PROCEDURE),
    ("*MODAL DYNAMIC", PROCEDURE),
    ("*MODAL DAMPING", PROCEDURE),
    ("*STEADY STATE DYNAMICS", PROCEDURE),
    ("*BUCKLE", PROCEDURE),
    ("*SUBSTRUCTURE GENERATE", PROCEDURE),
    ("*GREEN", PROCEDURE),
    ("*CRACK PROPAGATION", PROCEDURE),
    ("*SENSITIVITY", OPTIMUM),
    ("*OBJECTIVE", OPTIMUM),
    ("*CONSTRAINT", OPTIMUM),
    ("*DESIGNVARIABLES", OPTIMUM),
    ("*FILTER", OPTIMUM),
    ("*NGEN", MADE),
    ("*NFILL", MADE),
    ("*NCOPY", MADE),
    ("*NMAP", MADE),
    ("*ELGEN", MADE),
    ("*ELCOPY", MADE),
    ("*PARAMETER", "parameters are not evaluated. Write their values"),
    ("*USER ELEMENT", "user elements are not supported"),
    ("*MATRIX INPUT", "matrices are read by a model of matrices alone: see the manual"),
    ("*MATRIX ASSEMBLE", "matrices are read by a model of matrices alone: see the manual"),
    ("*SUBSTRUCTURE PROPERTY", "substructures are not supported"),
];

/// What happens to a keyword, by its name in capital letters without blanks.
///
/// # Errors
/// [`Error::Input`](crate::Error::Input) for a keyword that is refused or unknown, and for a parameter that is unknown.
pub fn treatment(card: &Card) -> Result<Treatment> {
    let is = |name: &str| name.bytes().skip(1).filter(|&byte| byte != b' ').eq(card.name.bytes());
    if let Some((_, treatment)) = READ.iter().find(|(name, _)| is(name)) {
        check_parameters(card, *treatment)?;
        return Ok(*treatment);
    }
    if IGNORED.iter().any(|name| is(name)) {
        return Ok(Ignored);
    }
    if let Some((name, why)) = REFUSED.iter().find(|(name, _)| is(name)) {
        return Err(card.error(format_args!("{name} is not supported: {why}")));
    }
    let known = READ.iter().map(|(name, _)| *name).chain(IGNORED.iter().copied());
    let near = names::nearest(&card.spelled, known).map(|name| format!(" Did you mean {name}?"));
    let near = near.unwrap_or_default();
    Err(card.error(format_args!("the keyword {} is not known.{near}", card.spelled)))
}

fn check_parameters(card: &Card, treatment: Treatment) -> Result<()> {
    let Read(reads, ignores) = treatment else { return Ok(()) };
    let known = || reads.iter().chain(ignores).copied();
    match card.parameters().find(|parameter| !known().any(|name| name == *parameter)) {
        None => Ok(()),
        Some(parameter) => {
            let near = names::nearest(parameter, known()).map(|name| format!(" Did you mean {name}?"));
            let near = near.unwrap_or_default();
            Err(card.error(format_args!("the parameter {parameter} is not supported ({}).{near}", card.spelled)))
        }
    }
}

/// The tables of the manual.
pub fn markdown() -> String {
    let mut out = String::from("| read | parameters that count | parameters that change no result |\n|---|---|---|\n");
    let list = |names: &[&str]| names.join(", ");
    for (name, treatment) in READ {
        if let Read(reads, ignores) = treatment {
            out += &format!("| {name} | {} | {} |\n", list(reads), list(ignores));
        }
    }
    out += "\n| ignored, as they change no result |\n|---|\n";
    IGNORED.chunks(6).for_each(|names| out += &format!("| {} |\n", names.join(", ")));
    out += "\n| refused | why |\n|---|---|\n";
    REFUSED.iter().for_each(|(name, why)| out += &format!("| {name} | {why} |\n"));
    out
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::Place;
    use std::path::Path;

    fn of(text: &str) -> std::result::Result<Treatment, String> {
        let card = Card::parse(text, Place { file: 0, line: 1 }, Path::new("a.inp")).unwrap();
        treatment(&card).map_err(|error| error.to_string())
    }

    #[test]
    fn each_keyword_has_one_treatment() {
        let all = READ.iter().map(|(name, _)| *name).chain(IGNORED.iter().copied());
        let mut all: Vec<String> =
            all.chain(REFUSED.iter().map(|(name, _)| *name)).map(|n| n.replace(' ', "")).collect();
        let n = all.len();
        all.sort();
        all.dedup();
        assert_eq!(all.len(), n);
    }

    /// The page is written again where it differs; the test fails all the same, so that the change is seen.
    #[test]
    fn the_manual_lists_all_keywords() {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("docs/manual/src/deck-keywords.md");
        let text = format!("# Keywords of decks\n\nSee [Abaqus and CalculiX decks](decks.md).\n\n{}", markdown());
        if std::fs::read_to_string(&path).unwrap_or_default() != text {
            std::fs::write(&path, text).unwrap();
            panic!("{} was out of date and has been written", path.display());
        }
    }

    #[test]
    fn keywords_are_read_ignored_or_refused() {
        assert!(matches!(of("*solidsection, elset=a, material=b"), Ok(Read(..))));
        assert_eq!(of("*Node Print, NSET=A"), Ok(Ignored));
        let first = REFUSED[0];
        assert_eq!(of(first.0).unwrap_err(), format!("a.inp:1: {} is not supported: {}", first.0, first.1));
        assert!(of("*MATERAIL").unwrap_err().ends_with("the keyword *MATERAIL is not known. Did you mean *MATERIAL?"));
        assert!(of("*NODE, INPUT=x").unwrap_err().contains("the parameter INPUT is not supported (*NODE)"));
    }
}
