//! Effect `phase_transformation`: steel that becomes austenite under the contact and is quenched
//! behind it to a white etching layer.
//!
//! Steel transforms to austenite if its temperature exceeds A_c1 + s max(log₁₀(Ṫ/Ṫ₀), 0). The
//! heating rate through A_c1 is Ṫ = V ∂T/∂x, and s is the shift for a tenfold rate above the
//! reference rate Ṫ₀. Below A_c1 nothing transforms, however slow the heating. The austenite
//! becomes martensite if it then cools through A_c1 faster than the critical rate.
//!
//! In steady motion the thermal cycle of a material point is the temperature profile along its row.
//! The transformed layer therefore has a cross-section, with a width and a largest depth, but no
//! length: it continues along the rolling direction. The layer is the region that meets both
//! conditions; the cooling rate is evaluated at the surface for the whole depth.
//!
//! In transient cases every material point is followed on its way through the contact. The length
//! of the layer is that of the longest row of points that have become austenite, without those that
//! then cooled too slowly. For a moving body this is the distance its material covers while the
//! contact is hot enough. For a stationary one, such as a locked wheel, it is the length of the
//! patch above the transformation temperature.
//!
//! Points that are still hot at the end of the run are counted, and also given separately
//! (`hot_length_m`); their quenching after the end of the slide is not computed. A stationary body
//! in a steady case is hot permanently, and its whole layer is of that kind.
//!
//! Source: Naeimi et al., par. 5.6 (600 °C); Ahlström & Karlsson, Wear 232 (1999) 1–14 and 15–24,
//! for the transformation under a sliding wheel and its critical rates. Neglected: the time for
//! carbon to diffuse, which the shift represents; the pressure, which lowers A_c1; plastic
//! deformation.

use crate::scene::Scene;
use crate::situation::Situation;
use proto::advice::Advice;
use proto::bodies::ABSOLUTE;
use proto::configuration::{Configuration, Mode, Refusal};
use proto::description::{EffectSpec, KeySpec};
use proto::figure::FigureSpec;
use proto::figure::contact::FRICTION_POWER;
use proto::readable;

/// Name of the effect in the case file.
pub const NAME: &str = "phase_transformation";

const START: &str = "effects.phase_transformation.start_temperature";
const SHIFT: &str = "effects.phase_transformation.rate_shift";
const REFERENCE: &str = "effects.phase_transformation.reference_rate";
const CRITICAL: &str = "effects.phase_transformation.critical_cooling_rate";

/// Eutectoid temperature of iron and carbon [K].
const EUTECTOID: f64 = 1000.15;
/// Critical cooling rate of pearlitic rail steel [K/s].
const PEARLITIC: f64 = 100.0;

/// Criterion of the transformation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Criterion {
    /// Start temperature: A_c1 up to the reference rate [K].
    pub start: f64,
    /// Shift s of A_c1 for a tenfold heating rate [K].
    pub shift: f64,
    /// Heating rate Ṫ₀ up to which the start temperature holds [K/s].
    pub reference_rate: f64,
    /// Smallest cooling rate through the start temperature that forms martensite [K/s].
    pub critical_rate: f64,
}

impl Criterion {
    /// Converts the criterion to rises above an initial temperature [K].
    #[must_use]
    pub fn over(&self, initial: f64) -> Self {
        Self { start: self.start - initial, ..*self }
    }

    /// Temperature [K] at which steel becomes austenite at this heating rate [K/s]; A_c1 up to the
    /// reference rate.
    #[must_use]
    pub fn temperature(&self, rate: f64) -> f64 {
        let decades = (rate / self.reference_rate).log10().max(0.0);
        self.start + if rate > 0.0 { self.shift * decades } else { 0.0 }
    }
}

/// Returns the description of the effect.
#[must_use]
pub fn spec() -> EffectSpec {
    let figure = |name: &str, unit, words, short| {
        FigureSpec::new(&format!("white_layer.*.{name}"), unit, words)
            .on("white layer of *", short)
            .driven_by(FRICTION_POWER)
    };
    EffectSpec {
        name: NAME.to_owned(),
        law: "T > A_c1 + s max(log10(rate/rate0), 0) on heating, then faster than the critical rate on cooling"
            .to_owned(),
        source: "Naeimi et al., par. 5.6; Ahlstroem & Karlsson, Wear 232 (1999) 1-14".to_owned(),
        models: Vec::new(),
        consumes: Vec::new(),
        provides: Vec::new(),
        keys: vec![
            KeySpec::quantity(START, "K", "temperature A_c1 at which austenite forms on slow heating")
                .expected(100.0..=3000.0, ABSOLUTE)
                .default_value(EUTECTOID)
                .above(0.0),
            KeySpec::quantity(SHIFT, "K", "rise of A_c1 for a tenfold heating rate, above the reference rate")
                .of_differences()
                .default_value(0.0)
                .at_least(0.0),
            KeySpec::quantity(REFERENCE, "K/s", "heating rate up to which the start temperature holds")
                .default_value(1.0)
                .above(0.0),
            KeySpec::quantity(CRITICAL, "K/s", "smallest cooling rate at which austenite becomes martensite")
                .default_value(PEARLITIC)
                .at_least(0.0),
        ],
        figures: vec![
            figure("depth_m", "m", "depth of the transformed layer", "depth").headline(),
            figure("width_m", "m", "width of the transformed layer", "width"),
            figure("length_m", "m", "length of the transformed layer along the rolling direction", "length"),
            figure("hot_length_m", "m", "length of the austenite that remains at the end", "hot at the end"),
            figure("temperature_margin_k", "K", "highest temperature minus the transformation temperature", "margin").digits(3),
            figure("heating_rate_k_per_s", "K/s", "heating rate through the start temperature", "heating").digits(3),
            figure("cooling_rate_k_per_s", "K/s", "cooling rate through the start temperature", "cooling").digits(3),
        ],
    }
}

/// Reads the criterion of a case, if the effect is active.
///
/// # Errors
/// A value that is out of range; two stationary bodies; a transient case in which surfaces return
/// to the contact periodically.
pub fn read(
    given: &Configuration,
    scene: &Scene,
    repeats: bool,
) -> Result<Option<Criterion>, Refusal> {
    if !given.has_effect(NAME) {
        return Ok(None);
    }
    if given.mode == Mode::Transient && repeats {
        return Err(Refusal::new(
            &format!("effects.{NAME}"),
            "a transient case follows each place until it has left the contact, but here contacts repeat",
            "write time.mode = \"steady\" or \"sequence\", another [thermal] model, or remove the effect",
        ));
    }
    if scene.at_rest == [true; 2] {
        return Err(Refusal::new(
            &format!("effects.{NAME}"),
            "both bodies are at rest: no place is heated and quenched by a passage",
            "write a motion.speed above 0, or remove the effect",
        ));
    }
    let specs = spec().keys;
    let number = |key: &str| {
        let default = specs
            .iter()
            .find(|spec| spec.path == key)
            .and_then(|spec| spec.default.as_ref()?.as_f64());
        let value = given.case.maybe_number(key)?.or(default).unwrap_or(0.0);
        match value >= 0.0 && (value > 0.0 || key == SHIFT || key == CRITICAL) {
            true => Ok(value),
            false => {
                Err(Refusal::new(key, format!("{value} is not above 0"), "write a value above 0"))
            }
        }
    };
    Ok(Some(Criterion {
        start: number(START)?,
        shift: number(SHIFT)?,
        reference_rate: number(REFERENCE)?,
        critical_rate: number(CRITICAL)?,
    }))
}

/// Estimates how much the effect matters in a scene.
#[must_use]
pub fn advise(situation: &Situation<'_>) -> Advice {
    let body = situation.hotter();
    let rests = situation.speeds[body] == 0.0;
    let highest = scene_temperature(situation, body);
    let number = |key: &str| situation.case.maybe_number(key).ok().flatten();
    let start = number(START).unwrap_or(EUTECTOID);
    let rates = rates(situation, body, start);
    let criterion = Criterion {
        start,
        shift: number(SHIFT).unwrap_or(0.0),
        reference_rate: number(REFERENCE).unwrap_or(1.0),
        critical_rate: number(CRITICAL).unwrap_or(PEARLITIC),
    };
    // The heating rate is defined only if A_c1 is reached.
    let needed = if highest >= start { criterion.temperature(rates[0]) } else { start };
    let name = &situation.scene.names.0[body];
    let mut why = format!("{name} reaches {highest:.0} K and transforms at {needed:.0} K");
    if highest >= needed && rests {
        why += "; it is at rest, so that it is hot up to the end";
    } else if highest >= needed {
        let critical = criterion.critical_rate;
        why += &format!(
            "; it cools by {} K/s and quenches from {critical} K/s on",
            readable::number(rates[1], 1),
            critical = readable::number(critical, 1)
        );
    }
    // A stationary body is counted as long as it is hot.
    let forms = highest >= needed && (rests || rates[1] >= criterion.critical_rate);
    Advice::new(NAME, why)
        .number("highest temperature over A_c1", highest / start)
        .number("highest temperature over the transformation temperature", highest / needed)
        .moves(format!("white_layer.{name}.depth_m"), if forms { f64::INFINITY } else { 0.0 })
        .with(format!("effects.{NAME}={{}}"))
}

/// Estimates the rate of heating to the largest rise along the contact, and the rate of cooling
/// through a temperature behind it, where T ~ 1/√t [K/s]; zero for a stationary body.
fn rates(situation: &Situation<'_>, body: usize, start: f64) -> [f64; 2] {
    let (rise, speed) = (situation.rises[body], situation.speeds[body]);
    let passing = 2.0 * situation.semi_axes[0] / speed;
    let over = start - situation.scene.initial_temperatures[body];
    if speed == 0.0 || rise == 0.0 {
        return [0.0; 2];
    }
    [rise / passing, over.powi(3) / (rise * rise * passing)]
}

/// Highest temperature of a body [K].
fn scene_temperature(situation: &Situation<'_>, body: usize) -> f64 {
    situation.scene.initial_temperatures[body] + situation.rises[body]
}
