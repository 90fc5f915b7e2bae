//! Keys, values prescribed in a window, and the grid that holds the contacts of all rows.

use crate::case::difference;
use crate::case::ellipse::Ellipse;
use crate::case::keys::CheckedParams;
use crate::case::resolution::{self, RESOLUTION};
use crate::case::scene::{Drive, Scene, contact_keys};
use crate::models::half_space::geometry::prescribed;
use elastic::Elasticity;
use elastic::Material;
use half_space::conformal::contact::Prescription;
use half_space::conformal::shape::Arcs;
use half_space::difference::Difference;
use half_space::extent::{FittedContact, Moments, fit_grid};
use half_space::normal::Prescribed;
use proto::bodies::{LOWER, UPPER};
use proto::configuration::{Configuration, Refusal};
use proto::description::KeySpec;
use proto::grid::Structured;
use proto::params::Params;
use std::f64::consts::PI;

/// Default number of elements per semi-axis.
const ELEMENTS: usize = 20;
/// Elements per semi-axis on the coarse grid that finds the extent of the contact.
const COARSE: f64 = 10.0;
/// Maximum number of elements of the coarse grid.
const MOST_COARSE: usize = 200_000;
/// Growth of the grid beyond the contact of half-spaces with the same gap.
const GROWTH: f64 = 1.15;
/// Free elements around the contact.
const MARGIN: f64 = 2.0;
/// Maximum of elements times rows: the influence coefficients of every pair of rows take 150 bytes
/// each.
const MOST: f64 = 3e7;
/// Largest angle of the surface within the contact, relative to s = 0 [rad].
const STEEPEST: f64 = 0.45 * PI;

const TURN: &str = "contact.turn";
const NORMAL_CREEPAGE: &str = "mech.normal_creepage";
const RIGID_SLIP: &str = "mech.rigid_slip";
const LATERAL_RESOLUTION: &str = "mech.lateral_resolution";

/// Keys of the model. The contact is driven by creepages only.
pub(super) fn keys() -> Vec<KeySpec> {
    let forces = ["motion.traction_coefficient", "motion.tangential_force"];
    let mut keys = contact_keys();
    keys.retain(|key| !forces.contains(&key.path.as_str()));
    keys.extend([
        KeySpec::quantity(
            TURN,
            "rad",
            "angle by which the surfaces turn across, from one straight flank to the other; 0: influence \
             numbers of half-spaces",
        )
        .default_value(PI / 2.0)
        .at_least(0.0)
        .at_most(5.0 * PI / 6.0),
        KeySpec::number(
            NORMAL_CREEPAGE,
            "relative velocity along the normal in the middle of the surface, over the speed; causes lateral slip \
             where the surface turns; 0 in a steady contact",
        )
        .default_value(0.0)
        .varies(),
        KeySpec::choice(
            RIGID_SLIP,
            &["surfaces", "plane"],
            "rigid slip on the curved surface, or in the plane of its middle as for half-spaces",
        )
        .default_value("surfaces"),
        KeySpec::integer(
            LATERAL_RESOLUTION,
            "elements per semi-axis b along the surface; absent: dy = dx",
        )
        .at_least(1.0)
        .at_most(resolution::MOST as f64),
        difference::key(),
        resolution::key(ELEMENTS),
    ]);
    keys
}

/// Checked values of a case that do not vary.
pub(super) struct Case {
    pub(super) materials: [Material; 2],
    pub(super) arcs: Arcs,
    /// Angle by which the surfaces turn across the contact [rad].
    pub(super) turn: f64,
    pub(super) difference: Difference,
    resolution: usize,
    lateral: Option<f64>,
}

/// Values prescribed in a window.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Row {
    pub(super) prescription: Prescription,
    /// Rolling speed [m/s]; `surface_speeds` are those of the upper and the lower surface [m/s].
    pub(super) speed: f64,
    pub(super) surface_speeds: [f64; 2],
}

impl Case {
    /// Reads a case.
    ///
    /// # Errors
    /// Values that are missing or out of range; bodies without lateral curvature; radii that vary.
    pub(super) fn read(configuration: &Configuration) -> Result<Self, Refusal> {
        let params = &configuration.case;
        let scene = Scene::read(params)?;
        let checked = CheckedParams::new(params, keys());
        if let Some(histories) = &configuration.histories {
            let shape = |key: &&String| key.starts_with("bodies.");
            if let Some(key) = histories.values.keys().find(shape) {
                let fix = "run each shape as a separate case, or use `coordinator sweep`";
                return Err(Refusal::new(key, "the influence numbers belong to one shape", fix));
            }
        }
        let arcs = arcs(&scene);
        if arcs.curvature() == 0.0 {
            return Err(Refusal::new(
                &scene.names.key(LOWER, "radius_y"),
                "the surface between the bodies is plane",
                "give both bodies radii across, one of them negative, or write [mech] model = \"half-space\"",
            ));
        }
        let [upper, lower] = arcs.curvatures;
        if upper <= lower {
            return Err(Refusal::new(
                &scene.names.key(UPPER, "radius_y"),
                "the arcs touch at their ends: the concave body is narrower than the convex one",
                "give the concave body the larger radius",
            ));
        }
        let lateral = match checked.has(LATERAL_RESOLUTION) {
            true => Some(checked.integer(LATERAL_RESOLUTION)? as f64),
            false => None,
        };
        Ok(Self {
            materials: scene.materials(),
            arcs,
            turn: checked.number(TURN)?,
            difference: difference::read(params)?,
            resolution: resolution::read(params, ELEMENTS)?,
            lateral,
        })
    }

    /// Returns the values prescribed in a window. Partial slip is possible if `adheres`; otherwise
    /// the whole contact slides.
    ///
    /// # Errors
    /// A value that is missing or out of range.
    pub(super) fn row(&self, params: &Params, adheres: bool) -> Result<Row, Refusal> {
        let scene = Scene::read(params)?;
        let checked = CheckedParams::new(params, keys());
        let Drive::Creepage { xi, eta, phi } = scene.drive else {
            return Err(Refusal::new(
                "motion.creepage.xi",
                "this model is driven by creepages only",
                "prescribe motion.creepage",
            ));
        };
        let speed = scene.speeds.rolling;
        if speed == 0.0 {
            return Err(Refusal::new(
                crate::case::scene::SPEED,
                "this model needs bodies that roll steadily",
                "give a speed above 0, or write [mech] model = \"half-space\" for a shift",
            ));
        }
        Ok(Row {
            prescription: Prescription {
                load: prescribed(scene.load),
                creepage: [xi, eta, phi],
                normal_creepage: checked.number(NORMAL_CREEPAGE)?,
                in_plane: checked.text(RIGID_SLIP)? == "plane",
                friction: scene.friction_coefficient,
                adheres,
            },
            speed,
            surface_speeds: scene.speeds.of_surfaces(xi),
        })
    }
}

fn arcs(scene: &Scene) -> Arcs {
    let [upper, lower] = [&scene.bodies[UPPER], &scene.bodies[LOWER]];
    Arcs {
        curvatures: [1.0 / upper.radius_y, -1.0 / lower.radius_y],
        rolling_curvature: 1.0 / upper.radius_x + 1.0 / lower.radius_x,
    }
}

/// Region in which the contact is solved, and its grid.
pub(super) struct Footprint {
    pub(super) grid: Structured,
    /// Semi-axes, or equivalent values for other contacts [m].
    pub(super) semi_axes: [f64; 2],
}

impl Footprint {
    /// Finds the region of the contacts of all rows, or of the single row of a case without
    /// histories.
    ///
    /// # Errors
    /// A row without contact, or one that reaches too far around the surface; a grid that is too
    /// large.
    pub(super) fn of(configuration: &Configuration, case: &Case) -> Result<Self, Refusal> {
        let rows = configuration.histories.as_ref().map_or(1, |histories| histories.times.len());
        let mut params = configuration.case.clone();
        let mut ranges = [[f64::INFINITY, f64::NEG_INFINITY]; 2];
        let mut semi_axes = [0.0_f64; 2];
        let mut finest = f64::INFINITY;
        for row in 0..rows {
            if let Some(histories) = &configuration.histories {
                histories.put_row(&mut params, row);
            }
            let fitted = coarse(case, &params)?;
            let moments = Moments::of(&fitted.grid, &fitted.pressure);
            finest = finest.min(moments.semi_axes[0]);
            for axis in 0..2 {
                semi_axes[axis] = semi_axes[axis].max(moments.semi_axes[axis]);
                let [low, high] = range(&fitted, axis);
                ranges[axis] = [ranges[axis][0].min(low), ranges[axis][1].max(high)];
            }
        }
        let dx = finest / case.resolution as f64;
        let dy = case.lateral.map_or(dx, |count| semi_axes[1] / count);
        let ends = |[low, high]: [f64; 2], side: f64| {
            let reach = GROWTH * low.abs().max(high.abs()) / side + MARGIN;
            reach.ceil()
        };
        let half = [ends(ranges[0], dx), ends(ranges[1], dy)];
        let [nx, ny] = half.map(|half| 2.0 * half + 1.0);
        if nx * ny * ny > MOST {
            return Err(Refusal::new(
                RESOLUTION,
                format!("makes {nx} x {ny} elements, with influence numbers of every pair of rows"),
                format!("lower it, or give fewer rows by {LATERAL_RESOLUTION}"),
            ));
        }
        let grid = Structured::contact_plane(
            -half[0] * dx,
            -half[1] * dy,
            dx,
            dy,
            nx as usize,
            ny as usize,
        );
        Ok(Self { grid, semi_axes })
    }

    /// Angles of the surface at both ends of the grid [rad].
    pub(super) fn directions(&self, case: &Case) -> [f64; 2] {
        let ends = [self.grid.y(0), self.grid.y(self.grid.nj - 1)];
        let [first, last] = ends.map(|s| case.arcs.direction(s));
        [first.min(last), first.max(last)]
    }
}

/// Solves the contact of half-spaces with the undeformed distance of the arcs, on a coarse grid.
fn coarse(case: &Case, params: &Params) -> Result<FittedContact, Refusal> {
    let scene = Scene::read(params)?;
    let ellipse = Ellipse::solve(&scene, None)?;
    let arcs = case.arcs;
    let steepest = STEEPEST / arcs.curvature().abs();
    let [dx, dy] = [ellipse.semi_axis_a, ellipse.semi_axis_b.min(steepest)].map(|a| a / COARSE);
    let half = COARSE as usize;
    let (nx, ny) = (2 * half + 1, 2 * half + 1);
    let grid = Structured::contact_plane(-COARSE * dx, -COARSE * dy, dx, dy, nx, ny);
    let (approach, load) = match prescribed(scene.load) {
        Prescribed::Approach(approach) => (approach, Prescribed::Approach(0.0)),
        load @ Prescribed::Load(_) => (0.0, load),
    };
    let distance = |x: f64, s: f64| arcs.distance(x, s) - approach * arcs.direction(s).cos();
    let [upper, lower] = &case.materials;
    let pair = Elasticity::of_pair(upper, lower);
    let within = [-steepest, steepest];
    fit_grid(grid, pair, &distance, load, within, MOST_COARSE, f64::INFINITY).map_err(|error| {
        Refusal::new(
            "load",
            format!("{error}; the contact spans more than ±81° of the surface"),
            "lower the load, or increase the difference of the radii",
        )
    })
}

/// Range of the elements in contact along an axis [m].
fn range(fitted: &FittedContact, axis: usize) -> [f64; 2] {
    let grid = &fitted.grid;
    let pressed = fitted.pressure.iter().enumerate().filter(|(_, p)| **p > 0.0);
    let place = |at: usize| match axis {
        0 => grid.x(at % grid.ni),
        _ => grid.y(at / grid.ni),
    };
    pressed.fold([0.0, 0.0], |[low, high], (at, _)| [low.min(place(at)), high.max(place(at))])
}
