//! An SVG as PNG or PDF. Letters come with the program: a node of a cluster may have none.

use resvg::tiny_skia::{Pixmap, Transform};
use resvg::usvg::{Options, Tree};
use run::error::RunError;
use std::path::Path;
use svg2pdf::{ConversionOptions, PageOptions};

/// What a picture is written as.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Format {
    /// Pixels.
    Png,
    /// Lines, for browsers and editors.
    Svg,
    /// Lines, for papers.
    Pdf,
}

impl Format {
    /// What the ending of a file says.
    ///
    /// # Errors
    /// [`RunError::Usage`] for another ending, or none.
    pub(super) fn of(path: &Path) -> Result<Self, RunError> {
        let ending = path.extension().and_then(|ending| ending.to_str()).unwrap_or_default();
        match ending.to_ascii_lowercase().as_str() {
            "png" => Ok(Self::Png),
            "svg" => Ok(Self::Svg),
            "pdf" => Ok(Self::Pdf),
            _ => {
                let path = path.display();
                let fix = "end its name in .png, .svg or .pdf";
                Err(RunError::Usage(format!("--out {path}: the ending says no format; {fix}")))
            }
        }
    }

    /// The file's content; a PNG is `width` pixels wide.
    ///
    /// # Errors
    /// [`RunError::Usage`] for a picture that no memory holds.
    pub(super) fn bytes(self, svg: String, width: u32) -> Result<Vec<u8>, RunError> {
        match self {
            Self::Svg => Ok(svg.into_bytes()),
            Self::Png => png(&tree(&svg)?, width),
            Self::Pdf => {
                let made = svg2pdf::to_pdf(
                    &tree(&svg)?,
                    ConversionOptions::default(),
                    PageOptions::default(),
                );
                made.map_err(|why| RunError::Usage(format!("no PDF can be made: {why}")))
            }
        }
    }
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

fn png(tree: &Tree, width: u32) -> Result<Vec<u8>, RunError> {
    let size = tree.size();
    let scale = width as f32 / size.width();
    let height = (size.height() * scale).ceil() as u32;
    let too_large = || {
        RunError::Usage(format!("a picture of {width} × {height} pixels: choose a smaller --width"))
    };
    let mut pixels = Pixmap::new(width, height).ok_or_else(too_large)?;
    resvg::render(tree, Transform::from_scale(scale, scale), &mut pixels.as_mut());
    pixels.encode_png().map_err(|_| too_large())
}

#[cfg(test)]
mod tests {
    use super::*;

    const SVG: &str = "<svg width=\"40\" height=\"20\" viewBox=\"0 0 40 20\" \
        xmlns=\"http://www.w3.org/2000/svg\"><rect width=\"100%\" height=\"100%\" fill=\"#fff\"/>\
        <text x=\"2\" y=\"15\" font-family=\"system-ui, sans-serif\" font-size=\"14\">ξ µ</text></svg>";

    #[test]
    fn letters_are_drawn_without_fonts_of_the_machine() {
        let bytes = Format::Png.bytes(SVG.to_owned(), 80).unwrap();
        let mut reader = png::Decoder::new(std::io::Cursor::new(bytes)).read_info().unwrap();
        let mut pixels = vec![0; reader.output_buffer_size().unwrap()];
        let frame = reader.next_frame(&mut pixels).unwrap();
        assert_eq!((frame.width, frame.height), (80, 40));
        let dark = pixels.chunks_exact(4).filter(|pixel| pixel[0] < 100).count();
        assert!(dark > 40, "{dark} dark pixels");
        let pdf = Format::Pdf.bytes(SVG.to_owned(), 80).unwrap();
        assert!(pdf.starts_with(b"%PDF-") && pdf.len() > 1000);
    }

    #[test]
    fn the_ending_is_the_format() {
        assert_eq!(Format::of(Path::new("a.b/c.PNG")).unwrap(), Format::Png);
        let wrong = Format::of(Path::new("c.jpg")).unwrap_err().to_string();
        assert!(wrong.contains("c.jpg") && wrong.contains(".png, .svg or .pdf"), "{wrong}");
    }
}
