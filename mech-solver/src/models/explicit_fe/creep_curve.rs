//! Creep curve of half-spaces, which starts and guides the search for the creepage of a prescribed
//! force. It deviates from the creep curve of the finite elements by some per cent, by nearly a
//! constant factor if both have similar elements. One point takes some milliseconds.

use crate::models::half_space;
use crate::terms::Terms;
use proto::configuration::{Configuration, Mode, Refusal};
use proto::field::FieldSpec;
use proto::model::{InputField, Inputs, Outputs, Step};
use proto::progress::Progress;
use serde_json::json;

/// Largest share of f N for which a creepage is computed; larger forces are replaced by it.
const MOST: f64 = 0.9995;

/// Half-space model of a case.
pub(super) struct CreepCurve {
    configuration: Configuration,
    friction: f64,
    speed: f64,
    flexibility: f64,
}

impl CreepCurve {
    /// Creates the curve of a case with `resolution` elements per semi-axis, this friction
    /// coefficient, rolling speed [m/s] and tangential flexibility between the bodies [m/Pa].
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
            windows: None,
            case,
            inputs: Vec::new(),
            outputs: Vec::new(),
            observed: Vec::new(),
            ..configuration.clone()
        };
        Self { configuration, friction, speed, flexibility }
    }

    /// Returns the creepage for a longitudinal force divided by f N.
    ///
    /// # Errors
    /// Half-spaces without a solution.
    pub(super) fn creepage(&self, ratio: f64) -> Result<f64, Refusal> {
        let mut configuration = self.configuration.clone();
        let coefficient = ratio.clamp(-MOST, MOST) * self.friction;
        configuration.case.0["motion"] =
            json!({"speed": self.speed, "traction_coefficient": coefficient});
        let terms = Terms { adhesion: true, layers: vec![self.flexibility], ..Terms::default() };
        let setup = (half_space::MODEL.configure)(&configuration, terms)?;
        let mut model = setup.build(&Progress::default())?;
        let none = |error: &dyn std::fmt::Display| {
            let reason = format!("the half-space model has no creepage for it: {error}");
            Refusal::new("motion.traction_coefficient", reason, "write motion.creepage")
        };
        model.solve(&Step::STEADY, &Nothing, &mut Nothing).map_err(|error| none(&error))?;
        model.accept();
        model.summary()["contact"]["creepage_xi"].as_f64().ok_or_else(|| none(&"no figure"))
    }
}

/// Empty inputs and outputs.
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
