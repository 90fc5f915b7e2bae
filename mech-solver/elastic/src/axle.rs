//! The axle of the upper body: a mass on a primary suspension, that runs over an irregularity of a surface.

use std::f64::consts::PI;

/// A mass on a primary suspension that carries the load, and the irregularity that it runs over.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Axle {
    /// Unsprung mass [kg].
    pub mass: f64,
    /// Stiffness of the suspension to a car body whose height does not change [N/m].
    pub stiffness: f64,
    /// Its damping [N·s/m].
    pub damping: f64,
    /// Rotary inertia of a body that a constant torque drives [kg·m²]; absent: its surface speed is held.
    pub rotary_inertia: Option<f64>,
    /// Irregularity of a surface, if there is one.
    pub irregularity: Option<Irregularity>,
}

/// Forms of an irregularity.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Form {
    /// A hollow of the lower body, a period of a cosine: a dipped weld, a squat.
    Dip,
    /// Two straight ramps of the lower body that meet in a kink: a dipped joint.
    Joint,
    /// Waves of the lower body, without end.
    Corrugation,
    /// A hollow of the upper body, a period of a cosine, once a turn: a worn wheel flat.
    Flat,
}

impl Form {
    /// All, by name.
    pub const NAMES: [(&'static str, Self); 4] = [
        ("dip", Self::Dip),
        ("joint", Self::Joint),
        ("corrugation", Self::Corrugation),
        ("flat", Self::Flat),
    ];
}

/// An irregularity of a surface along the way of rolling.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Irregularity {
    /// Its form.
    pub form: Form,
    /// Depth, of waves from crest to trough [m].
    pub depth: f64,
    /// Length, of waves the wavelength [m].
    pub length: f64,
    /// Way along the surface from where the contact is at the beginning to the middle of it; of waves, to the
    /// first crest [m].
    pub at: f64,
}

impl Irregularity {
    /// The body that has it: 0 the upper, 1 the lower one.
    #[must_use]
    pub fn body(&self) -> usize {
        usize::from(self.form != Form::Flat)
    }

    /// Way along the surface from where the contact is at the beginning to where it begins [m].
    #[must_use]
    pub fn begins(&self) -> f64 {
        match self.form {
            Form::Corrugation => self.at,
            Form::Dip | Form::Joint | Form::Flat => self.at - 0.5 * self.length,
        }
    }

    /// Depth of the surface below the smooth one [m] at a way along it [m]; of a body with so long a circumference [m], if
    /// it has one, again after every turn.
    #[must_use]
    pub fn hollow(&self, way: f64, circumference: f64) -> f64 {
        let Self { form, depth, length, .. } = *self;
        let from = self.way_from_middle(way, circumference);
        let within = 2.0 * from.abs() < length;
        match form {
            Form::Corrugation if from > 0.0 => {
                0.5 * depth * (1.0 - (2.0 * PI * from / length).cos())
            }
            Form::Joint if within => depth * (1.0 - 2.0 * from.abs() / length),
            Form::Dip | Form::Flat if within => {
                0.5 * depth * (1.0 + (2.0 * PI * from / length).cos())
            }
            _ => 0.0,
        }
    }

    /// Derivative of [`Self::hollow`] by the way [-].
    #[must_use]
    pub fn slope(&self, way: f64, circumference: f64) -> f64 {
        let Self { form, depth, length, .. } = *self;
        let from = self.way_from_middle(way, circumference);
        let within = 2.0 * from.abs() < length;
        let wave = PI * depth / length * (2.0 * PI * from / length).sin();
        match form {
            Form::Corrugation if from > 0.0 => wave,
            Form::Joint if within => -2.0 * depth / length * from.signum(),
            Form::Dip | Form::Flat if within => -wave,
            _ => 0.0,
        }
    }

    /// Way from the middle, or from the first crest [m].
    fn way_from_middle(&self, way: f64, circumference: f64) -> f64 {
        let from = way - self.at;
        match self.form {
            Form::Flat if circumference.is_finite() => {
                (from + 0.5 * circumference).rem_euclid(circumference) - 0.5 * circumference
            }
            _ => from,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn hollows() {
        let of = |form| Irregularity { form, depth: 2.0, length: 8.0, at: 10.0 };
        let turn = f64::INFINITY;
        for (form, at, hollow) in [
            (Form::Dip, 10.0, 2.0),
            (Form::Dip, 12.0, 1.0),
            (Form::Dip, 14.5, 0.0),
            (Form::Joint, 9.0, 1.5),
            (Form::Joint, 5.0, 0.0),
            (Form::Corrugation, 9.0, 0.0),
            (Form::Corrugation, 14.0, 2.0),
            (Form::Corrugation, 26.0, 0.0),
        ] {
            assert!((of(form).hollow(at, turn) - hollow).abs() < 1e-15, "{form:?} {at}");
        }
        assert_eq!(of(Form::Flat).hollow(10.0 + 3.0 * 50.0, 50.0), 2.0);
        assert_eq!((of(Form::Flat).body(), of(Form::Dip).body()), (0, 1));
        for form in Form::NAMES.map(|(_, form)| form) {
            for way in [5.0, 8.0, 11.5, 13.0, 17.0] {
                let [before, behind] = [-1e-6, 1e-6].map(|step| of(form).hollow(way + step, 50.0));
                let slope = of(form).slope(way, 50.0);
                assert!((slope - (behind - before) / 2e-6).abs() < 1e-8, "{form:?} {way}");
            }
        }
    }
}
