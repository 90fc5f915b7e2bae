//! An SVG as PNG or PDF. Letters come with the program: a node of a cluster may have none.

use resvg::tiny_skia::{Pixmap, Transform};
use resvg::usvg::{Options, Tree};
use run::error::RunError;
use svg2pdf::{ConversionOptions, PageOptions};

/// The drawing in lines.
///
/// # Errors
/// [`RunError::Usage`] for a drawing that cannot be converted.
pub(super) fn pdf(svg: &str) -> Result<Vec<u8>, RunError> {
    let made = svg2pdf::to_pdf(&tree(svg)?, ConversionOptions::default(), PageOptions::default());
    made.map_err(|why| RunError::Usage(format!("no PDF can be made: {why}")))
}

/// The drawing in pixels, `width` of them wide.
///
/// # Errors
/// [`RunError::Usage`] for a picture that no memory holds.
pub(super) fn png(svg: &str, width: u32) -> Result<Vec<u8>, RunError> {
    let tree = tree(svg)?;
    let size = tree.size();
    let scale = width as f32 / size.width();
    let height = (size.height() * scale).ceil() as u32;
    let too_large = || {
        RunError::Usage(format!("a picture of {width} × {height} pixels: choose a smaller --width"))
    };
    let mut pixels = Pixmap::new(width, height).ok_or_else(too_large)?;
    resvg::render(&tree, Transform::from_scale(scale, scale), &mut pixels.as_mut());
    pixels.encode_png().map_err(|_| too_large())
}

fn tree(svg: &str) -> Result<Tree, RunError> {
    let mut options = Options::default();
    let fonts = options.fontdb_mut();
    fonts.load_font_data(dejavu::sans::regular().to_vec());
    fonts.load_font_data(dejavu::sans::bold().to_vec());
    fonts.set_serif_family("DejaVu Sans");
    fonts.set_sans_serif_family("DejaVu Sans");
    Tree::from_str(svg, &options)
        .map_err(|why| RunError::Usage(format!("the drawing cannot be read: {why}")))
}

#[cfg(test)]
mod tests {
    use super::*;

    const SVG: &str = "<svg width=\"40\" height=\"20\" viewBox=\"0 0 40 20\" \
        xmlns=\"http://www.w3.org/2000/svg\"><rect width=\"100%\" height=\"100%\" fill=\"#fff\"/>\
        <text x=\"2\" y=\"15\" font-family=\"system-ui, sans-serif\" font-size=\"14\">ξ µ</text></svg>";

    #[test]
    fn letters_are_drawn_without_fonts_of_the_machine() {
        let bytes = png(SVG, 80).unwrap();
        let mut reader = png::Decoder::new(std::io::Cursor::new(bytes)).read_info().unwrap();
        let mut pixels = vec![0; reader.output_buffer_size().unwrap()];
        let frame = reader.next_frame(&mut pixels).unwrap();
        assert_eq!((frame.width, frame.height), (80, 40));
        let dark = pixels.chunks_exact(4).filter(|pixel| pixel[0] < 100).count();
        assert!(dark > 40, "{dark} dark pixels");
        let pdf = pdf(SVG).unwrap();
        assert!(pdf.starts_with(b"%PDF-") && pdf.len() > 1000);
    }
}
