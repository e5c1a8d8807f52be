//! Ties, rigid bodies, equations, springs and connectors that are wrong in one thing.

/// What is exchanged, what for, and how the message begins.
pub const BROKEN_JOINTS: &[[&str; 3]] = &[
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
        "*ORIENTATION, NAME=A, SYSTEM=CYLINDRICAL\n0,0,0,0,0,1\n*ELEMENT, TYPE=SPRING1, ELSET=S\n901, 14\n\
         *SPRING, ELSET=S, ORIENTATION=A\n2\n500.\n*MATERIAL, NAME=Steel\n",
        "a.inp:38: cylindrical axes are not supported here: they change from point to point",
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
        "*ELEMENT, TYPE=SPRINGA, ELSET=S\n901, 1, 11\n*SPRING, ELSET=S\n\n5.\n*MATERIAL, NAME=Steel\n",
        "a.inp:39: the ends of a SPRINGA are one point, so that it has no direction",
    ],
    [
        "*MATERIAL, NAME=Steel\n",
        "*NODE\n101, 0, 0, 9\n*ELEMENT, TYPE=SPRING1, ELSET=S\n901, 101\n*SPRING, ELSET=S\n1, 1\n5.\n*MATERIAL, NAME=Steel\n",
        "a.inp:41: node 101 belongs to no solid and no coupling, and is unconstrained",
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
        "a.inp:40: there is no orientation AXES",
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
    [
        "*MATERIAL, NAME=Steel\n",
        "*COUPLING, REF NODE=14, SURFACE=DISC_FACE\n*KINEMATIC\n*MATERIAL, NAME=Steel\n",
        "a.inp:38: the reference node 14 belongs to a solid",
    ],
    [
        "*MATERIAL, NAME=Steel\n",
        "*NODE\n103, 3., 3., 5.\n*NSET, NSET=R\n103\n*TRANSFORM, NSET=R\n0., 1., 0., -1., 0., 0.\n\
         *COUPLING, REF NODE=103, SURFACE=DISC_FACE\n*KINEMATIC\n*MATERIAL, NAME=Steel\n",
        "a.inp:43: local axes of a reference node are not supported (*TRANSFORM)",
    ],
    [
        "*MATERIAL, NAME=Steel\n",
        "*ELEMENT, TYPE=CONN3D2, ELSET=C\n901, 4, 14\n*CONNECTOR SECTION, ELSET=C, BEHAVIOR=B\nCARTESIAN\n\
         *CONNECTOR BEHAVIOR, NAME=B\n*CONNECTOR ELASTICITY, COMPONENT=4\n5.\n*MATERIAL, NAME=Steel\n",
        "a.inp:40: component 4 has a constant, but CARTESIAN does not have it free",
    ],
    [
        "*MATERIAL, NAME=Steel\n",
        "*NSET, NSET=U, UNSORTED\n3, 1\n*MATERIAL, NAME=Steel\n",
        "a.inp:38: the parameter UNSORTED is not supported (*NSET)",
    ],
];
