//! PC2 vertex caches, in and out, interrupted and resumed.
#![allow(clippy::unwrap_used, clippy::panic, reason = "a test fails by panicking")]
#![allow(clippy::disallowed_methods, reason = "tests look at what is on the disk")]

mod support;

use artifact::pc2::{Reader, Writer};
use proptest::prelude::*;
use std::path::Path;
use support::{Place, bytes, refusal, says};

const VERTICES: usize = 3;

fn sample(number: u32) -> Vec<f32> {
    (0..VERTICES as u32 * 3).map(|i| (number * 100 + i) as f32 + 0.1).collect()
}

/// A whole cache of so many samples.
fn cache(path: &Path, samples: u32) {
    let mut writer = Writer::create(path, VERTICES, 1001).unwrap();
    (0..samples).for_each(|number| writer.write(&sample(number)).unwrap());
    writer.finish().unwrap().publish().unwrap();
}

#[test]
fn samples_survive() {
    let place = Place::new();
    let path = place.path("s.pc2");
    cache(&path, 4);
    assert_eq!(bytes(&path).len(), 32 + 4 * VERTICES * 12);
    let mut reader = Reader::open(&path).unwrap();
    assert_eq!((reader.vertex_count(), reader.sample_count(), reader.start_frame()), (3, 4, 1001));
    assert_eq!(reader.read().unwrap().unwrap(), sample(0));
    reader.skip(2).unwrap();
    assert_eq!(reader.read().unwrap().unwrap(), sample(3));
    assert_eq!(reader.read().unwrap(), None);
    reader.skip(9).unwrap();
    assert_eq!(reader.read().unwrap(), None);
}

#[test]
fn an_empty_cache_survives() {
    let place = Place::new();
    cache(&place.path("s.pc2"), 0);
    assert_eq!(Reader::open(&place.path("s.pc2")).unwrap().read().unwrap(), None);
}

#[test]
fn counts_that_disagree_with_the_size_are_refused() {
    let place = Place::new();
    let path = place.path("s.pc2");
    cache(&path, 4);
    let whole = bytes(&path);
    for length in (0..whole.len()).chain([whole.len() + 1]) {
        let mut other = whole.clone();
        other.resize(length, 0);
        let message = refusal(Reader::open(&place.file("cut.pc2", &other)).map(|_| ()));
        match length {
            0..32 => says(&message, &["cut.pc2: is shorter than a PC2 header", "cut short"]),
            _ => says(&message, &["byte 28: says 4 samples of 3 vertices, 176 bytes, but has", "cut short"]),
        }
    }
}

#[test]
fn headers_that_make_no_sense_are_refused() {
    let place = Place::new();
    let path = place.path("s.pc2");
    cache(&path, 1);
    let with = |at: usize, new: &[u8]| {
        let mut other = bytes(&path);
        other[at..at + new.len()].copy_from_slice(new);
        refusal(Reader::open(&place.file("odd.pc2", &other)).map(|_| ()))
    };
    says(&with(0, b"POINTCACHE3"), &["odd.pc2, byte 0: is not a PC2 vertex cache"]);
    says(&with(12, &2i32.to_le_bytes()), &["byte 12: is PC2 version 2"]);
    says(&with(16, &(-1i32).to_le_bytes()), &["byte 12: is PC2 version 1 with -1 vertices"]);
    // Counts whose product does not fit 64 bits.
    let mut huge = i32::MAX.to_le_bytes().to_vec();
    huge.extend([0; 8]);
    huge.extend(u32::MAX.to_le_bytes());
    says(&with(16, &huge), &["says 4294967295 samples of 2147483647 vertices"]);
}

#[test]
fn a_rest_mesh_of_another_size_is_refused() {
    let place = Place::new();
    cache(&place.path("s.pc2"), 1);
    let reader = Reader::open(&place.path("s.pc2")).unwrap();
    reader.check_vertex_count(Path::new("rest.obj"), 3).unwrap();
    let message = refusal(reader.check_vertex_count(Path::new("rest.obj"), 4));
    says(&message, &["s.pc2: has 3 vertices, but rest.obj has 4", "to do: "]);
}

#[test]
fn numbers_that_are_not_finite_are_refused_both_ways() {
    let place = Place::new();
    let path = place.path("s.pc2");
    let mut writer = Writer::create(&path, VERTICES, 0).unwrap();
    writer.write(&sample(0)).unwrap();
    let mut odd = sample(1);
    odd[7] = f32::NAN;
    assert_eq!(refusal(writer.write(&odd)), "s.pc2, sample 1, vertex 2: the position is not finite");
    drop(writer);
    assert!(place.names().is_empty());
    cache(&path, 2);
    let mut file = bytes(&path);
    file[32 + 36 + 4..][..4].copy_from_slice(&f32::INFINITY.to_le_bytes());
    let mut reader = Reader::open(&place.file("odd.pc2", file)).unwrap();
    reader.read().unwrap();
    assert_eq!(refusal(reader.read()), "odd.pc2, sample 1, vertex 0: the position is not finite");
}

#[test]
fn a_pipe_is_refused_before_the_work() {
    let message = refusal(Writer::create(Path::new("-"), VERTICES, 0).map(|_| ()));
    says(&message, &["cannot be written to a pipe", "name a file"]);
    says(&refusal(Writer::resumable(Path::new("-"), VERTICES, 0, "key", true).map(|_| ())), &["to a pipe"]);
}

/// Starts or continues a cache and writes samples up to `until`; then the run is interrupted, or finished.
fn resumed(path: &Path, key: &str, until: u32, finish: bool) -> u32 {
    let (mut writer, there) = Writer::resumable(path, VERTICES, 1001, key, true).unwrap();
    (there..until).for_each(|number| writer.write(&sample(number)).unwrap());
    if finish {
        writer.finish().unwrap().publish().unwrap();
    }
    there
}

#[test]
fn an_interrupted_cache_goes_on_and_equals_the_whole() {
    let place = Place::new();
    let (whole, path) = (place.path("whole.pc2"), place.path("s.pc2"));
    cache(&whole, 7);
    assert_eq!(resumed(&path, "key", 3, false), 0);
    assert_eq!(place.names(), ["s.pc2.partial", "s.pc2.partial.key", "whole.pc2"]);
    assert_eq!(resumed(&path, "key", 5, false), 3);
    assert_eq!(resumed(&path, "key", 7, true), 5);
    assert_eq!(place.names(), ["s.pc2", "whole.pc2"], "nothing is left beside it");
    assert_eq!(bytes(&path), bytes(&whole));
}

#[test]
fn a_cut_anywhere_goes_on_from_whole_samples() {
    let place = Place::new();
    let (whole, path) = (place.path("whole.pc2"), place.path("s.pc2"));
    cache(&whole, 3);
    for length in 0..=32 + 3 * 36 {
        resumed(&path, "key", 3, false);
        let partial = std::fs::File::options().write(true).open(place.path("s.pc2.partial")).unwrap();
        partial.set_len(length).unwrap();
        let there = resumed(&path, "key", 3, true);
        assert_eq!(u64::from(there), length.saturating_sub(32) / 36);
        assert_eq!(bytes(&path), bytes(&whole), "cut at {length}");
    }
}

#[test]
fn another_key_starts_anew() {
    let place = Place::new();
    let path = place.path("s.pc2");
    resumed(&path, "parameters 1", 5, false);
    assert_eq!(resumed(&path, "parameters 2", 2, true), 0);
    assert_eq!(Reader::open(&path).unwrap().sample_count(), 2);
}

#[test]
fn a_finished_but_unpublished_cache_can_be_resumed() {
    let place = Place::new();
    let path = place.path("s.pc2");
    let (mut writer, _) = Writer::resumable(&path, VERTICES, 1001, "key", true).unwrap();
    writer.write(&sample(0)).unwrap();
    drop(writer.finish().unwrap());
    assert_eq!(place.names(), ["s.pc2.partial", "s.pc2.partial.key"]);
    assert_eq!(resumed(&path, "key", 2, true), 1);
    cache(&place.path("whole.pc2"), 2);
    assert_eq!(bytes(&path), bytes(&place.path("whole.pc2")));
}

proptest! {
    #[test]
    fn any_bytes_never_panic(mut tail in proptest::collection::vec(any::<u8>(), 0..120)) {
        let mut file = b"POINTCACHE2\0\x01\0\0\0".to_vec();
        file.append(&mut tail);
        if let Ok(mut reader) = Reader::open(&Place::new().file("a.pc2", file)) {
            while let Ok(Some(_)) = reader.read() {}
        }
    }
}
