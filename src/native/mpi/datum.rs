//! The types of number that messages carry.

use squeal_sys as sys;

/// A type of number that MPI can send, add and compare. Sealed: MPI's name of the type must be the right one.
pub trait Datum: sealed::Named + Copy + Default + 'static {}

pub(super) mod sealed {
    use super::sys;

    pub trait Named {
        /// MPI's name of the type.
        fn datatype() -> sys::MPI_Datatype;
    }
}

macro_rules! datum {
    ($($number:ty => $name:ident),*) => {$(
        impl Datum for $number {}

        impl sealed::Named for $number {
            fn datatype() -> sys::MPI_Datatype {
                // SAFETY: gives a constant handle, and needs nothing.
                unsafe { sys::$name() }
            }
        }
    )*};
}

datum!(f64 => squeal_type_double, f32 => squeal_type_float, i32 => squeal_type_int32, i64 => squeal_type_int64);
datum!(u32 => squeal_type_uint32, u64 => squeal_type_uint64, u8 => squeal_type_byte, usize => squeal_type_uint64);

const _: () = assert!(usize::BITS == 64, "a usize is sent as 64 bits");
