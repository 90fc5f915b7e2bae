//! Axle of the upper body: a mass on a primary suspension that runs over an irregularity of a
//! surface.

use std::f64::consts::PI;

/// Mass on a primary suspension that carries the load, and the irregularity under it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Axle {
    /// Unsprung mass [kg].
    pub mass: f64,
    /// Stiffness of the suspension to a car body of constant height [N/m].
    pub stiffness: f64,
    /// Damping of the suspension [N·s/m].
    pub damping: f64,
    /// Rotary inertia of a body driven by a constant torque [kg·m²]; `None` holds the surface speed
    /// constant.
    pub rotary_inertia: Option<f64>,
    /// Irregularity of a surface, if any.
    pub irregularity: Option<Irregularity>,
}

/// Shape of an irregularity.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Form {
    /// Hollow in the lower body, one period of a cosine: a dipped weld, a squat.
    Dip,
    /// Two straight ramps of the lower body that meet in a kink: a dipped joint.
    Joint,
    /// Endless waves of the lower body.
    Corrugation,
    /// Hollow in the upper body, one period of a cosine, once per turn: a worn wheel flat.
    Flat,
}

impl Form {
    /// All forms by name.
    pub const NAMES: [(&'static str, Self); 4] = [
        ("dip", Self::Dip),
        ("joint", Self::Joint),
        ("corrugation", Self::Corrugation),
        ("flat", Self::Flat),
    ];
}

/// Irregularity of a surface along the rolling direction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Irregularity {
    /// Shape of the irregularity.
    pub form: Form,
    /// Depth [m]; for waves, from crest to trough.
    pub depth: f64,
    /// Length [m]; for waves, the wavelength.
    pub length: f64,
    /// Distance along the surface from the initial position of the contact to the middle of the
    /// irregularity [m]; for waves, to the first crest.
    pub at: f64,
}

impl Irregularity {
    /// Index of the body with the irregularity: 0 the upper, 1 the lower.
    #[must_use]
    pub fn body(&self) -> usize {
        usize::from(self.form != Form::Flat)
    }

    /// Distance along the surface from the initial position of the contact to the start of the
    /// irregularity [m].
    #[must_use]
    pub fn begins(&self) -> f64 {
        match self.form {
            Form::Corrugation => self.at,
            Form::Dip | Form::Joint | Form::Flat => self.at - 0.5 * self.length,
        }
    }

    /// Depth of the surface below the smooth surface [m] at a distance along it [m]. On a body with
    /// a finite `circumference` [m] it repeats with every turn.
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

    /// Derivative of [`Self::hollow`] with respect to the distance [-].
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

    /// Distance from the middle of the irregularity, or from the first crest [m].
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
