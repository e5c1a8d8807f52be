//! `squeal`
fn main() {}
