//! The undeformed distance of wheel and rail, and the grid on which they touch.
//!
//! h(x, y) = x²/(2R(y)) + z_w(y − s) − z_r(y) + roughness, less the smallest value of the part
//! without roughness; z_w and z_r are the lateral shapes of wheel and rail, s the lateral shift of
//! the wheel. A measured wheel has the rolling radius R(y) = R + z_w(0) − z_w(y − s). The distance
//! is taken along z, which is the contact normal for small contact angles only; a steeper contact
//! is refused. With profiles the origin lies at the centre of pressure.

use crate::effects::roughness::{self, Roughness};
use crate::ellipse::Ellipse;
use crate::half_space::extent::{Fitted, Moments, fit_grid};
use crate::half_space::influence::Elasticity;
use crate::half_space::normal::{NormalError, Prescribed};
use crate::half_space::profile::Profile;
use crate::keys::CheckedParams;
use crate::scene::{CROWN_RADIUS, Load, RAIL_SHAPE, RESOLUTION, Scene};
use proto::configuration::{Configuration, Refusal};
use proto::description::KeySpec;
use proto::grid::Structured;
use std::path::Path;

/// More elements are refused: operators and Krylov space would take tens of gigabytes.
const MOST_ELEMENTS: usize = 4_000_000;
/// Free elements round a contact whose extent is known in closed form: the trailing edge's passages
/// need one.
const MARGIN: f64 = 1.0;
/// Elements along the estimated radius of a contact of profiles, when its extent is looked for.
const COARSE: f64 = 12.0;
/// Free elements of that coarse grid round the contact.
const COARSE_MARGIN: f64 = 2.0;
/// Growth of the grid for a rough contact, which is wider than the smooth one.
const ROUGH_GROWTH: f64 = 1.25;
/// Growth of the grid for different bodies, whose contact the tractions shift.
const COUPLED_GROWTH: f64 = 1.4;
/// Elements of the coarse grid at most.
const MOST_COARSE_ELEMENTS: usize = 200_000;
/// Points at which the lateral distance is searched for its smallest value.
const SAMPLES: usize = 2000;
/// Steepest contact that is treated as plane [rad].
const STEEPEST: f64 = 0.2;

const RAIL_PROFILE: &str = "rail.profile";
const WHEEL_PROFILE: &str = "wheel.profile";
const LATERAL_SHIFT: &str = "wheel.lateral_shift";
const LATERAL_RESOLUTION: &str = "mech.lateral_resolution";

/// The keys that the geometry reads besides the scene's.
pub(super) fn keys() -> Vec<KeySpec> {
    vec![
        KeySpec::file(RAIL_PROFILE, "measured lateral profile of the rail: y and z, z up")
            .one_of(RAIL_SHAPE),
        KeySpec::file(WHEEL_PROFILE, "measured lateral profile of the wheel as it stands: y and z"),
        KeySpec::quantity(LATERAL_SHIFT, "m", "lateral shift of a measured wheel, to the left")
            .default_value(0.0),
        KeySpec::integer(
            LATERAL_RESOLUTION,
            "elements per semi-axis b: dy = b/lateral_resolution; absent: dy = dx",
        )
        .at_least(1.0)
        .at_most(2000.0),
    ]
}

/// Lateral shape of a body.
#[derive(Clone, Debug)]
enum Shape {
    /// z = ½ κ y².
    Curvature(f64),
    Profile(Profile),
}

impl Shape {
    fn height(&self, y: f64) -> f64 {
        match self {
            Self::Curvature(curvature) => 0.5 * curvature * y * y,
            Self::Profile(profile) => profile.height(y),
        }
    }

    fn slope(&self, y: f64) -> f64 {
        match self {
            Self::Curvature(curvature) => curvature * y,
            Self::Profile(profile) => profile.slope(y),
        }
    }

    fn range(&self, shift: f64) -> [f64; 2] {
        match self {
            Self::Curvature(_) => [f64::NEG_INFINITY, f64::INFINITY],
            Self::Profile(profile) => profile.range().map(|end| end + shift),
        }
    }
}

/// The undeformed distance.
#[derive(Clone, Debug)]
pub(super) struct Gap {
    wheel: Shape,
    rail: Shape,
    wheel_radius: f64,
    shift: f64,
    /// Smallest lateral distance [m].
    closest: f64,
    /// Lateral coordinate of the origin [m].
    pub(super) origin: f64,
    roughness: Option<Roughness>,
}

impl Gap {
    /// There is roughness on the surfaces.
    pub(super) fn is_rough(&self) -> bool {
        self.roughness.is_some()
    }

    /// Reads the shapes.
    fn read(configuration: &Configuration, scene: &Scene) -> Result<Self, Refusal> {
        let case = CheckedParams::new(&configuration.case, keys());
        let measured = |key: &str| -> Result<Option<Shape>, Refusal> {
            if !case.has(key) {
                return Ok(None);
            }
            let path = case.text(key)?;
            let wrong = |error| {
                Refusal::new(
                    key,
                    format!("`{path}`: {error}"),
                    "see docs/theory/half-space.md for the format",
                )
            };
            Profile::read(Path::new(path)).map(|p| Some(Shape::Profile(p))).map_err(wrong)
        };
        let rail = match (measured(RAIL_PROFILE)?, scene.rail_crown_radius) {
            (Some(profile), None) => profile,
            (None, Some(radius)) => Shape::Curvature(-1.0 / radius),
            (None, None) => {
                return Err(Refusal::new(
                    CROWN_RADIUS,
                    "missing",
                    format!("add `{CROWN_RADIUS}` or `{RAIL_PROFILE}`"),
                ));
            }
            (Some(_), Some(_)) => {
                return Err(Refusal::new(
                    RAIL_PROFILE,
                    format!("stands beside `{CROWN_RADIUS}`"),
                    "keep one of them",
                ));
            }
        };
        let wheel = match measured(WHEEL_PROFILE)? {
            Some(_) if scene.tread_curvature != 0.0 => {
                return Err(Refusal::new(
                    WHEEL_PROFILE,
                    "stands beside `wheel.tread_radius`",
                    "keep one of them",
                ));
            }
            Some(profile) => profile,
            None => Shape::Curvature(scene.tread_curvature),
        };
        let shift = case.number(LATERAL_SHIFT)?;
        if shift != 0.0 && matches!(wheel, Shape::Curvature(_)) {
            return Err(Refusal::new(
                LATERAL_SHIFT,
                "shifts a measured wheel, and this one has no profile",
                format!("add `{WHEEL_PROFILE}`, or remove the key"),
            ));
        }
        Ok(Self {
            wheel,
            rail,
            wheel_radius: scene.wheel_radius,
            shift,
            closest: 0.0,
            origin: 0.0,
            roughness: roughness::read(configuration)?,
        })
    }

    /// Both bodies have curvatures, so that without roughness the contact is Hertz's.
    fn is_quadric(&self) -> bool {
        matches!((&self.wheel, &self.rail), (Shape::Curvature(_), Shape::Curvature(_)))
    }

    fn lateral(&self, y: f64) -> f64 {
        self.wheel.height(y - self.shift) - self.rail.height(y)
    }

    fn smooth(&self, x: f64, y: f64) -> f64 {
        let y = y + self.origin;
        let radius = match &self.wheel {
            Shape::Curvature(_) => self.wheel_radius,
            Shape::Profile(profile) => {
                self.wheel_radius + profile.height(0.0) - profile.height(y - self.shift)
            }
        };
        0.5 * x * x / radius + self.lateral(y) - self.closest
    }

    /// Undeformed distance at (x, y) from the origin [m].
    pub(super) fn distance(&self, x: f64, y: f64) -> f64 {
        let rough = self.roughness.as_ref().map_or(0.0, |roughness| roughness.height(x, y));
        self.smooth(x, y) + rough
    }

    /// The lateral range in which both shapes are known.
    fn range(&self) -> [f64; 2] {
        let ([w0, w1], [r0, r1]) = (self.wheel.range(self.shift), self.rail.range(0.0));
        [w0.max(r0), w1.min(r1)]
    }

    /// Moves origin and zero to the place of first touch.
    fn settle(&mut self) -> Result<(), Refusal> {
        let [first, last] = self.range();
        if first >= last {
            return Err(Refusal::new(
                WHEEL_PROFILE,
                "wheel and rail do not face each other anywhere",
                "check the lateral coordinates of both profiles and wheel.lateral_shift",
            ));
        }
        let at = |k: usize| first + (last - first) * k as f64 / SAMPLES as f64;
        let lowest = |y: &f64, z: &f64| self.lateral(*y).total_cmp(&self.lateral(*z));
        let y = (0..=SAMPLES).map(at).min_by(lowest).expect("there are samples");
        (self.origin, self.closest) = (y, self.lateral(y));
        Ok(())
    }

    /// Refuses a contact that is steep anywhere.
    fn refuse_steep(&self, fitted: &Fitted) -> Result<(), Refusal> {
        let rows = fitted.pressure.chunks_exact(fitted.grid.ni).enumerate();
        for (row, _) in rows.filter(|(_, row)| row.iter().any(|p| *p > 0.0)) {
            let y = fitted.grid.y(row) + self.origin;
            let slope = self.rail.slope(y).abs().max(self.wheel.slope(y - self.shift).abs());
            if slope.atan() > STEEPEST {
                let angle = slope.atan();
                return Err(Refusal::new(
                    RAIL_PROFILE,
                    format!("the bodies touch at y = {y:.4} m under {angle:.2} rad to the plane"),
                    format!("shift or turn the profiles until all contact is below {STEEPEST} rad"),
                ));
            }
        }
        Ok(())
    }
}

/// Where the contact is solved.
#[derive(Clone, Debug)]
pub(super) struct Footprint {
    /// The undeformed distance; `None` where the case gives the pressure.
    pub(super) gap: Option<Gap>,
    /// Hertz's or the given ellipse, where the contact is one.
    pub(super) ellipse: Option<Ellipse>,
    /// Semi-axes, or what comes near them [m].
    pub(super) semi_axes: [f64; 2],
    pub(super) grid: Structured,
}

/// Finds the extent of the contact and lays a grid over it.
pub(super) fn footprint(
    configuration: &Configuration,
    scene: &Scene,
    given: Option<Ellipse>,
    bodies: &Elasticity,
) -> Result<Footprint, Refusal> {
    let case = CheckedParams::new(&configuration.case, keys());
    let lateral = match case.has(LATERAL_RESOLUTION) {
        true => Some(case.integer(LATERAL_RESOLUTION)? as f64),
        false => None,
    };
    let sides = |[a, b]: [f64; 2]| {
        let dx = a / scene.resolution as f64;
        [dx, lateral.map_or(dx, |count| b / count)]
    };
    let mut gap = Gap::read(configuration, scene)?;
    let rough = gap.roughness.is_some();
    if given.is_some() || gap.is_quadric() {
        if given.is_some() && (rough || !gap.is_quadric()) {
            let reason = "a given pressure leaves no room for profiles or roughness";
            return Err(Refusal::new("contact", reason, "remove [contact], or the others"));
        }
        let ellipse = given.map_or_else(|| Ellipse::solve(scene, None), Ok)?;
        let semi_axes = [ellipse.semi_axis_a, ellipse.semi_axis_b];
        let [dx, dy] = sides(semi_axes);
        let growth = match (rough, bodies.is_coupled()) {
            (_, true) => COUPLED_GROWTH,
            (true, false) => ROUGH_GROWTH,
            (false, false) => 1.0,
        };
        let reach = |semi_axis: f64, side: f64| {
            let elements = growth * semi_axis / side;
            [-elements, elements].map(|end| end + end.signum() * (MARGIN - 0.5))
        };
        let smooth_grid = lay([reach(semi_axes[0], dx), reach(semi_axes[1], dy)], [dx, dy])?;
        let grid = match rough {
            true => fit(&gap, scene, bodies, smooth_grid)?.grid,
            false => smooth_grid,
        };
        let gap = given.is_none().then_some(gap);
        return Ok(Footprint { gap, ellipse: Some(ellipse), semi_axes, grid });
    }
    gap.settle()?;
    let coarse = coarse_contact(&gap, scene, bodies)?;
    let Moments { centre, semi_axes } = Moments::of(&coarse.grid, &coarse.pressure);
    gap.origin += centre[1];
    let [dx, dy] = sides(semi_axes);
    let [x_range, y_range] = bounds(&coarse);
    let growth = if bodies.is_coupled() { COUPLED_GROWTH } else { 1.0 };
    let elements = |range: [f64; 2], side: f64| range.map(|end| growth * end / side);
    let y_range = y_range.map(|y| y - centre[1]);
    let mut grid = lay([elements(x_range, dx), elements(y_range, dy)], [dx, dy])?;
    if rough {
        grid = fit(&gap, scene, bodies, grid)?.grid;
    }
    Ok(Footprint { gap: Some(gap), ellipse: None, semi_axes, grid })
}

/// A grid whose elements cover a range of places, in elements from the origin, with an element's
/// centre at the origin.
fn lay([x, y]: [[f64; 2]; 2], [dx, dy]: [f64; 2]) -> Result<Structured, Refusal> {
    let ends = |[first, last]: [f64; 2]| [first.floor(), last.ceil()];
    let ([left, right], [low, high]) = (ends(x), ends(y));
    let (nx, ny) = (right - left + 1.0, high - low + 1.0);
    refuse_too_many(nx * ny)?;
    Ok(Structured::contact_plane(left * dx, low * dy, dx, dy, nx as usize, ny as usize))
}

fn refuse_too_many(elements: f64) -> Result<(), Refusal> {
    if elements <= MOST_ELEMENTS as f64 {
        return Ok(());
    }
    Err(Refusal::new(
        RESOLUTION,
        format!("makes {elements:.3e} elements in all"),
        format!("lower it until there are no more than {MOST_ELEMENTS:.3e}"),
    ))
}

/// What the normal problem is given.
pub(super) fn prescribed(load: Load) -> Prescribed {
    match load {
        Load::NormalForce(force) => Prescribed::Load(force),
        Load::Approach(approach) => Prescribed::Approach(approach),
    }
}

fn fit(gap: &Gap, scene: &Scene, bodies: &Elasticity, grid: Structured) -> Result<Fitted, Refusal> {
    let distance = |x: f64, y: f64| gap.distance(x, y);
    let within = gap.range().map(|end| end - gap.origin);
    fit_grid(grid, bodies, &distance, prescribed(scene.load), within, MOST_ELEMENTS)
        .map_err(refused)
}

fn refused(error: NormalError) -> Refusal {
    let fix = "check the shapes, the load and the units; or lower mech.resolution";
    Refusal::new("load", error.to_string(), fix)
}

/// The contact of profiles on a coarse grid that spans all of their width.
fn coarse_contact(gap: &Gap, scene: &Scene, bodies: &Elasticity) -> Result<Fitted, Refusal> {
    let (radius, compliance) = (scene.wheel_radius, bodies.contact_compliance());
    let estimate = match scene.load {
        Load::NormalForce(force) => (0.75 * force * radius * compliance).cbrt(),
        Load::Approach(approach) => (radius * approach).sqrt(),
    };
    let side = estimate / COARSE;
    let [first, last] = gap.range().map(|end| end - gap.origin);
    let x = [-COARSE, COARSE];
    // Only profiles that are as flat as Hertz's estimate is deep can be touched farther out.
    let reach = |y: f64| (y / side).clamp(-40.0 * COARSE, 40.0 * COARSE);
    let grid = lay([x, [reach(first) + 1.0, reach(last) - 1.0]], [side, side])?;
    let smooth = |x: f64, y: f64| gap.smooth(x, y);
    let load = prescribed(scene.load);
    let fitted = fit_grid(grid, bodies, &smooth, load, [first, last], MOST_COARSE_ELEMENTS)
        .map_err(|error| match error {
            NormalError::EndOfShape | NormalError::GridLimit { .. } => Refusal::new(
                RAIL_PROFILE,
                "the contact reaches the end of a profile, or the bodies are flat",
                "give profiles that reach farther, or check wheel.lateral_shift and the units",
            ),
            error => refused(error),
        })?;
    gap.refuse_steep(&fitted)?;
    Ok(fitted)
}

/// Ranges of x and y of the elements in contact, and a margin [m].
fn bounds(fitted: &Fitted) -> [[f64; 2]; 2] {
    let grid = &fitted.grid;
    let mut ranges = [[f64::INFINITY, f64::NEG_INFINITY]; 2];
    for (index, _) in fitted.pressure.iter().enumerate().filter(|(_, p)| **p > 0.0) {
        let place = [grid.x(index % grid.ni), grid.y(index / grid.ni)];
        for (range, at) in ranges.iter_mut().zip(place) {
            *range = [range[0].min(at), range[1].max(at)];
        }
    }
    let sides = [grid.dx(), grid.dy()];
    std::array::from_fn(|k| {
        let margin = COARSE_MARGIN * sides[k];
        [ranges[k][0] - margin, ranges[k][1] + margin]
    })
}
