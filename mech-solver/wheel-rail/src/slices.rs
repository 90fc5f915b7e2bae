//! A surface through profiles at positions along the rolling direction: a rail that varies, a wheel
//! that is not round.
//!
//! **Paths.** Corresponding points of the slices lie on a path. A slice is divided at its breaks:
//! its ends and s = 0, or the given features. Between two breaks a path divides the tape of every
//! slice in the same ratio. The number of paths is the number of points of the finest slice, and s
//! is the tape distance along that slice. Kinks of a slice move to the nearest path.
//!
//! **Across**, every slice is a natural cubic spline over its own tape through its points on the
//! paths. **Along**, a piece between two paths consists of its ends, their second derivatives times
//! the squared width, and the width. Each of these numbers is a cubic spline over the position u,
//! so that the surface is a tensor product of splines:
//!
//! - [`Along::Through`]: a natural spline through the slices;
//! - [`Along::Near`]: the cubic B-spline over the knots u_k whose control points are the slices. At
//!   u_k it is P_k + α(P_{k+1} − P_k) + β(P_{k−1} − P_k) with α = h²_{k−1} c₊, β = h²_k c₋,
//!   h_k = u_{k+1} − u_k, c₊ = 1/((u_{k+1} − u_{k−1})(u_{k+2} − u_{k−1})), c₋ = 1/((u_{k+1} −
//!   u_{k−1})(u_{k+1} − u_{k−2})), and its second derivative 6 c₊(P_{k+1} − P_k) + 6 c₋(P_{k−1} −
//!   P_k). It smooths over three slices.
//!
//! *Ends.* Beyond its slices a rail continues with the profile of the last one. A wheel closes: if
//! there are slices all round it, the spline continues over the seam. Otherwise the surface is
//! straight over u from the last slice to the first.
//!
//! If all slices are equal, the surface reproduces their profile to rounding.
//!
//! Source: de Boor, *A Practical Guide to Splines* (1978) ch. 9, 10 and 17. CONTACT's user guide,
//! ch. 3 (rail slices-file), has the same surface with paths of 0.5 mm.

use super::outline::{Outline, Place};
use crate::spline::smoothed;

/// Least number of slices.
const FEWEST: usize = 2;
/// Least distance of two slices, relative to the length of all.
const CLOSEST: f64 = 1e-9;
/// A wheel counts as having slices all round it if the seam is at most this many times the widest
/// distance of two slices.
const SEAM: f64 = 1.5;
/// Most pieces of a surface.
const MOST_PIECES: usize = 4_000_000;
/// Number of slices repeated on each side of a seam.
const REPEATED: usize = 8;

/// Piece of a slice between two paths: y and z of both ends, their second derivatives with respect
/// to the tape times the squared width, and the width [m].
type Piece = [f64; 9];

/// Interpolation of a surface along its slices.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Along {
    /// Through all slices.
    Through,
    /// Near the slices: smoothed over three of them.
    Near,
}

/// A profile at its position.
#[derive(Clone, Debug, PartialEq)]
pub struct Slice {
    /// Position along the track [m], or round the wheel [rad].
    pub at: f64,
    /// The profile, in the axes of [`super::profile`].
    pub outline: Outline,
    /// Features as distances along the tape from the profile's first point, in ascending order [m];
    /// all slices have the same number. Empty for none.
    pub features: Vec<f64>,
}

/// Reason why slices do not form a surface.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum SlicesError {
    /// Too few slices.
    #[error("number of slices is {0}; a surface needs at least {FEWEST}")]
    Few(usize),
    /// Positions are not in ascending order.
    #[error(
        "the positions of slices {number} and {next} are {from} and {to}; they must be in ascending order",
        next = number + 1
    , from = tables::readable::number(*.from, 7), to = tables::readable::number(*.to, 7))]
    Order {
        /// Number of the first of the two slices, from 1.
        number: usize,
        /// Position of the first [m or rad].
        from: f64,
        /// Position of the second [m or rad].
        to: f64,
    },
    /// Slices span more than one and a half turns of a wheel.
    #[error("the slices span {0:.4} rad, more than one and a half turns of a wheel")]
    Turns(f64),
    /// Too many slices with too many points.
    #[error(
        "it has {slices} slices of up to {points} points; remove points that a spline does not need"
    )]
    Large {
        /// Number of slices.
        slices: usize,
        /// Points of the finest slice.
        points: usize,
    },
    /// Features are off the profile, not in ascending order, or not the same number for all slices.
    #[error(
        "the features of slice {0} are not in ascending order on its profile, or their number differs from the first slice"
    )]
    Features(usize),
}

/// A surface through slices.
#[derive(Clone, Debug, PartialEq)]
pub struct Slices {
    /// Positions, in ascending order [m or rad].
    at: Vec<f64>,
    /// Tape distance of the paths [m].
    paths: Vec<f64>,
    /// Paths on which a slice has a kink.
    kinks: Vec<usize>,
    /// Pieces of every slice.
    pieces: Vec<Vec<Piece>>,
    /// Second derivatives of the pieces with respect to the position.
    bends: Vec<Vec<Piece>>,
    /// Period of the positions [rad].
    period: Option<f64>,
}

/// A point of a surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Spot {
    /// y and z, and their derivatives with respect to s.
    pub place: Place,
    /// Derivative of y and z with respect to the position [-] or [m/rad].
    pub along: [f64; 2],
}

/// Neighbouring slices of a position, with the weights of both and of their second derivatives.
struct SlicePair {
    slices: [usize; 2],
    weights: [f64; 4],
    /// Derivatives of the weights with respect to the position.
    rates: [f64; 4],
}

impl Slices {
    /// Creates the surface through slices; `period` [rad] is given for a wheel.
    ///
    /// # Errors
    /// Fails if there are too few slices or too many points, if positions are not in ascending
    /// order or span too many turns, or if features do not fit the profiles.
    pub fn new(slices: &[Slice], along: Along, period: Option<f64>) -> Result<Self, SlicesError> {
        check_positions(slices, period)?;
        let breaks = breaks(slices)?;
        let by_points = |k: &usize| slices[*k].outline.points().len();
        let finest = (0..slices.len()).max_by_key(by_points).unwrap_or(0);
        let ratios = ratios(slices[finest].outline.lengths(), &breaks[finest]);
        if slices.len() * ratios.len() > MOST_PIECES {
            return Err(SlicesError::Large { slices: slices.len(), points: ratios.len() });
        }
        let paths = tape(&ratios, &breaks[finest]);
        let mut kinks = Vec::new();
        let pieces = slices.iter().zip(&breaks);
        let pieces = pieces
            .map(|(slice, breaks)| pieces_of(&slice.outline, &tape(&ratios, breaks), &mut kinks));
        let mut pieces: Vec<Vec<Piece>> = pieces.collect();
        kinks.sort_unstable();
        kinks.dedup();
        let mut at: Vec<f64> = slices.iter().map(|slice| slice.at).collect();
        if let Some(period) = period {
            close(&mut at, &mut pieces, period);
        }
        let mut surface = Self { at, paths, kinks, pieces, bends: Vec::new(), period };
        match along {
            Along::Through => surface.interpolate(),
            Along::Near => surface.approximate(),
        }
        Ok(surface)
    }

    /// Natural splines over the positions, for each number of a piece separately.
    fn interpolate(&mut self) {
        let count = self.paths.len() - 1;
        self.bends = vec![vec![[0.0; 9]; count]; self.at.len()];
        for piece in 0..count {
            for part in 0..9 {
                let values: Vec<f64> = self.pieces.iter().map(|slice| slice[piece][part]).collect();
                let bend = smoothed(&self.at, &values, 0.0).bend;
                let of_part = self.bends.iter_mut().map(|slice| &mut slice[piece][part]);
                of_part.zip(bend).for_each(|(place, bend)| *place = bend);
            }
        }
    }

    /// Spline whose control points are the slices; the first and the last are interpolated.
    fn approximate(&mut self) {
        let (at, last) = (&self.at, self.at.len() - 1);
        let of = |k: usize, part: fn([f64; 4]) -> f64, piece: usize, number: usize| {
            if k == 0 || k == last {
                return part([self.pieces[k][piece][number], 0.0, 0.0, 0.0]);
            }
            // Beyond the ends knots continue at equal distances.
            let far_left = if k > 1 { at[k - 2] } else { 2.0 * at[0] - at[1] };
            let far_right = if k + 1 < last { at[k + 2] } else { 2.0 * at[last] - at[last - 1] };
            let width = at[k + 1] - at[k - 1];
            let right = 1.0 / (width * (far_right - at[k - 1]));
            let left = 1.0 / (width * (at[k + 1] - far_left));
            let value = |k: usize| self.pieces[k][piece][number];
            let (up, down) = (value(k + 1) - value(k), value(k - 1) - value(k));
            let steps = [at[k] - at[k - 1], at[k + 1] - at[k]].map(|step| step * step);
            part([
                value(k),
                steps[0] * right * up + steps[1] * left * down,
                right * up,
                left * down,
            ])
        };
        let all = |part: fn([f64; 4]) -> f64| -> Vec<Vec<Piece>> {
            let pieces = 0..self.paths.len() - 1;
            let slice = |k: usize| {
                let piece = |piece| std::array::from_fn(|number| of(k, part, piece, number));
                pieces.clone().map(piece).collect()
            };
            (0..=last).map(slice).collect()
        };
        let pieces = all(|[value, more, ..]| value + more);
        self.bends = all(|[_, _, right, left]| 6.0 * (right + left));
        self.pieces = pieces;
    }

    /// First and last s [m].
    #[must_use]
    pub fn range(&self) -> [f64; 2] {
        [self.paths[0], self.paths[self.paths.len() - 1]]
    }

    /// Positions of the slices [m or rad]; more than a turn if a wheel has slices all round it.
    #[must_use]
    pub fn positions(&self) -> &[f64] {
        &self.at
    }

    /// Point of the surface at a position and s [m]. The search starts at the piece `near`, which
    /// receives the piece of s.
    #[must_use]
    pub fn at(&self, position: f64, s: f64, near: &mut usize) -> Spot {
        let last = self.paths.len() - 2;
        let mut left = (*near).min(last);
        while left < last && s >= self.paths[left + 1] {
            left += 1;
        }
        while left > 0 && s < self.paths[left] {
            left -= 1;
        }
        *near = left;
        let between = self.between(position);
        let [from, to] = [self.paths[left], self.paths[left + 1]];
        let (width, inside) = (to - from, s.clamp(from, to));
        let share = (inside - from) / width;
        let (value, rate) = cubic(&self.blend(&between, left, &between.weights), share);
        let tangent = rate.map(|rate| rate / width);
        let position = [0, 1].map(|k| value[k] + tangent[k] * (s - inside));
        let (along, _) = cubic(&self.blend(&between, left, &between.rates), share);
        Spot { place: Place { position, tangent }, along }
    }

    /// Profile at a position. Its s is its own tape distance, zero where that of the paths is.
    #[must_use]
    pub fn section(&self, position: f64) -> Outline {
        let between = self.between(position);
        let count = self.paths.len();
        let (mut length, mut points) = (vec![0.0; count], vec![[0.0; 2]; count]);
        let mut bend = vec![[0.0; 2]; count];
        for left in 0..count - 1 {
            let piece = self.blend(&between, left, &between.weights);
            let [y, z, next_y, next_z, bend_y, bend_z, next_bend_y, next_bend_z, width] = piece;
            // A spline over slices whose parts grow and shrink may become negative.
            let width = width.max(super::outline::CLOSEST);
            length[left + 1] = length[left] + width;
            (points[left], points[left + 1]) = ([y, z], [next_y, next_z]);
            // Mean of both sides, which are equal in a slice and nearly equal between slices.
            let squared = width * width;
            let half = |bend: f64| 0.5 * bend / squared;
            let [first, second] = [[bend_y, bend_z], [next_bend_y, next_bend_z]];
            for k in 0..2 {
                bend[left][k] += half(first[k]);
                bend[left + 1][k] += half(second[k]);
            }
        }
        let origin = self.origin(&length);
        length.iter_mut().for_each(|length| *length -= origin);
        Outline::of_parts(length, points, bend, self.kinks.clone())
    }

    /// Tape distance of s = 0 from the first point, in a section whose points are at these lengths
    /// [m].
    fn origin(&self, length: &[f64]) -> f64 {
        let right = self.paths.partition_point(|path| *path <= 0.0).clamp(1, self.paths.len() - 1);
        let [from, to] = [self.paths[right - 1], self.paths[right]];
        length[right - 1] - from / (to - from) * (length[right] - length[right - 1])
    }

    /// Mirrors the surface at the z-axis: (y, s) → (−y, −s).
    #[must_use]
    pub fn mirrored(&self) -> Self {
        let flip = |piece: &Piece| {
            let [y, z, next_y, next_z, bend_y, bend_z, next_bend_y, next_bend_z, width] = *piece;
            [-next_y, next_z, -y, z, -next_bend_y, next_bend_z, -bend_y, bend_z, width]
        };
        let last = self.paths.len() - 1;
        Self {
            paths: self.paths.iter().rev().map(|path| -path).collect(),
            kinks: self.kinks.iter().rev().map(|path| last - path).collect(),
            ..self.each(
                |slice| slice.iter().rev().map(flip).collect(),
                |slice| slice.iter().rev().map(flip).collect(),
            )
        }
    }

    /// Turns the surface about the origin, from y to z, by `angle` [rad], then shifts it by (y, z)
    /// [m].
    #[must_use]
    pub fn placed(&self, angle: f64, shift: [f64; 2]) -> Self {
        let (sin, cos) = angle.sin_cos();
        let turned = |piece: &Piece, shift: [f64; 2]| {
            let mut turned = *piece;
            for k in 0..4 {
                let [y, z] = [piece[2 * k], piece[2 * k + 1]];
                let by = if k < 2 { shift } else { [0.0; 2] };
                turned[2 * k] = cos * y - sin * z + by[0];
                turned[2 * k + 1] = sin * y + cos * z + by[1];
            }
            turned
        };
        let of = |slice: &[Piece], shift: [f64; 2]| {
            slice.iter().map(|piece| turned(piece, shift)).collect()
        };
        self.each(|slice| of(slice, shift), |slice| of(slice, [0.0; 2]))
    }

    /// Maps the pieces of every slice, and their second derivatives, to new ones.
    fn each(
        &self,
        pieces: impl Fn(&[Piece]) -> Vec<Piece>,
        bends: impl Fn(&[Piece]) -> Vec<Piece>,
    ) -> Self {
        Self {
            at: self.at.clone(),
            paths: self.paths.clone(),
            kinks: self.kinks.clone(),
            pieces: self.pieces.iter().map(|slice| pieces(slice)).collect(),
            bends: self.bends.iter().map(|slice| bends(slice)).collect(),
            period: self.period,
        }
    }

    /// Slices beside a position, and their weights.
    fn between(&self, position: f64) -> SlicePair {
        let last = self.at.len() - 1;
        let [from, to] = [self.at[0], self.at[last]];
        let mut position = position;
        if let Some(period) = self.period {
            let middle = 0.5 * (from + to);
            position =
                (position - middle + 0.5 * period).rem_euclid(period) + middle - 0.5 * period;
            if position < from {
                position += period;
            }
            if position > to {
                let seam = from + period - to;
                let share = (position - to) / seam;
                let rate = 1.0 / seam;
                return SlicePair {
                    slices: [last, 0],
                    weights: [1.0 - share, share, 0.0, 0.0],
                    rates: [-rate, rate, 0.0, 0.0],
                };
            }
        }
        if position <= from || position >= to {
            let end = if position <= from { 0 } else { last };
            return SlicePair {
                slices: [end, end],
                weights: [1.0, 0.0, 0.0, 0.0],
                rates: [0.0; 4],
            };
        }
        let left = self.at.partition_point(|at| *at <= position).clamp(1, last) - 1;
        let width = self.at[left + 1] - self.at[left];
        let b = (position - self.at[left]) / width;
        let a = 1.0 - b;
        let [bend_a, bend_b] = [a, b].map(|c| width * width * (c * c * c - c) / 6.0);
        let [rate_a, rate_b] = [a, b].map(|c| width * (3.0 * c * c - 1.0) / 6.0);
        SlicePair {
            slices: [left, left + 1],
            weights: [a, b, bend_a, bend_b],
            rates: [-1.0 / width, 1.0 / width, -rate_a, rate_b],
        }
    }

    /// Weighted sum of a piece of both slices.
    fn blend(&self, between: &SlicePair, piece: usize, [a, b, c, d]: &[f64; 4]) -> Piece {
        let [one, next] = between.slices;
        let (from, to) = (&self.pieces[one][piece], &self.pieces[next][piece]);
        if *c == 0.0 && *d == 0.0 {
            return std::array::from_fn(|k| a * from[k] + b * to[k]);
        }
        let (bend, next_bend) = (&self.bends[one][piece], &self.bends[next][piece]);
        std::array::from_fn(|k| a * from[k] + b * to[k] + c * bend[k] + d * next_bend[k])
    }
}

/// Checks that positions rise and span at most one and a half turns.
fn check_positions(slices: &[Slice], period: Option<f64>) -> Result<(), SlicesError> {
    if slices.len() < FEWEST {
        return Err(SlicesError::Few(slices.len()));
    }
    let span = slices[slices.len() - 1].at - slices[0].at;
    for (number, pair) in (1..).zip(slices.windows(2)) {
        let [from, to] = [pair[0].at, pair[1].at];
        let rises = to - from > CLOSEST * span;
        if !rises {
            return Err(SlicesError::Order { number, from, to });
        }
    }
    match period {
        Some(period) if span > 1.5 * period => Err(SlicesError::Turns(span)),
        _ => Ok(()),
    }
}

/// s of the breaks of every slice, in ascending order.
fn breaks(slices: &[Slice]) -> Result<Vec<Vec<f64>>, SlicesError> {
    let count = slices[0].features.len();
    if count > 0 {
        let of = |(number, slice): (usize, &Slice)| {
            let [from, to] = slice.outline.range();
            let mut breaks: Vec<f64> = slice.features.iter().map(|s| from + s).collect();
            let known = breaks.len();
            if let Some(last) = breaks.last_mut() {
                *last = last.min(to);
            }
            let rise = breaks.windows(2).all(|pair| pair[1] - pair[0] > super::outline::CLOSEST);
            let inside = breaks.iter().all(|s| (from..=to).contains(s));
            match known == count && known > 1 && rise && inside {
                true => Ok(breaks),
                false => Err(SlicesError::Features(number)),
            }
        };
        return (1..).zip(slices).map(of).collect();
    }
    // The origin is a break if it lies inside all slices.
    let inside = |slice: &Slice| {
        let [from, to] = slice.outline.range();
        from < -super::outline::CLOSEST && to > super::outline::CLOSEST
    };
    let with_origin = slices.iter().all(inside);
    let of = |slice: &Slice| {
        let [from, to] = slice.outline.range();
        if with_origin { vec![from, 0.0, to] } else { vec![from, to] }
    };
    Ok(slices.iter().map(of).collect())
}

/// Positions of the points of a slice between its breaks: number of the part, and the share of the
/// part before the point.
fn ratios(lengths: &[f64], breaks: &[f64]) -> Vec<(usize, f64)> {
    let last = breaks.len() - 2;
    let mut ratios = Vec::with_capacity(lengths.len() + breaks.len());
    for (part, pair) in breaks.windows(2).enumerate() {
        let near = super::outline::CLOSEST;
        ratios.push((part, 0.0));
        let within = lengths.iter().filter(|s| **s > pair[0] + near && **s < pair[1] - near);
        ratios.extend(within.map(|s| (part, (s - pair[0]) / (pair[1] - pair[0]))));
    }
    ratios.push((last, 1.0));
    ratios
}

/// s of the paths on a slice with these breaks.
fn tape(ratios: &[(usize, f64)], breaks: &[f64]) -> Vec<f64> {
    let at = |(part, ratio): &(usize, f64)| {
        let [from, to] = [breaks[*part], breaks[part + 1]];
        (1.0 - ratio) * from + ratio * to
    };
    ratios.iter().map(at).collect()
}

/// Divides a slice at these s of the paths, and appends its kinks.
fn pieces_of(outline: &Outline, paths: &[f64], kinks: &mut Vec<usize>) -> Vec<Piece> {
    let last = paths.len() - 1;
    let mut near = 0;
    let points: Vec<[f64; 2]> =
        paths.iter().map(|s| outline.at_near(*s, &mut near).position).collect();
    let nearest = |s: f64| {
        let right = paths.partition_point(|path| *path < s).clamp(1, last);
        if s - paths[right - 1] < paths[right] - s { right - 1 } else { right }
    };
    let own = outline.kinks().map(nearest).filter(|path| *path > 0 && *path < last);
    let mut ends: Vec<usize> = std::iter::once(0).chain(own).chain([last]).collect();
    ends.dedup();
    kinks.extend(&ends[1..ends.len() - 1]);
    let mut bend = vec![[0.0; 2]; paths.len()];
    for pair in ends.windows(2).filter(|pair| pair[1] - pair[0] > 1) {
        let within = pair[0]..=pair[1];
        for k in 0..2 {
            let values: Vec<f64> = points[within.clone()].iter().map(|point| point[k]).collect();
            let found = smoothed(&paths[within.clone()], &values, 0.0).bend;
            let places = bend[within.clone()].iter_mut().map(|bend| &mut bend[k]);
            places.zip(found).for_each(|(place, bend)| *place = bend);
        }
    }
    let piece = |left: usize| {
        let width = paths[left + 1] - paths[left];
        let [one, next] = [points[left], points[left + 1]];
        let [first, second] = [bend[left], bend[left + 1]].map(|b| b.map(|b| width * width * b));
        [one[0], one[1], next[0], next[1], first[0], first[1], second[0], second[1], width]
    };
    (0..last).map(piece).collect()
}

/// Repeats slices on either side of a seam that is not much wider than the distances of slices.
fn close(at: &mut Vec<f64>, pieces: &mut Vec<Vec<Piece>>, period: f64) {
    let count = at.len();
    let seam = period - (at[count - 1] - at[0]);
    let widest = at.windows(2).map(|pair| pair[1] - pair[0]).fold(0.0, f64::max);
    if seam <= CLOSEST * period || seam > SEAM * widest {
        return;
    }
    let few = REPEATED.min(count);
    let before = (count - few..count).map(|k| (at[k] - period, pieces[k].clone()));
    let own = (0..count).map(|k| (at[k], pieces[k].clone()));
    let behind = (0..few).map(|k| (at[k] + period, pieces[k].clone()));
    (*at, *pieces) = before.chain(own).chain(behind).unzip();
}

/// Value of a piece at the share `b` of its width, and its derivative with respect to `b`.
fn cubic(piece: &Piece, b: f64) -> ([f64; 2], [f64; 2]) {
    let a = 1.0 - b;
    let (weight_a, weight_b) = ((a * a * a - a) / 6.0, (b * b * b - b) / 6.0);
    let (slope_a, slope_b) = ((3.0 * a * a - 1.0) / 6.0, (3.0 * b * b - 1.0) / 6.0);
    let value = |k: usize| {
        a * piece[k] + b * piece[k + 2] + weight_a * piece[k + 4] + weight_b * piece[k + 6]
    };
    let rate = |k: usize| piece[k + 2] - piece[k] + slope_b * piece[k + 6] - slope_a * piece[k + 4];
    ([0, 1].map(value), [0, 1].map(rate))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::standard::{rail_60e1, wheel_s1002};
    use proptest::prelude::*;
    use std::f64::consts::TAU;

    fn slice(at: f64, outline: Outline) -> Slice {
        Slice { at, outline, features: Vec::new() }
    }

    /// A rail with equal slices reproduces the profile everywhere, along the rail too.
    #[test]
    fn equal_slices_are_their_profile() {
        for profile in [rail_60e1().unwrap(), wheel_s1002().unwrap()] {
            let slices: Vec<Slice> =
                [-0.3, 0.1, 0.25, 1.0].map(|at| slice(at, profile.clone())).to_vec();
            for along in [Along::Through, Along::Near] {
                let surface = Slices::new(&slices, along, None).unwrap();
                let (turned, mirrored) = (surface.placed(0.3, [0.1, 0.2]), surface.mirrored());
                let mut near = [0; 3];
                for k in 0..200 {
                    let [from, to] = surface.range();
                    let s = from + (to - from) * (f64::from(k) + 0.3) / 200.0;
                    for u in [-1.0, -0.2, 0.1, 0.7, 2.0] {
                        let spot = surface.at(u, s, &mut near[0]);
                        let place = profile.at(s);
                        let off = |one: [f64; 2], other: [f64; 2]| {
                            (one[0] - other[0]).hypot(one[1] - other[1])
                        };
                        assert!(off(spot.place.position, place.position) < 2e-16 * 200.0, "{s}");
                        assert!(off(spot.place.tangent, place.tangent) < 1e-10);
                        assert!(spot.along[0].hypot(spot.along[1]) < 1e-13);
                        let section = surface.section(u).at(s);
                        assert!(off(section.position, place.position) < 1e-15);
                        let there = turned.at(u, s, &mut near[1]).place.position;
                        let expected = profile.placed(0.3, [0.1, 0.2]).at(s).position;
                        assert!(off(there, expected) < 1e-15);
                        let there = mirrored.at(u, -s, &mut near[2]).place;
                        let expected = profile.mirrored().at(-s);
                        assert!(off(there.position, expected.position) < 1e-16 * 400.0);
                        assert!(off(there.tangent, expected.tangent) < 1e-10);
                    }
                }
            }
        }
    }

    /// A profile raised along u. The error is of fourth order through the slices and of second
    /// order near them, where the surface lies h²/6 times the second derivative inside.
    #[test]
    fn along_the_slices_the_orders_are_those_of_splines() {
        let profile = rail_60e1().unwrap();
        let height = |u: f64| 1e-3 * (3.0 * u).sin();
        let error = |along: Along, count: i32| {
            let at = |k: i32| 2.0 * f64::from(k) / f64::from(count) - 1.0;
            let raised = |u: f64| slice(u, profile.placed(0.0, [0.0, height(u)]));
            let slices: Vec<Slice> = (0..=count).map(at).map(raised).collect();
            let surface = Slices::new(&slices, along, None).unwrap();
            let off = |k: i32| {
                let u = 0.5 * at(k) * f64::from(count) / 100.0;
                let spot = surface.at(u, 2e-3, &mut 0);
                let rate = 3e-3 * (3.0 * u).cos();
                assert!((spot.along[1] - rate).abs() < 1e-4);
                (spot.place.position[1] - profile.at(2e-3).position[1] - height(u)).abs()
            };
            (0..100).map(off).fold(0.0, f64::max)
        };
        let [through, near] = [Along::Through, Along::Near].map(|along| {
            let (coarse, fine) = (error(along, 20), error(along, 40));
            (coarse / fine, fine)
        });
        assert!(through.0 > 14.0 && through.1 < 1e-8, "{through:?}");
        assert!((3.5..4.5).contains(&near.0), "{near:?}");
        let inside =
            0.05_f64.powi(2) / 6.0 * 9e-3 * 0.7_f64.sin().max(3.0_f64.mul_add(0.5, 0.0).sin());
        assert!((near.1 / inside - 1.0).abs() < 0.05, "{} {inside}", near.1);
    }

    /// A wheel with slices all round has a seam as smooth as the rest. With few slices the seam is
    /// straight. After a full turn the surface repeats.
    #[test]
    fn a_wheel_closes() {
        let profile = wheel_s1002().unwrap();
        let radial = |theta: f64| 1e-4 * (2.0 * theta).sin();
        let raised = |theta: f64| slice(theta, profile.placed(0.0, [0.0, radial(theta)]));
        let all: Vec<Slice> = (0..60).map(|k| raised(0.1 + TAU * f64::from(k) / 60.0)).collect();
        let surface = Slices::new(&all, Along::Through, Some(TAU)).unwrap();
        for k in -200..200 {
            let theta = 0.05 * f64::from(k);
            let height = surface.at(theta, 1e-3, &mut 0).place.position[1];
            assert!(
                (height - profile.at(1e-3).position[1] - radial(theta)).abs() < 1e-9,
                "{theta}"
            );
        }
        let few: Vec<Slice> = [-0.2, 0.0, 0.1].map(raised).to_vec();
        let surface = Slices::new(&few, Along::Through, Some(TAU)).unwrap();
        let height = |theta: f64| surface.at(theta, 0.0, &mut 0).place.position[1];
        let mean = 0.5 * (radial(-0.2) + radial(0.1));
        assert!((height(-0.05 + 0.5 * TAU) - mean).abs() < 1e-12);
        assert!((height(-0.1) - height(-0.1 - TAU)).abs() < 1e-15);
    }

    /// A corner that wanders across stays on its path if it is a feature, and is smeared otherwise.
    #[test]
    fn features_hold_corners_together() {
        let roof = |at: f64, ridge: f64| {
            let point = |k: i32| {
                let y = 1e-3 * f64::from(k);
                let from = (y - ridge).abs();
                [y, -0.3 * from]
            };
            let mut points: Vec<[f64; 2]> = (-30..=30).map(point).collect();
            points.push([ridge, 0.0]);
            points.sort_by(|a, b| a[0].total_cmp(&b[0]));
            let outline = Outline::new(&points, 0.0).unwrap();
            let ridge = outline.kinks().next().unwrap();
            let features = vec![0.0, ridge, 999.0];
            Slice { at, outline, features }
        };
        let mut slices: Vec<Slice> =
            (0..5).map(|k| roof(0.1 * f64::from(k), 1e-3 * f64::from(k) + 3.5e-4)).collect();
        let top = |slices: &[Slice]| {
            let section = Slices::new(slices, Along::Through, None).unwrap().section(0.15);
            let [from, to] = section.range();
            let top = section.largest([from, to], |place| place.position[1]);
            section.at(top).position
        };
        let [y, z] = top(&slices);
        assert!((y - 1.85e-3).abs() < 1e-8 && z.abs() < 1e-8, "{y} {z}");
        slices[2].features[1] = 0.5;
        let wrong = Slices::new(&slices, Along::Through, None);
        assert_eq!(wrong, Err(SlicesError::Features(3)));
        slices.iter_mut().for_each(|slice| slice.features.clear());
        assert!(top(&slices)[1] < -1e-5);
    }

    proptest! {
        /// Positions and features of any size, and slices with different numbers of points.
        #[test]
        fn no_slices_panic(
            given in prop::collection::vec((any::<f64>(), -2.0..2.0_f64, 0.0..0.2_f64, 4..40_usize), 0..6),
            features: bool,
            near: bool,
            wheel: bool,
            at in any::<f64>(),
        ) {
            let slice = |(wild, tame, feature, count): &(f64, f64, f64, usize)| {
                let point = |k: usize| [2e-3 * k as f64 - 5e-3, *feature * (k as f64 * tame).sin()];
                let outline = Outline::new(&(0..*count).map(point).collect::<Vec<_>>(), 0.0).ok()?;
                let features = if features { vec![0.0, *feature, 999.0] } else { Vec::new() };
                Some(Slice { at: if count % 5 == 0 { *wild } else { *tame }, outline, features })
            };
            let mut slices: Vec<Slice> = given.iter().filter_map(slice).collect();
            slices.sort_by(|a, b| a.at.total_cmp(&b.at));
            let along = if near { Along::Near } else { Along::Through };
            if let Ok(surface) = Slices::new(&slices, along, wheel.then_some(TAU)) {
                let _ = surface.section(at).at(1e-3);
                let _ = surface.placed(0.1, [0.0; 2]).mirrored().at(at, -1e-3, &mut 0);
            }
        }
    }

    #[test]
    fn slices_that_are_no_surface_are_refused() {
        let profile = rail_60e1().unwrap();
        let of = |at: &[f64], period| {
            let slices: Vec<Slice> = at.iter().map(|at| slice(*at, profile.clone())).collect();
            Slices::new(&slices, Along::Through, period).unwrap_err().to_string()
        };
        assert!(of(&[0.0], None).contains("is 1;"));
        assert!(of(&[0.0, 1.0, 1.0], None).contains("slices 2 and 3"));
        assert!(of(&[0.0, f64::NAN], None).contains("ascending"));
        assert!(of(&[0.0, 12.0], Some(TAU)).contains("12.0000 rad"));
    }
}
