//! Table `[output]`: fields that are written out.

use super::source::Source;
use super::tables::Tables;
use crate::notes::NoteKind;
use crate::participant::Export;

/// Writes the table.
pub(super) fn write(source: &mut Source<'_>, tables: &mut Tables) {
    let participants = &source.configuration.participants;
    let exports: Vec<&Export> =
        participants.iter().flat_map(|participant| &participant.exports).collect();
    let every = exports.iter().map(|export| export.every_windows).filter(|every| *every > 0).min();
    if let Some(every) = every {
        tables.open("output");
        tables.key("every", every.to_string());
    }
    for export in exports {
        let element = format!("export:{}", export.format);
        let reason = "the fields of all participants are in the folder of the run, as VTK files";
        source.notes.add(NoteKind::Changed, export.line, &element, reason);
        if export.every_iteration {
            let reason = "accepted windows are written, iterations are not";
            let element = format!("{element}, every-iteration");
            let instead = Some("run --record keeps them");
            source.notes.advise(NoteKind::Missing, export.line, element, reason, instead);
        }
        if every.is_some_and(|every| export.every_windows != every) {
            let reason = "all fields are written at the same windows";
            let element = format!("{element}, every-n-time-windows");
            source.notes.add(NoteKind::Changed, export.line, element, reason);
        }
    }
}
