//! Speed of the assembly of M, C and K on the demo brake, against DOLFINx where that is installed: `cargo bench --bench
//! assembly`, or with a model file after `--`. Under mpirun run the executable that `cargo bench --no-run` names.
//!
//! Not a timed test: it prints figures and judges nothing. From the mesh and materials in memory to matrices ready for
//! use. The first assembly of a process pays for the memory that it is the first to touch; the best of the next four
//! does not.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::Instant;

use squeal::assembly::{Connectivity, ElementMatrices, Elements};
use squeal::element::Shape;
use squeal::element::solid::volume;
use squeal::equilibrium::Contacts;
use squeal::native::{Comm, Session};
use squeal::structure::FullModel;
use squeal::{Result, mesh, model};

fn main() -> Result<()> {
    let asked = std::env::args().skip(1).find(|argument| !argument.starts_with('-'));
    let path = PathBuf::from(asked.unwrap_or_else(|| "meshes/brake-medium.toml".into()));
    let launched = std::env::var_os("OMPI_COMM_WORLD_SIZE").is_some();
    // Before our own session: what it leaves in the environment would confuse another MPI program's.
    let others = if launched { None } else { Some(dolfinx(&path)?) };
    let comm = Session::start(&[])?;
    let brake = FullModel::read(&comm, &path)?;
    let n_tets = comm.sum(brake.own_elements().count()) as f64;
    if comm.is_root() {
        println!("{}: {n_tets} tetrahedra on {} ranks", path.display(), comm.size());
    }
    let ours = measure(&comm, &brake, false)?;
    let [_, again] = measure(&comm, &brake, true)?;
    tell(&comm, "squeal", "K and M", "first", ours[0], n_tets);
    tell(&comm, "squeal", "K and M", "again", ours[1], n_tets);
    tell(&comm, "squeal", "K, M and C", "again", again, n_tets);
    contact(&comm, &brake)?;
    match others {
        Some(Ok(theirs)) => {
            tell(&comm, "DOLFINx", "K and M", "first", theirs[0], n_tets);
            tell(&comm, "DOLFINx", "K and M", "again", theirs[1], n_tets);
            let ratio = |run: usize| theirs[run].iter().sum::<f64>() / ours[run].iter().sum::<f64>();
            println!("DOLFINx takes {:.2} times as long at first, {:.2} times again", ratio(0), ratio(1));
        }
        Some(Err(reason)) => println!("no comparison with DOLFINx: {reason}"),
        None => (),
    }
    Ok(())
}

/// The first assembly and the best of the others.
fn measure(comm: &Comm, brake: &FullModel, damped: bool) -> Result<[[f64; 2]; 2]> {
    let runs: Vec<[f64; 2]> = (0..5).map(|_| assemble(comm, brake, damped)).collect::<Result<_>>()?;
    let all = |run: &[f64; 2]| run[0] + run[1];
    let best = runs[1..].iter().min_by(|a, b| all(a).total_cmp(&all(b))).expect("several runs");
    Ok([runs[0], *best])
}

/// Seconds of one tangent: a copy of K and the blocks of all contact points, as if all were closed.
fn contact(comm: &Comm, brake: &FullModel) -> Result<()> {
    let system = brake.assemble(comm, &brake.families()?)?;
    let (contacts, mut tangent) = (Contacts::new(&brake.interface, &system)?, system.k.duplicate()?);
    let n = brake.interface.points.len();
    let mut best = [f64::INFINITY; 2];
    for _ in 0..5 {
        let start = Instant::now();
        tangent.copy_from(&system.k)?;
        let copied = start.elapsed().as_secs_f64();
        contacts.add_blocks((0..n).map(|_| [[1.0, 2.0, 3.0], [4.0, 5.0, 6.0], [7.0, 8.0, 9.0]]), &mut tangent)?;
        best = [best[0].min(copied), best[1].min(start.elapsed().as_secs_f64() - copied)];
    }
    if comm.is_root() {
        println!("contact tangent: copy of K {:.3} s, {n} closed points {:.3} s", best[0], best[1]);
    }
    Ok(())
}

/// Seconds of the pattern and of the values, those of the slowest rank.
fn assemble(comm: &Comm, brake: &FullModel, damped: bool) -> Result<[f64; 2]> {
    let families = brake.families()?;
    let families = families.list().map(|family| Chosen { family, damped });
    let families = families.each_ref().map(|family| family as &dyn Elements);
    comm.barrier();
    let start = Instant::now();
    let system = brake.assemble_families(comm, &families)?;
    comm.barrier();
    let (all, pattern) = (start.elapsed().as_secs_f64(), comm.max(system.pattern_seconds));
    Ok([pattern, all - pattern])
}

/// A family with its damping or without.
struct Chosen<'a> {
    family: &'a dyn Elements,
    damped: bool,
}

impl Connectivity for Chosen<'_> {
    fn len(&self) -> usize {
        self.family.len()
    }
    fn nodes(&self, e: usize) -> &[u32] {
        self.family.nodes(e)
    }
}

impl Elements for Chosen<'_> {
    fn mass_couples_axes(&self) -> bool {
        self.family.mass_couples_axes()
    }
    fn matrices(&self, e: usize, out: &mut ElementMatrices) {
        self.family.matrices(e, out);
        if !self.damped {
            out.c.clear();
        }
    }
}

fn tell(comm: &Comm, who: &str, what: &str, run: &str, [pattern, values]: [f64; 2], n_tets: f64) {
    let rate = n_tets / (pattern + values) / comm.size() as f64;
    if comm.is_root() {
        println!("{who:8} {what:11} {run:6} pattern {pattern:.3} s, values {values:.3} s, {rate:.0} tets/s and rank");
    }
}

/// The same for DOLFINx (0.5, Debian's python3-dolfinx-real) on the same mesh, or why not.
fn dolfinx(path: &Path) -> Result<std::result::Result<[[f64; 2]; 2], String>> {
    const PYTHON: &str = "/usr/bin/python3";
    let found = Command::new(PYTHON).args(["-c", "import dolfinx"]).output();
    if !found.is_ok_and(|found| found.status.success()) {
        return Ok(Err("apt-get install python3-dolfinx-real".into()));
    }
    let model = model::read(path)?;
    let mesh = mesh::read(&model.mesh_file, model.mesh_unit)?;
    let folder = std::env::temp_dir().join(format!("squeal-bench-{}", std::process::id()));
    let write = |name: &str, bytes: Vec<u8>| fs::write(folder.join(name), bytes).expect("a temporary file");
    fs::create_dir_all(&folder).expect("a temporary folder");
    write("nodes", mesh.nodes.as_flattened().iter().flat_map(|x| x.to_le_bytes()).collect());
    write("tets", mesh.elements.all_nodes().0.iter().flat_map(|n| n.to_le_bytes()).collect());
    let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("benches/dolfinx/assembly.py");
    let said = Command::new(PYTHON).arg(script).arg(&folder).output().expect("it was there");
    fs::remove_dir_all(&folder).expect("our own folder");
    let volume: f64 = (0..mesh.elements.len()).map(|e| volume(Shape::Tetrahedron10, &mesh.element_nodes(e))).sum();
    let lines = String::from_utf8_lossy(&said.stdout).into_owned();
    let numbers: Vec<f64> = lines.split_whitespace().filter_map(|word| word.parse().ok()).collect();
    Ok(match numbers[..] {
        [a, b, v, c, d, _] if (v / volume - 1.0).abs() < 1e-9 => Ok([[a, b], [c, d]]),
        _ => Err(format!("it said\n{lines}{}", String::from_utf8_lossy(&said.stderr))),
    })
}
