//! Files whose lock shows that their owner lives.
//!
//! The kernel releases the lock of a file when the last copy of its descriptor is closed. A process
//! that another thread is just starting holds such a copy until it runs its own program. Therefore
//! a lock is released explicitly, which ends it for all copies.

use std::fs::File;
use std::ops::Deref;

/// A file that is unlocked when it is dropped. Locks are taken with [`File::try_lock`] and
/// [`File::try_lock_shared`].
#[derive(Debug)]
pub struct LockFile(File);

impl From<File> for LockFile {
    fn from(file: File) -> Self {
        Self(file)
    }
}

impl Deref for LockFile {
    type Target = File;

    fn deref(&self) -> &File {
        &self.0
    }
}

impl Drop for LockFile {
    fn drop(&mut self) {
        let _ = self.0.unlock();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The copy stands for the descriptor in a process that is being started.
    #[test]
    fn a_dropped_lock_is_free_although_a_copy_of_its_descriptor_is_open() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("lock");
        let held = LockFile::from(File::create(&path).unwrap());
        held.try_lock().unwrap();
        let copy = held.try_clone().unwrap();
        let next = LockFile::from(File::open(&path).unwrap());
        assert!(next.try_lock().is_err());
        drop(held);
        next.try_lock().unwrap();
        drop(copy);
    }
}
