//! Packing of values for the network: uncompressed, or compressed without loss.
//!
//! Before compression, the bytes of all values are grouped by significance. Neighbouring values of
//! a smooth field share signs, exponents and leading digits; grouping lets a compressor find them.

use std::borrow::Cow;
use std::fmt;
use zerocopy::{Immutable, IntoBytes, KnownLayout, TryFromBytes};

/// Packing of values.
#[derive(
    Clone,
    Copy,
    Debug,
    Default,
    PartialEq,
    Eq,
    clap::ValueEnum,
    Immutable,
    IntoBytes,
    KnownLayout,
    TryFromBytes,
)]
#[repr(u8)]
pub enum Packing {
    /// Uncompressed.
    #[default]
    None,
    /// LZ4.
    Lz4,
}

/// Error for bytes that do not unpack to the expected number of values.
#[derive(Debug, PartialEq, thiserror::Error)]
#[error("a sample does not unpack to {values} values")]
pub(crate) struct Unpackable {
    values: usize,
}

impl fmt::Display for Packing {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::None => "none",
            Self::Lz4 => "lz4",
        })
    }
}

/// Packs values as requested, or not at all if that is shorter. Returns the packing used and the
/// bytes.
pub(crate) fn pack(values: &[f64], wanted: Packing) -> (Packing, Cow<'_, [u8]>) {
    let planes = || {
        let mut planes = vec![0; size_of_val(values)];
        let count = values.len();
        for (at, value) in values.iter().enumerate() {
            for (plane, byte) in value.to_le_bytes().into_iter().enumerate() {
                planes[plane * count + at] = byte;
            }
        }
        planes
    };
    let packed = match wanted {
        Packing::None => None,
        Packing::Lz4 => Some(lz4_flex::block::compress(&planes())),
    };
    match packed.filter(|packed| packed.len() < size_of_val(values)) {
        Some(packed) => (wanted, packed.into()),
        None => (Packing::None, values.as_bytes().into()),
    }
}

/// Unpacks into `values`; allocates at most the size of `values`.
pub(crate) fn unpack(packing: Packing, bytes: &[u8], values: &mut [f64]) -> Result<(), Unpackable> {
    let (length, unpackable) = (size_of_val(values), Unpackable { values: values.len() });
    if packing == Packing::None {
        if bytes.len() != length {
            return Err(unpackable);
        }
        values.as_mut_bytes().copy_from_slice(bytes);
        return Ok(());
    }
    let mut planes = vec![0; length];
    if lz4_flex::block::decompress_into(bytes, &mut planes).ok() != Some(length) {
        return Err(unpackable);
    }
    let count = values.len();
    for (at, value) in values.iter_mut().enumerate() {
        *value = f64::from_le_bytes(std::array::from_fn(|plane| planes[plane * count + at]));
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const ALL: [Packing; 2] = [Packing::None, Packing::Lz4];

    proptest! {
        #![proptest_config(crate::fuzz_config())]

        #[test]
        fn every_bit_comes_back(bits in proptest::collection::vec(any::<u64>(), 0..300)) {
            let values: Vec<f64> = bits.iter().map(|bits| f64::from_bits(*bits)).collect();
            for wanted in ALL {
                let (packing, bytes) = pack(&values, wanted);
                let mut back = vec![0.0; values.len()];
                unpack(packing, &bytes, &mut back).unwrap();
                let back: Vec<u64> = back.iter().map(|value| value.to_bits()).collect();
                prop_assert_eq!(&back, &bits);
            }
        }

        #[test]
        fn no_bytes_unpack_to_more_than_there_is_room(
            bytes in proptest::collection::vec(any::<u8>(), 0..200), values in 0..40_usize,
        ) {
            let mut room = vec![0.0; values];
            for packing in ALL {
                let _ = unpack(packing, &bytes, &mut room);
            }
        }
    }

    #[test]
    fn a_smooth_field_shrinks_and_a_wrong_length_is_refused() {
        let values: Vec<f64> = (0..10_000).map(|n| (f64::from(n) * 1e-3).sin()).collect();
        let (packing, bytes) = pack(&values, Packing::Lz4);
        assert_eq!(packing, Packing::Lz4);
        assert!(bytes.len() < 70_000, "{}", bytes.len());
        for length in [9_999, 10_001] {
            assert!(unpack(packing, &bytes, &mut vec![0.0; length]).is_err());
        }
        let (packing, bytes) = pack(&[1.0], Packing::Lz4);
        assert_eq!((packing, bytes.len()), (Packing::None, 8), "shorter as it is");
    }
}
