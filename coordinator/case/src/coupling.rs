//! The settings under `[coupling]`: words, numbers, and tolerances for one field or for all.

use super::settings::Settings;
use contract::message::Interpolation;
use coupling::settings::{Acceleration, Implicit, Preconditioner, Predictor, Tolerances};
use serde_json::Value as Json;

impl Settings<'_> {
    pub(super) fn interpolation(&self) -> Interpolation {
        match self.text("coupling.interpolation").as_deref() {
            Some("linear") => Interpolation::Linear,
            _ => Interpolation::Constant,
        }
    }

    pub(super) fn implicit(&self) -> Implicit {
        let key = |name: &str| format!("coupling.{name}");
        let value = |name: &str| self.0.get(&key(name)).expect("own keys with defaults are there");
        let number = |name: &str| value(name).as_f64().expect("a checked number");
        let count = |name: &str| value(name).as_u64().expect("a checked count");
        let word = |name: &str| value(name).as_str().expect("a checked word");
        let least = |name: &str| u32::try_from(count(name)).unwrap_or(u32::MAX);
        let acceleration = Acceleration::from_word(word("acceleration"));
        let fields = self.0.get("coupling.fields").and_then(Json::as_object);
        let own = |name: &String| {
            (self.field_name(name), self.tolerances(&key(&format!("fields.{name}"))))
        };
        Implicit {
            acceleration: acceleration
                .filter(|a| *a != Acceleration::Auto)
                .unwrap_or(Acceleration::IqnIls),
            relaxation: number("relaxation"),
            min_iterations: least("min_iterations"),
            max_iterations: least("max_iterations"),
            tolerances: self.tolerances("coupling"),
            fields: fields.into_iter().flat_map(|fields| fields.keys().map(own)).collect(),
            reuse_windows: count("reuse_windows"),
            max_columns: usize::try_from(count("max_columns")).unwrap_or(usize::MAX),
            filter: number("filter"),
            preconditioner: Preconditioner::from_word(word("preconditioner"))
                .unwrap_or(Preconditioner::ResidualSum),
            predictor: Predictor::from_word(word("predictor")).unwrap_or(Predictor::Last),
            strict: value("strict").as_bool().unwrap_or(true),
            threads: 1,
        }
    }

    fn tolerances(&self, section: &str) -> Tolerances {
        let measure = |name| self.0.get(&format!("{section}.{name}")).and_then(Json::as_f64);
        let given = Tolerances {
            absolute: measure("absolute"),
            relative: measure("relative"),
            residual_relative: measure("residual_relative"),
        };
        if given == Tolerances::default() {
            return Implicit::default().tolerances;
        }
        given
    }
}
