//! Wires of a program, given on the command line: which of its data are which fields.
//!
//! ```text
//! Temperature -> lower_temperature              data that the program writes give a field
//! Heat-Flux <- friction_power                   a field gives data that the program reads
//! Heat-Flux <- 0.5 * friction_power             a part of it
//! Temperature - 293.15 -> lower_temperature     a rise above 293.15
//! Force -> wall_force [N]                       unit of a field that no table has
//! "Wall Heat" -> wall_heat                      name with blanks or arrows, in double quotes
//! ```
//!
//! Data without a wire are fields of the same name, with the unit 1.

use proto::grid::check_name;
use proto::text::{masked, unquoted};

/// A linear relation: the target is `factor` times the source, plus `offset`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Linear {
    /// Factor.
    pub factor: f64,
    /// Offset, in the unit of the target.
    pub offset: f64,
}

impl Linear {
    /// The target equals the source.
    pub const SAME: Self = Self { factor: 1.0, offset: 0.0 };

    /// Applies the relation to all values.
    pub fn apply(self, values: &mut [f64]) {
        if self != Self::SAME {
            values.iter_mut().for_each(|value| *value = self.factor * *value + self.offset);
        }
    }
}

/// Direction of a wire.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Direction {
    /// The program reads a field.
    Read,
    /// The program writes a field.
    Written,
}

/// A wire between data of the program and a field.
#[derive(Clone, Debug, PartialEq)]
pub struct Wire {
    /// Name of the data.
    pub data: String,
    /// Direction.
    pub direction: Direction,
    /// Name of the field.
    pub field: String,
    /// Relation from source to target.
    pub scale: Linear,
    /// Unit of the field, if given.
    pub unit: Option<String>,
}

/// Reason why a wire cannot be used.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum WireError {
    /// The wire has no single arrow.
    #[error("has no arrow; write \"DATA -> FIELD\" or \"DATA <- FIELD\"")]
    Arrow,
    /// A side of the arrow is malformed.
    #[error(
        "has `{0}`, which is not of the form [NUMBER *] NAME [+ NUMBER | - NUMBER]; a name with \
         blanks stands in double quotes"
    )]
    Side(String),
    /// The field's name is malformed.
    #[error("names a field: {0}")]
    Field(String),
    /// A field that the program reads has a unit.
    #[error("gives the unit of a field that the program reads; its producer defines it")]
    Unit,
}

impl Wire {
    /// Parses a wire.
    ///
    /// # Errors
    /// Fails if the wire is malformed.
    pub fn parse(wire: &str) -> Result<Self, WireError> {
        let mask = masked(wire);
        let arrows = ["->", "<-"].map(|arrow| mask.find(arrow));
        let single =
            |at: usize| match mask[at + 2..].contains("->") || mask[at + 2..].contains("<-") {
                true => Err(WireError::Arrow),
                false => Ok((&wire[..at], &wire[at + 2..])),
            };
        let (direction, (data, field)) = match arrows {
            [Some(at), None] => (Direction::Written, single(at)?),
            [None, Some(at)] => (Direction::Read, single(at)?),
            _ => return Err(WireError::Arrow),
        };
        let (field, unit) =
            match field.trim().strip_suffix(']').and_then(|text| text.rsplit_once('[')) {
                Some((field, unit)) => (field, Some(unit.trim().to_owned())),
                None => (field, None),
            };
        let (scaled, plain) = match direction {
            Direction::Written => (data, field),
            Direction::Read => (field, data),
        };
        let (source, scale) = linear(scaled)?;
        let (target, Linear::SAME) = linear(plain)? else {
            return Err(WireError::Side(plain.trim().to_owned()));
        };
        let (data, field) = match direction {
            Direction::Written => (source, target),
            Direction::Read => (target, source),
        };
        check_name("field", field).map_err(WireError::Field)?;
        match (direction, &unit) {
            (Direction::Read, Some(_)) => Err(WireError::Unit),
            _ => {
                let data = unquoted(data).into_owned();
                Ok(Self { data, direction, field: field.to_owned(), scale, unit })
            }
        }
    }
}

/// Parses a name with a factor before it and an offset behind it. Names may contain a hyphen, so
/// operators stand between blanks.
fn linear(text: &str) -> Result<(&str, Linear), WireError> {
    let malformed = || WireError::Side(text.trim().to_owned());
    let number = |word: &str| {
        word.parse::<f64>().ok().filter(|value| value.is_finite()).ok_or_else(malformed)
    };
    let mask = masked(text);
    let mut rest = 0;
    let words: Vec<&str> = mask
        .split_whitespace()
        .map(|word| {
            let start = rest + mask[rest..].find(word).unwrap_or_default();
            rest = start + word.len();
            &text[start..rest]
        })
        .collect();
    let (factor, words) = match words[..] {
        [factor, "*", ref rest @ ..] => (number(factor)?, rest),
        ref words => (1.0, words),
    };
    match *words {
        [name] => Ok((name, Linear { factor, offset: 0.0 })),
        [name, "+", offset] => Ok((name, Linear { factor, offset: number(offset)? })),
        [name, "-", offset] => Ok((name, Linear { factor, offset: -number(offset)? })),
        _ => Err(malformed()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn wires_have_direction_scale_and_unit() {
        let parsed = |wire: &str| {
            let Wire { data, direction, field, scale, unit } = Wire::parse(wire).unwrap();
            (data, direction, field, [scale.factor, scale.offset], unit)
        };
        let expected = |data: &str, direction, field: &str, scale, unit: Option<&str>| {
            (data.to_owned(), direction, field.to_owned(), scale, unit.map(str::to_owned))
        };
        assert_eq!(
            parsed("Heat-Flux <- -0.5 * friction_power"),
            expected("Heat-Flux", Direction::Read, "friction_power", [-0.5, 0.0], None)
        );
        assert_eq!(
            parsed("T - 293.15 -> lower_temperature"),
            expected("T", Direction::Written, "lower_temperature", [1.0, -293.15], None)
        );
        assert_eq!(
            parsed("2 * \"Wall -> \"\"Heat\"\"\" - 1 -> wall_heat"),
            expected("Wall -> \"Heat\"", Direction::Written, "wall_heat", [2.0, -1.0], None)
        );
        assert_eq!(
            parsed("\"Wall Heat\" <- 2 * heat"),
            expected("Wall Heat", Direction::Read, "heat", [2.0, 0.0], None)
        );
        assert_eq!(
            parsed("1e3 * Force + 1 -> wall_force [N]"),
            expected("Force", Direction::Written, "wall_force", [1e3, 1.0], Some("N"))
        );
    }

    #[test]
    fn malformed_wires_are_refused() {
        let fault = |wire: &str| Wire::parse(wire).unwrap_err();
        assert_eq!(fault("T = t"), WireError::Arrow);
        assert_eq!(fault("T -> t <- u"), WireError::Arrow);
        assert_eq!(fault("T -> t -> u"), WireError::Arrow);
        assert_eq!(fault("Wall Heat -> t"), WireError::Side("Wall Heat".to_owned()));
        assert_eq!(fault("T -> 2 * t"), WireError::Side("2 * t".to_owned()));
        assert_eq!(fault("inf * T -> t"), WireError::Side("inf * T".to_owned()));
        assert_eq!(fault("T <- t [K]"), WireError::Unit);
        assert!(matches!(fault("T -> a/b"), WireError::Field(_)));
        assert!(matches!(fault(" -> t"), WireError::Side(_)));
    }

    #[test]
    fn values_are_scaled() {
        let mut values = [1.0, 2.0];
        Linear { factor: 2.0, offset: -1.0 }.apply(&mut values);
        assert_eq!(values, [1.0, 3.0]);
    }
}
