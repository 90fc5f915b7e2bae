//! Point of a body at which an equivalent stress is largest, searched over the whole volume.
//!
//! The search starts from two sets of points. The first lies below the elements' centres of a
//! coarse grid with a few hundred loaded elements, whose loads are means over the original
//! elements, at depths from the surface to twice the contact's half size; smooth contacts have
//! their peak there. The second lies below the elements of the largest pressure and the largest
//! traction, at depths of some elements; roughness or friction puts the peak there. From the three
//! highest of these points the search climbs along x, y and depth, in steps that are halved where
//! no neighbour is higher. It uses the original loads near the point and their means farther away.
//! The final stress is computed from all original loads. Next to the surface only the centres of
//! elements count.
//!
//! Deviation from an exhaustive search: a peak is missed if it is narrower than the spacing of the
//! start points and all of them lie beside it.

use super::{Element, Section, SurfaceLoad};
use elastic::Stress;
use grids::Structured;

/// Largest number of loaded elements in the coarse grid.
const COARSE: usize = 400;
/// Depths on the coarse grid, over half the larger side of the loaded rectangle.
const DEPTHS: [f64; 12] = [0.0, 0.03, 0.08, 0.15, 0.25, 0.35, 0.45, 0.6, 0.8, 1.0, 1.4, 2.0];
/// Depths below single elements, over the longer side of an element.
const SHALLOW: [f64; 5] = [0.0, 0.5, 1.0, 2.0, 4.0];
/// Number of points from which the search climbs.
const STARTS: usize = 3;
/// Distance within which original loads are used, in elements of the coarse grid.
const NEAR: f64 = 3.0;
/// Depth, as a share of an element's side, above which stresses are taken at the elements' centres.
/// Between two elements the piecewise constant tractions jump, unlike the real ones, and stresses
/// in the surface are infinite there.
const ON_SURFACE: f64 = 0.5;
/// Last step of the search, over half the larger side of the loaded rectangle.
const LAST_STEP: f64 = 1e-3;

/// A point of a body, and its stress.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Peak {
    /// x, y and depth [m].
    pub place: [f64; 3],
    /// Stress there [Pa].
    pub stress: Stress,
}

impl SurfaceLoad<'_> {
    /// Finds the point with the largest `equivalent` stress, such as [`Stress::von_mises`]; `None`
    /// without load. For a line of contact (a single row), only the middle of the width is
    /// searched.
    #[must_use]
    pub fn peak(&self, poisson_ratio: f64, equivalent: fn(&Stress) -> f64) -> Option<Peak> {
        let extent = Extent::of(self)?;
        let coarse = Coarse::new(self, &extent, poisson_ratio);
        let search =
            Search { load: self, coarse: &coarse, poisson_ratio, equivalent, within: None };
        search.highest(search.starts(extent.size), extent.size)
    }

    /// Finds the peak below each of several patches of elements, under the loads of all patches.
    /// The search of a patch stays within the rectangle of the patch, and starts where the patch's
    /// own loads alone give the highest stress.
    #[must_use]
    pub fn peaks<'b>(
        &self,
        poisson_ratio: f64,
        equivalent: fn(&Stress) -> f64,
        patches: impl Iterator<Item = &'b [usize]>,
    ) -> Vec<Option<Peak>> {
        let Some(whole) = Extent::of(self) else { return patches.map(|_| None).collect() };
        let all = Coarse::new(self, &whole, poisson_ratio);
        let below = |elements: &[usize]| {
            let fields: [Vec<f64>; 3] = std::array::from_fn(|kind| {
                let mut own = vec![0.0; self.grid.points()];
                elements.iter().for_each(|at| own[*at] = self.on_element(*at)[kind]);
                own
            });
            let own = SurfaceLoad { grid: self.grid, fields: fields.each_ref().map(Vec::as_slice) };
            let extent = Extent::of(&own)?;
            let coarse = Coarse::new(&own, &extent, poisson_ratio);
            let alone =
                Search { load: &own, coarse: &coarse, poisson_ratio, equivalent, within: None };
            let within = Some(extent.sides(self.grid));
            let search = Search { load: self, coarse: &all, poisson_ratio, equivalent, within };
            search.highest(alone.starts(extent.size), extent.size)
        };
        patches.map(below).collect()
    }
}

/// Smallest rectangle of elements that contains all loads.
struct Extent {
    /// First and last column.
    columns: [usize; 2],
    rows: [usize; 2],
    /// Number of loaded elements.
    count: usize,
    /// Half the larger side [m].
    size: f64,
}

impl Extent {
    fn of(load: &SurfaceLoad<'_>) -> Option<Self> {
        let grid = load.grid;
        let [mut columns, mut rows] = [[usize::MAX, 0]; 2];
        let mut count = 0;
        for at in (0..grid.points()).filter(|at| load.on_element(*at) != [0.0; 3]) {
            for (range, place) in [(&mut columns, at % grid.ni), (&mut rows, at / grid.ni)] {
                *range = [range[0].min(place), range[1].max(place)];
            }
            count += 1;
        }
        if count == 0 {
            return None;
        }
        let length = |[first, last]: [usize; 2], side: f64| 0.5 * side * (last + 1 - first) as f64;
        let along = length(columns, grid.dx());
        let size = if grid.nj == 1 { along } else { along.max(length(rows, grid.dy())) };
        Some(Self { columns, rows, count, size })
    }

    /// Sides along x and along y [m].
    fn sides(&self, grid: &Structured) -> [[f64; 2]; 2] {
        let side = |[first, last]: [usize; 2], origin: f64, step: f64| {
            [(first as f64 - 0.5) * step + origin, (last as f64 + 0.5) * step + origin]
        };
        [side(self.columns, grid.x(0), grid.dx()), side(self.rows, grid.y(0), grid.dy())]
    }
}

/// Point that has been evaluated.
#[derive(Clone, Copy, Debug)]
struct Point {
    place: [f64; 3],
    value: f64,
    /// First steps of a search from here along x, y and depth [m].
    steps: [f64; 3],
}

/// Loads averaged over blocks of elements.
struct Coarse {
    grid: Structured,
    /// Elements of a block along x and along y.
    block: [usize; 2],
    first: [usize; 2],
    /// Pressures, and tractions first along x, then along y [Pa].
    pressure: Vec<f64>,
    traction: Vec<f64>,
    element: Element,
}

impl Coarse {
    fn new(
        load: &SurfaceLoad<'_>,
        &Extent { columns, rows, count, .. }: &Extent,
        poisson_ratio: f64,
    ) -> Self {
        let grid = load.grid;
        let share = count as f64 / COARSE as f64;
        let side = if grid.nj == 1 { share } else { share.sqrt() }.ceil().max(1.0) as usize;
        let block = [side, if grid.nj == 1 { 1 } else { side }];
        let [ni, nj] = [(columns, 0), (rows, 1)]
            .map(|([first, last], axis)| (last + 1 - first).div_ceil(block[axis]));
        let [dx, dy] = [grid.dx() * block[0] as f64, grid.dy() * block[1] as f64];
        let middle = |block: usize| 0.5 * (block - 1) as f64;
        let x0 = grid.x(columns[0]) + middle(block[0]) * grid.dx();
        let y0 = grid.y(rows[0]) + middle(block[1]) * grid.dy();
        let coarse = Structured::contact_plane(x0, y0, dx, dy, ni, nj);
        let mut fields = [(); 3].map(|()| vec![0.0; ni * nj]);
        let share = ((block[0] * block[1]) as f64).recip();
        for j in rows[0]..=rows[1] {
            for i in columns[0]..=columns[1] {
                let at = (j - rows[0]) / block[1] * ni + (i - columns[0]) / block[0];
                for (field, value) in fields.iter_mut().zip(load.on_element(j * grid.ni + i)) {
                    field[at] += share * value;
                }
            }
        }
        let [pressure, mut traction, mut across] = fields;
        traction.append(&mut across);
        let first = [columns[0], rows[0]];
        Self {
            grid: coarse,
            block,
            first,
            pressure,
            traction,
            element: Element { dx, dy, poisson_ratio },
        }
    }

    fn load(&self) -> SurfaceLoad<'_> {
        SurfaceLoad::new(&self.grid, &self.pressure, &self.traction)
    }
}

struct Search<'a> {
    load: &'a SurfaceLoad<'a>,
    coarse: &'a Coarse,
    poisson_ratio: f64,
    equivalent: fn(&Stress) -> f64,
    /// Limits along x and along y [m]; `None` for no limits.
    within: Option<[[f64; 2]; 2]>,
}

impl Search<'_> {
    /// Start points of the search, highest first.
    fn starts(&self, size: f64) -> Vec<Point> {
        let mut points = self.over_the_volume(size);
        points.extend(self.below_the_largest());
        points.sort_unstable_by(|one, other| other.value.total_cmp(&one.value));
        points
    }

    /// Highest point reached from the first of these starts, in a contact of this size [m].
    fn highest(&self, starts: Vec<Point>, size: f64) -> Option<Peak> {
        let found = starts.iter().take(STARTS).map(|start| self.uphill(start, LAST_STEP * size));
        let best = found.max_by(|one, other| one.value.total_cmp(&other.value))?;
        let stress = self.load.stresses_at(self.poisson_ratio, &[best.place])[0];
        Some(Peak { place: best.place, stress })
    }

    /// Highest point of each row of the coarse grid, under the coarse loads.
    fn over_the_volume(&self, size: f64) -> Vec<Point> {
        let (grid, load) = (&self.coarse.grid, self.coarse.load());
        let depths = DEPTHS.map(|depth| depth * size);
        let mut points = Vec::new();
        let mut stresses = vec![Stress::default(); grid.ni * depths.len()];
        for j in 0..grid.nj {
            let mut section = Section::new(grid, self.poisson_ratio, grid.y(j), &depths);
            section.stresses(&load, &mut stresses);
            let values = stresses.iter().map(self.equivalent).enumerate();
            let Some((at, value)) = values.max_by(|a, b| a.1.total_cmp(&b.1)) else { continue };
            let layer = at / grid.ni;
            let down = depths[(layer + 1).min(depths.len() - 1)] - depths[layer];
            let place = [grid.x(at % grid.ni), grid.y(j), depths[layer]];
            points.push(Point {
                place,
                value,
                steps: [0.5 * grid.dx(), 0.5 * grid.dy(), 0.5 * down],
            });
        }
        points
    }

    /// Points below the elements of the largest pressure and the largest traction.
    fn below_the_largest(&self) -> Vec<Point> {
        let grid = self.load.grid;
        let largest = |of: &dyn Fn([f64; 3]) -> f64| {
            let value = |at: &usize| of(self.load.on_element(*at));
            (0..grid.points()).max_by(|a, b| value(a).total_cmp(&value(b))).unwrap_or_default()
        };
        let side = if grid.nj == 1 { grid.dx() } else { grid.dx().max(grid.dy()) };
        let elements = [largest(&|[p, _, _]| p), largest(&|[_, qx, qy]| qx.hypot(qy))];
        let mut points = Vec::new();
        for at in elements {
            let centre = grid.centre(at % grid.ni, at / grid.ni);
            let mixed = Mixed::around(self, centre);
            for depth in SHALLOW.map(|depth| depth * side) {
                let place = [centre[0], centre[1], depth];
                let value = mixed.value(place);
                points.push(Point { place, value, steps: [0.5 * side; 3] });
            }
        }
        points
    }

    /// Returns the point itself; next to the surface, the point below the centre of the element.
    fn meant(&self, [x, y, depth]: [f64; 3]) -> [f64; 3] {
        let grid = self.load.grid;
        if depth >= ON_SURFACE * grid.dx().min(grid.dy()) {
            return [x, y, depth];
        }
        let centre = |at: f64, first: f64, side: f64, count: usize| {
            first + side * ((at - first) / side).round().clamp(0.0, (count - 1) as f64)
        };
        [centre(x, grid.x(0), grid.dx(), grid.ni), centre(y, grid.y(0), grid.dy(), grid.nj), depth]
    }

    /// Climbs from a point until the steps are at most `last` [m].
    fn uphill(&self, start: &Point, last: f64) -> Point {
        let mixed = Mixed::around(self, start.place);
        let mut here = Point { value: mixed.value(start.place), ..*start };
        let line = self.load.grid.nj == 1;
        while here.steps.iter().any(|step| *step > last) {
            let mut best = here;
            for axis in (0..3).filter(|axis| !(line && *axis == 1)) {
                for sign in [1.0, -1.0] {
                    let mut place = here.place;
                    place[axis] += sign * here.steps[axis];
                    if let Some(within) = &self.within {
                        for (at, [from, to]) in place.iter_mut().zip(within) {
                            *at = at.clamp(*from, *to);
                        }
                    }
                    let place = self.meant([place[0], place[1], place[2].max(0.0)]);
                    let value = mixed.value(place);
                    if value > best.value {
                        best = Point { place, value, ..here };
                    }
                }
            }
            if best.value <= here.value {
                best.steps = here.steps.map(|step| 0.5 * step);
                if line {
                    best.steps[1] = 0.0;
                }
            }
            here = best;
        }
        here
    }
}

/// Original loads near a point, and averaged loads farther away.
struct Mixed<'a> {
    search: &'a Search<'a>,
    near: Vec<([f64; 3], [f64; 3])>,
    far: Vec<([f64; 3], [f64; 3])>,
}

impl<'a> Mixed<'a> {
    fn around(search: &'a Search<'a>, place: [f64; 3]) -> Self {
        let (load, coarse) = (search.load, search.coarse);
        let (mut near, mut far) = (Vec::new(), Vec::new());
        let means = coarse.load();
        for at in 0..coarse.grid.points() {
            let (i, j) = (at % coarse.grid.ni, at / coarse.grid.ni);
            let centre = coarse.grid.centre(i, j);
            let away = [0, 1].map(|axis| (centre[axis] - place[axis]).abs());
            let within = [coarse.element.dx, coarse.element.dy].map(|side| NEAR * side);
            if coarse.block == [1, 1] || away[0] > within[0] || away[1] > within[1] {
                far.push((centre, means.on_element(at)));
                continue;
            }
            let grid = load.grid;
            let [columns, rows] = [(i, 0, grid.ni), (j, 1, grid.nj)].map(|(of, axis, end)| {
                let from = coarse.first[axis] + of * coarse.block[axis];
                from..(from + coarse.block[axis]).min(end)
            });
            for row in rows {
                let elements = columns.clone().map(|column| (column, row * grid.ni + column));
                near.extend(
                    elements.map(|(column, at)| (grid.centre(column, row), load.on_element(at))),
                );
            }
        }
        for list in [&mut near, &mut far] {
            list.retain(|(_, load)| *load != [0.0; 3]);
        }
        Self { search, near, far }
    }

    fn value(&self, [x, y, depth]: [f64; 3]) -> f64 {
        let Search { load, coarse, poisson_ratio, equivalent, .. } = *self.search;
        let fine = Element { dx: load.grid.dx(), dy: load.grid.dy(), poisson_ratio };
        let of = |element: &Element, loads: &[([f64; 3], [f64; 3])]| -> Stress {
            let by = |(centre, [pressure, along_x, along_y]): &([f64; 3], [f64; 3])| {
                let units = element.at(x - centre[0], y - centre[1], depth);
                units.under(*pressure, [*along_x, *along_y])
            };
            loads.iter().map(by).sum()
        };
        equivalent(&(of(&fine, &self.near) + of(&coarse.element, &self.far)))
    }
}
