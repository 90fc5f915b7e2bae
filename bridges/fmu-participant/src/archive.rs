//! FMU archive. The file is untrusted: entries cannot be written outside the target folder, and the
//! unpacked size is limited regardless of the size the archive states.

use proto::input_file;
use std::fs::{self, File};
use std::io::{self, Read};
use std::path::{Path, PathBuf};
use zip::ZipArchive;

/// Maximum length of a model description [byte].
const LONGEST_TEXT: u64 = 64 << 20;
/// Maximum unpacked size [byte]; the target folder lies in memory.
const LARGEST: u64 = 2 << 30;
/// Maximum number of files.
const MOST_FILES: usize = 20_000;

/// Open FMU archive.
#[derive(Debug)]
pub struct Archive {
    path: PathBuf,
    zip: ZipArchive<File>,
}

impl Archive {
    /// Opens an FMU.
    ///
    /// # Errors
    /// Fails if the file is missing, is not an archive, or holds too many files.
    pub fn open(path: &Path) -> Result<Self, String> {
        let failed = |error: &dyn std::fmt::Display| format!("{}: {error}", path.display());
        let file = input_file::open(path).map_err(|error| failed(&error))?;
        let zip = ZipArchive::new(file).map_err(|error| failed(&error))?;
        match zip.len() {
            count if count > MOST_FILES => {
                Err(failed(&format!("has {count} files, at most {MOST_FILES}")))
            }
            _ => Ok(Self { path: path.to_owned(), zip }),
        }
    }

    /// Reads a text file of the archive.
    ///
    /// # Errors
    /// Fails if the file is missing, too long or not UTF-8.
    pub fn text(&mut self, name: &str) -> Result<String, String> {
        let place = format!("{}: {name}", self.path.display());
        let file = self.zip.by_name(name).map_err(|error| format!("{place}: {error}"))?;
        let mut text = String::new();
        let read = file.take(LONGEST_TEXT + 1).read_to_string(&mut text);
        let length = read.map_err(|error| format!("{place}: {error}"))? as u64;
        match length > LONGEST_TEXT {
            true => Err(format!("{place}: longer than {LONGEST_TEXT} bytes")),
            false => Ok(text),
        }
    }

    /// Unpacks the archive into a new folder.
    ///
    /// # Errors
    /// Fails if the folder exists, an entry is a link or leads out of the folder, the content is
    /// too large, or a file cannot be written.
    pub fn unpack(&mut self, folder: &Path) -> Result<(), String> {
        self.unpack_up_to(folder, LARGEST)
    }

    fn unpack_up_to(&mut self, folder: &Path, largest: u64) -> Result<(), String> {
        fs::create_dir(folder).map_err(|error| format!("{}: {error}", folder.display()))?;
        let mut left = largest;
        for index in 0..self.zip.len() {
            let written = self.unpack_one(index, folder, left);
            left -= written.map_err(|fault| format!("{}: {fault}", self.path.display()))?;
        }
        Ok(())
    }

    /// Unpacks one file of at most `most` bytes and returns its size.
    fn unpack_one(&mut self, index: usize, folder: &Path, most: u64) -> Result<u64, String> {
        let file = self.zip.by_index(index).map_err(|error| format!("file {index}: {error}"))?;
        let name = file.name().to_owned();
        let failed = |error: io::Error| format!("{name:?}: {error}");
        let Some(inside) = file.enclosed_name() else {
            return Err(format!("{name:?} leads out of the folder it is unpacked to"));
        };
        if file.is_symlink() {
            return Err(format!("{name:?} is a link"));
        }
        let to = folder.join(inside);
        if file.is_dir() {
            return fs::create_dir_all(&to).map(|()| 0).map_err(failed);
        }
        if let Some(parent) = to.parent() {
            fs::create_dir_all(parent).map_err(failed)?;
        }
        let mut into = File::create_new(&to).map_err(failed)?;
        let written =
            io::copy(&mut file.take(most.saturating_add(1)), &mut into).map_err(failed)?;
        match written > most {
            true => Err(format!("its content is larger than {} MiB", LARGEST >> 20)),
            false => Ok(written),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use std::io::Write;
    use zip::write::SimpleFileOptions;

    fn packed(files: &[(&str, &[u8])], folder: &Path) -> PathBuf {
        let path = folder.join("a.fmu");
        let mut zip = zip::ZipWriter::new(File::create(&path).unwrap());
        for (name, content) in files {
            zip.start_file(*name, SimpleFileOptions::default()).unwrap();
            zip.write_all(content).unwrap();
        }
        zip.finish().unwrap();
        path
    }

    #[test]
    fn files_come_out_as_they_went_in() {
        let folder = tempfile::tempdir().unwrap();
        let path = packed(&[("modelDescription.xml", b"<a/>"), ("b/c.so", b"x")], folder.path());
        let mut archive = Archive::open(&path).unwrap();
        assert_eq!(archive.text("modelDescription.xml").unwrap(), "<a/>");
        let into = folder.path().join("out");
        archive.unpack(&into).unwrap();
        assert_eq!(fs::read(into.join("b/c.so")).unwrap(), b"x");
        let again = archive.unpack(&into).unwrap_err();
        assert!(again.contains("exists"), "{again}");
        assert!(archive.text("none").unwrap_err().contains("a.fmu: none"));
    }

    #[test]
    fn names_that_lead_elsewhere_are_refused() {
        for name in ["../evil", "a/../../evil", "/evil"] {
            let folder = tempfile::tempdir().unwrap();
            let path = packed(&[(name, b"x")], folder.path());
            let into = folder.path().join("in/to");
            fs::create_dir(folder.path().join("in")).unwrap();
            let said = Archive::open(&path).unwrap().unpack(&into);
            // An absolute name is treated as relative to the folder.
            assert!(name.starts_with('/') || said.unwrap_err().contains("leads out of"), "{name}");
            assert!(
                !folder.path().join("in/evil").exists() && !folder.path().join("evil").exists()
            );
            assert!(!Path::new("/evil").exists());
        }
    }

    #[test]
    fn links_and_too_much_are_refused() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.fmu");
        let mut zip = zip::ZipWriter::new(File::create(&path).unwrap());
        zip.add_symlink("l", "/etc", SimpleFileOptions::default()).unwrap();
        zip.finish().unwrap();
        let said = Archive::open(&path).unwrap().unpack(&folder.path().join("out")).unwrap_err();
        assert!(said.contains("is a link"), "{said}");
        // Zeros compress to almost nothing: the size is known only while unpacking.
        let zeros = vec![0; 1 << 20];
        let path = packed(&[("a", &zeros), ("b", &zeros)], folder.path());
        let mut archive = Archive::open(&path).unwrap();
        let said = archive.unpack_up_to(&folder.path().join("two"), (2 << 20) - 1).unwrap_err();
        assert!(said.contains("is larger than"), "{said}");
        assert_eq!(archive.unpack_up_to(&folder.path().join("three"), 2 << 20), Ok(()));
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(64))]

        /// An archive with one byte changed, and a few bytes cut off.
        #[test]
        fn any_bytes_are_unpacked_or_refused(at in 0_usize..400, byte: u8, cut in 0_usize..400) {
            let folder = tempfile::tempdir().unwrap();
            let path = packed(&[("modelDescription.xml", b"<a/>"), ("b/c", b"hello")], folder.path());
            let mut bytes = fs::read(&path).unwrap();
            let place = at % bytes.len();
            bytes[place] = byte;
            bytes.truncate(bytes.len() - cut.min(bytes.len()) / 8);
            fs::write(&path, bytes).unwrap();
            if let Ok(mut archive) = Archive::open(&path) {
                let _ = archive.text("modelDescription.xml");
                let _ = archive.unpack(&folder.path().join("out"));
            }
            let there: Vec<_> = fs::read_dir(folder.path()).unwrap().flatten().map(|e| e.file_name()).collect();
            prop_assert!(there.iter().all(|name| name == "a.fmu" || name == "out"), "{there:?}");
        }
    }
}
