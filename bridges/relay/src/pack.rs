//! Values on their way, compressed or not; never with loss.
//!
//! Before they are compressed the bytes of all values are put side by side by their significance: neighbours of
//! a smooth field have signs, exponents and first digits in common, which a compressor finds only then.

use std::borrow::Cow;
use std::fmt;
use zerocopy::{Immutable, IntoBytes, KnownLayout, TryFromBytes};

/// How values are packed.
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
    /// As they are.
    #[default]
    None,
    /// By LZ4: fast.
    Lz4,
    /// By Zstandard, level 1: smaller.
    Zstd,
}

/// Values that cannot be unpacked.
#[derive(Debug, PartialEq, thiserror::Error)]
#[error("a sample does not unpack to {values} values")]
pub(crate) struct Unpackable {
    values: usize,
}

/// The level of Zstandard: higher ones are slower than the networks that they would save.
const LEVEL: i32 = 1;

impl fmt::Display for Packing {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::None => "none",
            Self::Lz4 => "lz4",
            Self::Zstd => "zstd",
        })
    }
}

/// The bytes of values, and how they are packed: as asked, or not at all where that is shorter.
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
        Packing::Zstd => zstd::bulk::compress(&planes(), LEVEL).ok(),
    };
    match packed.filter(|packed| packed.len() < size_of_val(values)) {
        Some(packed) => (wanted, packed.into()),
        None => (Packing::None, values.as_bytes().into()),
    }
}

/// Unpacks into values; memory is taken for no more than these.
pub(crate) fn unpack(packing: Packing, bytes: &[u8], values: &mut [f64]) -> Result<(), Unpackable> {
    let (length, unpackable) = (size_of_val(values), Unpackable { values: values.len() });
    let mut planes = match packing {
        Packing::None => {
            if bytes.len() != length {
                return Err(unpackable);
            }
            values.as_mut_bytes().copy_from_slice(bytes);
            return Ok(());
        }
        Packing::Lz4 | Packing::Zstd => vec![0; length],
    };
    let unpacked = match packing {
        Packing::Lz4 => lz4_flex::block::decompress_into(bytes, &mut planes).ok(),
        _ => zstd::bulk::decompress_to_buffer(bytes, &mut planes[..]).ok(),
    };
    if unpacked != Some(length) {
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

    const ALL: [Packing; 3] = [Packing::None, Packing::Lz4, Packing::Zstd];

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
        for wanted in [Packing::Lz4, Packing::Zstd] {
            let (packing, bytes) = pack(&values, wanted);
            assert_eq!(packing, wanted);
            assert!(bytes.len() < 70_000, "{wanted}: {}", bytes.len());
            for length in [9_999, 10_001] {
                assert!(unpack(packing, &bytes, &mut vec![0.0; length]).is_err());
            }
        }
        let (packing, bytes) = pack(&[1.0], Packing::Zstd);
        assert_eq!((packing, bytes.len()), (Packing::None, 8), "shorter as it is");
    }
}
