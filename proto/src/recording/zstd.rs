//! Reads chunks compressed with Zstandard, as earlier versions of this program and other programs
//! write them. This program writes LZ4, which needs no large C library.

use mcap::sans_io::decompressor::{DecompressResult, Decompressor};
use mcap::{McapError, McapResult};
use ruzstd::decoding::{BlockDecodingStrategy, FrameDecoder};
use std::io::Read;

/// Longest block with its header, after the longest header of a frame \[byte\].
const LONGEST: usize = (128 << 10) + 3 + 18;
/// Longest history that a frame may refer to \[byte\]. A chunk has 4 MiB.
const LONGEST_HISTORY: u64 = 8 << 20;

/// Decompressor of one frame per chunk.
pub(super) struct Zstd {
    frame: FrameDecoder,
    begun: bool,
}

impl Zstd {
    pub(super) fn new() -> Self {
        let mut frame = FrameDecoder::new();
        frame.set_max_window_size(LONGEST_HISTORY);
        Self { frame, begun: false }
    }
}

impl Decompressor for Zstd {
    fn next_read_size(&self) -> usize {
        LONGEST
    }

    /// Decompresses one block at most: a few bytes may stand for a whole block.
    fn decompress(&mut self, source: &[u8], target: &mut [u8]) -> McapResult<DecompressResult> {
        let mut left = source;
        if !self.begun {
            self.frame.reset(&mut left).map_err(damaged)?;
            self.begun = true;
        }
        if self.frame.can_collect() == 0 && !self.frame.is_finished() {
            let one = BlockDecodingStrategy::UptoBlocks(1);
            self.frame.decode_blocks(&mut left, one).map_err(damaged)?;
        }
        let wrote = self.frame.read(target)?;
        Ok(DecompressResult { consumed: source.len() - left.len(), wrote })
    }

    fn reset(&mut self) -> McapResult<()> {
        self.begun = false;
        Ok(())
    }

    fn name(&self) -> &'static str {
        "zstd"
    }
}

fn damaged(error: impl std::fmt::Display) -> McapError {
    McapError::DecompressionError(error.to_string())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// 3000 values n²/3 mod 61 + 32, compressed by `zstd -1` 1.5.
    const FRAME: &str = "28b52ffd60b80a0d0500728b2518306b0f39c9f104852714e934a44ba4976bb7de0f06065401071daa05202d24\
        0be2a781557ce3ee66009737a2fe4f3324579891ddeda5a49c345b049e2e9076a8c8300faf2a8140e493c97ecf\
        f6ad46d177c69720237c0f4649b838efae68d6b3b97f36138f209250959f6940f5d09005f58285e99493b2b6eb\
        92c18a4b867e5fc706bf00665fd778c50ed2472c4981c24053073a270100377fe97c2305";

    #[test]
    fn a_frame_of_the_reference_library_is_read_in_pieces_of_any_size() {
        let frame: Vec<u8> = (0..FRAME.len() / 2)
            .map(|n| u8::from_str_radix(&FRAME[2 * n..2 * n + 2], 16).unwrap())
            .collect();
        let expected: Vec<u8> = (0..3000_u32).map(|n| (n * n / 3 % 61 + 32) as u8).collect();
        let mut reader = Zstd::new();
        for piece in [1, 7, 5000] {
            let (mut left, mut told) = (&frame[..], Vec::new());
            while told.len() < expected.len() {
                let mut target = vec![0; piece];
                let done = reader.decompress(left, &mut target).unwrap();
                assert!(done.consumed + done.wrote > 0);
                left = &left[done.consumed..];
                told.extend_from_slice(&target[..done.wrote]);
            }
            assert!(left.is_empty() && told == expected);
            reader.reset().unwrap();
        }
    }
}
