//! What this process may still take, against what a factor will need.
//!
//! Three limits hold at once: what the machine has free, what the control group (a container, a batch job) may have,
//! and the address space of a process (`ulimit -v`). The kernel tells all three under `/proc` and `/sys`; one that it
//! does not tell is no limit.

use std::fs;
use std::path::Path;

use squeal_sys as sys;

use crate::native::Comm;
use crate::{Error, Result};

const MB: f64 = 1024.0 * 1024.0;

/// Whether the ranks together may still take so much memory, MB. Where they may not at first, what they have freed is
/// given back to the system before it is said: Open MPI has the C library keep it, which saves the page faults of the
/// next factor (a third of its time on the medium demo brake). Collective.
pub fn has_mb(comm: &Comm, needed_mb: f64) -> bool {
    if needed_mb <= available_mb(comm) {
        return true;
    }
    // SAFETY: it frees nothing that is in use.
    unsafe { sys::squeal_give_memory_back() };
    comm.barrier();
    needed_mb <= available_mb(comm)
}

/// Memory that the ranks together may still take, MB. Collective; ranks are taken to share one machine and control
/// group.
pub fn available_mb(comm: &Comm) -> f64 {
    limits(comm).0
}

/// The most memory that the ranks together have had so far, MB: the sum of their largest resident sets. Collective.
pub fn peak_mb(comm: &Comm) -> f64 {
    let status = fs::read_to_string("/proc/self/status").unwrap_or_default();
    let mut total = [kilobytes(&status, "VmHWM:").unwrap_or(0.0) / 1024.0];
    comm.sum_all(&mut total);
    total[0]
}

/// Whether the ranks together may reserve so much address space, MB, and use so much of it. Collective.
pub(in crate::native) fn has_room(comm: &Comm, used_mb: f64, reserved_mb: f64) -> bool {
    let each = comm.min(address_space_mb().unwrap_or(f64::INFINITY));
    has_mb(comm, used_mb) && reserved_mb <= each * comm.size() as f64
}

/// What the ranks together may still take, MB, and what limits it.
fn limits(comm: &Comm) -> (f64, &'static str) {
    let own = machine_mb().unwrap_or(f64::INFINITY).min(group_mb().unwrap_or(f64::INFINITY));
    let shared = comm.min(own);
    let each = comm.min(address_space_mb().unwrap_or(f64::INFINITY));
    let available = shared.min(each * comm.size() as f64);
    (available, if shared <= available { "the machine or its container" } else { "ulimit -v" })
}

/// Refuses a factor that the ranks together cannot hold. Collective.
pub(in crate::native) fn require(comm: &Comm, needed_mb: f64) -> Result<()> {
    if has_mb(comm, needed_mb) {
        return Ok(());
    }
    let (available, whose) = limits(comm);
    let gigabytes = |mb: f64| format!("{:.2} GB", mb / 1024.0);
    let (needs, leaves) = (gigabytes(needed_mb), gigabytes(available));
    let what = format!("the factor needs {needs}, even out of core, and {whose} leaves {leaves}");
    Err(Error::OutOfMemory { what, needed_mb: Some(needed_mb) })
}

/// Memory that the kernel could give now, MB.
fn machine_mb() -> Option<f64> {
    let text = fs::read_to_string("/proc/meminfo").ok()?;
    Some(kilobytes(&text, "MemAvailable:")? / 1024.0)
}

/// Address space that this process may still take, MB.
fn address_space_mb() -> Option<f64> {
    let limits = fs::read_to_string("/proc/self/limits").ok()?;
    let line = limits.lines().find_map(|line| line.strip_prefix("Max address space"))?;
    let limit: f64 = line.split_whitespace().next()?.parse().ok()?;
    let status = fs::read_to_string("/proc/self/status").ok()?;
    Some((limit / MB - kilobytes(&status, "VmSize:")? / 1024.0).max(0.0))
}

/// Memory that this process's control group may still take, MB: the least of its own and its parents' room.
fn group_mb() -> Option<f64> {
    let groups = fs::read_to_string("/proc/self/cgroup").ok()?;
    let rooms = groups.lines().filter_map(|line| {
        let mut fields = line.splitn(3, ':').skip(1);
        let (controllers, path) = (fields.next()?, fields.next()?);
        let version = VERSIONS.iter().find(|version| controllers.split(',').any(|name| name == version.controller))?;
        let parents = Path::new(path.trim_start_matches('/')).ancestors();
        parents.filter_map(|group| room_mb(&Path::new(version.root).join(group), version)).reduce(f64::min)
    });
    rooms.reduce(f64::min)
}

/// How a version of control groups calls things.
struct Version {
    controller: &'static str,
    root: &'static str,
    limit: &'static str,
    used: &'static str,
    reclaimable: &'static str,
}

const VERSIONS: [Version; 2] = [
    Version {
        controller: "",
        root: "/sys/fs/cgroup",
        limit: "memory.max",
        used: "memory.current",
        reclaimable: "inactive_file ",
    },
    Version {
        controller: "memory",
        root: "/sys/fs/cgroup/memory",
        limit: "memory.limit_in_bytes",
        used: "memory.usage_in_bytes",
        reclaimable: "total_inactive_file ",
    },
];

/// What a control group may still take, MB. Files that it holds in memory without need do not count as taken.
fn room_mb(group: &Path, version: &Version) -> Option<f64> {
    let number = |name| fs::read_to_string(group.join(name)).ok()?.trim().parse::<f64>().ok();
    let (limit, used) = (number(version.limit)?, number(version.used)?);
    let statistics = fs::read_to_string(group.join("memory.stat")).unwrap_or_default();
    let reclaimable = statistics.lines().find_map(|line| line.strip_prefix(version.reclaimable)?.parse::<f64>().ok());
    Some(((limit - used + reclaimable.unwrap_or(0.0)) / MB).max(0.0))
}

/// The number of kB after a key.
fn kilobytes(text: &str, key: &str) -> Option<f64> {
    let rest = text.lines().find_map(|line| line.strip_prefix(key))?;
    rest.split_whitespace().next()?.parse().ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_groups_room_is_its_limit_less_what_it_needs() {
        let group = tempfile::tempdir().unwrap();
        let write = |name: &str, text: &str| fs::write(group.path().join(name), text).unwrap();
        write("memory.max", "1073741824\n");
        write("memory.current", "805306368\n");
        assert_eq!(room_mb(group.path(), &VERSIONS[0]), Some(256.0));
        write("memory.stat", "anon 1\ninactive_file 268435456\nslab 7\n");
        assert_eq!(room_mb(group.path(), &VERSIONS[0]), Some(512.0));
        write("memory.max", "max\n");
        assert_eq!(room_mb(group.path(), &VERSIONS[0]), None);
    }

    #[test]
    fn the_kernel_is_understood() {
        assert_eq!(kilobytes("MemTotal: 3 kB\nMemAvailable:    2048 kB\n", "MemAvailable:"), Some(2048.0));
        assert!(machine_mb().is_some_and(|mb| mb > 1.0));
    }

    #[test]
    fn the_peak_of_memory_rises_with_what_is_used() {
        let comm = crate::native::Session::start(&[]).unwrap();
        let before = peak_mb(&comm);
        let used = std::hint::black_box(vec![1_u8; 64 << 20]);
        assert!(before > 1.0 && peak_mb(&comm) > before + 32.0, "{before} {} {}", peak_mb(&comm), used.len());
    }
}
