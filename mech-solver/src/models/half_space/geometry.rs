//! Grid of the contact.
//!
//! For bodies given by radii, its extent is that of the Hertzian contact. For profiles, a coarse
//! grid locates the contact wherever the gap closes ([`fit_grid`]), and the origin is placed at the
//! centre of pressure.

use super::drive::Driven;
use super::gap::Gap;
use super::spacing::{Patch as SlippingPatch, Zone};
use crate::case::difference;
use crate::case::ellipse::{Ellipse, Extent};
use crate::case::keys::CheckedParams;
use crate::case::resolution::RESOLUTION;
use crate::case::scene::{Load, Scene, WIDTH};
use crate::case::shape;
use crate::terms::{Kind, Terms};
use half_space::difference::Difference;
use half_space::extent::{FittedContact, Moments, fit_grid};
use half_space::normal::{NormalError, Prescribed};
use half_space::patches::{Patch, patches};
use half_space::retarded::Delay;
use half_space::viscoelastic::Bodies;
use proto::configuration::{Configuration, Refusal};
use proto::description::KeySpec;
use proto::grid::Structured;
use proto::readable::number;
use std::f64::consts::{PI, TAU};

/// Maximum number of elements; beyond it operators and Krylov space would take tens of gigabytes.
const MOST_ELEMENTS: usize = 4_000_000;
/// Free elements around a contact of known closed-form extent; the passages at the trailing edge
/// need one.
const MARGIN: f64 = 1.0;
/// Difference from a whole number of elements that is rounding.
const WHOLE: f64 = 1e-6;
/// Number of grid offsets tried within one element.
const POSITIONS: u32 = 64;
/// Elements per estimated contact radius on the coarse grid that locates a contact of profiles.
const COARSE: f64 = 12.0;
/// Free elements of the coarse grid around the contact.
const COARSE_MARGIN: f64 = 2.0;
/// Growth of the grid for a rough contact, which is wider than the smooth one.
const ROUGH_GROWTH: f64 = 1.25;
/// Lateral growth of the grid for wearing profiles, whose contact widens.
const WORN_GROWTH: f64 = 1.6;
/// Growth of the grid for bodies of different elastic constants, whose contact is shifted by
/// tractions.
const COUPLED_GROWTH: f64 = 1.4;
/// Maximum number of elements of the coarse grid.
const MOST_COARSE_ELEMENTS: usize = 200_000;
/// Minimum number of rows across every patch of the coarse grid; the patch size is then known to a
/// few per cent.
const COARSE_ROWS: usize = 6;
/// Refinement factor of the rows of the coarse grid.
const NARROWER: f64 = 3.0;
/// Minimum share of the load for a patch to count.
const PATCH_SHARE: f64 = 0.01;
/// Default number of rows across half of the narrowest patch.
const LEAST_ROWS: f64 = 5.0;
/// Ratio b/a of the semi-axes below which an ellipse is narrow. With a difference of second order
/// it has as many rows per semi-axis b as there are elements in this share of a. On square elements
/// its rows make most of the error, which hardly falls with n.
const NARROW: f64 = 0.5;
/// Maximum number of elements up to which the grid is refined automatically for its narrowest
/// patch.
const MOST_RESOLVED: f64 = 400_000.0;

const LATERAL_RESOLUTION: &str = "mech.lateral_resolution";

/// Keys of shapes and grid, in addition to those of the scene.
pub(super) fn keys() -> Vec<KeySpec> {
    let mut keys = shape::keys();
    keys.push(
        KeySpec::integer(
            LATERAL_RESOLUTION,
            "elements per semi-axis b of the narrowest patch: dy = b/lateral_resolution; \
             absent: dy = dx, or less if a patch is narrow",
        )
        .at_least(1.0)
        .at_most(2000.0),
    );
    keys
}

/// Region in which the contact is solved, and its grid.
#[derive(Clone, Debug)]
pub(in crate::models) struct Footprint {
    /// Undeformed distance; `None` if the case gives the pressure.
    pub(in crate::models) gap: Option<Gap>,
    /// Hertzian or given ellipse, if the contact is elliptic.
    pub(in crate::models) ellipse: Option<Ellipse>,
    /// Semi-axes, or equivalent values for other contacts [m].
    pub(in crate::models) semi_axes: [f64; 2],
    /// Semi-axes of the smallest ellipse if values vary, otherwise of the ellipse [m].
    pub(in crate::models) smallest: [f64; 2],
    /// Expected half lengths of the slip zone along x and y [m], where known before the solve.
    pub(in crate::models) slips: Option<[f64; 2]>,
    pub(in crate::models) grid: Structured,
    /// Lateral position of the maximum pressure, if it is not the origin [m].
    pub(in crate::models) peak_y: Option<f64>,
    /// Remarks on modifications of the shapes and on unresolved patches.
    pub(in crate::models) remarks: Vec<String>,
}

/// Shapes and bodies from which the grid of the contact is determined.
#[derive(Clone, Copy)]
pub(in crate::models) struct Shapes<'a> {
    pub(in crate::models) scene: &'a Scene,
    /// Ellipse given by the case.
    pub(in crate::models) given: Option<Ellipse>,
    /// Extent of all contacts of a case whose values vary.
    pub(in crate::models) extent: Option<&'a Extent>,
    pub(in crate::models) bodies: &'a Bodies,
    /// Delayed compliances of bodies that do not roll.
    pub(in crate::models) delays: &'a [Delay],
    /// Active effects; those of the gap change the shapes.
    pub(in crate::models) terms: &'a Terms,
    /// Elements per semi-axis.
    pub(in crate::models) resolution: usize,
    /// True if the elements are shorter along x where the slip zone is.
    pub(in crate::models) follows_slip: bool,
}

impl Shapes<'_> {
    /// Contact whose slip zone sets the length of the elements.
    fn patch(&self, semi_axes: [f64; 2], line: bool, normal_force: f64) -> SlippingPatch<'_> {
        let [a, b] = semi_axes;
        let equivalent = a * b * if line { PI } else { TAU / 3.0 };
        SlippingPatch {
            semi_axes,
            line,
            normal_force,
            max_pressure: normal_force / equivalent,
            friction_coefficient: self.scene.friction_coefficient,
            bodies: self.bodies,
        }
    }
}

/// Finds the extent of the contact and covers it with a grid.
pub(in crate::models) fn footprint(
    configuration: &Configuration,
    shapes: &Shapes<'_>,
) -> Result<Footprint, Refusal> {
    let Shapes { scene, given, extent, bodies, terms, resolution, .. } = *shapes;
    let case = CheckedParams::new(&configuration.case, keys());
    let lateral = match case.has(LATERAL_RESOLUTION) {
        true => Some(case.integer(LATERAL_RESOLUTION)? as f64),
        false => None,
    };
    let side = |a: f64| a / resolution as f64;
    let second_order =
        scene.speeds.rolling > 0.0 && difference::read(&configuration.case)? == Difference::Fromm;
    let mut gap = Gap::read(configuration, scene)?;
    refuse_in_plane(scene, &gap, lateral.is_some())?;
    let rough = !terms.leave_hertz();
    if let Some(effect) = terms.effect_of(Kind::Retardation) {
        if !gap.is_quadric() {
            return Err(Refusal::new(
                &format!("effects.{effect}"),
                "the contact of measured profiles is not supported for bodies whose compliance grows",
                "give radii, or remove the effect",
            ));
        }
        if bodies.remember() {
            return delayed_footprint(gap, shapes, lateral);
        }
    }
    if given.is_some() || gap.is_quadric() {
        if given.is_some() && (rough || !gap.is_quadric()) {
            let reason = "a given pressure excludes profiles and effects that change it";
            return Err(Refusal::new("contact", reason, "remove [contact], or the others"));
        }
        let ellipse = given.map_or_else(|| Ellipse::solve(scene, None), Ok)?;
        let extent = extent.copied().unwrap_or_else(|| ellipse.extent());
        let extent = extent.grown(growth(shapes, extent.line));
        let semi_axes = [extent.a, extent.b];
        let side = side(extent.finest);
        let area = 4.0 * semi_axes[0] * semi_axes[1];
        let mut remarks = Vec::new();
        let dy = match (extent.line, lateral) {
            (true, _) => 2.0 * extent.b,
            (false, Some(count)) => semi_axes[1] / count,
            (false, None) if semi_axes[1] < NARROW * semi_axes[0] => {
                let along = if second_order { NARROW * semi_axes[0] / side } else { 0.0 };
                resolving_rows(semi_axes[1], along.max(LEAST_ROWS), side, area, &mut remarks)
            }
            // Others have as many rows as the case asks for.
            (false, None) => side,
        };
        let patch = shapes.patch(semi_axes, ellipse.line, ellipse.normal_force);
        let zone = slip_zone(configuration, shapes, &patch)?;
        let dx = along(shapes, zone, [semi_axes[0], side, dy], area);
        let growth = match (rough, bodies.are_coupled()) {
            (_, true) => COUPLED_GROWTH,
            (true, false) => ROUGH_GROWTH,
            (false, false) => 1.0,
        };
        let reach = |semi_axis: f64, length: f64, margin: f64| {
            let elements = growth * semi_axis / length;
            [-elements, elements].map(|end| end + end.signum() * margin)
        };
        let wider = if terms.removal.is_some() { WORN_GROWTH } else { 1.0 };
        // An aligned grid and its rows move by up to half an element each. The rows limit the
        // accuracy of the extent along x.
        let ahead = match second_order {
            true => MARGIN - WHOLE + 0.5 * (side / dx - 1.0),
            false => MARGIN - 0.5,
        };
        let across =
            if extent.line { [0.0; 2] } else { reach(wider * semi_axes[1], dy, MARGIN - 0.5) };
        let mut smooth_grid = lay([reach(semi_axes[0], dx, ahead), across], [dx, dy])?;
        let smallest = semi_axes.map(|axis| axis * extent.finest / semi_axes[0]);
        if second_order {
            align(&mut smooth_grid, smallest);
        }
        let (grid, peak_y) = match rough {
            true => {
                let fitted = fit(&gap, shapes, smooth_grid)?;
                (fitted.grid, Some(highest(&fitted)))
            }
            false => (smooth_grid, None),
        };
        let gap = given.is_none().then_some(gap);
        let ellipse = Some(ellipse);
        let slips = patch.slips(zone);
        return Ok(Footprint { gap, ellipse, semi_axes, smallest, slips, grid, peak_y, remarks });
    }
    let low = gap.settle()?;
    let coarse = coarse_contact(&gap, low, scene, bodies)?;
    let mut remarks = gap.remarks(&coarse);
    let Moments { centre, semi_axes } = Moments::of(&coarse.grid, &coarse.pressure);
    gap.origin += centre[1];
    let side = side(semi_axes[0]);
    let [x_range, y_range] = bounds(&coarse);
    let growth = if bodies.are_coupled() { COUPLED_GROWTH } else { 1.0 };
    let elements = |range: [f64; 2], side: f64| range.map(|end| growth * end / side);
    let wider = if terms.removal.is_some() { WORN_GROWTH } else { 1.0 };
    let y_range = y_range.map(|y| wider * (y - centre[1]));
    let area = growth * growth * (x_range[1] - x_range[0]) * (y_range[1] - y_range[0]);
    let dy = row_width(&coarse, side, lateral, area, &mut remarks);
    let normal_force = coarse.pressure.iter().sum::<f64>() * coarse.grid.element_area();
    let patch = shapes.patch(semi_axes, false, normal_force);
    let zone = slip_zone(configuration, shapes, &patch)?;
    let dx = along(shapes, zone, [semi_axes[0], side, dy], area);
    let mut grid = lay([elements(x_range, dx), elements(y_range, dy)], [dx, dy])?;
    let mut peak_y = highest(&coarse) - centre[1];
    if rough {
        let fitted = fit(&gap, shapes, grid)?;
        (grid, peak_y) = (fitted.grid, highest(&fitted));
    }
    let (gap, peak_y) = (Some(gap), Some(peak_y));
    let (smallest, slips) = (semi_axes, patch.slips(zone));
    Ok(Footprint { gap, ellipse: None, semi_axes, smallest, slips, grid, peak_y, remarks })
}

/// Slip zone, where it is known before the solve: the whole contact, or that of a steady contact.
fn slip_zone(
    configuration: &Configuration,
    shapes: &Shapes<'_>,
    patch: &SlippingPatch<'_>,
) -> Result<Option<Zone>, Refusal> {
    let Shapes { scene, given, terms, follows_slip, .. } = shapes;
    if !terms.adhesion || scene.slides() {
        return Ok(Some(Zone::WHOLE));
    }
    if !follows_slip {
        return Ok(None);
    }
    let driven = Driven::read(configuration, scene, given.as_ref(), None, true)?;
    Ok(patch.slip_zone(&driven))
}

/// Length of the elements along x [m]: that of elements of a grid as fine as the case asks for, or
/// a whole part of the semi-axis `a` where the slip zone is short. A grid over this area [m²] does
/// not become too large.
fn along(shapes: &Shapes<'_>, zone: Option<Zone>, [a, side, dy]: [f64; 3], area: f64) -> f64 {
    let Some(zone) = zone.filter(|_| shapes.follows_slip) else { return side };
    let wanted = side.min((area / (dy * MOST_RESOLVED)).max(side * zone.share()));
    if wanted < side { a / (a / wanted - WHOLE).ceil() } else { side }
}

/// Refuses lateral variation for bodies in line contact.
fn refuse_in_plane(scene: &Scene, gap: &Gap, rows: bool) -> Result<(), Refusal> {
    let line = "bodies that touch along a line are uniform across their width";
    match scene.width {
        Some(_) if !gap.is_quadric() => Err(Refusal::new(
            WIDTH,
            format!("excludes `{}`: {line}", gap.profile_key()),
            "keep one of them",
        )),
        Some(_) if rows => Err(Refusal::new(
            LATERAL_RESOLUTION,
            format!("excludes `{WIDTH}`: {line}"),
            "keep one of them",
        )),
        _ => Ok(()),
    }
}

/// Footprint of rolling bodies whose compliance grows. A coarse grid around the contact with the
/// instantaneous compliance finds how far their contact extends and how it shifts along x.
fn delayed_footprint(
    gap: Gap,
    shapes: &Shapes<'_>,
    lateral: Option<f64>,
) -> Result<Footprint, Refusal> {
    let Shapes { scene, bodies, terms, resolution, .. } = *shapes;
    let ellipse = Ellipse::solve(scene, None)?;
    let growth = bodies.relaxed().contact_compliance() / bodies.instantaneous.contact_compliance();
    let growth = growth.cbrt();
    // `fit_grid` extends this grid as far as the bodies touch.
    let count = (COARSE * growth).min(0.4 * (MOST_COARSE_ELEMENTS as f64).sqrt());
    let [along, across] =
        [ellipse.semi_axis_a, ellipse.semi_axis_b].map(|semi_axis| growth * semi_axis / count);
    let one_row = ellipse.line.then_some(2.0 * ellipse.semi_axis_b);
    let rows = if ellipse.line { [0.0; 2] } else { [-count, count] };
    let grid = lay([[-count, count], rows], [along, one_row.unwrap_or(across)])?;
    let smooth = |x: f64, y: f64| gap.distance(x, y);
    let load = prescribed(scene.load);
    let everywhere = [f64::NEG_INFINITY, f64::INFINITY];
    let coarse =
        fit_grid(grid, bodies, &smooth, load, everywhere, MOST_COARSE_ELEMENTS, f64::INFINITY)
            .map_err(refused)?;
    let Moments { semi_axes, .. } = Moments::of(&coarse.grid, &coarse.pressure);
    let [x_range, y_range] = bounds(&coarse);
    let dx = semi_axes[0] / resolution as f64;
    let dy = one_row.unwrap_or(lateral.map_or(dx, |count| semi_axes[1] / count));
    let wide = if bodies.are_coupled() { COUPLED_GROWTH } else { 1.0 };
    let worn = if terms.removal.is_some() { WORN_GROWTH } else { 1.0 };
    let along =
        x_range.map(|end| end / dx + end.signum() * (1.0 + (wide - 1.0) * semi_axes[0] / dx));
    let across = match one_row {
        Some(_) => [0.0; 2],
        None => y_range.map(|end| wide * worn * end / dy),
    };
    let mut grid = lay([along, across], [dx, dy])?;
    let mut peak_y = None;
    if !terms.leave_hertz() {
        let fitted = fit(&gap, shapes, grid)?;
        (grid, peak_y) = (fitted.grid, Some(highest(&fitted)));
    }
    let (gap, remarks, smallest) = (Some(gap), Vec::new(), semi_axes);
    let (ellipse, slips) = (None, None);
    Ok(Footprint { gap, ellipse, semi_axes, smallest, slips, grid, peak_y, remarks })
}

/// Ratio of the final size of a contact under constant load to its instantaneous size.
fn growth(shapes: &Shapes<'_>, line: bool) -> f64 {
    let at_once = shapes.bodies.instantaneous.contact_compliance();
    let gained = shapes.delays.iter().map(|delay| delay.elasticity.contact_compliance());
    let compliance = 1.0 + gained.sum::<f64>() / at_once;
    if line { compliance.sqrt() } else { compliance.cbrt() }
}

/// Lateral position of the maximum pressure [m].
fn highest(fitted: &FittedContact) -> f64 {
    let pressures = fitted.pressure.iter().enumerate();
    let highest = pressures.max_by(|a, b| a.1.total_cmp(b.1)).map_or(0, |(at, _)| at);
    fitted.grid.y(highest / fitted.grid.ni)
}

/// Row width that resolves the narrowest patch: as the case prescribes, otherwise at least
/// [`LEAST_ROWS`] across its half width. Fewer rows are used if a grid over this area [m²] would
/// become too large. Adds remarks on unresolved patches.
fn row_width(
    coarse: &FittedContact,
    dx: f64,
    lateral: Option<f64>,
    area: f64,
    remarks: &mut Vec<String>,
) -> f64 {
    let patches: Vec<Patch> = of_weight(coarse).collect();
    let least = |axis: usize| {
        patches.iter().map(|p| p.moments.semi_axes[axis]).fold(f64::INFINITY, f64::min)
    };
    let [shortest, narrowest] = [least(0), least(1)];
    if patches.len() > 1 && shortest < LEAST_ROWS * dx {
        let columns = 2.0 * shortest / dx;
        remarks.push(format!(
            "the shortest patch is {columns:.1} elements long: raise mech.resolution to resolve it"
        ));
    }
    if let Some(count) = lateral {
        return narrowest / count;
    }
    resolving_rows(narrowest, LEAST_ROWS, dx, area, remarks)
}

/// Row width that puts at least this number of rows across half of a patch of this semi-axis [m],
/// unless a grid over this area [m²] would become too large. A remark tells of fewer than
/// [`LEAST_ROWS`].
fn resolving_rows(narrowest: f64, rows: f64, dx: f64, area: f64, remarks: &mut Vec<String>) -> f64 {
    let dy = dx.min((narrowest / rows).max(area / (dx * MOST_RESOLVED)));
    if dy > narrowest / LEAST_ROWS {
        let rows = 2.0 * narrowest / dy;
        remarks.push(format!(
            "the narrowest patch is {rows:.1} rows across: set mech.lateral_resolution to resolve \
             it, at the price of a large grid"
        ));
    }
    dy
}

/// Patches that carry more than [`PATCH_SHARE`] of the load.
fn of_weight(fitted: &FittedContact) -> impl Iterator<Item = Patch> {
    let found = patches(&fitted.grid, &fitted.pressure);
    let all: f64 = found.iter().map(|patch| patch.sum).sum();
    found.into_iter().filter(move |patch| patch.sum > PATCH_SHARE * all)
}

/// Moves a grid along x by a fraction of an element, so that the leading edge of an ellipse falls
/// between two elements in the mean over the rows, weighted by the square of their chords.
///
/// Nearly all of the remaining error of the forces, with the second-order difference, is due to the
/// positions of the element edges. It is proportional to that mean (correlation 0.96 to 0.99 over
/// 32 positions of the grid at a/7 to a/20; docs/theory/half-space.md).
fn align(grid: &mut Structured, [a, b]: [f64; 2]) {
    let dx = grid.dx();
    let chords: Vec<f64> = match grid.nj {
        1 => vec![a],
        rows => {
            let chord = |j: usize| a * (1.0 - (grid.y(j) / b).powi(2)).max(0.0).sqrt();
            (0..rows).map(chord).filter(|chord| *chord > 0.0).collect()
        }
    };
    // Distance of the edge beyond the end of the nearest element, in elements.
    let beyond = |shift: f64| -> f64 {
        let ends = |chord: &f64| (chord - grid.x(0)) / dx - 0.5 - shift;
        chords.iter().map(|chord| chord * chord * (ends(chord) - ends(chord).round())).sum()
    };
    let shifts = (1..=POSITIONS).map(|k| {
        let size = f64::from(k / 2) / f64::from(POSITIONS);
        if k % 2 == 0 { size } else { -size }
    });
    let best = shifts.min_by(|one, other| beyond(*one).abs().total_cmp(&beyond(*other).abs()));
    grid.origin[0] += best.unwrap_or(0.0) * dx;
}

/// Returns a grid that covers these ranges, given in elements from the origin, with an element's
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
        format!("makes {elements} elements in all", elements = number(elements, 4)),
        format!(
            "lower it until there are no more than {MOST_ELEMENTS}",
            MOST_ELEMENTS = number(MOST_ELEMENTS as f64, 4)
        ),
    ))
}

/// Prescribed load or approach of the normal problem.
pub(in crate::models) fn prescribed(load: Load) -> Prescribed {
    match load {
        Load::NormalForce(force) => Prescribed::Load(force),
        Load::Approach(approach) => Prescribed::Approach(approach),
    }
}

fn fit(gap: &Gap, shapes: &Shapes<'_>, grid: Structured) -> Result<FittedContact, Refusal> {
    let Shapes { scene, bodies, terms, .. } = *shapes;
    let distance = |x: f64, y: f64| gap.distance(x, y) + terms.height(x, y);
    let within = gap.range().map(|end| end - gap.origin);
    let (load, bound) = (prescribed(scene.load), terms.pressure_bound());
    fit_grid(grid, bodies, &distance, load, within, MOST_ELEMENTS, bound).map_err(refused)
}

fn refused(error: NormalError) -> Refusal {
    let fix = "check the shapes, the load and the units; or lower mech.resolution";
    Refusal::new("load", error.to_string(), fix)
}

/// Solves the contact of profiles on a coarse grid around the first point of contact, and wherever
/// else the gap closes. `low` is the lowest y of the points that touch first [m]. The rows are
/// refined until the narrowest patch is resolved.
fn coarse_contact(
    gap: &Gap,
    low: f64,
    scene: &Scene,
    bodies: &Bodies,
) -> Result<FittedContact, Refusal> {
    let (radius, compliance) =
        (scene.relative_radius_x(), bodies.instantaneous.contact_compliance());
    let estimate = match scene.load {
        Load::NormalForce(force) => (0.75 * force * radius * compliance).cbrt(),
        Load::Approach(approach) => (radius * approach).sqrt(),
    };
    let side = estimate / COARSE;
    let [first, last] = gap.range().map(|end| end - gap.origin);
    let smooth = |x: f64, y: f64| gap.distance(x, y);
    let mut rows = side;
    loop {
        // Starting range; the grid grows to wherever the gap closes.
        let reach = |y: f64| y.clamp(low - 40.0 * estimate, low + 40.0 * estimate) / rows;
        let grid = lay([[-COARSE, COARSE], [reach(first) + 1.0, reach(last) - 1.0]], [side, rows])?;
        let load = prescribed(scene.load);
        let within = [first, last];
        let fitted =
            fit_grid(grid, bodies, &smooth, load, within, MOST_COARSE_ELEMENTS, f64::INFINITY)
                .map_err(|error| no_coarse_contact(gap, error))?;
        let fewest = of_weight(&fitted).map(|patch| patch.row_count()).min();
        let too_many = NARROWER * fitted.grid.points() as f64 > MOST_COARSE_ELEMENTS as f64;
        if too_many || fewest.is_none_or(|rows| rows >= COARSE_ROWS) {
            gap.refuse_steep(&fitted)?;
            return Ok(fitted);
        }
        rows /= NARROWER;
    }
}

fn no_coarse_contact(gap: &Gap, error: NormalError) -> Refusal {
    match error {
        NormalError::EndOfShape | NormalError::GridLimit { .. } => Refusal::new(
            gap.profile_key(),
            "the contact reaches the end of a profile, or the bodies are flat",
            "give profiles that reach farther, or check their lateral_shift and the units",
        ),
        NormalError::FarApart { .. } => Refusal::new(
            gap.profile_key(),
            error.to_string(),
            "raise the load, or limit the profiles to the extent of the relevant contact",
        ),
        error => refused(error),
    }
}

/// Ranges of x and y of the elements in contact, including a margin [m].
fn bounds(fitted: &FittedContact) -> [[f64; 2]; 2] {
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
