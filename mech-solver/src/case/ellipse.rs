//! Contact patch in closed form, shared by several models: the Hertz ellipse, the ellipse given
//! under `[contact]`, or the line contact of bodies that are straight across. The module also has
//! the grid that covers the patch and the friction limit.

use crate::case::resolution::{MOST, RESOLUTION};
use crate::case::scene::{APPROACH, Drive, GivenPatch, Load, NORMAL_FORCE, SPEED, Scene, WIDTH};
use crate::figures::indicators::Indicators;
use elastic::hertz;
use elastic::strips::semi_ellipse::SemiEllipse;
use elastic::strips::sliding::SlidingSlip;
use elastic::strips::{Lateral, StripField, Strips};
use proto::bodies::{LOWER, UPPER};
use proto::configuration::Refusal;
use proto::grid::Structured;
use proto::readable::{number, quantity};
use serde_json::{Value, json};
use std::collections::BTreeMap;
use std::f64::consts::PI;
use std::fmt;

/// Largest number of elements; the fields of larger grids would take gigabytes.
const MOST_ELEMENTS: f64 = 33_554_432.0;

/// Normal contact in closed form.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Ellipse {
    /// Semi-axis a along x [m].
    pub(crate) semi_axis_a: f64,
    /// Semi-axis b along y, or half the width of a line contact [m].
    pub(crate) semi_axis_b: f64,
    /// True for a line contact, uniform across its width.
    pub(crate) line: bool,
    /// Pressure at the centre [Pa].
    pub(crate) max_pressure: f64,
    /// Approach of the bodies [m]; unknown for a given ellipse.
    pub(crate) approach: Option<f64>,
    /// Normal force of the patch [N].
    pub(crate) normal_force: f64,
    /// Reference values of the assessment indicators.
    pub(crate) indicators: Indicators,
}

/// Region that a grid has to cover: one ellipse, or several.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Extent {
    /// Semi-axis that sets the element size [m].
    pub(crate) finest: f64,
    /// Smallest semi-axis along x [m].
    pub(crate) smallest: f64,
    /// Largest semi-axis along x [m].
    pub(crate) a: f64,
    /// Largest semi-axis along y [m].
    pub(crate) b: f64,
    /// True for line contacts, which one row of elements covers.
    pub(crate) line: bool,
}

impl Extent {
    /// Returns the extent enlarged by a factor, with the same element size.
    pub(crate) fn grown(&self, factor: f64) -> Self {
        let b = if self.line { self.b } else { factor * self.b };
        Self { a: factor * self.a, b, ..*self }
    }

    /// Returns the extent that covers both.
    pub(crate) fn and(&self, other: &Self) -> Self {
        Self {
            finest: self.finest.min(other.finest),
            smallest: self.smallest.min(other.smallest),
            a: self.a.max(other.a),
            b: self.b.max(other.b),
            line: self.line,
        }
    }

    /// Returns a grid of elements Δx = Δy = finest/resolution that covers the extent. The numbers
    /// of rows and columns are odd; a line contact has one row.
    pub(crate) fn grid(&self, resolution: usize) -> Result<Structured, Refusal> {
        let step = self.finest / resolution as f64;
        let half = |semi_axis: f64| (semi_axis / step - 0.5).ceil().max(0.0);
        let dy = if self.line { 2.0 * self.b } else { step };
        let [half_columns, half_rows] = [half(self.a), if self.line { 0.0 } else { half(self.b) }];
        let elements = (2.0 * half_columns + 1.0) * (2.0 * half_rows + 1.0);
        if elements > MOST_ELEMENTS {
            return Err(Refusal::new(
                RESOLUTION,
                format!(
                    "{resolution} elements per semi-axis a make {elements} elements in all",
                    elements = number(elements, 4)
                ),
                format!(
                    "lower it until there are no more than {MOST_ELEMENTS}",
                    MOST_ELEMENTS = number(MOST_ELEMENTS, 4)
                ),
            ));
        }
        let (nx, ny) = (2 * half_columns as usize + 1, 2 * half_rows as usize + 1);
        let (x0, y0) = (-half_columns * step, -half_rows * step);
        Ok(Structured::contact_plane(x0, y0, step, dy, nx, ny))
    }
}

/// Prescribed tangential force or creepage of an ellipse.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Prescribed {
    /// Longitudinal force divided by f N, in [−1, 1]; positive drives.
    ForceRatio(f64),
    /// Creepages: longitudinal and lateral [-], spin [rad/m].
    Creepage { xi: f64, eta: f64, phi: f64 },
}

impl Ellipse {
    /// Solves the normal contact, or uses the given ellipse.
    pub(crate) fn solve(scene: &Scene, given: Option<GivenPatch>) -> Result<Self, Refusal> {
        let ellipse = match given {
            Some(patch) => Self::of_given_patch(scene, patch),
            None if scene.width.is_some() => Self::of_line(scene)?,
            None => Self::of_hertz(scene)?,
        };
        if let (Some(_), Some(_)) = (given, scene.width) {
            let reason = "excludes a given ellipse";
            return Err(Refusal::new(WIDTH, reason, "remove it, or the ellipse under [contact]"));
        }
        ellipse.refuse_beyond_floating_point(scene)?;
        Ok(ellipse)
    }

    fn of_given_patch(scene: &Scene, patch: GivenPatch) -> Self {
        let GivenPatch { semi_axis_a, semi_axis_b, max_pressure } = patch;
        let normal_force = hertz::normal_force(semi_axis_a, semi_axis_b, max_pressure);
        let indicators = Indicators::of(scene);
        let (line, approach) = (false, None);
        Self { semi_axis_a, semi_axis_b, line, max_pressure, approach, normal_force, indicators }
    }

    /// Solves the line contact of bodies that are straight across.
    fn of_line(scene: &Scene) -> Result<Self, Refusal> {
        let width = scene.width.unwrap_or_default();
        let gap = scene.gap_coefficient_x();
        if let Some(body) = (0..2).find(|body| scene.bodies[*body].radius_y.is_finite()) {
            return Err(Refusal::new(
                WIDTH,
                format!(
                    "excludes `{}`: bodies that touch along a line are straight across",
                    scene.names.key(body, "radius_y")
                ),
                "keep one of them",
            ));
        }
        if gap <= 0.0 {
            return Err(Refusal::new(
                &scene.names.key(UPPER, "radius_x"),
                "one body is at least as concave as the other is convex: there is no closed contact",
                "write radii with a positive sum of 1/radius_x",
            ));
        }
        let compliance = scene.contact_compliance();
        let normal_force = match scene.load {
            Load::NormalForce(force) => force,
            Load::Approach(approach) => {
                hertz::line_force_at_approach(gap, width, approach, compliance)
            }
        };
        let line = hertz::line_contact(gap, width, normal_force, compliance);
        if 2.0 * line.semi_axis_a >= width {
            return Err(Refusal::new(
                WIDTH,
                format!(
                    "of {width} m is not large compared with the contact length 2a = {}",
                    quantity(2.0 * line.semi_axis_a, "m", 4),
                    width = number(width, 4)
                ),
                "write the width of the bodies, or lower the load",
            ));
        }
        Self {
            semi_axis_a: line.semi_axis_a,
            semi_axis_b: line.semi_axis_b,
            line: true,
            max_pressure: line.max_pressure,
            approach: Some(line.approach),
            normal_force,
            indicators: Indicators::of(scene),
        }
        .within_the_bodies(scene)
    }

    fn of_hertz(scene: &Scene) -> Result<Self, Refusal> {
        let (gap_x, gap_y) = (scene.gap_coefficient_x(), scene.gap_coefficient_y());
        refuse_open_ellipse(scene, gap_x, gap_y)?;
        let compliance = scene.contact_compliance();
        let normal_force = match scene.load {
            Load::NormalForce(force) => force,
            Load::Approach(approach) => {
                hertz::force_at_approach(gap_x, gap_y, approach, compliance)
            }
        };
        let solution = hertz::elliptic_contact(gap_x, gap_y, normal_force, compliance);
        Self {
            semi_axis_a: solution.semi_axis_a,
            semi_axis_b: solution.semi_axis_b,
            line: false,
            max_pressure: solution.max_pressure,
            approach: Some(solution.approach),
            normal_force,
            indicators: Indicators::of(scene),
        }
        .within_the_bodies(scene)
    }

    /// Refuses a semi-axis a that is not below the smallest radius along x. The paraboloid that
    /// approximates the body continues there, and the body does not.
    fn within_the_bodies(self, scene: &Scene) -> Result<Self, Refusal> {
        let a = self.semi_axis_a;
        let radius = scene.smallest_radius_x();
        match a >= radius {
            true => Err(Refusal::new(
                load_key(scene),
                format!(
                    "gives a contact of semi-axis a = {a} on a body of radius {radius}",
                    a = quantity(a, "m", 4),
                    radius = quantity(radius, "m", 4)
                ),
                "lower the load, or check the units of load, radii and materials",
            )),
            false => Ok(self),
        }
    }

    fn refuse_beyond_floating_point(&self, scene: &Scene) -> Result<(), Refusal> {
        // Square of the area of the smallest element, which must be representable as well.
        let squared_area = (self.semi_axis_a / MOST as f64).powi(4);
        let size = [squared_area, self.semi_axis_b, self.max_pressure, self.normal_force];
        if size.iter().all(|value| value.is_normal()) {
            return Ok(());
        }
        Err(Refusal::new(
            load_key(scene),
            format!("gives a contact whose size or pressure is not a number: {self}"),
            "check the units of load, radii and materials",
        ))
    }

    /// Refuses bodies that do not roll, for the models of rolling.
    pub(crate) fn refuse_rest(scene: &Scene) -> Result<(), Refusal> {
        match scene.speeds.rolling == 0.0 {
            true => Err(Refusal::new(
                SPEED,
                "this model is for rolling; bodies that do not roll need mech.model = half-space",
                "write a speed above 0 m/s, or choose the model half-space",
            )),
            false => Ok(()),
        }
    }

    /// Extent of a grid that covers the ellipse.
    pub(crate) fn extent(&self) -> Extent {
        let Self { semi_axis_a: a, semi_axis_b: b, line, .. } = *self;
        Extent { finest: a, smallest: a, a, b, line }
    }

    /// Returns the prescribed creepage, or the prescribed force as a share of f N.
    pub(crate) fn prescribed(&self, scene: &Scene) -> Result<Prescribed, Refusal> {
        let within = |key: &str, value: f64, limit: f64, unit: &str| {
            if value.abs() <= limit {
                return Ok(Prescribed::ForceRatio(value / limit));
            }
            let reason = format!("{value}{unit} is beyond the friction limit of {limit}{unit}");
            Err(Refusal::new(key, reason, format!("write less than {limit}{unit} in magnitude")))
        };
        let friction = scene.friction_coefficient;
        match scene.drive {
            Drive::TractionCoefficient(value) => {
                within("motion.traction_coefficient", value, friction, "")
            }
            Drive::TangentialForce(value) => {
                within("motion.tangential_force", value, friction * self.normal_force, " N")
            }
            Drive::Creepage { xi, eta, phi } => Ok(Prescribed::Creepage { xi, eta, phi }),
            Drive::Shift(_) => Err(Refusal::new(
                "motion.shift",
                "bodies that roll have creepages; a shift is for bodies that do not roll",
                format!("write motion.creepage, or {SPEED} = 0"),
            )),
        }
    }

    /// Returns a remark if the given ellipse replaces the load of the case.
    pub(crate) fn remark(&self, scene: &Scene) -> Option<String> {
        // Smallest relative difference that is visible in printed numbers.
        const VISIBLE: f64 = 1e-6;
        if self.approach.is_some() {
            return None;
        }
        let force = self.normal_force;
        let replaced = match scene.load {
            Load::NormalForce(asked) if (force / asked - 1.0).abs() <= VISIBLE => return None,
            Load::NormalForce(asked) => {
                format!("{asked} of load.normal_force", asked = quantity(asked, "N", 7))
            }
            Load::Approach(asked) => {
                format!("{asked} of load.approach", asked = quantity(asked, "m", 7))
            }
        };
        Some(format!(
            "the ellipse given under [contact] carries {force}, which replaces the {replaced}",
            force = quantity(force, "N", 7)
        ))
    }

    /// Strips of the patch on a grid that covers it.
    pub(crate) fn strips(&self, grid: Structured) -> Strips {
        let Self { semi_axis_a: a, semi_axis_b: b, .. } = *self;
        if self.line { Strips::of_line(a, b, grid) } else { Strips::new(a, b, grid) }
    }

    /// Area [m²].
    fn area(&self) -> f64 {
        let shape = if self.line { 4.0 } else { PI };
        shape * self.semi_axis_a * self.semi_axis_b
    }

    /// Writes the element means of the Hertz pressure [Pa].
    pub(crate) fn write_pressure(&self, grid: Structured, means: &mut [f64]) {
        let strips = self.strips(grid);
        let (density, amplitude) = (SemiEllipse, self.max_pressure);
        let lateral = Lateral::Elliptic;
        strips.write_means(&StripField { density, amplitude, lateral }, means);
    }

    /// Writes the share of every element that lies in the ellipse.
    pub(crate) fn write_touching(&self, grid: Structured, shares: &mut [f64]) {
        let density = SlidingSlip { creep: 1.0, gradient: 0.0 };
        let field = StripField { density, amplitude: 1.0, lateral: Lateral::Constant };
        self.strips(grid).write_means(&field, shares);
    }

    /// Summary quantities that are known in closed form.
    pub(crate) fn closed_forms(&self) -> BTreeMap<String, f64> {
        let known = [
            ("semi_axis_a_m", Some(self.semi_axis_a)),
            ("semi_axis_b_m", Some(self.semi_axis_b)),
            ("max_pressure_pa", Some(self.max_pressure)),
            ("approach_m", self.approach),
        ];
        let keyed = |(key, value): (&str, Option<f64>)| Some((format!("contact.{key}"), value?));
        known.into_iter().filter_map(keyed).collect()
    }

    /// Part of the section `contact` of `summary.json` that describes the ellipse.
    pub(crate) fn summary(&self) -> Value {
        let mut contact = json!({
            "semi_axis_a_m": self.semi_axis_a,
            "semi_axis_b_m": self.semi_axis_b,
            "area_m2": self.area(),
            "max_pressure_pa": self.max_pressure,
            "normal_force_n": self.normal_force,
        });
        if let Some(approach) = self.approach {
            contact["approach_m"] = approach.into();
        }
        contact
    }
}

impl fmt::Display for Ellipse {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [a, b] = [self.semi_axis_a, self.semi_axis_b].map(|axis| 1e3 * axis);
        let pressure = 1e-6 * self.max_pressure;
        match self.line {
            true => write!(
                f,
                "line contact a = {a:.4} mm, {:.4} mm wide, p0 = {pressure:.2} MPa",
                2.0 * b
            ),
            false => {
                write!(f, "contact ellipse a = {a:.4} mm, b = {b:.4} mm, p0 = {pressure:.2} MPa")
            }
        }
    }
}

/// Key of the prescribed load, which determines the size of the contact.
fn load_key(scene: &Scene) -> &'static str {
    match scene.load {
        Load::NormalForce(_) => NORMAL_FORCE,
        Load::Approach(_) => APPROACH,
    }
}

/// Suggested fix if the bodies touch along a line: along y, or along x.
const LINE_FIX: [&str; 2] = [
    "write a radius similar to the other radii; or remove it, and write contact.width for a line contact (half-space, hertz-carter)",
    "write a radius similar to the other radii",
];

/// Refuses bodies that touch along a line, or that conform, and so have no contact ellipse.
fn refuse_open_ellipse(scene: &Scene, gap_x: f64, gap_y: f64) -> Result<(), Refusal> {
    // Smallest ratio of the gap coefficients; the semi-axes then have a ratio of about a million.
    const FLATTEST: f64 = 1e-12;
    let [along, across] = [gap_y <= FLATTEST * gap_x, gap_x <= FLATTEST * gap_y];
    if !along && !across {
        return Ok(());
    }
    let name = if along { "radius_y" } else { "radius_x" };
    let radii = scene.bodies.map(|body| if along { body.radius_y } else { body.radius_x });
    let hollow = (0..2).find(|body| radii[*body] < 0.0);
    let Some(hollow) = hollow else {
        let finite = (0..2).find(|body| radii[*body].is_finite());
        return Err(Refusal::new(
            &scene.names.key(finite.unwrap_or(if along { LOWER } else { UPPER }), name),
            "makes the contact a line, not an ellipse",
            LINE_FIX[usize::from(!along)],
        ));
    };
    let other = radii[1 - hollow];
    let reason = format!(
        "`{}` is at least as concave as `{}` is convex: there is no closed elliptic contact",
        scene.names.0[hollow],
        scene.names.0[1 - hollow]
    );
    // A concave body touches a flat or concave one only at its rim.
    let fix = match other.is_finite() {
        true if other > 0.0 => format!("write a value below -{other} m, or above 0 m"),
        true => format!("write a value above 0 m and below {} m", -other),
        false => "write a value above 0 m".to_owned(),
    };
    Err(Refusal::new(&scene.names.key(hollow, name), reason, fix))
}
