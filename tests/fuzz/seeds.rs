//! Small files of every format, all of them right.

use std::path::Path;

use crate::support::data;
use crate::support::program::Place;

fn all(names: &[&str]) -> Vec<Vec<u8>> {
    names.iter().map(|name| std::fs::read(data(name)).unwrap()).collect()
}

pub fn models() -> Vec<Vec<u8>> {
    let project = Path::new(env!("CARGO_MANIFEST_DIR"));
    let mut all = all(&["pad_on_disc.toml", "pads_on_disc.toml"]);
    all.extend(
        ["src/model/example.toml", "meshes/brake-small.toml"].map(|name| std::fs::read(project.join(name)).unwrap()),
    );
    all
}

pub fn meshes() -> Vec<Vec<u8>> {
    all(&[
        "hexahedra_wedges.msh",
        "hexahedra_wedges_linear.msh",
        "two_blocks_ascii.msh",
        "two_blocks_binary.msh",
        "mixed.msh",
    ])
}

/// A deck of a model of blocks, and one with instances, sets and steps.
pub fn decks() -> Vec<Vec<u8>> {
    let place = Place::blocks();
    let written = place.run(&["convert", "brake.toml", "-o", "brake.inp"]);
    assert_eq!(written.code, 0, "{}", written.err);
    let (before, after) = INSTANCES.split_once("*CLEARANCE").unwrap();
    let (_, after) = after.split_once('\n').unwrap();
    let joined = format!("{before}{after}").replace("*CONTACT PAIR, INTERACTION=I, TYPE=SURFACE TO SURFACE\n", JOINTS);
    vec![place.read("brake.inp").into_bytes(), INSTANCES.as_bytes().to_vec(), joined.into_bytes()]
}

/// A tie takes the place of the contact pair.
const JOINTS: &str = "*NODE, NSET=REFERENCE
101, 0.5, 0.5, 3.
*COUPLING, REF NODE=101, SURFACE=TWO.TOP, CONSTRAINT NAME=C
*DISTRIBUTING
1, 6
*ELEMENT, TYPE=MASS, ELSET=M
201, 101
*MASS, ELSET=M
1e-3
*ELEMENT, TYPE=SPRING1, ELSET=S
202, 101
*ORIENTATION, NAME=O
1., 1., 0., -1., 1., 0.
*SPRING, ELSET=S, ORIENTATION=O
3, 3
100.
*EQUATION
2
ONE.5, 1, 1., ONE.6, 1, -1.
*FRICTION
0.4, 0., 1.
0.3, 10., 1.
*TIE, NAME=T, POSITION TOLERANCE=0.1
";

const INSTANCES: &str = "*HEADING
two cubes
*PART, NAME=CUBE
*NODE, NSET=ALL
1, 0., 0., 0.
2, 1., 0., 0.
3, 1., 1., 0.
4, 0., 1., 0.
5, 0., 0., 1.
6, 1., 0., 1.
7, 1., 1., 1.
8, 0., 1., 1.
*ELEMENT, TYPE=C3D8I, ELSET=BODY
1, 1, 2, 3, 4, 5, 6, 7, 8
*NSET, NSET=LOW, GENERATE
1, 4, 1
*ELSET, ELSET=EACH
BODY
*SURFACE, NAME=TOP
BODY, S2
*SURFACE, NAME=BOTTOM
BODY, S1
*SOLID SECTION, ELSET=BODY, MATERIAL=STEEL
*END PART
*ASSEMBLY, NAME=A
*INSTANCE, NAME=ONE, PART=CUBE
*END INSTANCE
*INSTANCE, NAME=TWO, PART=CUBE
0., 0., 1.
0., 0., 0., 0., 0., 1., 90.
*END INSTANCE
*NSET, NSET=HELD, INSTANCE=ONE
LOW
*END ASSEMBLY
*MATERIAL, NAME=STEEL
*ELASTIC
210000., 0.3
*DENSITY
7.85e-9
*DAMPING, ALPHA=5., BETA=1e-7
*SURFACE INTERACTION, NAME=I
*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=LINEAR
2e4
*FRICTION
0.3
*CONTACT PAIR, INTERACTION=I, TYPE=SURFACE TO SURFACE
TWO.BOTTOM, ONE.TOP
*CLEARANCE, SLAVE=TWO.BOTTOM, MASTER=ONE.TOP, VALUE=0.001
*BOUNDARY
HELD, 1, 3
*STEP
*STATIC
*DSLOAD
TWO.TOP, P, 1.5
*END STEP
*STEP
*COMPLEX FREQUENCY
10, 0., 6000.
*END STEP
";

/// With a column of contacts, all coordinates and other columns; with two coordinates alone.
pub fn gap_fields() -> Vec<Vec<u8>> {
    let whole = "contact,x_mm,y_mm,z_mm,pressure_pa,gap_um\ndisc / pad,12.5,98,0,1e5,3.2\ndisc / pad,0,90,2,0,-0.5\n\
                 other,1,2,3,4,5\n\"disc / pad\", 7, 91.25, 1e0,,0\n";
    let plane = "y_m,x_m,gap_mm\n0.098,0.0125,1e-3\n0.09,0,2E-3\n";
    [whole, plane].map(|text| text.as_bytes().to_vec()).into()
}

/// Of three columns and two rows, in 8 and 16 bits.
pub fn gap_images() -> Vec<Vec<u8>> {
    let image = |depth: png::BitDepth, n_bytes: u8| {
        let mut file = Vec::new();
        let mut encoder = png::Encoder::new(&mut file, 3, 2);
        encoder.set_color(png::ColorType::Grayscale);
        encoder.set_depth(depth);
        let levels: Vec<u8> = (0..n_bytes).collect();
        encoder.write_header().unwrap().write_image_data(&levels).unwrap();
        file
    };
    vec![image(png::BitDepth::Eight, 6), image(png::BitDepth::Sixteen, 12)]
}

pub fn measured() -> Vec<Vec<u8>> {
    let rows = "x,y,z,direction,812.5,1930\n0,0,10,z,0.5,-1e-3\n12.5,-3,10,-y,1,0.25\n1,2,3,0.6 0 0.8,-0.5,2\n";
    vec![rows.as_bytes().to_vec()]
}

pub fn families() -> Vec<Vec<u8>> {
    all(&["matrices/bicycle.toml", "matrices/hoffmann.toml", "matrices/sinou.toml"])
}

pub fn matrix_market() -> Vec<Vec<u8>> {
    all(&["matrices/bicycle_m.mtx", "matrices/qep1_k.mtx", "matrices/sinou_k0.mtx"])
}

/// A dense and a sparse matrix of two rows: class, rows, columns, number of entries, then numbers.
pub fn petsc() -> Vec<Vec<u8>> {
    let file = |header: &[i32], values: &[f64]| {
        let mut bytes: Vec<u8> = header.iter().flat_map(|number| number.to_be_bytes()).collect();
        bytes.extend(values.iter().flat_map(|value| value.to_be_bytes()));
        bytes
    };
    const MATRIX: i32 = 1_211_216;
    let sparse = file(&[MATRIX, 2, 2, 3, 1, 2, 0, 0, 1], &[2.0, -1.0, 3.0]);
    vec![sparse, file(&[MATRIX, 2, 2, -1], &[2.0, -1.0, -1.0, 3.0])]
}

pub fn abaqus() -> Vec<Vec<u8>> {
    let listed = "1,1, 1,1, 2.0\n1,1, 1,2, -1.0\n1,2, 1,2, 3.0\n";
    vec![listed.as_bytes().to_vec()]
}

pub fn results() -> Vec<Vec<u8>> {
    let place = Place::blocks();
    let run = place.run(&["stability", "brake.toml", "--friction", "0.1:0.3:0.1", "-o", "out"]);
    assert_eq!(run.code, 0, "{}", run.err);
    vec![std::fs::read(place.path("out/results.h5")).unwrap()]
}

pub fn super_elements() -> Vec<Vec<u8>> {
    let place = Place::blocks();
    let run = place.run(&["reduce", "brake.toml", "--contacts", "4", "--limit", "240000", "-o", "brake.se.h5"]);
    assert_eq!(run.code, 0, "{}", run.err);
    vec![std::fs::read(place.path("brake.se.h5")).unwrap()]
}
