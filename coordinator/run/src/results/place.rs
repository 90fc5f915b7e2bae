//! Default result folders, if the user names none: `results/NAME`, then `results/NAME-2` and so on.
//! The last one is linked as `results/latest`.

use std::fs;
use std::io;
use std::iter::once;
use std::os::unix::fs::symlink;
use std::path::{Component, Path};

/// Folder of all results.
pub const RESULTS: &str = "results";

/// Link to the last result folder.
const LATEST: &str = "latest";

/// Returns NAME, NAME-2, NAME-3, and so on.
pub fn numbered(name: &str) -> impl Iterator<Item = String> {
    once(name.to_owned()).chain((2u64..).map(move |number| format!("{name}-{number}")))
}

/// Links the folder `name` in `results` as the latest. Results are valid without the link, so a
/// failure is only logged.
pub fn link_latest(results: &Path, name: &str) {
    if let Err(error) = link(results, name) {
        tracing::warn!(%error, "{} is not linked as {LATEST}", results.join(name).display());
    }
}

fn link(results: &Path, name: &str) -> io::Result<()> {
    let latest = results.join(LATEST);
    if latest.symlink_metadata().is_ok() && !is_ours(&latest) {
        return Err(io::Error::other("another file has that name"));
    }
    let new = results.join(format!(".{LATEST}-{}", std::process::id()));
    let _ = fs::remove_file(&new);
    symlink(name, &new).and_then(|()| fs::rename(&new, &latest))
}

/// Returns whether the link leads to a folder beside it, as the links of this module do.
fn is_ours(latest: &Path) -> bool {
    let Ok(target) = fs::read_link(latest) else { return false };
    let mut parts = target.components();
    matches!((parts.next(), parts.next()), (Some(Component::Normal(_)), None))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_counted_up() {
        let names: Vec<String> = numbered("a").take(3).collect();
        assert_eq!(names, ["a", "a-2", "a-3"]);
    }

    #[test]
    fn the_link_follows_and_what_is_not_ours_stays() {
        let place = tempfile::tempdir().unwrap();
        let latest = place.path().join(LATEST);
        for name in ["a", "a-2"] {
            link(place.path(), name).unwrap();
            assert_eq!(fs::read_link(&latest).unwrap(), Path::new(name));
        }
        fs::remove_file(&latest).unwrap();
        symlink("/tmp/mine", &latest).unwrap();
        assert!(link(place.path(), "a").is_err());
        fs::remove_file(&latest).unwrap();
        fs::create_dir(&latest).unwrap();
        assert!(link(place.path(), "a").is_err());
        assert_eq!(fs::read_dir(place.path()).unwrap().count(), 1);
    }
}
