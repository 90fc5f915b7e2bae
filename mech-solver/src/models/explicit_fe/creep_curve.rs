//! The creep curve of half-spaces: where the search for the creepage of a prescribed force begins, and along
//! which it goes on. It is some per cent off that of the elements, by nearly one factor where the elements of both are alike, and a
//! point of it takes some milliseconds.

use crate::models::half_space;
use crate::terms::Terms;
use proto::configuration::{Configuration, Mode, Refusal};
use proto::field::FieldSpec;
use proto::model::{InputField, Inputs, Outputs, Step};
use proto::progress::Progress;
use serde_json::json;

/// Forces beyond this share of f N are taken for it.
const MOST: f64 = 0.9995;

/// Half-spaces of a case.
pub(super) struct CreepCurve {
    configuration: Configuration,
    friction: f64,
    speed: f64,
    flexibility: f64,
}

impl CreepCurve {
    /// Of a case with so many elements to a semi-axis, this friction coefficient, rolling speed [m/s] and tangential
    /// flexibility between the bodies [m/Pa].
    pub(super) fn new(
        configuration: &Configuration,
        resolution: usize,
        friction: f64,
        speed: f64,
        flexibility: f64,
    ) -> Self {
        let mut case = configuration.case.clone();
        case.0["mech"] = json!({"model": half_space::MODEL.name, "resolution": resolution});
        let configuration = Configuration {
            model: half_space::MODEL.name.to_owned(),
            mode: Mode::Steady,
            case,
            inputs: Vec::new(),
            outputs: Vec::new(),
            observed: Vec::new(),
            ..configuration.clone()
        };
        Self { configuration, friction, speed, flexibility }
    }

    /// The creepage of a longitudinal force over f N.
    ///
    /// # Errors
    /// The half-spaces have no answer.
    pub(super) fn creepage(&self, ratio: f64) -> Result<f64, Refusal> {
        let mut configuration = self.configuration.clone();
        let coefficient = ratio.clamp(-MOST, MOST) * self.friction;
        configuration.case.0["motion"] =
            json!({"speed": self.speed, "traction_coefficient": coefficient});
        let terms = Terms { adhesion: true, layers: vec![self.flexibility], ..Terms::default() };
        let setup = (half_space::MODEL.configure)(&configuration, terms)?;
        let mut model = setup.build(&Progress::default())?;
        let none = |error: &dyn std::fmt::Display| {
            let reason = format!("half-spaces have no creepage for it: {error}");
            Refusal::new("motion.traction_coefficient", reason, "write motion.creepage")
        };
        model.solve(&Step::STEADY, &Nothing, &mut Nothing).map_err(|error| none(&error))?;
        model.accept();
        model.summary()["contact"]["creepage_xi"].as_f64().ok_or_else(|| none(&"no figure"))
    }
}

/// Neither inputs nor outputs.
struct Nothing;

impl Inputs for Nothing {
    fn get(&self, _: &FieldSpec) -> Option<InputField<'_>> {
        None
    }
}

impl Outputs for Nothing {
    fn get(&mut self, _: &FieldSpec) -> Option<&mut [f64]> {
        None
    }
}
