//! Cases whose values vary, or whose load varies under an axle: the scene of every window, and one
//! grid for all of them.
//!
//! All windows of a history share one grid, so that a solution can start from the previous one and
//! all fields of a run are comparable. The elements have the size that the case prescribes for the
//! smallest contact, but not less than a third of that for the largest.

use crate::case::ellipse::{Ellipse, Extent};
use crate::case::scene::{GivenPatch, Load, SPEED, Scene};
use crate::terms::axle_load::AxleLoad;
use crate::terms::{Kind, Terms};
use elastic::axle::Axle;
use proto::configuration::{Configuration, Mode, Refusal};
use proto::model::{Step, StepError};
use proto::params::Params;
use proto::readable::quantity;
use serde_json::Value;
use std::rc::Rc;

/// Contacts smaller than this share of the largest do not refine the grid.
const SMALLEST: f64 = 1.0 / 3.0;

/// Share of the steady load applied in a window without contact; the solver needs a positive load.
const LOST: f64 = 1e-6;

/// Relative tolerance by which the mean load of a window may exceed the largest load; covers
/// rounding.
const ROUNDING: f64 = 1e-9;

/// Maximum number of axle steps computed before a run.
const MOST_STEPS: f64 = 1e7;

/// A configuration whose values vary.
#[derive(Clone, Debug)]
pub(super) struct Varying {
    configuration: Configuration,
    /// The case with the values of the latest window.
    row: Params,
    /// Load under an axle, and the load of steady rolling [N].
    axle_load: Option<(Rc<AxleLoad>, f64)>,
    /// Name of the effect that defines the axle.
    effect: &'static str,
}

/// Keys that prescribe a force; a window without contact cannot carry one.
const FORCES: [&str; 4] =
    ["traction_coefficient", "tangential_force", "lateral_force", "spin_moment"];

impl Varying {
    /// Returns the varying values of a configuration; `None` if no value varies and there is no
    /// axle.
    ///
    /// # Errors
    /// An axle that this model cannot represent.
    pub(super) fn of(
        configuration: &Configuration,
        terms: &Terms,
        given: Option<GivenPatch>,
    ) -> Result<Option<Self>, Refusal> {
        let axle_load = match (terms.axle, terms.effect_of(Kind::Axle)) {
            (Some(axle), Some(effect)) => Some(axle_load(configuration, axle, effect, given)?),
            _ => None,
        };
        if configuration.histories.is_none() && axle_load.is_none() {
            return Ok(None);
        }
        let effect = terms.effect_of(Kind::Axle).unwrap_or_default();
        let (configuration, row) = (configuration.clone(), configuration.case.clone());
        Ok(Some(Self { configuration, row, axle_load, effect }))
    }

    /// Case values of a window.
    fn case(&self, step: &Step) -> Params {
        let mut case = self.configuration.case_at(step).into_owned();
        if let Some((axle_load, still)) = &self.axle_load {
            let mean = axle_load.window(step.start, step.end).mean;
            case.0["load"]["normal_force"] = mean.max(LOST * still).into();
            if let Some(motion) = case.0["motion"].as_object_mut().filter(|_| mean <= LOST * still)
            {
                let count = motion.len();
                motion.retain(|key, _| !FORCES.contains(&key.as_str()));
                if motion.len() < count {
                    motion.entry("creepage").or_insert_with(|| serde_json::json!({"xi": 0.0}));
                }
            }
        }
        case
    }

    /// Refuses a window whose load exceeds the largest load, for which the grid was made.
    ///
    /// # Errors
    /// A load beyond the largest load.
    pub(super) fn refuse_more(&self, step: &Step) -> Result<(), StepError> {
        let Some((axle_load, _)) = &self.axle_load else { return Ok(()) };
        let (load, most) = (axle_load.window(step.start, step.end).mean, axle_load.largest());
        if load <= most * (1.0 + ROUNDING) {
            return Ok(());
        }
        Err(StepError::NoSolution(format!(
            "effects.{}: the load of this window is {load}, beyond the {most} for which the grid was made: it still \
             rises after a hundred waves, or ten turns of a flat; write an earlier time.end, or more damping",
            self.effect,
            load = quantity(load, "N", 5),
            most = quantity(most, "N", 5)
        )))
    }

    /// Returns whether the load follows from an axle.
    pub(super) fn has_axle_load(&self) -> bool {
        self.axle_load.is_some()
    }

    /// Adds the axle's largest load and time without contact to the section `contact` of a window's
    /// summary.
    pub(super) fn add_to(&self, figures: &mut Value, step: &Step) {
        if let Some((axle_load, _)) = &self.axle_load {
            let load = axle_load.window(step.start, step.end);
            figures["largest_normal_force_n"] = load.largest.into();
            figures["apart_s"] = load.apart.into();
        }
    }

    /// Configuration of a window, with constant values.
    pub(super) fn configuration(&self, step: &Step) -> Configuration {
        let Configuration { role, model, mode, windows, .. } = &self.configuration;
        Configuration {
            role: role.clone(),
            model: model.clone(),
            mode: *mode,
            windows: *windows,
            case: self.case(step),
            histories: None,
            inputs: Vec::new(),
            outputs: Vec::new(),
            observed: Vec::new(),
            threads: self.configuration.threads,
        }
    }

    /// Returns the scene of a window.
    ///
    /// # Errors
    /// Values that make no valid scene; a load beyond the largest load.
    pub(super) fn scene(&mut self, step: &Step) -> Result<Scene, StepError> {
        self.refuse_more(step)?;
        match &self.configuration.histories {
            // Every row sets the same keys.
            Some(histories) if self.axle_load.is_none() => histories.put(&mut self.row, step),
            _ => self.row = self.case(step),
        }
        Scene::read(&self.row).map_err(no_answer)
    }

    /// Ellipses of all rows that have one; rows equal to the previous row are omitted.
    fn ellipses(&self, given: Option<GivenPatch>) -> Vec<Ellipse> {
        let Configuration { case, histories, .. } = &self.configuration;
        if let Some((axle_load, still)) = &self.axle_load {
            let at = |load: f64| {
                let mut case = case.clone();
                case.0["load"]["normal_force"] = load.into();
                Ellipse::solve(&Scene::read(&case).ok()?, given).ok()
            };
            return [*still, axle_load.largest()].into_iter().filter_map(at).collect();
        }
        let Some(histories) = histories else { return Vec::new() };
        let mut case = case.clone();
        let mut ellipse = |row: usize| {
            histories.put_row(&mut case, row);
            Ellipse::solve(&Scene::read(&case).ok()?, given).ok()
        };
        let rows = 0..histories.times.len();
        let shaping = histories.values.iter().filter(|(key, _)| shapes(key));
        let shaping: Vec<(&String, &Vec<f64>)> = shaping.collect();
        // An ellipse grows with its load, so the least and the largest load of a long history
        // suffice.
        if let [(key, loads)] = shaping.as_slice()
            && key.starts_with("load.")
        {
            let by_load = |a: &usize, b: &usize| loads[*a].total_cmp(&loads[*b]);
            let pressed = || rows.clone().filter(|row| loads[*row] > 0.0);
            let ends = [pressed().min_by(by_load), pressed().max_by(by_load)];
            if let [Some(Some(least)), Some(Some(most))] = ends.map(|row| row.map(&mut ellipse)) {
                return vec![least, most];
            }
        }
        let is_new = |row: &usize| {
            *row == 0
                || shaping.is_empty()
                || shaping.iter().any(|(_, of)| of[*row] != of[*row - 1])
        };
        let found = rows.filter(is_new).filter_map(ellipse);
        if shaping.is_empty() { found.take(1).collect() } else { found.collect() }
    }

    /// Extent and finest resolution that a grid needs for all rows.
    ///
    /// # Errors
    /// Histories without any contact.
    pub(super) fn extent(&self, given: Option<GivenPatch>) -> Result<Extent, Refusal> {
        let found = self.ellipses(given).iter().fold(None, |extent: Option<Extent>, ellipse| {
            Some(extent.map_or(ellipse.extent(), |extent| extent.and(&ellipse.extent())))
        });
        let extent = found.ok_or_else(|| {
            let reason = "no row of the histories has a contact";
            Refusal::new("load", reason, "check the columns, their units and the radii")
        })?;
        Ok(Extent { finest: extent.finest.max(SMALLEST * extent.a), ..extent })
    }

    /// Remark of the plan on the varying values.
    pub(super) fn remark(&self, extent: &Extent) -> String {
        if let Some((axle_load, still)) = &self.axle_load {
            let largest = axle_load.largest();
            return format!(
                "the load reaches {largest}, {:.2} times that of steady rolling",
                largest / still,
                largest = quantity(largest, "N", 5)
            );
        }
        let rows = self.configuration.histories.as_ref().map_or(0, |h| h.times.len());
        let [least, most] = [extent.smallest, extent.a].map(|a| 1e3 * a);
        format!("{rows} rows on one grid; a from {least:.4} to {most:.4} mm")
    }
}

/// Scenes of all windows of a run.
#[derive(Clone, Debug)]
pub(super) struct Scenes {
    /// Scene of the case.
    scene: Scene,
    /// Values that vary, if any.
    varying: Option<Varying>,
}

impl Scenes {
    /// Creates the scenes of a run: the scene of the case for every window, unless its values vary.
    pub(super) fn new(scene: Scene, varying: Option<Varying>) -> Self {
        Self { scene, varying }
    }

    /// Returns the scene of a window.
    ///
    /// # Errors
    /// Values that make no valid scene.
    pub(super) fn of(&mut self, step: &Step) -> Result<Scene, StepError> {
        match &mut self.varying {
            Some(varying) => varying.scene(step),
            None => Ok(self.scene.clone()),
        }
    }

    /// Returns the summary of a window, completed by the figures of the axle.
    pub(super) fn complete(&self, mut summary: Value, step: &Step) -> Value {
        if let Some(varying) = &self.varying {
            varying.add_to(&mut summary["contact"], step);
        }
        summary
    }
}

/// Returns whether a key may change the ellipse; motion, friction and effects do not.
fn shapes(key: &str) -> bool {
    !["motion.", "friction.", "effects."].iter().any(|section| key.starts_with(section))
}

/// Load under an axle, and the load of steady rolling [N].
fn axle_load(
    configuration: &Configuration,
    axle: Axle,
    effect: &str,
    given: Option<GivenPatch>,
) -> Result<(Rc<AxleLoad>, f64), Refusal> {
    let refused = |reason: &str, fix: &str| {
        Err(Refusal::new(
            &format!("effects.{effect}"),
            reason,
            format!("{fix}, or remove the effect"),
        ))
    };
    if configuration.mode == Mode::Steady {
        return refused(
            "steady rolling does not depend on the axle that carries the load",
            "write time.mode = \"transient\" with a window and an end",
        );
    }
    if configuration.histories.is_some() {
        return refused(
            "the load follows from the axle, not from a table",
            "write numbers in place of columns",
        );
    }
    if axle.rotary_inertia.is_some() {
        return refused(
            "this model keeps the speed of the surface constant",
            "remove the rotary inertia, or choose the model explicit-fe",
        );
    }
    let scene = Scene::read(&configuration.case)?;
    let ellipse = Ellipse::solve(&scene, given)?;
    if !matches!(scene.load, Load::NormalForce(_)) || scene.speeds.rolling <= 0.0 {
        return refused(
            "an axle needs a prescribed normal force and rolling",
            "write load.normal_force and a motion.speed above 0",
        );
    }
    match AxleLoad::new(axle, &scene, &ellipse) {
        Some(axle_load) if axle_load.steps() > MOST_STEPS => refused(
            "the axle needs more than ten million steps to pass the irregularity",
            "write a larger mass, less damping or stiffness, a higher speed, or a nearer irregularity",
        ),
        Some(axle_load) => Ok((Rc::new(axle_load), ellipse.normal_force)),
        None => refused("the stiffness of a given ellipse is not known", "remove [contact]"),
    }
}

/// Reason why a contact that rolls in some rows cannot stand still in others.
const STANDSTILL: &str = "a contact that rolls has neither creepages nor power at standstill";
/// Fix for a row at standstill.
const GO_ON: &str = "leave these rows out, or write a small speed such as 0.001 m/s, at which the \
                     forces are those of the limit";

/// Refuses histories in which the bodies roll in some windows and stand still in others.
///
/// # Errors
/// A row, or a stretch between rows, with a speed of zero beside others.
pub(crate) fn refuse_standstill(configuration: &Configuration) -> Result<(), Refusal> {
    let Some(histories) = &configuration.histories else { return Ok(()) };
    let Some(speeds) = histories.values.get(SPEED) else { return Ok(()) };
    let Some(largest) = speeds.iter().copied().max_by(f64::total_cmp).filter(|most| *most > 0.0)
    else {
        return Ok(());
    };
    // A speed that only touches zero between two rows has no window at standstill. The first row
    // describes the case.
    let stands = |row: &usize| {
        let beside = [row.checked_sub(1), Some(row + 1)];
        let goes_on = beside.iter().flatten().any(|row| speeds.get(*row) == Some(&0.0));
        speeds[*row] == 0.0 && (histories.rows || *row == 0 || goes_on)
    };
    match (0..speeds.len()).find(stands) {
        Some(row) => Err(Refusal::new(
            SPEED,
            format!(
                "is 0 m/s in row {} of its column and up to {largest} m/s in others: {STANDSTILL}",
                row + 1
            ),
            GO_ON,
        )),
        None => Ok(()),
    }
}

/// Refuses a row at standstill of a contact that rolls, and a rolling row of one that does not.
pub(super) fn refuse_change_of_rolling(before: &Scene, now: &Scene) -> Result<(), Refusal> {
    match (before.speeds.rolling > 0.0) == (now.speeds.rolling > 0.0) {
        true => Ok(()),
        false => Err(Refusal::new(
            SPEED,
            format!("is 0 m/s in one row and above 0 m/s in another: {STANDSTILL}"),
            GO_ON,
        )),
    }
}

/// Converts the refusal of a row into the error of a window without solution.
pub(super) fn no_answer(Refusal { key, reason, fix }: Refusal) -> StepError {
    StepError::NoSolution(format!("{key}: {reason}; {fix}"))
}
