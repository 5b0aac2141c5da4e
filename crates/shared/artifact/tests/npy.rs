//! NumPy arrays, in and out.
#![allow(clippy::unwrap_used, clippy::panic, reason = "a test fails by panicking")]
#![allow(clippy::disallowed_methods, reason = "tests look at what is on the disk")]

mod support;

use artifact::npy::{read_f32, write};
use proptest::prelude::*;
use support::{Place, bytes, refusal, says};

#[test]
fn values_and_shape_survive() {
    let place = Place::new();
    let path = place.path("a.npy");
    let values = [0.1, -0.0, f32::MIN_POSITIVE / 2.0, f32::MAX, 5.0, 6.0];
    write(&path, [2, 3], &values).unwrap().publish().unwrap();
    let (shape, back) = read_f32(&path).unwrap();
    assert_eq!(shape, [2, 3]);
    assert_eq!(back.map_bits(), values.map_bits());
}

trait Bits {
    fn map_bits(&self) -> Vec<u32>;
}

impl<T: AsRef<[f32]>> Bits for T {
    fn map_bits(&self) -> Vec<u32> {
        self.as_ref().iter().map(|x| x.to_bits()).collect()
    }
}

/// A file of NumPy with this header text.
fn array(header: &str, data: &[u8]) -> Vec<u8> {
    let mut file = b"\x93NUMPY\x01\0".to_vec();
    let header = format!("{header:<117}\n");
    file.extend((header.len() as u16).to_le_bytes());
    file.extend(header.as_bytes());
    file.extend(data);
    file
}

#[test]
fn other_arrays_are_refused() {
    let refused = |header: &str, data: &[u8]| {
        refusal(read_f32(&Place::new().file("a.npy", array(header, data))).map(|_| ()))
    };
    let header = "{'descr': '<f4', 'fortran_order': False, 'shape': (2, 1), }";
    assert!(read_f32(&Place::new().file("a.npy", array(header, &[0; 8]))).is_ok());
    let fix = "give a float32 array of two dimensions, C order";
    says(&refused(header, &[0; 7]), &["a.npy: cannot be read: ", fix]);
    says(&refused(&header.replace("<f4", "<f8"), &[0; 16]), &["a.npy: cannot be read: ", fix]);
    says(&refused(&header.replace("False", "True"), &[0; 8]), &["is in Fortran order", fix]);
    says(&refused(&header.replace("(2, 1)", "(2,)"), &[0; 8]), &["has 1 dimensions", fix]);
    says(
        &refused(header, &[0, 0, 0, 0, 0, 0, 0xc0, 0x7f]),
        &["a.npy, row 1, column 0: the value is not finite"],
    );
    let no_array = refusal(read_f32(&Place::new().file("a.npy", "hello")).map(|_| ()));
    says(&no_array, &["is not a NumPy array", fix]);
    // More values than memory could hold.
    let large = |shape| refused(&header.replace("(2, 1)", shape), &[0; 8]);
    says(&large("(99999999999, 9999999)"), &["a.npy: cannot be read: "]);
    says(&large("(4294967296, 4294967296)"), &["a.npy: is not a NumPy array: its shape is larger"]);
    let deep = format!("{{'shape': {}", "(".repeat(60_000));
    says(&refused(&deep, &[]), &["its header has 60011 bytes"]);
}

#[test]
fn the_writer_refuses_numbers_that_are_not_finite() {
    let place = Place::new();
    let message = refusal(write(&place.path("a.npy"), [2, 2], &[0.0, 1.0, 2.0, f32::NAN]));
    assert_eq!(message, "a.npy, row 1, column 1: the value is not finite");
    assert!(place.names().is_empty());
}

proptest! {
    #[test]
    fn a_changed_byte_never_panics(at in 0usize..136, byte in any::<u8>()) {
        let place = Place::new();
        let path = place.path("a.npy");
        write(&path, [1, 2], &[1.0, 2.0]).unwrap().publish().unwrap();
        let mut file = bytes(&path);
        file[at] = byte;
        let _ = read_f32(&place.file("b.npy", file));
    }
}
