//! Explicit finite elements: waves, and the advected mesh.

use explicit_fe::block::{Block, Solid, Support};
use explicit_fe::section::{Section, Sizes, circle};

const E: f64 = 210e9;
const DENSITY: f64 = 7850.0;

fn solid(nu: f64, radius: f64) -> Solid {
    let lame = [E * nu / ((1.0 + nu) * (1.0 - 2.0 * nu)), 0.5 * E / (1.0 + nu)];
    Solid { lame, density: DENSITY, flow: None, radius }
}

/// An advected block equals a part of a long stationary one, whose columns are never dropped or
/// added. Both receive the same pushes, until a wave reaches an end. Tolerance: rounding.
#[test]
fn a_block_that_travels_is_part_of_a_long_one() {
    let element = 1e-3;
    let section = || {
        let sizes = Sizes { element, fine: [3e-3, 3e-3], whole: [40e-3, 30e-3], middle: 0.0 };
        Section::new(&sizes, circle(0.3))
    };
    for radius in [f64::INFINITY, 0.3] {
        let new = |columns: usize| {
            Block::new(columns, element, section(), solid(0.3, radius), Support::Faces)
        };
        let (mut short, mut long) = (new(48), new(64));
        let step = 0.9 * 2.0 / short.highest_frequency();
        for block in [&mut short, &mut long] {
            block.damping = 0.05 * step;
        }
        let (mut ahead, row) = (8, short.counts[1] / 2);
        let mut shifts = 0;
        for count in 0..16 {
            short.step(step);
            long.step(step);
            let velocity = [0.3 * f64::from(count), 0.1, -1.0];
            short.push(row * short.stride + 24, velocity, step);
            long.push(row * long.stride + 24 + ahead, velocity, step);
            if short.travel(0.23 * element) {
                shifts += 1;
                ahead += 1;
            }
        }
        assert_eq!(shifts, 3);
        let mut largest = 0.0_f64;
        for rows in 0..short.section.nodes.len() {
            for column in 0..=48 {
                let (own, other) =
                    (rows * short.stride + column, rows * long.stride + column + ahead);
                for k in 0..3 {
                    let (a, b) = (short.velocity[k][own], long.velocity[k][other]);
                    largest = largest.max(a.abs());
                    assert!((a - b).abs() <= 1e-15, "{radius} {rows} {column} {a:e} {b:e}");
                    let (a, b) = (short.damped[k][own], long.damped[k][other]);
                    assert!((a - b).abs() <= 1e-15 * step, "{radius} {rows} {column} {a:e} {b:e}");
                }
            }
        }
        assert!(largest > 0.1);
    }
}

/// Ratio of the speed of Rayleigh's wave to that of shear waves: (2 − s)² = 4 √((1 − s)(1 − κ s)),
/// with its square s and κ the squared ratio of shear to pressure wave speed.
fn rayleigh(kappa: f64) -> f64 {
    let excess = |s: f64| (2.0 - s).powi(2) - 4.0 * ((1.0 - s) * (1.0 - kappa * s)).sqrt();
    let (mut low, mut high) = (0.1, 1.0);
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        *(if excess(middle) < 0.0 { &mut low } else { &mut high }) = middle;
    }
    low.sqrt()
}

/// A line of the surface is struck: Rayleigh's wave passes two positions one after the other at its
/// speed, in plane strain, at the Poisson's ratio of steel and near 0.5. Tolerance: 1 %.
#[test]
fn a_wave_goes_along_the_surface() {
    for nu in [0.3, 0.45] {
        let (element, columns, deep) = (1e-3, 640, 90);
        let place = |k: usize, j: usize| [(j as f64 - 0.5) * element, k as f64 * element];
        let nodes = (0..=deep).flat_map(|k| [place(k, 0), place(k, 1)]).collect();
        let section = Section { counts: [1, deep], nodes, fine: [0, 1] };
        let own = solid(nu, f64::INFINITY);
        let mut block = Block::new(columns, element, section, own, Support::Nothing);
        let step = 0.9 * 2.0 / block.highest_frequency();
        let shear = (own.lame[1] / own.density).sqrt();
        let expected = shear * rayleigh(own.lame[1] / (own.lame[0] + 2.0 * own.lame[1]));
        // Push with a spectrum around wavelengths of 25 elements.
        let frequency = expected / (25.0 * element);
        let push = |time: f64| {
            let phase = (std::f64::consts::PI * (time * frequency - 1.2)).powi(2);
            (1.0 - 2.0 * phase) * (-phase).exp()
        };
        let (source, places) = (100, [250, 450]);
        let steps = ((400.0 * element / expected + 3.0 / frequency) / step) as usize;
        let mut heard: [Vec<f64>; 2] = Default::default();
        for count in 0..steps {
            block.step(step);
            let amount = push(count as f64 * step);
            for row in 0..2 {
                block.push(row * block.stride + source, [0.0, 0.0, amount], step);
            }
            // Plane strain.
            block.velocity[1].fill(0.0);
            block.damped[1].fill(0.0);
            for (heard, place) in heard.iter_mut().zip(places) {
                heard.push(block.damped[2][place]);
            }
        }
        let delay = delay(&heard[0], &heard[1]) * step;
        let speed = (places[1] - places[0]) as f64 * element / delay;
        println!("nu {nu}: {speed:.1} m/s, {:.5} of Rayleigh's", speed / expected);
        assert!((speed / expected - 1.0).abs() < 0.01, "{nu}: {speed} {expected}");
    }
}

/// Delay in steps at which the second signal correlates best with the first, refined by a parabola.
fn delay(first: &[f64], second: &[f64]) -> f64 {
    let alike =
        |shift: usize| -> f64 { first.iter().zip(&second[shift..]).map(|(a, b)| a * b).sum() };
    let all: Vec<f64> = (0..first.len()).map(alike).collect();
    let at = (1..all.len() - 1).max_by(|a, b| all[*a].total_cmp(&all[*b])).unwrap_or(1);
    let [before, top, after] = [all[at - 1], all[at], all[at + 1]];
    at as f64 + 0.5 * (before - after) / (before - 2.0 * top + after)
}
