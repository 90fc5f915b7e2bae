//! Contact of the surfaces of two blocks: impulses that prevent overlap, and friction.
//!
//! Every node of the upper surface near the lower one faces a point of the lower surface, with the
//! shares N of the four nodes around that point. Starred quantities are those of a step without
//! contact. With the impulses p on the upper body,
//!
//! - gap at the end of the step: g = g* + Δt n·W p ≥ 0, p_n ≥ 0, g p_n = 0;
//! - velocity during the step: v = v* + W p; v_t = 0 where |p_t| < f p_n, p_t = −f p_n v_t/|v_t|
//!   elsewhere;
//!
//! W are the inverse masses, coupled where nodes share a node below. Projected Gauss–Seidel sweeps
//! solve this, starting from the impulses of the previous step (Moreau; Jean, Comput. Methods Appl.
//! Mech. Engng 177 (1999) 235–257). Momentum is conserved to rounding. The friction work is −p_t ·
//! (v⁻ + v⁺)/2, which closes the energy balance of central differences.
//!
//! Surfaces that yield, as in a penalty method or with a layer between them, have flexibilities L
//! [m/Pa]. With c = L/(A Δt) at a node of area A, the gap at the end of a step is −c_n p_n, and a
//! sticking node is displaced by c_t p_t. Evaluated at the end of the step, this is stable for any
//! stiffness; multipliers are the case L = 0. The springs store c p²/2Δt, and the friction work is
//! reduced by the increase of this energy.

use super::block::Block;
use super::plane::{Event, Plane};
use elastic::axle::Irregularity;
use std::f64::consts::PI;

/// Gap below which a node is included in the contact search [m].
const NEAR: f64 = 1e-6;
/// Relative change of an impulse at which the sweeps end, and their largest number.
const SETTLED: f64 = 1e-4;
const MOST_SWEEPS: usize = 50;

/// Velocities of a node outside the contact search.
const NOT_WATCHED: [[f64; 3]; 2] = [[f64::NAN; 3]; 2];

/// Rigid motion of the bodies.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Frame {
    /// Overlap of the undeformed bodies [m].
    pub approach: f64,
    /// Velocity of the upper body upwards [m/s].
    pub rising: f64,
    /// Speeds at which the material of the upper and lower surface moves back [m/s].
    pub speeds: [f64; 2],
    /// Distances by which the material moves back in the step [m].
    pub ways: [f64; 2],
    /// Irregularity of one of the surfaces.
    pub irregularity: Option<Irregularity>,
    /// Distances by which both surfaces have moved back before the step [m].
    pub travelled: [f64; 2],
}

/// Friction law between the surfaces.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Law {
    /// Coulomb's friction coefficient [-].
    pub coefficient: f64,
    /// True if surfaces may stick; otherwise all slide against the rigid motion.
    pub sticks: bool,
    /// Flexibilities, normal and tangential [m/Pa].
    pub flexibility: [f64; 2],
}

/// Sums over the contact in a step.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Sums {
    /// Impulse on the upper body, forward, left and up [N·s].
    pub impulse: [f64; 3],
    /// Normal impulse of all nodes [N·s].
    pub pressed: f64,
    /// Friction work [J].
    pub friction: f64,
    /// Work of the rigid motion on the contact [J].
    pub work: f64,
    /// Area of the pressed nodes, and of the sliding ones among them [m²].
    pub areas: [f64; 2],
    /// Number of sweeps.
    pub sweeps: usize,
    /// 1 if the impulses did not converge.
    pub unsettled: usize,
}

impl Sums {
    /// Adds the sums of a step.
    pub fn add(&mut self, more: &Self) {
        self.impulse = add(self.impulse, more.impulse);
        self.pressed += more.pressed;
        self.friction += more.friction;
        self.work += more.work;
        self.areas = [self.areas[0] + more.areas[0], self.areas[1] + more.areas[1]];
        self.sweeps += more.sweeps;
        self.unsettled += more.unsettled;
    }
}

/// Node of the upper surface and the point below it.
#[derive(Clone, Copy, Debug)]
struct Pair {
    node: usize,
    row: usize,
    below: [usize; 4],
    shares: [f64; 4],
    normal: [f64; 3],
    gap: f64,
    x: f64,
    angle: f64,
    velocity: [f64; 3],
    rigid: [f64; 3],
    /// Inverse masses [1/kg]: of the node, of the nodes below, and of the pair together.
    inverse: f64,
    inverse_below: [f64; 4],
    together: f64,
    /// Normal and tangential flexibility per area and step [m/(N·s)].
    yields: [f64; 2],
    impulse: [f64; 3],
    /// Impulse of the previous step [N·s].
    before: [f64; 3],
}

/// The contact of two blocks.
#[derive(Debug)]
pub struct Contact {
    pairs: Vec<Pair>,
    /// Impulses of the last step on the nodes of the upper surface, forward, left, up [N·s].
    impulses: Vec<[f64; 3]>,
    /// Velocities of the nodes relative to the lower surface [m/s], total and of the rigid motion;
    /// NaN for nodes outside the contact search.
    last: Vec<[[f64; 3]; 2]>,
    /// Length of the last step [s].
    step: f64,
    changes: [Vec<[f64; 3]>; 2],
}

impl Contact {
    /// Creates the contact between two blocks.
    #[must_use]
    pub fn new(upper: &Block, lower: &Block) -> Self {
        let nodes = |block: &Block| block.stride * (block.counts[1] + 1);
        Self {
            pairs: Vec::new(),
            impulses: vec![[0.0; 3]; nodes(upper)],
            last: vec![NOT_WATCHED; nodes(upper)],
            step: 0.0,
            changes: [upper, lower].map(|block| vec![[0.0; 3]; nodes(block)]),
        }
    }

    /// State on which the next step depends.
    pub fn state(&mut self) -> [&mut [f64]; 3] {
        let Self { impulses, last, step, .. } = self;
        let last = last.as_flattened_mut().as_flattened_mut();
        [impulses.as_flattened_mut(), last, std::slice::from_mut(step)]
    }

    /// Follows a shift of the upper body's columns.
    pub fn shift(&mut self, upper: &Block) {
        let last = upper.counts[0];
        for row in self.impulses.chunks_exact_mut(upper.stride) {
            row.copy_within(1..=last, 0);
            row[last] = [0.0; 3];
        }
        for row in self.last.chunks_exact_mut(upper.stride) {
            row.copy_within(1..=last, 0);
            row[last] = NOT_WATCHED;
        }
    }

    /// Prevents overlap of the surfaces at the end of a step [s]. The events of the nodes are added
    /// to `plane`, whose extent limits the contact search.
    pub fn resolve(
        &mut self,
        [upper, lower]: [&mut Block; 2],
        frame: &Frame,
        law: Law,
        step: f64,
        plane: &mut Plane,
    ) -> Sums {
        if self.step != step {
            self.last_for(step);
        }
        self.meet([upper, lower], frame, law, step, plane);
        let (sweeps, settled) = self.sweep(law, step);
        let mut sums = Sums { sweeps, unsettled: usize::from(!settled), ..Sums::default() };
        for (node, impulse) in self.pairs.iter().map(|pair| (pair.node, pair.impulse)) {
            self.impulses[node] = impulse;
        }
        for pair in &self.pairs {
            let velocity = match law.sticks {
                true => add(pair.velocity, self.change(pair)),
                false => pair.rigid,
            };
            let now = [velocity, pair.rigid];
            let last = std::mem::replace(&mut self.last[pair.node], now);
            let last = if last[0][0].is_nan() { now } else { last };
            let [mean, rigid] = [0, 1].map(|k| add(now[k], last[k]).map(|sum| 0.5 * sum));
            let normal = dot(pair.impulse, pair.normal);
            let tangential = sub_scaled(pair.impulse, pair.normal, normal);
            let before = sub_scaled(pair.before, pair.normal, dot(pair.before, pair.normal));
            let yields = if law.sticks { pair.yields[1] } else { 0.0 };
            let stored = 0.5 * yields / step * (dot(tangential, tangential) - dot(before, before));
            let slip = |k: usize| velocity[k] * step + yields * (tangential[k] - before[k]);
            let event = Event {
                normal,
                tangential: [tangential[0], tangential[1]],
                slip: [slip(0), slip(1)],
                work: -dot(tangential, mean) - stored,
            };
            if normal > 0.0 {
                let area = upper.length * upper.section.width(pair.row);
                let bound = law.coefficient * normal * (1.0 - 1e-9);
                let slides = dot(tangential, tangential).sqrt() >= bound;
                sums.areas[0] += area;
                sums.areas[1] += if slides { area } else { 0.0 };
            }
            sums.impulse = add(sums.impulse, pair.impulse);
            sums.pressed += normal;
            sums.friction += event.work;
            sums.work -= dot(pair.impulse, rigid);
            plane.add(pair.row, pair.x, &event);
        }
        self.apply(upper, lower, frame, step);
        sums
    }

    /// Rescales the impulses of the last step to a step of this length [s], so that the forces stay
    /// the same.
    fn last_for(&mut self, step: f64) {
        if self.step > 0.0 {
            let ratio = step / self.step;
            self.impulses.as_flattened_mut().iter_mut().for_each(|impulse| *impulse *= ratio);
        }
        self.step = step;
    }

    /// Finds the nodes near the other surface, and the points below them.
    fn meet(
        &mut self,
        [upper, lower]: [&Block; 2],
        frame: &Frame,
        law: Law,
        step: f64,
        plane: &Plane,
    ) {
        self.pairs.clear();
        let grid = &plane.grid;
        let reach = [grid.x(0), grid.x(grid.ni - 1)].map(|x| {
            let column = x / upper.length + 0.5 * upper.counts[0] as f64;
            column.max(1.0) as usize
        });
        let surfaces = [Surface::of(upper, 0, frame), Surface::of(lower, 1, frame)];
        for row in plane.first_row..plane.first_row + grid.nj {
            for column in reach[0]..=reach[1].min(upper.counts[0] - 1) {
                let node = row * upper.stride + column;
                let place = surfaces[0].place(node, row, column);
                let met = surfaces[1].below(place);
                let near = met.gap <= NEAR || dot(self.impulses[node], met.normal) > 0.0;
                if !near {
                    self.last[node] = NOT_WATCHED;
                    continue;
                }
                let rigid_of = |surface: &Surface, node: usize| {
                    let (row, column) = (node / surface.block.stride, node % surface.block.stride);
                    (surface.rigid(node, row, column), surface.own(node, column))
                };
                let area = upper.length * upper.section.width(row);
                let (mut rigid, mut own) = rigid_of(&surfaces[0], node);
                let inverse = upper.inverse_mass[row];
                let mut together = inverse;
                let inverse_below = met.nodes.map(|node| lower.inverse_mass[node / lower.stride]);
                for (corner, share) in met.shares.iter().enumerate() {
                    let (other, its_own) = rigid_of(&surfaces[1], met.nodes[corner]);
                    rigid = sub_scaled(rigid, other, *share);
                    own = sub_scaled(own, its_own, *share);
                    together += share * share * inverse_below[corner];
                }
                self.pairs.push(Pair {
                    node,
                    row,
                    below: met.nodes,
                    shares: met.shares,
                    normal: met.normal,
                    gap: met.gap,
                    x: place[0],
                    angle: surfaces[0].angle(column),
                    velocity: add(rigid, own),
                    rigid,
                    inverse,
                    inverse_below,
                    together,
                    yields: law.flexibility.map(|flexibility| flexibility / (area * step)),
                    impulse: self.impulses[node],
                    before: self.impulses[node],
                });
            }
        }
        for index in 0..self.pairs.len() {
            let impulse = self.pairs[index].impulse;
            self.spread(index, impulse);
        }
    }

    /// Adds the effect of an impulse at a pair to the velocities of its nodes.
    fn spread(&mut self, index: usize, impulse: [f64; 3]) {
        let pair = &self.pairs[index];
        let [upper, lower] = &mut self.changes;
        let change = &mut upper[pair.node];
        *change = sub_scaled(*change, impulse, -pair.inverse);
        for corner in 0..4 {
            let change = &mut lower[pair.below[corner]];
            *change =
                sub_scaled(*change, impulse, pair.shares[corner] * pair.inverse_below[corner]);
        }
    }

    /// Change of the relative velocity of a pair's surfaces.
    fn change(&self, pair: &Pair) -> [f64; 3] {
        let mut change = self.changes[0][pair.node];
        for (node, share) in pair.below.iter().zip(pair.shares) {
            change = sub_scaled(change, self.changes[1][*node], share);
        }
        change
    }

    /// Sweeps over the pairs until their impulses converge. Returns the number of sweeps, and
    /// whether they converged.
    fn sweep(&mut self, law: Law, step: f64) -> (usize, bool) {
        for sweep in 1..=MOST_SWEEPS {
            let (mut largest, mut change) = (0.0_f64, 0.0_f64);
            for index in 0..self.pairs.len() {
                let pair = &self.pairs[index];
                let (old, normal, together) = (pair.impulse, pair.normal, pair.together);
                let by_others = self.change(pair);
                let velocity = add(pair.velocity, by_others);
                let pressed = dot(old, normal);
                let [yields, yields_along] = pair.yields;
                let gap = pair.gap + step * dot(normal, by_others) + yields * pressed;
                let new_pressed = (pressed - gap / (step * together + yields)).max(0.0);
                let wanted = match law.sticks {
                    true => {
                        let away = sub_scaled(
                            velocity.map(|v| step * v),
                            sub_scaled(old, pair.before, 1.0),
                            -yields_along,
                        );
                        sub_scaled(old, away, 1.0 / (step * together + yields_along))
                    }
                    false => pair.rigid.map(|v| -v),
                };
                let tangential = sub_scaled(wanted, normal, dot(wanted, normal));
                let size = dot(tangential, tangential).sqrt();
                let bound = law.coefficient * new_pressed;
                let within = law.sticks && size <= bound || size == 0.0;
                let scale = if within { 1.0 } else { bound / size };
                let new = sub_scaled(tangential.map(|t| scale * t), normal, -new_pressed);
                let more = sub_scaled(new, old, 1.0);
                self.pairs[index].impulse = new;
                self.spread(index, more);
                largest = largest.max(new_pressed);
                change = change.max(dot(more, more).sqrt());
            }
            if change <= SETTLED * largest {
                return (sweep, true);
            }
        }
        (MOST_SWEEPS, false)
    }

    /// Applies the velocity changes to the nodes of both surfaces and resets them, because several
    /// pairs share a node below.
    fn apply(&mut self, upper: &mut Block, lower: &mut Block, frame: &Frame, step: f64) {
        let [changes, below] = &mut self.changes;
        for pair in &self.pairs {
            let change = std::mem::take(&mut changes[pair.node]);
            upper.push(pair.node, own_directions(change, pair.angle, 1.0), step);
            for node in pair.below {
                let change = std::mem::take(&mut below[node]);
                if change != [0.0; 3] {
                    let along = lower.place(node % lower.stride) - frame.ways[1];
                    let angle = along / lower.solid.radius;
                    lower.push(node, own_directions(change, angle, -1.0), step);
                }
            }
        }
    }
}

/// A surface in the frame of the contact: x forward, y left, z up, with the origin where the
/// undeformed bodies touch.
struct Surface<'a> {
    block: &'a Block,
    /// 1 for the upper body, which extends upwards, −1 for the lower one.
    side: f64,
    height: f64,
    rising: f64,
    speed: f64,
    way: f64,
    irregularity: Option<Irregularity>,
    travelled: f64,
}

/// Point of a surface, and the gap to it.
struct SurfacePoint {
    nodes: [usize; 4],
    shares: [f64; 4],
    normal: [f64; 3],
    gap: f64,
}

impl<'a> Surface<'a> {
    /// Surface of the upper (0) or lower (1) body at the end of the step.
    fn of(block: &'a Block, which: usize, frame: &Frame) -> Self {
        let (side, height, rising) =
            if which == 0 { (1.0, -frame.approach, frame.rising) } else { (-1.0, 0.0, 0.0) };
        let own = |irregularity: &Irregularity| irregularity.body() == which;
        Self {
            block,
            side,
            height,
            rising,
            speed: frame.speeds[which],
            way: frame.ways[which],
            irregularity: frame.irregularity.filter(own),
            travelled: frame.travelled[which],
        }
    }

    fn along(&self, column: usize) -> f64 {
        self.block.place(column) - self.way
    }

    fn angle(&self, column: usize) -> f64 {
        self.along(column) / self.block.solid.radius
    }

    /// Depth of a column of the surface below the smooth one [m].
    fn hollow(&self, irregularity: &Irregularity, column: usize) -> f64 {
        let circumference = 2.0 * PI * self.block.solid.radius;
        irregularity.hollow(self.block.place(column) + self.travelled, circumference)
    }

    fn place(&self, node: usize, row: usize, column: usize) -> [f64; 3] {
        let [y, depth] = self.block.section.nodes[row];
        let depth = depth + self.irregularity.map_or(0.0, |of| self.hollow(&of, column));
        let u: [f64; 3] = std::array::from_fn(|k| self.block.displacement(node, k));
        let radius = self.block.solid.radius;
        let (sine, cosine) = self.angle(column).sin_cos();
        let (x, z) = if radius.is_finite() {
            ((radius - depth) * sine, radius - (radius - depth) * cosine)
        } else {
            (self.along(column), depth)
        };
        let x = x + u[0] * cosine - u[2] * sine;
        let z = z + u[0] * sine + u[2] * cosine;
        [x, y + u[1], self.height + self.side * z]
    }

    /// Velocity of a node in the rigid motion, in the middle of the step [m/s]: its displacement in
    /// the step over the step.
    fn rigid(&self, node: usize, row: usize, column: usize) -> [f64; 3] {
        let radius = self.block.solid.radius;
        if radius.is_infinite() {
            return [-self.speed, 0.0, self.rising];
        }
        let depth = self.block.section.nodes[row][1];
        let [u, w] = [0, 2].map(|k| self.block.displacement(node, k));
        let turn = -self.speed / radius;
        let own = [turn * (radius - depth - w), 0.0, turn * u];
        let angle = (self.block.place(column) - 0.5 * self.way) / radius;
        let [x, y, z] = lab_directions(own, angle, self.side);
        [x, y, z + self.rising]
    }

    /// Velocity of a node beyond the rigid motion [m/s].
    fn own(&self, node: usize, column: usize) -> [f64; 3] {
        let own = std::array::from_fn(|k| self.block.velocity[k][node]);
        lab_directions(own, self.angle(column), self.side)
    }

    /// Point of this surface that faces a position.
    fn below(&self, place: [f64; 3]) -> SurfacePoint {
        let block = self.block;
        let [columns, across, _] = block.counts;
        let last = |value: f64, most: usize| (value.max(0.0) as usize).min(most - 1);
        let (mut along, mut lateral) = (place[0], place[1]);
        let mut met = SurfacePoint { nodes: [0; 4], shares: [0.0; 4], normal: [0.0; 3], gap: 0.0 };
        // The position is that of the material: repeat the search with the displacement found.
        for _ in 0..3 {
            let at = (along + block.behind + self.way) / block.length + 0.5 * columns as f64;
            let column = last(at, columns);
            let rows = &block.section.nodes[..=across];
            let row = rows.partition_point(|node| node[0] <= lateral).clamp(1, across) - 1;
            let xi = at - column as f64;
            let eta = (lateral - rows[row][0]) / (rows[row + 1][0] - rows[row][0]);
            let corners =
                [(row, column), (row, column + 1), (row + 1, column), (row + 1, column + 1)];
            met.nodes = corners.map(|(row, column)| row * block.stride + column);
            let places: [[f64; 3]; 4] = std::array::from_fn(|corner| {
                let (row, column) = corners[corner];
                self.place(met.nodes[corner], row, column)
            });
            met.shares = [(1.0 - xi) * (1.0 - eta), xi * (1.0 - eta), (1.0 - xi) * eta, xi * eta];
            let mixed = |w: [f64; 4]| -> [f64; 3] {
                std::array::from_fn(|k| (0..4).map(|corner| w[corner] * places[corner][k]).sum())
            };
            let forward = mixed([eta - 1.0, 1.0 - eta, -eta, eta]);
            let left = mixed([xi - 1.0, -xi, 1.0 - xi, xi]);
            let normal = cross(forward, left);
            let size = dot(normal, normal).sqrt();
            met.normal = normal.map(|n| n / size);
            let to = sub_scaled(place, mixed(met.shares), 1.0);
            met.gap = dot(met.normal, to);
            along += to[0];
            lateral += to[1];
        }
        met
    }
}

/// Converts forward, left and up to along, across and into a body at an angle.
fn own_directions([x, y, z]: [f64; 3], angle: f64, side: f64) -> [f64; 3] {
    let ((sine, cosine), z) = (angle.sin_cos(), side * z);
    [x * cosine + z * sine, y, -x * sine + z * cosine]
}

/// Converts along, across and into a body at an angle to forward, left and up.
fn lab_directions([u, v, w]: [f64; 3], angle: f64, side: f64) -> [f64; 3] {
    let (sine, cosine) = angle.sin_cos();
    [u * cosine - w * sine, v, side * (u * sine + w * cosine)]
}

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn add(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[0] + b[0], a[1] + b[1], a[2] + b[2]]
}

fn sub_scaled(a: [f64; 3], b: [f64; 3], scale: f64) -> [f64; 3] {
    [a[0] - scale * b[0], a[1] - scale * b[1], a[2] - scale * b[2]]
}

fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}
