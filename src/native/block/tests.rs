use super::*;
use crate::native::Session;

/// Of five columns two are zero, or as good as zero, and one lies between the others: two directions remain.
#[test]
fn columns_without_a_direction_are_dropped() {
    let comm = Session::start(&[]).unwrap();
    let columns = [[3.0, 0.0, 0.0], [0.0; 3], [0.0, 1e-200, 0.0], [1.0, 0.0, 1.0], [5.0, 0.0, 1.0]];
    let block = Block::from_columns(&comm, 3, columns.concat());
    let basis = block.orthonormalised(1e-6, 5).unwrap();
    assert_eq!(basis.n_columns(), 2);
    let gram = basis.gram(&basis);
    let identity = [1.0, 0.0, 0.0, 1.0];
    assert!(gram.iter().zip(identity).all(|(a, b)| (a - b).abs() < 1e-12), "{gram:?}");
    let infinite = Block::from_columns(&comm, 1, vec![1e200, 1.0]);
    assert_eq!(infinite.orthonormalised(1e-6, 2).err().unwrap().kind(), crate::ErrorKind::NotConverged);
}
