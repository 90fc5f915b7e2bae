//! The formats of a picture.

#[cfg(feature = "pictures")]
mod render;

use run::error::RunError;
use std::path::Path;

/// A format of a picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    /// Pixels.
    #[cfg(feature = "pictures")]
    Png,
    /// Lines, for browsers and editors.
    Svg,
    /// Lines, for papers.
    #[cfg(feature = "pictures")]
    Pdf,
}

impl Format {
    /// The format by the ending of a file.
    ///
    /// # Errors
    /// [`RunError::Usage`] for another ending, for none, and for a format that this build cannot
    /// write.
    pub fn of(path: &Path) -> Result<Self, RunError> {
        let ending = path.extension().and_then(|ending| ending.to_str()).unwrap_or_default();
        let shown = path.display();
        match ending.to_ascii_lowercase().as_str() {
            "svg" => Ok(Self::Svg),
            #[cfg(not(feature = "pictures"))]
            "png" | "pdf" => Err(RunError::Usage(format!(
                "--out {shown}: this build writes pictures as SVG only; end the name in .svg, or build with \
                 `cargo build --release --features coordinator/pictures`"
            ))),
            #[cfg(feature = "pictures")]
            "png" => Ok(Self::Png),
            #[cfg(feature = "pictures")]
            "pdf" => Ok(Self::Pdf),
            _ => {
                let fix = "end its name in .png, .svg or .pdf";
                Err(RunError::Usage(format!("--out {shown}: the ending says no format; {fix}")))
            }
        }
    }

    /// Name of a picture's file, unless the user gives one.
    pub fn default_file() -> &'static str {
        if cfg!(feature = "pictures") { "picture.png" } else { "picture.svg" }
    }

    /// Content of the file; a PNG is `width` pixels wide.
    ///
    /// # Errors
    /// [`RunError::Usage`] for a picture that no memory holds.
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
