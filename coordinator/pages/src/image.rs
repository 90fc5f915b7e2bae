//! Small images within the page: indexed PNG as a data address, with the palette of
//! [`super::palette`].

use super::palette::{COLOURS, colour};
use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use png::{BitDepth, ColorType, Compression, Encoder, EncodingError};

/// The address of an image with one palette entry a pixel, row by row from the top.
///
/// # Panics
/// `pixels` is not a multiple of `width`, or empty.
#[must_use]
pub fn address(width: usize, pixels: &[u8]) -> String {
    assert!(!pixels.is_empty() && pixels.len().is_multiple_of(width), "an image has full rows");
    let image = encoded(width, pixels).expect("a map has few elements, and memory takes them all");
    format!("data:image/png;base64,{}", STANDARD.encode(image))
}

/// Eight bits, indexed; entry 0 is transparent.
fn encoded(width: usize, pixels: &[u8]) -> Result<Vec<u8>, EncodingError> {
    let size = |length: usize| u32::try_from(length).unwrap_or(u32::MAX);
    let palette = std::iter::once([0; 3]).chain((1..=COLOURS).map(colour));
    let mut out = Vec::new();
    let mut encoder = Encoder::new(&mut out, size(width), size(pixels.len() / width));
    encoder.set_color(ColorType::Indexed);
    encoder.set_depth(BitDepth::Eight);
    encoder.set_palette(palette.flatten().collect::<Vec<u8>>());
    encoder.set_trns(vec![0]);
    encoder.set_compression(Compression::Balanced);
    let mut writer = encoder.write_header()?;
    writer.write_image_data(pixels)?;
    writer.finish()?;
    Ok(out)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_image_reads_back_as_it_was() {
        let pixels: Vec<u8> = (0..80 * 60).map(|n| (n % 80) as u8).collect();
        let address = address(80, &pixels);
        let code = address.strip_prefix("data:image/png;base64,").unwrap();
        let image = std::io::Cursor::new(STANDARD.decode(code).unwrap());
        let mut decoder = png::Decoder::new(image);
        decoder.set_transformations(png::Transformations::IDENTITY);
        let mut reader = decoder.read_info().unwrap();
        let mut back = vec![0; reader.output_buffer_size().unwrap()];
        let frame = reader.next_frame(&mut back).unwrap();
        assert_eq!((frame.width, frame.height, back), (80, 60, pixels));
        assert_eq!(reader.info().trns.as_deref(), Some(&[0][..]));
        let first = reader.info().palette.as_ref().unwrap()[3..6].to_vec();
        assert_eq!(first, colour(1));
    }
}
