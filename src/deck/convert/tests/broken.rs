//! Decks that are wrong in one thing, and decks that are damaged.

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
    ["HUB, 1, 3", "HUB, 1, 3, 0.1", "a.inp:54: a displacement other than 0 is not supported"],
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
    ["=LINEAR\n20000.", "=TABULAR\n0.,0.\n1.,1.\n4.,2.", "a.inp:48: a table that is no straight line"],
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
        "*TIE\nPAD_FACE, DISC_FACE\n*MATERIAL, NAME=Steel\n",
        "a.inp:38: NAME= is missing (*TIE)",
    ],
    [
        "*MATERIAL, NAME=Steel\n",
        "*TIE, NAME=T\n*MATERIAL, NAME=Steel\n",
        "a.inp:38: the two surfaces are missing (*TIE)",
    ],
    [
        "*MATERIAL, NAME=Steel\n",
        "*TIE, NAME=T\nPAD_FACE\n*MATERIAL, NAME=Steel\n",
        "a.inp:39: the master surface is missing",
    ],
    [
        "*MATERIAL, NAME=Steel\n",
        "*TIE, NAME=T\nPAD_FCE, DISC_FACE\n*MATERIAL, NAME=Steel\n",
        "a.inp:39: there is no surface PAD_FCE. Did you mean",
    ],
    [
        "*MATERIAL, NAME=Steel\n",
        "*TIE, NAME=T, POSITION TOLERANCE=-1\nPAD_FACE, DISC_FACE\n*MATERIAL, NAME=Steel\n",
        "a.inp:38: POSITION TOLERANCE must be above 0",
    ],
    [
        "*MATERIAL, NAME=Steel\n",
        "*TIE, NAME=T, POSITION TOLERANCE=x\nPAD_FACE, DISC_FACE\n*MATERIAL, NAME=Steel\n",
        "a.inp:38: POSITIONTOLERANCE=x is no number",
    ],
    [
        "*MATERIAL, NAME=Steel\n",
        "*TIE, NAME=T, CYCLIC SYMMETRY\nPAD_FACE, DISC_FACE\n*MATERIAL, NAME=Steel\n",
        "a.inp:38: the parameter CYCLICSYMMETRY is not supported (*TIE)",
    ],
    [
        "*MATERIAL, NAME=Steel\n",
        "*TIE, NAME=T, ADJUST=MAYBE\nPAD_FACE, DISC_FACE\n*MATERIAL, NAME=Steel\n",
        "a.inp:38: ADJUST=MAYBE is not supported (*TIE)",
    ],
    [
        "*MATERIAL, NAME=Steel\n",
        "*RIGID BODY, NSET=HUB\n*MATERIAL, NAME=Steel\n",
        "a.inp:38: REFNODE= is missing (*RIGID BODY)",
    ],
    [
        "*MATERIAL, NAME=Steel\n",
        "*RIGID BODY, REF NODE=1\n*MATERIAL, NAME=Steel\n",
        "a.inp:38: a rigid body has one set",
    ],
    [
        "*MATERIAL, NAME=Steel\n",
        "*RIGID BODY, REF NODE=1, NSET=HUB, ELSET=PAD\n*MATERIAL, NAME=Steel\n",
        "a.inp:38: a rigid body has one set",
    ],
    [
        "*MATERIAL, NAME=Steel\n",
        "*RIGID BODY, REF NODE=1, NSET=HUBS\n*MATERIAL, NAME=Steel\n",
        "a.inp:38: there is no node set HUBS. Did you mean",
    ],
    [
        "*MATERIAL, NAME=Steel\n",
        "*RIGID BODY, REF NODE=1, ELSET=PADS\n*MATERIAL, NAME=Steel\n",
        "a.inp:38: there is no element set PADS. Did you mean",
    ],
    [
        "*MATERIAL, NAME=Steel\n",
        "*RIGID BODY, REF NODE=999, NSET=HUB\n*MATERIAL, NAME=Steel\n",
        "a.inp:38: there is no node 999",
    ],
    [
        "*MATERIAL, NAME=Steel\n",
        "*RIGID BODY, REF NODE=HUB, NSET=HUB\n*MATERIAL, NAME=Steel\n",
        "a.inp:38: the reference node of a rigid body must be one node",
    ],
    [
        "*MATERIAL, NAME=Steel\n",
        "*NODE, NSET=FAR\n101, 0, 0, 9\n*RIGID BODY, REF NODE=1, NSET=FAR\n*MATERIAL, NAME=Steel\n",
        "a.inp:40: the rigid body has no node of a solid",
    ],
    [
        "*MATERIAL, NAME=Steel\n",
        "*RIGID BODY, REF NODE=1, NSET=HUB, ANALYTICAL SURFACE=S\n*MATERIAL, NAME=Steel\n",
        "a.inp:38: the parameter ANALYTICALSURFACE is not supported",
    ],
    ["*MATERIAL, NAME=Steel\n", "*EQUATION\n*MATERIAL, NAME=Steel\n", "a.inp:38: the equation is missing"],
    [
        "*MATERIAL, NAME=Steel\n",
        "*EQUATION\n1\n1, 1, 1.\n*MATERIAL, NAME=Steel\n",
        "a.inp:39: an equation has two terms at least",
    ],
    [
        "*MATERIAL, NAME=Steel\n",
        "*EQUATION\ntwo\n1, 1, 1., 2, 1, -1.\n*MATERIAL, NAME=Steel\n",
        "a.inp:39: the number of terms is \"two\"",
    ],
    [
        "*MATERIAL, NAME=Steel\n",
        "*EQUATION\n3\n1, 1, 1., 2, 1, -1.\n*MATERIAL, NAME=Steel\n",
        "a.inp:39: 2 terms, but the equation has 3",
    ],
    [
        "*MATERIAL, NAME=Steel\n",
        "*EQUATION\n2\n1, 1, 1., 2, 1\n*MATERIAL, NAME=Steel\n",
        "a.inp:40: 5 fields: a term is a node, a displacement and a coefficient",
    ],
    [
        "*MATERIAL, NAME=Steel\n",
        "*EQUATION\n2\n1, 1, 1., 2, 1, -1., 3, 1, 1.\n*MATERIAL, NAME=Steel\n",
        "a.inp:40: 9 fields: a term is",
    ],
    [
        "*MATERIAL, NAME=Steel\n",
        "*EQUATION\n2\n1, 7, 1., 2, 1, -1.\n*MATERIAL, NAME=Steel\n",
        "a.inp:40: the displacement \"7\" is not supported",
    ],
    [
        "*MATERIAL, NAME=Steel\n",
        "*EQUATION\n2\n1, 5, 1., 2, 1, -1.\n*MATERIAL, NAME=Steel\n",
        "a.inp:39: a rotation in an equation is not supported",
    ],
    [
        "*MATERIAL, NAME=Steel\n",
        "*EQUATION\n2\n1, 1, x, 2, 1, -1.\n*MATERIAL, NAME=Steel\n",
        "a.inp:40: the coefficient is \"x\", not a number",
    ],
    [
        "*MATERIAL, NAME=Steel\n",
        "*EQUATION\n2\n1, 1, 1., 99, 1, -1.\n*MATERIAL, NAME=Steel\n",
        "a.inp:39: there is no node 99",
    ],
    [
        "*MATERIAL, NAME=Steel\n",
        "*EQUATION\n2\n1, 1, 1., 1, 1, -1.\n*MATERIAL, NAME=Steel\n",
        "a.inp:39: the equation relates fewer than two displacements",
    ],
    [
        "*MATERIAL, NAME=Steel\n",
        "*EQUATION\n2\nHUB, 1, 1., TURNING, 1, -1.\n*MATERIAL, NAME=Steel\n",
        "a.inp:39: the sets of the equation have different numbers of nodes",
    ],
    [
        "*MATERIAL, NAME=Steel\n",
        "*EQUATION, REMOVE ALL\n*MATERIAL, NAME=Steel\n",
        "a.inp:38: the parameter REMOVEALL is not supported (*EQUATION)",
    ],
    [
        "*MATERIAL, NAME=Steel\n",
        "*NODE\n101, 0, 0, 9\n*EQUATION\n2\n1, 1, 1., 101, 1, -1.\n*MATERIAL, NAME=Steel\n",
        "a.inp:41: node 101 belongs to no solid",
    ],
    [
        "*MATERIAL, NAME=Steel\n",
        "*MPC\n*MATERIAL, NAME=Steel\n",
        "a.inp:38: the constraint and its nodes are missing (*MPC)",
    ],
    [
        "*MATERIAL, NAME=Steel\n",
        "*MPC\nSLIDER, 1, 2\n*MATERIAL, NAME=Steel\n",
        "a.inp:39: the constraint \"SLIDER\" is not supported (*MPC). There is: BEAM, TIE, PIN",
    ],
    [
        "*MATERIAL, NAME=Steel\n",
        "*MPC\nTIE, 1\n*MATERIAL, NAME=Steel\n",
        "a.inp:39: TIE is between two nodes or sets (*MPC)",
    ],
    [
        "*MATERIAL, NAME=Steel\n",
        "*MPC\nBEAM, 1, HUB\n*MATERIAL, NAME=Steel\n",
        "a.inp:39: the second node of a BEAM must be one node",
    ],
    [
        "*MATERIAL, NAME=Steel\n",
        "*MPC\nBEAM, 1, 11\n*MATERIAL, NAME=Steel\n",
        "a.inp:39: the two nodes of a BEAM are one point",
    ],
    [
        "*MATERIAL, NAME=Steel\n",
        "*MPC\nTIE, HUB, TURNING\n*MATERIAL, NAME=Steel\n",
        "a.inp:39: the two sets have different numbers of nodes (*MPC)",
    ],
    [
        "*MATERIAL, NAME=Steel\n",
        "*TRANSFORM\n1, 0, 0, 0, 1, 0\n*MATERIAL, NAME=Steel\n",
        "a.inp:38: NSET= is missing (*TRANSFORM)",
    ],
    [
        "*MATERIAL, NAME=Steel\n",
        "*TRANSFORM, NSET=HUB\n*MATERIAL, NAME=Steel\n",
        "a.inp:38: the points of the axes are missing (*TRANSFORM)",
    ],
    [
        "*MATERIAL, NAME=Steel\n",
        "*TRANSFORM, NSET=HUB, TYPE=S\n1, 0, 0, 0, 1, 0\n*MATERIAL, NAME=Steel\n",
        "a.inp:38: TYPE=S is not supported (*TRANSFORM)",
    ],
    [
        "*MATERIAL, NAME=Steel\n",
        "*TRANSFORM, NSET=HUB\n1, 0, 0, 2, 0, 0\n*MATERIAL, NAME=Steel\n",
        "a.inp:39: the axes are not determined",
    ],
    [
        "*MATERIAL, NAME=Steel\n",
        "*TRANSFORM, NSET=HUBB\n1, 0, 0, 0, 1, 0\n*MATERIAL, NAME=Steel\n",
        "a.inp:39: there is no node set HUBB. Did you mean",
    ],
    [
        "*MATERIAL, NAME=Steel\n",
        "*CLEARANCE, VALUE=0.1, MASTER=DISC_FACE, SLAVE=PAD_FACE\n*MATERIAL, NAME=Steel\n",
        "a.inp:38: a gap other than that of the mesh is not supported",
    ],
    ["*MATERIAL, NAME=Steel\n", "*SPRING\n1\n5.\n*MATERIAL, NAME=Steel\n", "a.inp:38: ELSET= is missing (*SPRING)"],
    [
        "*MATERIAL, NAME=Steel\n",
        "*SPRING, ELSET=S\n*MATERIAL, NAME=Steel\n",
        "a.inp:38: the constant is missing (*SPRING)",
    ],
    [
        "*MATERIAL, NAME=Steel\n",
        "*SPRING, ELSET=S, NONLINEAR\n1\n5.\n*MATERIAL, NAME=Steel\n",
        "a.inp:38: the parameter NONLINEAR is not supported (*SPRING)",
    ],
    [
        "*MATERIAL, NAME=Steel\n",
        "*SPRING, ELSET=S\n1, 1\n-5.\n*MATERIAL, NAME=Steel\n",
        "a.inp:38: the constant must be 0 or above, not -5 (*SPRING)",
    ],
    [
        "*MATERIAL, NAME=Steel\n",
        "*DASHPOT, ELSET=S\n1, 1\n5., 100.\n6., 200.\n*MATERIAL, NAME=Steel\n",
        "a.inp:38: a second row of constants",
    ],
    [
        "*MATERIAL, NAME=Steel\n",
        "*SPRING, ELSET=SPRINGS\n1, 1\n5.\n*MATERIAL, NAME=Steel\n",
        "a.inp:38: there is no element set SPRINGS",
    ],
    [
        "*MATERIAL, NAME=Steel\n",
        "*ELEMENT, TYPE=SPRING1, ELSET=S\n901, 14\n*MATERIAL, NAME=Steel\n",
        "a.inp:39: element 901 is a SPRING1 without its constants",
    ],
    [
        "*MATERIAL, NAME=Steel\n",
        "*ELEMENT, TYPE=SPRING1, ELSET=S\n901, 14\n*SPRING, ELSET=S\n9\n5.\n*MATERIAL, NAME=Steel\n",
        "a.inp:40: a spring or dashpot acts between the same displacement (1 to 6) of both ends",
    ],
    [
        "*MATERIAL, NAME=Steel\n",
        "*ELEMENT, TYPE=SPRING1, ELSET=S\n901, 14\n*SPRING, ELSET=S\n4, 4\n5.\n*MATERIAL, NAME=Steel\n",
        "a.inp:39: a spring against the rotation of a node of solids",
    ],
    [
        "*MATERIAL, NAME=Steel\n",
        "*ELEMENT, TYPE=SPRING2, ELSET=S\n901, 7, 14\n*SPRING, ELSET=S\n2, 3\n5.\n*MATERIAL, NAME=Steel\n",
        "a.inp:40: a spring or dashpot acts between the same displacement (1 to 6) of both ends",
    ],
    [
        "*MATERIAL, NAME=Steel\n",
        "*ELEMENT, TYPE=SPRING2, ELSET=S\n901, 7, 14\n*SPRING, ELSET=S\n1, 1\n5.\n*MATERIAL, NAME=Steel\n",
        "a.inp:39: the ends are two points, and the line between them is not along the axis",
    ],
    [
        "*MATERIAL, NAME=Steel\n",
        "*ELEMENT, TYPE=SPRINGA, ELSET=S\n901, 2, 14\n*SPRING, ELSET=S\n\n5.\n*MATERIAL, NAME=Steel\n",
        "a.inp:39: a SPRINGA is supported where its ends lie one behind the other along a global axis",
    ],
    [
        "*MATERIAL, NAME=Steel\n",
        "*NODE\n101, 0, 0, 9\n*ELEMENT, TYPE=SPRING1, ELSET=S\n901, 101\n*SPRING, ELSET=S\n1, 1\n5.\n*MATERIAL, NAME=Steel\n",
        "a.inp:41: node 101 belongs to no solid and no coupling, and is not held",
    ],
    [
        "*MATERIAL, NAME=Steel\n",
        "*ELEMENT, TYPE=MASS, ELSET=M\n901, 14\n*MASS, ELSET=M\n-1.\n*MATERIAL, NAME=Steel\n",
        "a.inp:40: the constant must be 0 or above, not -1 (*MASS)",
    ],
    [
        "*MATERIAL, NAME=Steel\n",
        "*ELEMENT, TYPE=ROTARYI, ELSET=M\n901, 14\n*ROTARY INERTIA, ELSET=M\n1., 1., 1.\n*MATERIAL, NAME=Steel\n",
        "a.inp:39: a rotary inertia is supported on a reference node",
    ],
    [
        "*MATERIAL, NAME=Steel\n",
        "*ELEMENT, TYPE=CONN3D2, ELSET=C\n901, 7, 14\n*MATERIAL, NAME=Steel\n",
        "a.inp:39: element 901 is a CONN3D2 without its constants",
    ],
    [
        "*MATERIAL, NAME=Steel\n",
        "*ELEMENT, TYPE=CONN3D2, ELSET=C\n901, 7, 14\n*CONNECTOR SECTION, ELSET=C\n*MATERIAL, NAME=Steel\n",
        "a.inp:40: the type of the connector is missing",
    ],
    [
        "*MATERIAL, NAME=Steel\n",
        "*ELEMENT, TYPE=CONN3D2, ELSET=C\n901, 7, 14\n*CONNECTOR SECTION, ELSET=C\nUNIVERSAL\n*MATERIAL, NAME=Steel\n",
        "a.inp:40: connectors of the type UNIVERSAL are not supported",
    ],
    [
        "*MATERIAL, NAME=Steel\n",
        "*ELEMENT, TYPE=CONN3D2, ELSET=C\n901, 7, 14\n*CONNECTOR SECTION, ELSET=C\nBUSHING\nAXES\n*MATERIAL, NAME=Steel\n",
        "a.inp:42: axes of a connector are not supported",
    ],
    [
        "*MATERIAL, NAME=Steel\n",
        "*ELEMENT, TYPE=CONN3D2, ELSET=C\n901, 7, 14\n*CONNECTOR SECTION, ELSET=C, BEHAVIOR=B\nBUSHING\n*MATERIAL, NAME=Steel\n",
        "a.inp:40: there is no *CONNECTOR BEHAVIOR B",
    ],
    [
        "*MATERIAL, NAME=Steel\n",
        "*ELEMENT, TYPE=CONN3D2, ELSET=C\n901, 7, 14\n*CONNECTOR SECTION, ELSET=C\nCARTESIAN\n*MATERIAL, NAME=Steel\n",
        "a.inp:40: the connector has neither elasticity nor damping",
    ],
    [
        "*MATERIAL, NAME=Steel\n",
        "*CONNECTOR BEHAVIOR\n*MATERIAL, NAME=Steel\n",
        "a.inp:38: NAME= is missing (*CONNECTOR BEHAVIOR)",
    ],
    [
        "*MATERIAL, NAME=Steel\n",
        "*CONNECTOR ELASTICITY, COMPONENT=1\n5.\n*MATERIAL, NAME=Steel\n",
        "a.inp:38: *CONNECTOR ELASTICITY before any *CONNECTOR BEHAVIOR",
    ],
    [
        "*MATERIAL, NAME=Steel\n",
        "*CONNECTOR BEHAVIOR, NAME=B\n*CONNECTOR ELASTICITY, COMPONENT=7\n5.\n*MATERIAL, NAME=Steel\n",
        "a.inp:39: COMPONENT= must be one of 1 to 6",
    ],
    [
        "*MATERIAL, NAME=Steel\n",
        "*CONNECTOR BEHAVIOR, NAME=B\n*CONNECTOR ELASTICITY, COMPONENT=1\n*MATERIAL, NAME=Steel\n",
        "a.inp:39: the constant is missing (*CONNECTOR ELASTICITY)",
    ],
    [
        "*MATERIAL, NAME=Steel\n",
        "*CONNECTOR BEHAVIOR, NAME=B\n*CONNECTOR DAMPING, COMPONENT=1\n-5.\n*MATERIAL, NAME=Steel\n",
        "a.inp:40: the constant must be 0 or above, not -5",
    ],
    [
        "*MATERIAL, NAME=Steel\n",
        "*CONNECTOR BEHAVIOR, NAME=B\n*CONNECTOR DAMPING, COMPONENT=1\n5.\n6.\n*MATERIAL, NAME=Steel\n",
        "a.inp:41: a second constant: it depends on something",
    ],
    [
        "*MATERIAL, NAME=Steel\n",
        "*CONNECTOR BEHAVIOR, NAME=B\n*CONNECTOR STOP, COMPONENT=1\n5.\n*MATERIAL, NAME=Steel\n",
        "a.inp:39: *CONNECTOR STOP is not supported",
    ],
    [
        "*MATERIAL, NAME=Steel\n",
        "*NODE\n103, 3., 3., 5.\n*COUPLING, SURFACE=DISC_FACE\n*KINEMATIC\n*MATERIAL, NAME=Steel\n",
        "a.inp:40: REFNODE= is missing (*COUPLING)",
    ],
    [
        "*MATERIAL, NAME=Steel\n",
        "*NODE\n103, 3., 3., 5.\n*COUPLING, REF NODE=103, SURFACE=DISC_FACE\n*MATERIAL, NAME=Steel\n",
        "a.inp:40: no *KINEMATIC or *DISTRIBUTING follows (*COUPLING)",
    ],
    [
        "*MATERIAL, NAME=Steel\n",
        "*NODE\n103, 3., 3., 5.\n*COUPLING, REF NODE=103, SURFACE=DISC_FCE\n*KINEMATIC\n*MATERIAL, NAME=Steel\n",
        "a.inp:40: there is no surface DISC_FCE. Did you mean",
    ],
    [
        "*MATERIAL, NAME=Steel\n",
        "*NODE\n103, 3., 3., 5.\n*COUPLING, REF NODE=103, SURFACE=DISC_FACE\n*KINEMATIC\n1, 2\n*MATERIAL, NAME=Steel\n",
        "a.inp:40: a coupling of some displacements is supported where all six of its reference node are held",
    ],
    [
        "*MATERIAL, NAME=Steel\n",
        "*NODE\n103, 3., 3., 5.\n*COUPLING, REF NODE=103, SURFACE=DISC_FACE\n*KINEMATIC\n7\n*MATERIAL, NAME=Steel\n",
        "a.inp:42: the displacement \"7\" is not supported",
    ],
    [
        "*MATERIAL, NAME=Steel\n",
        "*KINEMATIC\n*MATERIAL, NAME=Steel\n",
        "a.inp:38: *KINEMATIC without a *COUPLING above it",
    ],
    ["BACK, 3, -25.", "BACK, 3, -25.\n1000, 3, 1.", "a.inp:59: there is no node 1000"],
    ["=LINEAR\n20000.", "=TIED\n0.", "a.inp:48: the stiffness of the contact must be above 0"],
];

#[test]
fn broken_decks_are_refused_with_one_message_at_its_place() {
    let text = good();
    let mut wrong = Vec::new();
    for [old, new, begin] in BROKEN {
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
    assert!(BROKEN.len() >= 100 && wrong.is_empty(), "{}", wrong.join("\n"));
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
