//! The table of fields that may cross the interface.
//!
//! Each field is defined once, with its unit, number of components and mapping between grids. The
//! table holds the fields that more than one crate uses; a participant may define further fields in
//! its description.

use serde::{Deserialize, Serialize};

/// Quantity that a mapping between grids preserves.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Mapping {
    /// The mapping preserves the surface integral (densities such as a heat flux).
    Conservative,
    /// The mapping preserves constants (point values such as a temperature).
    Consistent,
}

/// Body of a field; the case names the bodies ([`crate::bodies`]).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Body {
    /// Body 1.
    Upper,
    /// Body 2.
    Lower,
    /// Contact interface between the bodies.
    Interface,
}

/// A kind of field: all its properties that do not depend on a run.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct FieldKind {
    /// Name in messages, results and case files; at most 31 bytes of ASCII.
    pub name: String,
    /// SI unit; at most 15 bytes of ASCII.
    pub unit: String,
    /// Number of components; component-major layout, `data[component * points + point]`.
    pub components: u32,
    /// Quantity that a mapping between grids preserves.
    pub mapping: Mapping,
    /// Body of the field.
    pub body: Body,
    /// Meaning of the field, in one line.
    pub meaning: String,
}

impl FieldKind {
    /// Returns whether the field is a power, whose sum over the surface is balanced: conservative,
    /// and no vector such as a force.
    #[must_use]
    pub fn is_power(&self) -> bool {
        self.mapping == Mapping::Conservative && self.components == 1
    }
}

/// A row of the table. Rust code names a field by one of the constants below.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct FieldSpec {
    /// Name in messages, results and case files.
    pub name: &'static str,
    /// SI unit.
    pub unit: &'static str,
    /// Number of components.
    pub components: u32,
    /// Quantity that a mapping between grids preserves.
    pub mapping: Mapping,
    /// Body of the field.
    pub body: Body,
    /// Meaning of the field, in one line.
    pub meaning: &'static str,
}

impl FieldSpec {
    /// Returns the owned form, as used in descriptions.
    #[must_use]
    pub fn kind(&self) -> FieldKind {
        FieldKind {
            name: self.name.to_owned(),
            unit: self.unit.to_owned(),
            components: self.components,
            mapping: self.mapping,
            body: self.body,
            meaning: self.meaning.to_owned(),
        }
    }
}

macro_rules! field_table {
    ($($(#[$doc:meta])* $constant:ident = $name:literal [$unit:literal; $components:literal],
       $mapping:ident, $body:ident, $meaning:literal;)*) => {
        $(
            $(#[$doc])*
            #[doc = concat!($meaning, " [", $unit, "], ", $components, " component(s).")]
            pub const $constant: FieldSpec = FieldSpec {
                name: $name, unit: $unit, components: $components,
                mapping: Mapping::$mapping, body: Body::$body, meaning: $meaning,
            };
        )*
        /// All rows of the table.
        pub const TABLE: &[FieldSpec] = &[$($constant),*];
    };
}

field_table! {
    GEOMETRY = "geometry" ["m"; 3], Consistent, Interface,
        "geometry of a grid that moves, on a topic of its own (grid/geometry.rs)";
    PRESSURE = "pressure" ["Pa"; 1], Consistent, Interface,
        "normal contact pressure, positive in compression";
    GAP = "normal_gap" ["m"; 1], Consistent, Interface,
        "distance of the deformed surfaces, 0 where they touch";
    TRACTION = "traction" ["Pa"; 2], Consistent, Interface,
        "tangential traction (x, y) acting on the upper body";
    SLIP_VELOCITY = "slip_velocity" ["m/s"; 2], Consistent, Interface,
        "velocity (x, y) of the upper surface relative to the lower one";
    FRICTION_POWER = "friction_power" ["W/m2"; 1], Conservative, Interface,
        "frictional power density, element and window mean";
    SURFACE_SPEED = "surface_speed" ["m/s"; 2], Consistent, Interface,
        "speeds (upper, lower) at which material passes through the contact, on a one-point grid";
    CONTACT_FORCE = "contact_force" ["N"; 3], Consistent, Interface,
        "force (x, y, z) of the contact on the upper body, on a one-point grid";
    LOWER_TEMPERATURE = "lower_temperature" ["K"; 1], Consistent, Lower,
        "temperature rise of the lower body's surface";
    UPPER_TEMPERATURE = "upper_temperature" ["K"; 1], Consistent, Upper,
        "temperature rise of the upper body's surface";
    LOWER_RISE_INTEGRAL = "lower_rise_integral" ["K m"; 1], Consistent, Lower,
        "temperature rise of the lower body integrated over the depth z, each wave number k weighted by exp(-k z)";
    UPPER_RISE_INTEGRAL = "upper_rise_integral" ["K m"; 1], Consistent, Upper,
        "temperature rise of the upper body integrated over the depth z, each wave number k weighted by exp(-k z)";
    LOWER_WEAR_DEPTH = "lower_wear_depth" ["m"; 1], Consistent, Lower,
        "depth that has been worn off the lower body";
    UPPER_WEAR_DEPTH = "upper_wear_depth" ["m"; 1], Consistent, Upper,
        "depth that has been worn off the upper body";
    LOWER_SECTION_TEMPERATURE = "lower_section_temperature" ["K"; 1], Consistent, Lower,
        "temperature rise of the lower body in a vertical plane along x under the surface";
    UPPER_SECTION_TEMPERATURE = "upper_section_temperature" ["K"; 1], Consistent, Upper,
        "temperature rise of the upper body in a vertical plane along x over the surface";
    LOWER_SECTION_VON_MISES = "lower_section_von_mises_stress" ["Pa"; 1], Consistent, Lower,
        "von Mises stress of the lower body in a vertical plane along x under the surface";
    UPPER_SECTION_VON_MISES = "upper_section_von_mises_stress" ["Pa"; 1], Consistent, Upper,
        "von Mises stress of the upper body in a vertical plane along x over the surface";
    LOWER_SECTION_MAX_SHEAR = "lower_section_max_shear_stress" ["Pa"; 1], Consistent, Lower,
        "largest shear stress of the lower body in a vertical plane along x under the surface";
    UPPER_SECTION_MAX_SHEAR = "upper_section_max_shear_stress" ["Pa"; 1], Consistent, Upper,
        "largest shear stress of the upper body in a vertical plane along x over the surface";
    POINT_VON_MISES = "point_von_mises_stress" ["Pa"; 1], Consistent, Interface,
        "von Mises stress at points that the case names";
    POINT_MAX_SHEAR = "point_max_shear_stress" ["Pa"; 1], Consistent, Interface,
        "largest shear stress (Tresca) at points that the case names";
    POINT_HYDROSTATIC = "point_hydrostatic_stress" ["Pa"; 1], Consistent, Interface,
        "mean normal stress at points that the case names, tension positive";
    POINT_STRESS = "point_stress" ["Pa"; 6], Consistent, Interface,
        "stress tensor (xx, yy, zz, xy, yz, xz) at points that the case names, tension positive";
    POINT_PRINCIPAL_1 = "point_principal_stress_1" ["Pa"; 1], Consistent, Interface,
        "largest principal stress at points that the case names";
    POINT_PRINCIPAL_2 = "point_principal_stress_2" ["Pa"; 1], Consistent, Interface,
        "middle principal stress at points that the case names";
    POINT_PRINCIPAL_3 = "point_principal_stress_3" ["Pa"; 1], Consistent, Interface,
        "smallest principal stress at points that the case names";
    POINT_DIRECTION_1 = "point_principal_direction_1" ["1"; 3], Consistent, Interface,
        "unit vector along the largest principal stress";
    POINT_DIRECTION_2 = "point_principal_direction_2" ["1"; 3], Consistent, Interface,
        "unit vector along the middle principal stress";
    POINT_DIRECTION_3 = "point_principal_direction_3" ["1"; 3], Consistent, Interface,
        "unit vector along the smallest principal stress";
}

/// An edge drawn in maps of a surface: the line where a field begins to differ from zero.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Edge {
    /// Field whose support has the edge.
    pub field: &'static FieldSpec,
    /// Field that limits the edge to the region where this field differs from zero.
    pub within: Option<&'static FieldSpec>,
    /// Power of the distance from the edge with which the field grows, if it is the same in every
    /// contact. Hertz's pressure grows with its square root.
    pub growth: Option<f64>,
    /// Meaning of the line.
    pub words: &'static str,
}

/// Edges of a contact, for pictures.
pub const EDGES: &[Edge] = &[
    Edge { field: &PRESSURE, within: None, growth: Some(0.5), words: "edge of contact" },
    Edge {
        field: &SLIP_VELOCITY,
        within: Some(&PRESSURE),
        growth: None,
        words: "between stick and slip",
    },
];

/// A map of the magnitude of one field divided by another on the same grid, where the divisor is
/// nonzero.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Quotient {
    /// Dividend.
    pub of: &'static FieldSpec,
    /// Divisor, a scalar field.
    pub over: &'static FieldSpec,
    /// Name of the quotient.
    pub name: &'static str,
    /// SI unit of the quotient.
    pub unit: &'static str,
    /// Meaning of the quotient, in one line.
    pub meaning: &'static str,
}

/// Quotients that pictures of a contact show.
pub const QUOTIENTS: &[Quotient] = &[Quotient {
    of: &TRACTION,
    over: &PRESSURE,
    name: "traction_over_pressure",
    unit: "1",
    meaning: "traction over pressure: the coefficient of friction where surfaces slip, less where they stick",
}];

/// Returns the row with this name, if the table has one.
#[must_use]
pub fn find(name: &str) -> Option<&'static FieldSpec> {
    TABLE.iter().find(|spec| spec.name == name)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_unique_and_fit_the_header() {
        for (i, spec) in TABLE.iter().enumerate() {
            assert!(spec.name.len() < 32 && spec.name.is_ascii(), "{}", spec.name);
            assert!(spec.unit.len() < 16 && spec.unit.is_ascii(), "{}", spec.unit);
            assert!(spec.components > 0);
            assert!(TABLE[..i].iter().all(|other| other.name != spec.name), "{}", spec.name);
            assert_eq!(find(spec.name), Some(spec));
        }
    }
}
