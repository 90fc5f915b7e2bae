//! Header of a field in a file: the bytes of [`FieldHeader`] on a little-endian machine, on every
//! platform.

use crate::message::{FieldHeader, Label};

/// Length of a header [byte].
pub const LABEL_BYTES: usize = 176;

/// Appends the bytes of a header.
pub fn write_label(into: &mut Vec<u8>, header: &FieldHeader) {
    let FieldHeader { protocol, components, points, grid_revision, window, .. } = *header;
    let FieldHeader { iteration, reserved, start, end, sequence, .. } = *header;
    into.extend_from_slice(&protocol.to_le_bytes());
    into.extend_from_slice(&components.to_le_bytes());
    for value in [points, grid_revision, window] {
        into.extend_from_slice(&value.to_le_bytes());
    }
    into.extend_from_slice(&iteration.to_le_bytes());
    into.extend_from_slice(&reserved.to_le_bytes());
    into.extend_from_slice(&start.to_le_bytes());
    into.extend_from_slice(&end.to_le_bytes());
    into.extend_from_slice(&sequence.to_le_bytes());
    let FieldHeader { name, unit, producer, grid, .. } = header;
    for text in [&name.0[..], &unit.0, &producer.0, &grid.0] {
        into.extend_from_slice(text);
    }
}

/// Splits a header from the front of the bytes; the rest are the values. Returns `None` if there
/// are fewer than [`LABEL_BYTES`].
#[must_use]
pub fn read_label(bytes: &[u8]) -> Option<(FieldHeader, &[u8])> {
    let (label, values) = bytes.split_at_checked(LABEL_BYTES)?;
    let mut rest = label;
    let header = FieldHeader {
        protocol: u32::from_le_bytes(take(&mut rest)?),
        components: u32::from_le_bytes(take(&mut rest)?),
        points: u64::from_le_bytes(take(&mut rest)?),
        grid_revision: u64::from_le_bytes(take(&mut rest)?),
        window: u64::from_le_bytes(take(&mut rest)?),
        iteration: u32::from_le_bytes(take(&mut rest)?),
        reserved: u32::from_le_bytes(take(&mut rest)?),
        start: f64::from_le_bytes(take(&mut rest)?),
        end: f64::from_le_bytes(take(&mut rest)?),
        sequence: u64::from_le_bytes(take(&mut rest)?),
        name: Label(take(&mut rest)?),
        unit: Label(take(&mut rest)?),
        producer: Label(take(&mut rest)?),
        grid: Label(take(&mut rest)?),
    };
    Some((header, values))
}

fn take<const N: usize>(rest: &mut &[u8]) -> Option<[u8; N]> {
    let (first, others) = rest.split_first_chunk()?;
    *rest = others;
    Some(*first)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn header() -> FieldHeader {
        FieldHeader {
            protocol: 7,
            components: 2,
            points: 3,
            grid_revision: 4,
            window: 5,
            iteration: 6,
            reserved: 0,
            start: 0.25,
            end: -0.5,
            sequence: u64::MAX,
            name: Label::new("friction_power"),
            unit: Label::new("W/m2"),
            producer: Label::new("mech"),
            grid: Label::new("contact"),
        }
    }

    #[test]
    fn a_label_comes_back() {
        let mut bytes = Vec::new();
        write_label(&mut bytes, &header());
        assert_eq!(bytes.len(), LABEL_BYTES);
        bytes.push(9);
        assert_eq!(read_label(&bytes), Some((header(), &[9_u8][..])));
        assert_eq!(read_label(&bytes[..LABEL_BYTES - 1]), None);
    }

    /// Checks the offsets stated in [`super::super::FIELD_SCHEMA`], which are those of the layout
    /// in memory.
    #[test]
    fn golden_bytes() {
        let mut bytes = Vec::new();
        write_label(&mut bytes, &header());
        let u32_at = |at: usize| u32::from_le_bytes(bytes[at..at + 4].try_into().unwrap());
        let u64_at = |at: usize| u64::from_le_bytes(bytes[at..at + 8].try_into().unwrap());
        assert_eq!([0, 4, 32, 36].map(u32_at), [7, 2, 6, 0]);
        assert_eq!([8, 16, 24, 56].map(u64_at), [3, 4, 5, u64::MAX]);
        assert_eq!([40, 48].map(|at| f64::from_bits(u64_at(at))), [0.25, -0.5]);
        let text = |at: usize, word: &str| bytes[at..].starts_with(word.as_bytes());
        assert!(text(64, "friction_power\0") && text(96, "W/m2\0"));
        assert!(text(112, "mech\0") && text(144, "contact\0"));
        assert_eq!(LABEL_BYTES, size_of::<FieldHeader>());
    }
}
