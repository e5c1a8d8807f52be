//! The communicator: reductions, gathers and messages of numbers.

use std::ffi::{c_char, c_int, c_void};
use std::mem::MaybeUninit;
use std::rc::Rc;

use squeal_sys as sys;

use super::{Datum, Session};
use crate::{Error, Result};

/// A communicator that keeps the session alive. Its methods are collective unless they say otherwise.
///
/// An error of MPI ends all ranks with a message: what the other ranks have received by then is unknown, so that none
/// can agree with them on an error, and a `Result` would be one that no caller can act on. So ends, too, a message that
/// MPI's 32-bit counts do not reach, as the others wait for it.
#[derive(Clone)]
pub struct Comm {
    /// For PETSc and MUMPS.
    raw: sys::MPI_Comm,
    /// The same ranks, for the messages of this crate.
    own: sys::MPI_Comm,
    rank: usize,
    size: usize,
    session: Rc<Session>,
}

/// The largest of the ranks' values, and where it is.
#[derive(Debug, Clone, Copy, PartialEq)]
#[repr(C)]
pub struct MaxLoc {
    /// The value.
    pub value: f64,
    rank: c_int,
}

impl MaxLoc {
    /// The first rank that has it.
    pub fn rank(&self) -> usize {
        self.rank as usize
    }
}

/// Bytes of a message at most: MPI counts with 32 bits.
const MESSAGE: usize = 1 << 30;
/// Exit code after an error of MPI.
const FAILED: i32 = 1;

/// A number of values as MPI counts them.
fn count(n: usize) -> std::result::Result<c_int, String> {
    c_int::try_from(n)
        .map_err(|_| format!("a message of {n} values is longer than MPI's 32-bit counts reach. Use more ranks"))
}

/// Where the parts of these lengths start, one after the other; their lengths and the whole, as MPI counts them.
fn layout(lengths: &[usize]) -> std::result::Result<([Vec<c_int>; 2], usize), String> {
    let total = lengths.iter().sum();
    count(total)?;
    let lengths = lengths.iter().map(|&n| count(n)).collect::<std::result::Result<Vec<_>, _>>()?;
    let starts = lengths.iter().scan(0, |end, n| {
        *end += n;
        Some(*end - n)
    });
    Ok(([starts.collect(), lengths.clone()], total))
}

impl Comm {
    pub(super) fn world(session: Rc<Session>) -> Comm {
        // SAFETY: a constant handle.
        let raw = unsafe { sys::squeal_comm_world() };
        let mut comm = Comm { raw, own: session.world, rank: 0, size: 1, session };
        let (mut rank, mut size) = (0, 0);
        // SAFETY: MPI is initialised as long as the session lives.
        unsafe {
            comm.check("MPI_Comm_rank", sys::MPI_Comm_rank(comm.own, &mut rank));
            comm.check("MPI_Comm_size", sys::MPI_Comm_size(comm.own, &mut size));
        }
        (comm.rank, comm.size) = (rank as usize, size as usize);
        comm
    }

    /// This rank's own communicator. Not collective.
    pub fn alone(&self) -> Comm {
        // SAFETY: a constant handle.
        let raw = unsafe { sys::squeal_comm_self() };
        Comm { raw, own: self.session.alone, rank: 0, size: 1, session: self.session.clone() }
    }

    /// The communicators of groups of ranks that follow each other, of so many ranks each: gives that of this rank's
    /// group, on which PETSc's objects may live. The last group has the rest.
    pub fn groups_of(&self, n_ranks: usize) -> Comm {
        let colour = (self.rank / n_ranks) as c_int;
        let split = |from: sys::MPI_Comm| {
            let mut group = from;
            // SAFETY: a valid communicator; ranks of one colour keep their order.
            self.check("MPI_Comm_split", unsafe { sys::MPI_Comm_split(from, colour, self.rank as c_int, &mut group) });
            self.session.groups.borrow_mut().push(group);
            group
        };
        // A group has the way of its whole to answer errors.
        let (raw, own) = (split(self.raw), split(self.own));
        let size = n_ranks.min(self.size - colour as usize * n_ranks);
        Comm { raw, own, rank: self.rank % n_ranks, size, session: self.session.clone() }
    }

    /// This process's number, from 0. Not collective.
    pub fn rank(&self) -> usize {
        self.rank
    }

    /// Number of processes. Not collective.
    pub fn size(&self) -> usize {
        self.size
    }

    /// Whether this process prints and writes. Not collective.
    pub fn is_root(&self) -> bool {
        self.rank == 0
    }

    /// The communicator for PETSc and MUMPS.
    pub(in crate::native) fn raw(&self) -> sys::MPI_Comm {
        self.raw
    }

    /// The door of every call of MPI: a code other than 0 ends all ranks.
    fn check(&self, call: &str, code: c_int) {
        if code == 0 {
            return;
        }
        let (mut text, mut length) = ([0 as c_char; 1024], 0);
        // SAFETY: MPI writes at most MPI_MAX_ERROR_STRING = 256 or 512 bytes.
        unsafe { sys::MPI_Error_string(code, text.as_mut_ptr(), &mut length) };
        let text: Vec<u8> = text[..length as usize].iter().map(|&c| c as u8).collect();
        self.fail(&format!("{call} failed: {}", String::from_utf8_lossy(&text)))
    }

    fn fail(&self, what: &str) -> ! {
        eprintln!("error on rank {}: {what}", self.rank);
        self.abort(FAILED)
    }

    /// What MPI cannot count ends all ranks.
    fn counted<T>(&self, counts: std::result::Result<T, String>) -> T {
        counts.unwrap_or_else(|what| self.fail(&what))
    }

    /// Sum over the ranks.
    pub fn sum<T: Datum>(&self, value: T) -> T {
        self.reduced(value, Comm::sum_all)
    }

    /// Largest value of any rank.
    pub fn max<T: Datum>(&self, value: T) -> T {
        self.reduced(value, Comm::max_all)
    }

    /// Least value of any rank.
    pub fn min<T: Datum>(&self, value: T) -> T {
        self.reduced(value, Comm::min_all)
    }

    fn reduced<T: Datum>(&self, value: T, reduce: impl FnOnce(&Comm, &mut [T])) -> T {
        let mut values = [value];
        reduce(self, &mut values);
        values[0]
    }

    /// Elementwise sum of an array over the ranks, in place.
    pub fn sum_all<T: Datum>(&self, values: &mut [T]) {
        // SAFETY: MPI_SUM is a constant handle.
        self.reduce_all(values, T::datatype(), unsafe { sys::squeal_op_sum() });
    }

    /// Elementwise largest value of any rank, in place.
    pub fn max_all<T: Datum>(&self, values: &mut [T]) {
        // SAFETY: MPI_MAX is a constant handle.
        self.reduce_all(values, T::datatype(), unsafe { sys::squeal_op_max() });
    }

    /// Elementwise least value of any rank, in place.
    pub fn min_all<T: Datum>(&self, values: &mut [T]) {
        // SAFETY: MPI_MIN is a constant handle.
        self.reduce_all(values, T::datatype(), unsafe { sys::squeal_op_min() });
    }

    /// The largest value of any rank, and the first rank that has it.
    pub fn max_loc(&self, value: f64) -> MaxLoc {
        self.max_loc_all(&[value])[0]
    }

    /// The same for each element of an array.
    pub fn max_loc_all(&self, values: &[f64]) -> Vec<MaxLoc> {
        let mut all: Vec<MaxLoc> = values.iter().map(|&value| MaxLoc { value, rank: self.rank as c_int }).collect();
        // SAFETY: constant handles; MPI_DOUBLE_INT is a struct of a double and an int.
        let (pair, max_loc) = unsafe { (sys::squeal_type_double_int(), sys::squeal_op_maxloc()) };
        self.reduce_all(&mut all, pair, max_loc);
        all
    }

    /// Reduces values of MPI's type `datatype`, in parts that MPI can count.
    fn reduce_all<T: Copy>(&self, values: &mut [T], datatype: sys::MPI_Datatype, op: sys::MPI_Op) {
        for part in values.chunks_mut(MESSAGE / size_of::<T>()) {
            let input = part.to_vec();
            let (from, to) = (input.as_ptr().cast::<c_void>(), part.as_mut_ptr().cast::<c_void>());
            // SAFETY: both arrays have the same length, which all ranks share by contract, and at most MESSAGE bytes.
            let code = unsafe { sys::MPI_Allreduce(from, to, part.len() as c_int, datatype, op, self.own) };
            self.check("MPI_Allreduce", code);
        }
    }

    /// The values of all ranks, one rank's after the other's.
    pub fn join<T: Datum>(&self, own: &[T]) -> Vec<T> {
        let lengths = self.lengths(own.len());
        let ([starts, counts], total) = self.counted(layout(&lengths));
        let (mut all, datatype) = (vec![T::default(); total], T::datatype());
        // SAFETY: every rank sends as many values as all know of.
        let code = unsafe {
            sys::MPI_Allgatherv(
                own.as_ptr().cast(),
                counts[self.rank],
                datatype,
                all.as_mut_ptr().cast(),
                counts.as_ptr(),
                starts.as_ptr(),
                datatype,
                self.own,
            )
        };
        self.check("MPI_Allgatherv", code);
        all
    }

    /// Every rank's length.
    pub(super) fn lengths(&self, own: usize) -> Vec<usize> {
        let mut lengths = vec![0; self.size];
        lengths[self.rank] = own;
        self.sum_all(&mut lengths);
        lengths
    }

    /// What each rank has for this one, from what this one has for each.
    ///
    /// # Panics
    /// Where there is not one part for each rank.
    pub fn exchange<T: Datum>(&self, parts: &[Vec<T>]) -> Vec<Vec<T>> {
        assert_eq!(parts.len(), self.size);
        let lengths: Vec<usize> = parts.iter().map(Vec::len).collect();
        let ([starts, counts], _) = self.counted(layout(&lengths));
        let their_lengths: Vec<usize> =
            self.join(&lengths).chunks(self.size).map(|lengths| lengths[self.rank]).collect();
        let ([their_starts, their_counts], n_theirs) = self.counted(layout(&their_lengths));
        let (own, mut theirs, datatype) = (parts.concat(), vec![T::default(); n_theirs], T::datatype());
        // SAFETY: lengths and starts were exchanged above.
        let code = unsafe {
            sys::MPI_Alltoallv(
                own.as_ptr().cast(),
                counts.as_ptr(),
                starts.as_ptr(),
                datatype,
                theirs.as_mut_ptr().cast(),
                their_counts.as_ptr(),
                their_starts.as_ptr(),
                datatype,
                self.own,
            )
        };
        self.check("MPI_Alltoallv", code);
        let part = |(&start, &n): (&c_int, &usize)| theirs[start as usize..][..n].to_vec();
        their_starts.iter().zip(&their_lengths).map(part).collect()
    }

    /// The values of one rank, on every rank; what the others pass is not looked at.
    pub fn broadcast<T: Datum>(&self, from: usize, mut values: Vec<T>) -> Vec<T> {
        let mut length = [values.len() as u64];
        self.broadcast_into(from, &mut length);
        values.resize(length[0] as usize, T::default());
        self.broadcast_into(from, &mut values);
        values
    }

    /// Fills an array, of one length on all ranks, with one rank's values.
    fn broadcast_into<T: Datum>(&self, from: usize, values: &mut [T]) {
        for part in values.chunks_mut(MESSAGE / size_of::<T>()) {
            let (pointer, n) = (part.as_mut_ptr().cast(), part.len() as c_int);
            // SAFETY: the array has the same length on all ranks, and at most MESSAGE bytes.
            let code = unsafe { sys::MPI_Bcast(pointer, n, T::datatype(), from as c_int, self.own) };
            self.check("MPI_Bcast", code);
        }
    }

    /// Sends values to a rank, which must be receiving them. Not collective.
    pub fn send<T: Datum>(&self, values: &[T], to: usize) {
        self.send_parts(&[values.len() as u64], to);
        self.send_parts(values, to);
    }

    fn send_parts<T: Datum>(&self, values: &[T], to: usize) {
        for part in values.chunks(MESSAGE / size_of::<T>()) {
            let (pointer, n) = (part.as_ptr().cast(), part.len() as c_int);
            // SAFETY: the values stay where they are until they are sent; they have at most MESSAGE bytes.
            let code = unsafe { sys::MPI_Send(pointer, n, T::datatype(), to as c_int, 0, self.own) };
            self.check("MPI_Send", code);
        }
    }

    /// The values that a rank sends. Not collective.
    pub fn receive<T: Datum>(&self, from: usize) -> Vec<T> {
        let mut length = [0_u64];
        self.receive_parts(&mut length, from);
        let mut values = vec![T::default(); length[0] as usize];
        self.receive_parts(&mut values, from);
        values
    }

    fn receive_parts<T: Datum>(&self, values: &mut [T], from: usize) {
        let mut status = sys::MPI_Status::default();
        for part in values.chunks_mut(MESSAGE / size_of::<T>()) {
            let (pointer, n) = (part.as_mut_ptr().cast(), part.len() as c_int);
            // SAFETY: the sender sends as many values as there is room for.
            let code = unsafe { sys::MPI_Recv(pointer, n, T::datatype(), from as c_int, 0, self.own, &mut status) };
            self.check("MPI_Recv", code);
        }
    }

    /// Waits for all ranks.
    pub fn barrier(&self) {
        // SAFETY: a valid communicator.
        self.check("MPI_Barrier", unsafe { sys::MPI_Barrier(self.own) });
    }

    /// Waits for all ranks, and calls `meanwhile` again and again until they are there; it sends no messages of this
    /// communicator.
    pub fn barrier_with(&self, mut meanwhile: impl FnMut()) {
        let mut request = MaybeUninit::uninit();
        // SAFETY: a valid communicator; MPI writes the request.
        self.check("MPI_Ibarrier", unsafe { sys::MPI_Ibarrier(self.own, request.as_mut_ptr()) });
        let (mut is_complete, mut status) = (0, sys::MPI_Status::default());
        loop {
            // SAFETY: the request is MPI's, and stays where it is until it is complete.
            let code = unsafe { sys::MPI_Test(request.as_mut_ptr(), &mut is_complete, &mut status) };
            self.check("MPI_Test", code);
            if is_complete != 0 {
                return;
            }
            meanwhile();
        }
    }

    /// The result on all ranks if none has an error; else the error of the first rank that has one, so that none is
    /// left waiting and any of them can print it.
    ///
    /// # Errors
    /// [`Error::Agreed`], of the kind of that error; on one rank its own error.
    pub fn agree<T>(&self, result: Result<T>) -> Result<T> {
        let first = self.min(if result.is_err() { self.rank } else { self.size });
        if self.size == 1 || first == self.size {
            return result;
        }
        let own = result.err().map(|error| (error.kind(), error.to_string()));
        let (kind, text) = self.broadcast_value(first, own).expect("this rank has an error");
        Err(Error::Agreed { kind, text })
    }

    /// Ends all ranks of the program, those of other groups among them, at once with this exit code. Not collective.
    pub fn abort(&self, code: i32) -> ! {
        // SAFETY: a constant handle of all ranks, whatever the group; the call does not return.
        unsafe { sys::MPI_Abort(sys::squeal_comm_world(), code) };
        std::process::exit(code)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lengths_that_mpi_cannot_count_are_refused() {
        let most = c_int::MAX as usize;
        assert_eq!(count(most), Ok(c_int::MAX));
        assert!(count(most + 1).is_err_and(|what| what.contains("2147483648 values")));
        assert_eq!(layout(&[3, 0, 2]), Ok(([vec![0, 3, 3], vec![3, 0, 2]], 5)));
        assert!(layout(&[most, 1]).is_err(), "each can be counted, not both");
    }

    #[test]
    fn one_rank_reduces_to_its_own_values() {
        let comm = Session::start(&[]).unwrap();
        assert_eq!((comm.sum(3_usize), comm.max(-2_i32), comm.min(1.5_f64)), (3, -2, 1.5));
        assert_eq!((comm.max_loc(-1.0).value, comm.max_loc(-1.0).rank()), (-1.0, 0));
        assert_eq!(comm.join(&[1_u8, 2]), [1, 2]);
        assert_eq!(comm.exchange(&[vec![7_i64]]), [[7]]);
        assert_eq!(comm.broadcast(0, vec![0.5_f32]), [0.5]);
        comm.barrier_with(|| ());
        let group = comm.groups_of(1);
        assert_eq!((group.rank(), group.size(), group.sum(3_usize)), (0, 1, 3));
    }
}
