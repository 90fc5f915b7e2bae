//! Transfer of the files a case names. Paths are not transmitted.

use super::ClientError;
use crate::frame::Frame;
use crate::link::Sending;
use contract::description::Description;
use run::record::named_files;
use serde_json::Value;
use std::fs::File;
use std::io::Read;
use std::path::Path;

/// Bytes of a file in one message.
const PIECE: usize = 1 << 20;
/// Maximum length of a file extension that is transmitted.
const ENDING: usize = 16;

/// Sends the files named by a configuration. An invalid configuration is left for the participant
/// to reject.
pub(super) fn send_files(
    sending: &Sending,
    description: &Description,
    configuration: &[u8],
) -> Result<(), ClientError> {
    let Ok(configuration) = serde_json::from_slice::<Value>(configuration) else { return Ok(()) };
    for (key, path) in named_files(description, &configuration["case"]) {
        let ending = path.extension().and_then(|ending| ending.to_str()).unwrap_or_default();
        let simple = ending.len() <= ENDING && ending.bytes().all(|b| b.is_ascii_alphanumeric());
        let ending = if simple { ending } else { "" };
        let sent = pieces(&path, |bytes, last| {
            sending.send(&Frame::File { key: &key, ending, last, bytes })
        });
        sent.map_err(|why| ClientError::of(format!("{key}: {}: {why}", path.display())))?;
    }
    Ok(())
}

/// Reads a file in pieces and passes each to `give`, which also learns whether the piece is the
/// last.
pub(super) fn pieces<E: std::fmt::Display>(
    path: &Path,
    mut give: impl FnMut(&[u8], bool) -> Result<(), E>,
) -> Result<(), String> {
    let mut file = File::open(path).map_err(|error| error.to_string())?;
    let mut piece = Vec::with_capacity(PIECE);
    loop {
        piece.clear();
        let read = file.by_ref().take(PIECE as u64).read_to_end(&mut piece);
        let count = read.map_err(|error| error.to_string())?;
        give(&piece, count < PIECE).map_err(|error| error.to_string())?;
        if count < PIECE {
            return Ok(());
        }
    }
}
