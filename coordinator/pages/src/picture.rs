//! File formats of pictures.

use run::error::RunError;
use std::path::Path;

/// A file format of a picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    /// Pixel image.
    #[cfg(feature = "pictures")]
    Png,
    /// Vector graphics, for browsers and editors.
    Svg,
    /// Vector graphics, for papers.
    #[cfg(feature = "pictures")]
    Pdf,
}

impl Format {
    /// Returns the format for the extension of a file name.
    ///
    /// # Errors
    /// [`RunError::Usage`] if the extension is missing or unknown, or this build cannot write the
    /// format.
    pub fn of(path: &Path) -> Result<Self, RunError> {
        let ending = path.extension().and_then(|ending| ending.to_str()).unwrap_or_default();
        let shown = path.display();
        match ending.to_ascii_lowercase().as_str() {
            "svg" => Ok(Self::Svg),
            #[cfg(not(feature = "pictures"))]
            "png" | "pdf" => Err(RunError::Usage(format!(
                "--out {shown}: this build writes pictures as SVG only; use a name that ends in \
                 .svg, or build with `cargo build --release --features coordinator/pictures`"
            ))),
            #[cfg(feature = "pictures")]
            "png" => Ok(Self::Png),
            #[cfg(feature = "pictures")]
            "pdf" => Ok(Self::Pdf),
            _ => {
                let fix = "use a name that ends in .png, .svg or .pdf";
                Err(RunError::Usage(format!(
                    "--out {shown}: the file name has no known extension; {fix}"
                )))
            }
        }
    }

    /// Default file name of a picture.
    pub fn default_file() -> &'static str {
        if cfg!(feature = "pictures") { "picture.png" } else { "picture.svg" }
    }

    /// Converts an SVG to the contents of the file; a PNG is `width` pixels wide.
    ///
    /// # Errors
    /// [`RunError::Usage`] if the SVG cannot be converted, or the picture does not fit into memory.
    #[cfg_attr(
        not(feature = "pictures"),
        expect(unused_variables, reason = "SVG has no width in pixels")
    )]
    pub fn bytes(self, svg: String, width: u32) -> Result<Vec<u8>, RunError> {
        match self {
            Self::Svg => Ok(svg.into_bytes()),
            #[cfg(feature = "pictures")]
            Self::Png => render::png(&svg, width),
            #[cfg(feature = "pictures")]
            Self::Pdf => render::pdf(&svg),
        }
    }
}

/// Renders an SVG as PNG or PDF. The fonts are embedded in the program, because a cluster node may
/// have none.
#[cfg(feature = "pictures")]
mod render {
    use resvg::tiny_skia::{Pixmap, Transform};
    use resvg::usvg::{Options, Tree};
    use run::error::RunError;
    use svg2pdf::{ConversionOptions, PageOptions};

    /// Converts an SVG to PDF.
    ///
    /// # Errors
    /// [`RunError::Usage`] if the drawing cannot be converted.
    pub(super) fn pdf(svg: &str) -> Result<Vec<u8>, RunError> {
        let made =
            svg2pdf::to_pdf(&tree(svg)?, ConversionOptions::default(), PageOptions::default());
        made.map_err(|why| RunError::Usage(format!("the PDF cannot be written: {why}")))
    }

    /// Converts an SVG to PNG, `width` pixels wide.
    ///
    /// # Errors
    /// [`RunError::Usage`] if the picture does not fit into memory.
    pub(super) fn png(svg: &str, width: u32) -> Result<Vec<u8>, RunError> {
        let tree = tree(svg)?;
        let size = tree.size();
        let scale = width as f32 / size.width();
        let height = (size.height() * scale).ceil() as u32;
        let too_large = || {
            RunError::Usage(format!(
                "a picture of {width} × {height} pixels is too large; choose a smaller --width"
            ))
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
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_ending_is_the_format() {
        assert_eq!(Format::of(Path::new("a.b/c.SVG")).unwrap(), Format::Svg);
        let wrong = Format::of(Path::new("c.jpg")).unwrap_err().to_string();
        assert!(wrong.contains("c.jpg") && wrong.contains(".png, .svg or .pdf"), "{wrong}");
        #[cfg(feature = "pictures")]
        assert_eq!(Format::of(Path::new("c.PNG")).unwrap(), Format::Png);
        #[cfg(not(feature = "pictures"))]
        {
            let left_out = Format::of(Path::new("c.PNG")).unwrap_err().to_string();
            assert!(left_out.contains("--features coordinator/pictures"), "{left_out}");
        }
    }
}
