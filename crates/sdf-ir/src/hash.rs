//! Hash maps for what holds many floats.
//!
//! Round numbers differ in the highest bits of their `f64` alone. The fast hasher moves no bit downwards, so that they
//! would share their places in a table; here the high bits are folded into the low ones in the end.

use rustc_hash::FxHasher;
use std::collections::HashMap;
use std::hash::{BuildHasherDefault, Hasher};

/// A hash map that is the same in every run.
pub type MixMap<K, V> = HashMap<K, V, BuildHasherDefault<Mix>>;

/// The fast hasher with a better end.
#[derive(Clone, Default)]
pub struct Mix(FxHasher);

impl Hasher for Mix {
    fn finish(&self) -> u64 {
        let x = self.0.finish();
        let x = (x ^ (x >> 32)).wrapping_mul(0x9e37_79b9_7f4a_7c15);
        x ^ (x >> 29)
    }

    fn write(&mut self, bytes: &[u8]) {
        self.0.write(bytes);
    }

    fn write_u8(&mut self, i: u8) {
        self.0.write_u8(i);
    }

    fn write_u16(&mut self, i: u16) {
        self.0.write_u16(i);
    }

    fn write_u32(&mut self, i: u32) {
        self.0.write_u32(i);
    }

    fn write_u64(&mut self, i: u64) {
        // Words that follow each other are added up before they are multiplied: the high bits must not be all there is.
        self.0.write_u64(i ^ (i >> 32));
    }

    fn write_usize(&mut self, i: usize) {
        self.0.write_usize(i);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::HashSet;
    use std::hash::BuildHasher;

    #[test]
    fn round_numbers_have_places_of_their_own() {
        let build = BuildHasherDefault::<Mix>::default();
        let hashes: Vec<u64> =
            (0..4096).map(|i| build.hash_one((3u32, f64::from(i).to_bits(), 7u32))).collect();
        for shift in [0, 20, 52] {
            let places: HashSet<u64> = hashes.iter().map(|h| h >> shift & 0xfff).collect();
            // As many as random places would be: 1 - 1/e of all.
            assert!(places.len() > 2400, "{} places of 4096 from bit {shift}", places.len());
        }
        let fast = BuildHasherDefault::<FxHasher>::default();
        let places: HashSet<u64> =
            (0..4096).map(|i| fast.hash_one((3u32, f64::from(i).to_bits())) & 0xfff).collect();
        assert!(places.len() < 2400, "the fast hasher needs no help: {}", places.len());
        assert_eq!(build.hash_one("a".to_string()), build.hash_one("a"));
    }
}
