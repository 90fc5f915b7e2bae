//! The formats of a picture.

use run::error::RunError;
use std::path::Path;

/// A format of a picture.
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
    /// The format by the ending of a file.
    ///
    /// # Errors
    /// [`RunError::Usage`] for another ending, for none, and for a format that this build cannot
    /// write.
    pub(super) fn of(path: &Path) -> Result<Self, RunError> {
        let ending = path.extension().and_then(|ending| ending.to_str()).unwrap_or_default();
        let shown = path.display();
        match ending.to_ascii_lowercase().as_str() {
            "svg" => Ok(Self::Svg),
            "png" | "pdf" if cfg!(not(feature = "pictures")) => Err(RunError::Usage(format!(
                "--out {shown}: this build writes pictures as SVG only; end the name in .svg, or build with \
                 `cargo build --release --features coordinator/pictures`"
            ))),
            "png" => Ok(Self::Png),
            "pdf" => Ok(Self::Pdf),
            _ => {
                let fix = "end its name in .png, .svg or .pdf";
                Err(RunError::Usage(format!("--out {shown}: the ending says no format; {fix}")))
            }
        }
    }

    /// Name of a picture's file, unless the user gives one.
    pub(super) fn default_file() -> &'static str {
        if cfg!(feature = "pictures") { "picture.png" } else { "picture.svg" }
    }

    /// Content of the file; a PNG is `width` pixels wide.
    ///
    /// # Errors
    /// [`RunError::Usage`] for a picture that no memory holds.
    pub(super) fn bytes(self, svg: String, width: u32) -> Result<Vec<u8>, RunError> {
        match self {
            Self::Svg => Ok(svg.into_bytes()),
            #[cfg(feature = "pictures")]
            Self::Png => super::render::png(&svg, width),
            #[cfg(feature = "pictures")]
            Self::Pdf => super::render::pdf(&svg),
            #[cfg(not(feature = "pictures"))]
            Self::Png | Self::Pdf => unreachable!("refused by its ending: {width}"),
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
        match Format::of(Path::new("c.PNG")) {
            Ok(format) => assert!(format == Format::Png && cfg!(feature = "pictures")),
            Err(why) => assert!(why.to_string().contains("--features coordinator/pictures")),
        }
    }
}
