//! Effect `temperature_friction`: the friction coefficient depends on the contact temperature.
//!
//! The coefficient is f(T) = f_∞ + (f_0 − f_∞) e^{−T/T_c} with the friction coefficient f_0 of the
//! case, or comes from a table of temperature rises and coefficients, linear between its rows. The
//! law enters as the factor f(T)/f_0. Factors of other effects therefore multiply f(T), and
//! traction bounds apply unchanged.
//!
//! T is the mean of the temperature rises of both surfaces over their initial temperature, at the
//! centre of an element. A negative rise counts as zero: friction only heats, so that a negative
//! value comes from rounding or from an iterate, and the exponential of a large one overflows.
//!
//! The effect closes a coupling loop: friction heats, and heat changes friction.
//!
//! An iterate of the coupling may be hotter than the converged solution, and friction may then
//! carry less than the prescribed force. Such an iterate returns the force carried in full sliding,
//! which continues the solutions below the limit; the contact can cool and reach the prescribed
//! force again. This state is not a solution: it is refused as an accepted state, with both forces
//! in the message.
//!
//! Source: Ertz & Bucher, Vehicle System Dynamics 37 supplement (2002) 675–684, for friction that
//! falls with temperature; Polach, Wear 258 (2005) 992–1000, for the exponential form, there over
//! the slip velocity.

use crate::advice::situation::{POWER, Situation};
use crate::case::keys::CheckedParams;
use crate::case::piecewise_linear::PiecewiseLinear;
use crate::registry::entry::Effect;
use crate::terms::friction::{FrictionFactor, FrictionLaw, FrictionState};
use crate::terms::surface::Surface;
use crate::terms::{Kind, Terms};
use proto::advice::Advice;
use proto::configuration::{Configuration, Refusal};
use proto::description::KeySpec;
use proto::field::{self, FieldSpec};
use proto::model::StepError;
use proto::params::Params;
use proto::table::{Column, headings};
use std::path::Path;

/// Registry entry of the effect.
pub const EFFECT: Effect = Effect {
    name: "temperature_friction",
    law: "f(T) = f_inf + (f_0 - f_inf) exp(-T/T_c), or a table; T the mean rise of both surfaces",
    source: "Ertz & Bucher, Vehicle System Dynamics 37 suppl. (2002) 675-684; Polach, Wear 258 \
             (2005) 992-1000",
    kinds: &[Kind::FrictionFactor],
    consumes: &[&SURFACES[0], &SURFACES[1]],
    provides: &[],
    keys,
    figures: Vec::new,
    advise: Some(advise),
    terms,
};

const LIMIT: &str = "effects.temperature_friction.limit";
const DECAY: &str = "effects.temperature_friction.decay_temperature";
const TABLE: &str = "effects.temperature_friction.table";
const BEYOND: &str = "effects.temperature_friction.beyond";

/// Surface temperatures on which friction depends.
const SURFACES: [FieldSpec; 2] = [field::UPPER_TEMPERATURE, field::LOWER_TEMPERATURE];
/// Columns of the table.
fn columns() -> [Column; 2] {
    [
        Column::new(&["temperature_rise", "rise"], "K")
            .of_differences()
            .expected(0.0..=3000.0, "steel melts below"),
        Column::new(&["friction_coefficient", "f"], "1").expected(
            0.0..=2.0,
            "no dry friction of metals is larger; check the order of the columns",
        ),
    ]
}

fn keys() -> Vec<KeySpec> {
    const LAW: &str = "effects.temperature_friction.law";
    vec![
        KeySpec::number(LIMIT, "friction coefficient at high temperature")
            .at_least(0.0)
            .one_of(LAW),
        KeySpec::quantity(DECAY, "K", "temperature rise at which 1/e of the fall remains")
            .of_differences()
            .default_value(200.0)
            .above(0.0),
        KeySpec::table(TABLE, &columns(), "friction over the temperature rise, in ascending order")
            .one_of(LAW),
        KeySpec::choice(BEYOND, &["refuse", "hold"], "behaviour beyond the table")
            .default_value("refuse"),
    ]
}

/// Friction coefficient as a function of the temperature rise.
#[derive(Debug, PartialEq)]
enum TemperatureLaw {
    /// f_∞ + (f_0 − f_∞) e^{−T/T_c}.
    Decay {
        /// f_∞ [-].
        hot: f64,
        /// T_c [K].
        scale: f64,
    },
    /// Coefficients over temperature rises [K].
    Table(PiecewiseLinear<1>),
}

fn terms(configuration: &Configuration) -> Result<Terms, Refusal> {
    let law = read(&configuration.case)?;
    Ok(Terms { friction: FrictionLaw::of_factor(law), ..Terms::default() })
}

fn read(params: &Params) -> Result<TemperatureLaw, Refusal> {
    let case = CheckedParams::new(params, keys());
    if case.has(TABLE) {
        let path = case.text(TABLE)?;
        let clamps = case.text(BEYOND)? == "hold";
        let curve =
            PiecewiseLinear::read(
                Path::new(path),
                &columns(),
                clamps,
                |[friction]| match *friction > 0.0 {
                    true => Ok(()),
                    false => Err("has no friction coefficient above 0".to_owned()),
                },
            );
        return curve.map(TemperatureLaw::Table).map_err(|reason| {
            let fix = format!("give a table of {}", headings(&columns()));
            Refusal::new(TABLE, format!("`{path}` {reason}"), fix)
        });
    }
    Ok(TemperatureLaw::Decay { hot: case.number(LIMIT)?, scale: case.number(DECAY)? })
}

impl TemperatureLaw {
    /// Returns f(T) for a friction coefficient f_0; `None` beyond the table.
    fn coefficient(&self, cold: f64, temperature: f64) -> Option<f64> {
        match self {
            Self::Decay { hot, scale } => Some(hot + (cold - hot) * (-temperature / scale).exp()),
            Self::Table(curve) => curve.at(temperature).map(|[friction]| friction),
        }
    }
}

impl FrictionFactor for TemperatureLaw {
    /// Writes the factors. The grid of the temperatures may differ in every solve; it is structured
    /// along x and y.
    fn write(
        &self,
        state: &FrictionState<'_>,
        coefficient: f64,
        factors: &mut [f64],
    ) -> Result<(), StepError> {
        let FrictionState { inputs: Some(inputs), rows, .. } = *state else { return Ok(()) };
        let surfaces = [Surface::of(inputs, &SURFACES[0])?, Surface::of(inputs, &SURFACES[1])?];
        for (index, factor) in factors.iter_mut().enumerate() {
            let [x, y] = rows.centre(index);
            let [upper, lower] = surfaces.each_ref().map(|surface| surface.at(x, y));
            let temperature = (0.5 * upper + 0.5 * lower).max(0.0);
            let friction = self.coefficient(coefficient, temperature).ok_or_else(|| {
                StepError::NoSolution(format!(
                    "the contact temperature rise of {temperature:.1} K is beyond the table of \
                     {TABLE}; extend it, or write {BEYOND} = \"hold\""
                ))
            })?;
            *factor = friction / coefficient;
        }
        Ok(())
    }

    fn follows_inputs(&self) -> bool {
        true
    }

    fn shortfall(&self) -> &'static str {
        "the contact is too hot for the force"
    }
}

/// Friction of hot steel relative to cold steel, used if the case has no law.
const TYPICAL: f64 = 0.4;
/// Temperature of the slip zone, approximately, relative to the highest temperature.
const MEAN: f64 = 0.6;

fn advise(situation: &Situation<'_>) -> Advice {
    let cold = situation.scene.friction_coefficient;
    let typical = TemperatureLaw::Decay { hot: TYPICAL * cold, scale: 200.0 };
    let law = match situation.has(EFFECT.name) {
        true => read(situation.case).unwrap_or(typical),
        false => typical,
    };
    let advice = Advice::new(
        EFFECT.name,
        "friction at 0.6 of the highest rise, to the first order of the loop",
    )
    .with(format!("{LIMIT}={}", TYPICAL * cold));
    let Some(rise) = situation.largest_rise() else { return advice };
    let friction = |share: f64| law.coefficient(cold, share * MEAN * rise);
    let Some(warm) = friction(1.0) else { return advice };
    let power = |friction: f64| situation.otherwise(POWER, friction, situation.sticks);
    // Sensitivity of the power to a rise that is 10 % higher.
    let powers = (power(warm), friction(1.1).and_then(power));
    let gain = match powers {
        (Some(now), Some(hotter)) if now > 0.0 => (hotter / now).ln().abs() / 1.1f64.ln(),
        _ => f64::NAN,
    };
    situation.with_friction(advice.number("gain of the loop", gain), warm)
}

#[cfg(test)]
mod tests {
    use super::*;
    use half_space::aligned::AlignedGrid;
    use proto::grid::Structured;
    use proto::model::Inputs;
    use proto::table::{Reading, Table};

    fn state<'a>(inputs: &'a Surfaces, rows: &'a AlignedGrid) -> FrictionState<'a> {
        FrictionState {
            velocity: None,
            inputs: Some(inputs),
            speed: 0.0,
            rigid_slip: &|_| 0.0,
            rows,
            coordinate: &|_, _, _| None,
            pressure: &[],
        }
    }

    #[test]
    fn decay_from_cold_to_hot() {
        let law = TemperatureLaw::Decay { hot: 0.2, scale: 100.0 };
        assert_eq!(law.coefficient(0.6, 0.0), Some(0.6));
        let value = law.coefficient(0.6, 100.0).unwrap();
        assert!((value - (0.2 + 0.4 / std::f64::consts::E)).abs() < 1e-15);
    }

    fn table(lines: &[u8]) -> TemperatureLaw {
        let table = Table::parse(String::from_utf8_lossy(lines).into_owned(), Reading::NUMBERS);
        TemperatureLaw::Table(
            PiecewiseLinear::from_table(&table.unwrap(), &columns(), false, |_| Ok(())).unwrap(),
        )
    }

    struct Surfaces(proto::grid::Grid, Vec<f64>);

    impl Inputs for Surfaces {
        fn get(&self, _: &FieldSpec) -> Option<proto::model::InputField<'_>> {
            Some(proto::model::InputField { values: &self.1, grid: &self.0 })
        }
    }

    /// Friction uses the grid of the temperatures of this solve. A rotated grid is refused.
    #[test]
    fn friction_follows_a_grid_that_moves() {
        let law = table(b"0 1\n10 2");
        let own = Structured::contact_plane(0.0, 0.0, 0.5, 0.5, 3, 2);
        let mut factors = vec![1.0; 6];
        for shift in [0.0, 0.25] {
            let mut shape = Structured::contact_plane(shift - 1.0, -1.0, 0.5, 0.5, 7, 7);
            let values = (0..49).map(|k| 2.0 + shape.x(k % 7)).collect();
            let mut surfaces = Surfaces(proto::grid::Grid::structured("contact", shape), values);
            law.write(&state(&surfaces, &AlignedGrid::regular(own)), 0.5, &mut factors).unwrap();
            for (k, found) in factors.iter().enumerate() {
                let expected = (1.0 + 0.1 * (2.0 + own.x(k % 3))) / 0.5;
                assert!((found - expected).abs() < 1e-14, "rounding: {found} {expected}");
            }
            shape.step_i = [0.3, 0.4, 0.0];
            surfaces.0 = proto::grid::Grid::structured("contact", shape);
            let refused = law
                .write(&state(&surfaces, &AlignedGrid::regular(own)), 0.5, &mut factors)
                .unwrap_err();
            assert!(refused.to_string().contains("along x and y"), "{refused}");
        }
    }

    /// An accelerated iterate may be far below any temperature, where e^{−T/T_c} overflows.
    #[test]
    fn a_rise_below_zero_is_none() {
        let own = Structured::contact_plane(0.0, 0.0, 0.5, 0.5, 3, 2);
        let grid = proto::grid::Grid::structured("contact", own);
        let surfaces = Surfaces(grid, vec![-1e6; 6]);
        let decay = TemperatureLaw::Decay { hot: 0.0, scale: 10.0 };
        for law in [decay, table(b"0 0.6\n10 0.2")] {
            let mut factors = vec![0.0; 6];
            law.write(&state(&surfaces, &AlignedGrid::regular(own)), 0.6, &mut factors).unwrap();
            assert_eq!(factors, [1.0; 6]);
        }
    }
}
