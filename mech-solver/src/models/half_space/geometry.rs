//! The grid on which the bodies touch.
//!
//! Its extent is Hertz's for radii. For profiles a coarse grid finds the contact, wherever the gap closes
//! ([`fit_grid`]), and the origin lies at the centre of pressure.

use super::gap::Gap;
use crate::case::difference;
use crate::case::ellipse::{Ellipse, Extent};
use crate::case::keys::CheckedParams;
use crate::case::resolution::RESOLUTION;
use crate::case::scene::{Load, Scene, WIDTH};
use crate::case::shape;
use crate::terms::{Kind, Terms};
use half_space::difference::Difference;
use half_space::extent::{Fitted, Moments, fit_grid};
use half_space::normal::{NormalError, Prescribed};
use half_space::patches::{Patch, patches};
use half_space::retarded::Delay;
use half_space::viscoelastic::Bodies;
use proto::configuration::{Configuration, Refusal};
use proto::description::KeySpec;
use proto::grid::Structured;

/// More elements are refused: operators and Krylov space would take tens of gigabytes.
const MOST_ELEMENTS: usize = 4_000_000;
/// Free elements round a contact whose extent is known in closed form: the trailing edge's passages
/// need one.
const MARGIN: f64 = 1.0;
/// Positions of a grid, over an element, that are tried.
const POSITIONS: u32 = 64;
/// Elements along the estimated radius of a contact of profiles, when its extent is looked for.
const COARSE: f64 = 12.0;
/// Free elements of that coarse grid round the contact.
const COARSE_MARGIN: f64 = 2.0;
/// Growth of the grid for a rough contact, which is wider than the smooth one.
const ROUGH_GROWTH: f64 = 1.25;
/// Growth across for profiles that wear, whose contact widens.
const WORN_GROWTH: f64 = 1.6;
/// Growth of the grid for different bodies, whose contact the tractions shift.
const COUPLED_GROWTH: f64 = 1.4;
/// Elements of the coarse grid at most.
const MOST_COARSE_ELEMENTS: usize = 200_000;
/// Rows across every patch of the coarse grid: its size is then known to a few per cent.
const COARSE_ROWS: usize = 6;
/// By how much the rows of the coarse grid are made narrower.
const NARROWER: f64 = 3.0;
/// Share of the load from which on a patch counts.
const PATCH_SHARE: f64 = 0.01;
/// Rows across half of the narrowest patch, unless the case says otherwise.
const LEAST_ROWS: f64 = 5.0;
/// Elements up to which a grid is made finer for its narrowest patch without being asked.
const MOST_RESOLVED: f64 = 400_000.0;

const LATERAL_RESOLUTION: &str = "mech.lateral_resolution";

/// The keys that shapes and grid are read from besides the scene's.
pub(super) fn keys() -> Vec<KeySpec> {
    let mut keys = shape::keys();
    keys.push(
        KeySpec::integer(
            LATERAL_RESOLUTION,
            "elements per semi-axis b, that of the narrowest patch: dy = b/lateral_resolution; \
             absent: dy = dx, or less where a patch is narrow",
        )
        .at_least(1.0)
        .at_most(2000.0),
    );
    keys
}

/// Where the contact is solved.
#[derive(Clone, Debug)]
pub(in crate::models) struct Footprint {
    /// The undeformed distance; `None` where the case gives the pressure.
    pub(in crate::models) gap: Option<Gap>,
    /// Hertz's or the given ellipse, where the contact is one.
    pub(in crate::models) ellipse: Option<Ellipse>,
    /// Semi-axes, or what comes near them [m].
    pub(in crate::models) semi_axes: [f64; 2],
    pub(in crate::models) grid: Structured,
    /// Lateral place of the highest pressure, where that is not the origin [m].
    pub(in crate::models) peak_y: Option<f64>,
    /// What was done to the shapes, and what the grid does not resolve.
    pub(in crate::models) remarks: Vec<String>,
}

/// What touches.
#[derive(Clone, Copy)]
pub(in crate::models) struct Shapes<'a> {
    pub(in crate::models) scene: &'a Scene,
    /// The ellipse that the case gives.
    pub(in crate::models) given: Option<Ellipse>,
    /// That of all contacts of a case whose values vary.
    pub(in crate::models) extent: Option<&'a Extent>,
    pub(in crate::models) bodies: &'a Bodies,
    /// What they gain with time where they do not roll.
    pub(in crate::models) delays: &'a [Delay],
    /// Those of the gap change the shapes.
    pub(in crate::models) terms: &'a Terms,
    /// Elements per semi-axis.
    pub(in crate::models) resolution: usize,
}

/// Finds the extent of the contact and lays a grid over it.
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
    let dx = |a: f64| a / resolution as f64;
    let second_order =
        scene.speeds.rolling > 0.0 && difference::read(&configuration.case)? == Difference::Fromm;
    let mut gap = Gap::read(configuration, scene)?;
    refuse_in_plane(scene, &gap, lateral.is_some())?;
    let rough = !terms.leave_hertz();
    if let Some(effect) = terms.effect_of(Kind::Retardation) {
        if !gap.is_quadric() {
            return Err(Refusal::new(
                &format!("effects.{effect}"),
                "the contact of measured profiles is not looked for on bodies whose compliance grows",
                "give radii, or remove the effect",
            ));
        }
        if bodies.remember() {
            return delayed_footprint(gap, shapes, lateral);
        }
    }
    if given.is_some() || gap.is_quadric() {
        if given.is_some() && (rough || !gap.is_quadric()) {
            let reason = "a given pressure leaves no room for profiles or effects that change it";
            return Err(Refusal::new("contact", reason, "remove [contact], or the others"));
        }
        let ellipse = given.map_or_else(|| Ellipse::solve(scene, None), Ok)?;
        let extent = extent.copied().unwrap_or_else(|| ellipse.extent());
        let extent = extent.grown(growth(shapes, extent.line));
        let semi_axes = [extent.a, extent.b];
        let dx = dx(extent.finest);
        let dy = match (extent.line, lateral) {
            (true, _) => 2.0 * extent.b,
            (false, Some(count)) => semi_axes[1] / count,
            (false, None) => dx,
        };
        let growth = match (rough, bodies.are_coupled()) {
            (_, true) => COUPLED_GROWTH,
            (true, false) => ROUGH_GROWTH,
            (false, false) => 1.0,
        };
        let reach = |semi_axis: f64, side: f64| {
            let elements = growth * semi_axis / side;
            [-elements, elements].map(|end| end + end.signum() * (MARGIN - 0.5))
        };
        let wider = if terms.removal.is_some() { WORN_GROWTH } else { 1.0 };
        let across = if extent.line { [0.0; 2] } else { reach(wider * semi_axes[1], dy) };
        let mut smooth_grid = lay([reach(semi_axes[0], dx), across], [dx, dy])?;
        if second_order {
            align(&mut smooth_grid, semi_axes.map(|axis| axis * extent.finest / semi_axes[0]));
        }
        let (grid, peak_y) = match rough {
            true => {
                let fitted = fit(&gap, shapes, smooth_grid)?;
                (fitted.grid, Some(highest(&fitted)))
            }
            false => (smooth_grid, None),
        };
        let gap = given.is_none().then_some(gap);
        let (ellipse, remarks) = (Some(ellipse), Vec::new());
        return Ok(Footprint { gap, ellipse, semi_axes, grid, peak_y, remarks });
    }
    let low = gap.settle()?;
    let coarse = coarse_contact(&gap, low, scene, bodies)?;
    let mut remarks = gap.remarks(&coarse);
    let Moments { centre, semi_axes } = Moments::of(&coarse.grid, &coarse.pressure);
    gap.origin += centre[1];
    let dx = dx(semi_axes[0]);
    let [x_range, y_range] = bounds(&coarse);
    let growth = if bodies.are_coupled() { COUPLED_GROWTH } else { 1.0 };
    let elements = |range: [f64; 2], side: f64| range.map(|end| growth * end / side);
    let wider = if terms.removal.is_some() { WORN_GROWTH } else { 1.0 };
    let y_range = y_range.map(|y| wider * (y - centre[1]));
    let area = growth * growth * (x_range[1] - x_range[0]) * (y_range[1] - y_range[0]);
    let dy = row_width(&coarse, dx, lateral, area, &mut remarks);
    let mut grid = lay([elements(x_range, dx), elements(y_range, dy)], [dx, dy])?;
    let mut peak_y = highest(&coarse) - centre[1];
    if rough {
        let fitted = fit(&gap, shapes, grid)?;
        (grid, peak_y) = (fitted.grid, highest(&fitted));
    }
    let (gap, peak_y) = (Some(gap), Some(peak_y));
    Ok(Footprint { gap, ellipse: None, semi_axes, grid, peak_y, remarks })
}

/// Refuses what varies across, of bodies that touch along a line.
fn refuse_in_plane(scene: &Scene, gap: &Gap, rows: bool) -> Result<(), Refusal> {
    let line = "bodies that touch along a line are the same all over their width";
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

/// That of bodies that roll and whose compliance grows: a coarse grid, round the contact of elastic ones at once, finds how far theirs reaches and leans.
fn delayed_footprint(
    gap: Gap,
    shapes: &Shapes<'_>,
    lateral: Option<f64>,
) -> Result<Footprint, Refusal> {
    let Shapes { scene, bodies, terms, resolution, .. } = *shapes;
    let ellipse = Ellipse::solve(scene, None)?;
    let growth = bodies.relaxed().contact_compliance() / bodies.instantaneous.contact_compliance();
    let growth = growth.cbrt();
    // The grid grows to where they touch.
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
    let (gap, remarks) = (Some(gap), Vec::new());
    Ok(Footprint { gap, ellipse: None, semi_axes, grid, peak_y, remarks })
}

/// By how much a contact under a load grows in time without end, over its size at once.
fn growth(shapes: &Shapes<'_>, line: bool) -> f64 {
    let at_once = shapes.bodies.instantaneous.contact_compliance();
    let gained = shapes.delays.iter().map(|delay| delay.elasticity.contact_compliance());
    let compliance = 1.0 + gained.sum::<f64>() / at_once;
    if line { compliance.sqrt() } else { compliance.cbrt() }
}

/// Lateral place of the highest pressure [m].
fn highest(fitted: &Fitted) -> f64 {
    let pressures = fitted.pressure.iter().enumerate();
    let highest = pressures.max_by(|a, b| a.1.total_cmp(b.1)).map_or(0, |(at, _)| at);
    fitted.grid.y(highest / fitted.grid.ni)
}

/// Width of the rows that resolves the narrowest patch, as the case says or with at least
/// [`LEAST_ROWS`] for its half width; on a grid over this area [m²] that would become very large,
/// with fewer. Remarks on what is not resolved.
fn row_width(
    coarse: &Fitted,
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
    let resolved = narrowest / LEAST_ROWS;
    let dy = dx.min(resolved.max(area / (dx * MOST_RESOLVED)));
    if dy > resolved {
        let rows = 2.0 * narrowest / dy;
        remarks.push(format!(
            "the narrowest patch is {rows:.1} rows across: set mech.lateral_resolution to resolve \
             it, at the price of a large grid"
        ));
    }
    dy
}

/// The patches that carry more than a hundredth of the load.
fn of_weight(fitted: &Fitted) -> impl Iterator<Item = Patch> {
    let found = patches(&fitted.grid, &fitted.pressure);
    let all: f64 = found.iter().map(|patch| patch.sum).sum();
    found.into_iter().filter(move |patch| patch.sum > PATCH_SHARE * all)
}

/// Moves a grid along x by a part of an element, so that the leading edge of an ellipse falls
/// between two elements in the mean over the rows, weighted by the square of their chords.
///
/// With the second-order difference nearly all that is left of the error of the forces is due to
/// where elements end: it is proportional to that mean (correlation 0.96 to 0.99 over 32 positions
/// of the grid at a/7 to a/20; docs/theory/half-space.md).
fn align(grid: &mut Structured, [a, b]: [f64; 2]) {
    let dx = grid.dx();
    let chords: Vec<f64> = match grid.nj {
        1 => vec![a],
        rows => {
            let chord = |j: usize| a * (1.0 - (grid.y(j) / b).powi(2)).max(0.0).sqrt();
            (0..rows).map(chord).filter(|chord| *chord > 0.0).collect()
        }
    };
    // How far the edge is beyond the end of the nearest element, in elements.
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
pub(in crate::models) fn prescribed(load: Load) -> Prescribed {
    match load {
        Load::NormalForce(force) => Prescribed::Load(force),
        Load::Approach(approach) => Prescribed::Approach(approach),
    }
}

fn fit(gap: &Gap, shapes: &Shapes<'_>, grid: Structured) -> Result<Fitted, Refusal> {
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

/// The contact of profiles on a coarse grid round the first touch, of which `low` is the lowest place
/// [m], and wherever else the gap closes; its rows are as narrow as its narrowest patch needs.
fn coarse_contact(gap: &Gap, low: f64, scene: &Scene, bodies: &Bodies) -> Result<Fitted, Refusal> {
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
        // Where to begin; the grid grows to wherever the gap closes.
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
            "raise the load, or give the profiles as far as the contact that matters reaches",
        ),
        error => refused(error),
    }
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
