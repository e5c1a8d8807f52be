//! Decks that are wrong in one thing, and decks that are damaged.

use super::broken_joints::BROKEN_JOINTS;
use super::joints::COUPLINGS;
use super::*;

/// What is exchanged, what for, and how the message begins.
const BROKEN: &[[&str; 3]] = &[
    ["*HEADING", "*INCLUDE, INPUT=none.inp\n*HEADING", "a.inp:1: cannot read the included file"],
    ["*HEADING", "*HEADNIG", "a.inp:1: the keyword *HEADNIG is not known. Did you mean *HEADING?"],
    ["*HEADING", "*NGEN\n1,2\n*HEADING", "a.inp:1: *NGEN is not supported: nodes and elements are not generated"],
    ["*HEADING", "*AMPLITUDE, NAME=A, NMAE=B\n*HEADING", "a.inp:1: the parameter NMAE is not supported (*AMPLITUDE)"],
    ["1, 0, 0, 0\n", "1, 0, 0, 0\n1, 0, 0, 1\n", "a.inp:5: node 1 is there already, with other coordinates"],
    ["1, 0, 0, 0\n", "1, 0, 0, x\n", "a.inp:4: coordinate 3 of node 1 is \"x\", not a number"],
    ["1, 0, 0, 0\n", "1, 0, 0, 1e999\n", "a.inp:4: coordinate 3 of node 1 is \"1e999\""],
    ["1, 0, 0, 0\n", "0, 0, 0, 0\n", "a.inp:4: the number of a node is \"0\", not a whole number"],
    ["1, 0, 0, 0\n", "99, 0, 0, 0\n", "a.inp:25: element 1 has node 1, which is not there"],
    ["4, 0, 0, -10\n", "4, 0, 0, 10\n", "a.inp:25: 1 of 2 elements are inverted"],
    ["1, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10", "1, 1, 2, 3, 4, 5, 6, 7", "a.inp:25: element 1 has 7 nodes, but C3D10 has 10"],
    ["1, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10", "2, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10", "a.inp:27: element 2 is there already"],
    [
        "1, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10",
        "1, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11",
        "a.inp:25: the element has more nodes",
    ],
    ["TYPE=C3D10,", "TYPE=C3D11,", "a.inp:24: elements of the type C3D11 are not supported"],
    ["TYPE=C3D10,", "TPYE=C3D10,", "a.inp:24: the parameter TPYE is not supported (*ELEMENT). Did you mean TYPE?"],
    ["NSET=Hub, GENERATE\n7, 10", "NSET=Hub\nHUB", "a.inp:29: the set Hub contains itself"],
    ["NSET=Hub, GENERATE\n7, 10", "NSET=Hub\nA\n*NSET, NSET=A\nHub", "a.inp:31: the set Hub contains itself"],
    ["NSET=Hub, GENERATE\n7, 10", "NSET=Hub, GENERATE\n70, 100", "a.inp:29: there is no node from 70 to 100"],
    ["NSET=Hub, GENERATE\n7, 10", "NSET=Hub\n7, 100", "a.inp:29: there is no node 100"],
    ["HUB, 1, 3", "HUBB, 1, 3", "a.inp:54: there is no node set HUBB. Did you mean"],
    ["HUB, 1, 3", "HUB, 11", "a.inp:54: the displacement \"11\" is not supported"],
    ["DISC, S1", "DISK, S1", "a.inp:35: there is no element set DISK. Did you mean"],
    ["DISC, S1", "DISC, S5", "a.inp:35: element 1 is a C3D10, which has no face 5"],
    ["DISC, S1", "DISC, SPOS", "a.inp:35: the face \"SPOS\" is not supported"],
    ["DISC, S1\n", "", "a.inp:34: the surface Disc_face is empty"],
    ["NAME=Pad_face", "NAME=DISC_FACE", "a.inp:36: the surface DISC_FACE is there already, in line 34"],
    ["*ELASTIC\n210000., 0.3\n", "", "a.inp:38: the material Steel has no *ELASTIC"],
    ["*DENSITY\n7.85e-9\n", "", "a.inp:38: the material Steel has no *DENSITY"],
    ["210000., 0.3", "210000., 0.5", "a.inp:40: no material has these constants"],
    ["210000., 0.3", "-210000., 0.3", "a.inp:40: no material has these constants"],
    ["7.85e-9", "7.85", "a.inp:44: no system of units makes solids of all materials: Steel has a modulus of"],
    ["ELSET=PAD, MATERIAL=STEEL", "ELSET=PAD, MATERIAL=STEAL", "a.inp:45: there is no material STEAL. Did you mean"],
    ["ELSET=PAD, MATERIAL", "ELSET=PADS, MATERIAL", "a.inp:45: there is no element set PADS. Did you mean"],
    ["ELSET=PAD, MATERIAL", "ELSET=DISC, MATERIAL", "a.inp:45: element 1 is in two sections, of Disc and of Disc part"],
    ["*SOLID SECTION, ELSET=PAD, MATERIAL=STEEL\n", "", "a.inp:27: element 2 is in no *SOLID SECTION"],
    ["INTERACTION=I\n", "INTERACTION=J\n", "a.inp:52: there is no *SURFACE INTERACTION J"],
    ["PAD_FACE, DISC_FACE", "PAD_FACE, DISC_FCE", "a.inp:52: there is no surface DISC_FCE. Did you mean"],
    ["PAD_FACE, DISC_FACE", "PAD_FACE", "a.inp:52: the master surface is missing"],
    ["PAD_FACE, DISC_FACE", "PAD_FACE, DISC_FACE\nPAD_FACE, DISC_FACE", "a.inp:53: the contact pair"],
    ["0.4\n", "-0.4\n", "a.inp:50: the friction coefficient must be 0 or above"],
    ["0.4\n", "4.\n", "a.inp:50: a friction coefficient of 4 is above 2"],
    ["\n20000.\n", "\n-1.\n", "a.inp:48: the stiffness of the contact must be above 0"],
    ["=LINEAR\n20000.", "=TABULAR\n0.,0.\n1.,1.\n1.,2.", "a.inp:48: pressures and overlaps of the table do not rise"],
    [
        "*MATERIAL, NAME=Steel\n",
        "*CLEARANCE, VALUE=0.1, MASTER=PAD_FACE, SLAVE=DISC_FACE\n*MATERIAL, NAME=Steel\n",
        "a.inp:38: no *CONTACT PAIR has slave and master Disc_face / Pad_face (*CLEARANCE). Did you mean",
    ],
    [
        "*MATERIAL, NAME=Steel\n",
        "*CLEARANCE, MASTER=DISC_FACE, SLAVE=PAD_FACE\n*MATERIAL, NAME=Steel\n",
        "a.inp:38: VALUE= is missing (*CLEARANCE). Give VALUE=",
    ],
    ["BACK, 3, -25.", "BACK, 4, -25.", "a.inp:58: a moment on nodes of solids"],
    ["BACK, 3, -25.", "BACK, 3, ", "a.inp:58: the force is missing"],
    ["TURNING, 5., 0,0,0, 0,0,1", "TURNING, 5., 0,0,0, 0,0,0", "a.inp:60: the two points of the axis of rotation"],
    ["TURNING, 5., 0", "HUB, 5., 0", "a.inp:60: a rotation needs all nodes of each part that turns"],
    ["*STATIC", "*DYNAMIC", "a.inp:56: *DYNAMIC is not supported"],
    ["*STEP\n*STATIC", "*STEP\n*STEP\n*STATIC", "a.inp:56: a step within the step of line 55"],
    ["20, 100., 6000.\n*END STEP\n", "20, 100., 6000.\n", "a.inp:62: the step does not end: the deck is cut off"],
    ["*END STEP\n*STEP\n*COMPLEX", "\0*END STEP\n*STEP\n*COMPLEX", "a.inp:61: here is a zero byte: the file is binary"],
    [
        "*MATERIAL, NAME=Steel\n",
        "*ELEMENT, TYPE=MASS, ELSET=M\n901, 14\n*MASS, ELSET=M\n-1.\n*MATERIAL, NAME=Steel\n",
        "a.inp:40: the constant must be 0 or above, not -1 (*MASS)",
    ],
    [
        "*MATERIAL, NAME=Steel\n",
        "*ELEMENT, TYPE=ROTARYI, ELSET=M\n901, 14\n*ROTARY INERTIA, ELSET=M\n1., 1., 0., 0., 2.\n*MATERIAL, NAME=Steel\n",
        "a.inp:40: inertia has a negative principal moment. Give I11, I22, I33, I12, I13, I23",
    ],
    [
        "*MATERIAL, NAME=Steel\n",
        "*ELEMENT, TYPE=ROTARYI, ELSET=M\n901, 14\n*ROTARY INERTIA, ELSET=M\n1., 1., 1.\n*MATERIAL, NAME=Steel\n",
        "a.inp:39: a rotary inertia is supported on a reference node",
    ],
];

#[test]
fn broken_decks_are_refused_with_one_message_at_its_place() {
    let text = good();
    let mut wrong = Vec::new();
    for [old, new, begin] in BROKEN.iter().chain(BROKEN_JOINTS) {
        let n = text.matches(old).count();
        let said = if n == 0 {
            "nothing to exchange".to_owned()
        } else {
            read(&text.replacen(old, new, 1)).err().unwrap_or_default()
        };
        if !said.starts_with(begin) || said.lines().count() != 1 {
            wrong.push(format!("{old:?} -> {new:?}\n   expected {begin:?}\n   found    {said:?}"));
        }
    }
    assert!(BROKEN.len() + BROKEN_JOINTS.len() >= 100 && wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn an_inverted_hexahedron_is_refused() {
    let corners = ["0,0,0", "1,0,0", "1,1,0", "0,1,0", "0,0,1", "1,0,1", "1,1,1", "0,1,1"];
    let nodes: String = (1..).zip(corners).map(|(n, x)| format!("{n}, {x}\n")).collect();
    let (_, material) = REST.split_once("*MATERIAL").unwrap();
    let (material, _) = material.split_once("*SOLID").unwrap();
    let deck = |order: &str| {
        let element = format!("*ELEMENT, TYPE=C3D8, ELSET=ALL\n1, {order}\n");
        let rest = format!("*MATERIAL{material}*SOLID SECTION, ELSET=ALL, MATERIAL=STEEL\n*STEP\n*STATIC\n*END STEP\n");
        read(&format!("*NODE\n{nodes}{element}{rest}")).map(|converted| converted.mesh.elements.len())
    };
    assert_eq!(deck("1, 2, 3, 4, 5, 6, 7, 8"), Ok(1));
    assert!(deck("5, 6, 7, 8, 1, 2, 3, 4").unwrap_err().starts_with("a.inp:11: 1 of 1 elements are inverted"));
}

/// A deck with bytes exchanged, lines left out and lines doubled is read or refused, and nothing panics.
#[test]
fn damaged_decks_never_panic() {
    let text = good().replace("*MATERIAL, NAME=Steel\n", COUPLINGS);
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("a.inp");
    let mut state = 0x2545_f491_4f6c_dd1d_u64;
    let mut random = |n: usize| {
        state ^= state << 13;
        state ^= state >> 7;
        state ^= state << 17;
        (state % n as u64) as usize
    };
    const BYTES: &[u8] = b"0123456789,.-*=eE \n\"SCABx\0\xff";
    let mut n_read = 0;
    for _ in 0..1500 {
        let mut lines: Vec<Vec<u8>> = text.lines().map(|line| line.as_bytes().to_vec()).collect();
        for _ in 0..=random(3) {
            let at = random(lines.len());
            match random(4) {
                0 => _ = lines.remove(at),
                1 => lines.insert(at, lines[at].clone()),
                2 => {
                    let other = random(lines.len());
                    lines.swap(at, other);
                }
                _ => {
                    let column = random(lines[at].len().max(1));
                    let byte = BYTES[random(BYTES.len())];
                    let end = lines[at].len().min(column + 1);
                    lines[at].splice(column.min(end)..end, [byte]);
                }
            }
        }
        std::fs::write(&file, lines.join(&b'\n')).unwrap();
        let read = parse(&file).and_then(|deck| convert(&deck, KnownUnits::default()));
        n_read += usize::from(read.is_ok());
    }
    assert!((100..1400).contains(&n_read), "{n_read} read");
}
