//! Small images within the page: indexed PNG as a data address.
//!
//! PNG (ISO/IEC 15948) with the palette of [`super::palette`]; the data are stored, not compressed
//! (RFC 1951, block type 0): a map of 80 × 60 elements takes 6 kB.

use super::palette::{COLOURS, colour};

/// Longest stored block of a deflate stream.
const BLOCK: usize = 65_535;

/// The address of an image with one palette entry a pixel, row by row from the top.
///
/// # Panics
/// `pixels` is not a multiple of `width`, or empty.
#[must_use]
pub fn address(width: usize, pixels: &[u8]) -> String {
    format!("data:image/png;base64,{}", base64(&png(width, pixels)))
}

fn png(width: usize, pixels: &[u8]) -> Vec<u8> {
    assert!(!pixels.is_empty() && pixels.len().is_multiple_of(width), "an image has full rows");
    let height = pixels.len() / width;
    let mut out = b"\x89PNG\r\n\x1a\n".to_vec();
    let mut header = Vec::new();
    for size in [width, height] {
        header.extend(u32::try_from(size).expect("a map has few elements").to_be_bytes());
    }
    // Eight bits, indexed; deflate, adaptive filters, no interlace.
    header.extend([8, 3, 0, 0, 0]);
    chunk(&mut out, b"IHDR", &header);
    let palette = std::iter::once([0; 3]).chain((1..=COLOURS).map(colour));
    chunk(&mut out, b"PLTE", &palette.flatten().collect::<Vec<u8>>());
    chunk(&mut out, b"tRNS", &[0]);
    let rows = pixels.chunks_exact(width);
    let raw: Vec<u8> = rows.flat_map(|row| std::iter::once(&0).chain(row)).copied().collect();
    chunk(&mut out, b"IDAT", &stored(&raw));
    chunk(&mut out, b"IEND", &[]);
    out
}

fn chunk(out: &mut Vec<u8>, kind: &[u8; 4], data: &[u8]) {
    out.extend(u32::try_from(data.len()).expect("a map has few elements").to_be_bytes());
    let from = out.len();
    out.extend(kind);
    out.extend(data);
    let sum = crc(&out[from..]);
    out.extend(sum.to_be_bytes());
}

/// A zlib stream (RFC 1950) of stored blocks.
fn stored(raw: &[u8]) -> Vec<u8> {
    let mut out = vec![0x78, 0x01];
    let mut blocks = raw.chunks(BLOCK).peekable();
    while let Some(block) = blocks.next() {
        let length = block.len() as u16;
        out.push(u8::from(blocks.peek().is_none()));
        out.extend(length.to_le_bytes());
        out.extend((!length).to_le_bytes());
        out.extend(block);
    }
    out.extend(adler(raw).to_be_bytes());
    out
}

fn adler(data: &[u8]) -> u32 {
    let step = |(a, b): (u32, u32), byte: &u8| {
        let a = (a + u32::from(*byte)) % 65_521;
        (a, (b + a) % 65_521)
    };
    let (a, b) = data.iter().fold((1, 0), step);
    b << 16 | a
}

fn crc(data: &[u8]) -> u32 {
    let bit = |sum: u32, _| if sum & 1 == 1 { 0xedb8_8320 ^ (sum >> 1) } else { sum >> 1 };
    let byte = |sum: u32, byte: &u8| (0..8).fold(sum ^ u32::from(*byte), bit);
    !data.iter().fold(!0, byte)
}

fn base64(data: &[u8]) -> String {
    const DIGITS: &[u8; 64] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let mut out = String::with_capacity(data.len().div_ceil(3) * 4);
    for group in data.chunks(3) {
        let byte = |k: usize| u32::from(group.get(k).copied().unwrap_or(0));
        let bits = byte(0) << 16 | byte(1) << 8 | byte(2);
        for k in 0..4 {
            let digit = DIGITS[(bits >> (18 - 6 * k) & 63) as usize];
            out.push(if k <= group.len() { char::from(digit) } else { '=' });
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Check values that the standards print: RFC 4648 §10, and the sums of `123456789`.
    #[test]
    fn sums_and_digits_are_those_of_the_standards() {
        assert_eq!(crc(b"123456789"), 0xcbf4_3926);
        assert_eq!(adler(b"123456789"), 0x091e_01de);
        let texts = ["", "f", "fo", "foo", "foob", "fooba", "foobar"];
        let digits = ["", "Zg==", "Zm8=", "Zm9v", "Zm9vYg==", "Zm9vYmE=", "Zm9vYmFy"];
        assert_eq!(texts.map(|text| base64(text.as_bytes())), digits);
    }

    #[test]
    fn long_data_are_stored_in_several_blocks() {
        let raw = vec![7; BLOCK + 2];
        let out = stored(&raw);
        assert_eq!(out[2..7], [0, 0xff, 0xff, 0, 0]);
        assert_eq!(out[7 + BLOCK..][..5], [1, 2, 0, 0xfd, 0xff]);
        assert_eq!(out.len(), 2 + 5 + BLOCK + 5 + 2 + 4);
    }
}
