//! Explicit finite elements: tests that every such code has to pass.

use explicit_fe::block::{Block, Solid, Support};
use explicit_fe::contact::{Contact, Frame, Law};
use explicit_fe::plane::Plane;
use explicit_fe::section::{Section, Sizes, circle};
use grids::Structured;

const E: f64 = 210e9;
const NU: f64 = 0.3;
const DENSITY: f64 = 7850.0;

fn steel(nu: f64, radius: f64) -> Solid {
    let lame = [E * nu / ((1.0 + nu) * (1.0 - 2.0 * nu)), 0.5 * E / (1.0 + nu)];
    Solid { lame, density: DENSITY, flow: None, radius }
}

/// Cross-section with quadrilaterals that are not rectangles.
fn distorted(element: f64) -> Section {
    let sizes = Sizes { element, fine: [4e-3, 3e-3], whole: [40e-3, 30e-3], middle: 0.0 };
    let mut section = Section::new(&sizes, circle(f64::INFINITY));
    let across = section.counts[0] + 1;
    for (at, node) in section.nodes.iter_mut().enumerate() {
        node[0] += 0.15 * element * ((at * 7) % 5) as f64 / 5.0;
        node[1] += 0.15 * element * ((at * 3 + at / across) % 7) as f64 / 7.0;
    }
    section
}

/// Displaces all nodes by a field over (x, y, z), z into the body.
fn displace(block: &mut Block, field: impl Fn([f64; 3]) -> [f64; 3]) {
    let (rows, stride, radius) = (block.section.nodes.len(), block.stride, block.solid.radius);
    for row in 0..rows {
        let [y, depth] = block.section.nodes[row];
        for column in 0..=block.counts[0] {
            let (sine, cosine) = (block.place(column) / radius).sin_cos();
            let place = if radius.is_finite() {
                [(radius - depth) * sine, y, radius - (radius - depth) * cosine]
            } else {
                [block.place(column), y, depth]
            };
            let [u, v, w] = field(place);
            let own = [u * cosine + w * sine, v, w * cosine - u * sine];
            for (values, own) in block.damped.iter_mut().zip(own) {
                values[row * stride + column] = own;
            }
        }
    }
}

/// Largest velocity after a step, of inner nodes and of all nodes.
fn largest(block: &Block) -> [f64; 2] {
    let [columns, across, deep] = block.counts;
    let mut largest = [0.0_f64; 2];
    for row in 0..(across + 1) * (deep + 1) {
        let (j, k) = (row % (across + 1), row / (across + 1));
        for column in 0..=columns {
            let size = (0..3)
                .map(|c| block.velocity[c][row * block.stride + column].powi(2))
                .sum::<f64>()
                .sqrt();
            let inside = (1..columns).contains(&column)
                && (1..across).contains(&j)
                && (1..deep).contains(&k);
            largest[1] = largest[1].max(size);
            largest[0] = largest[0].max(if inside { size } else { 0.0 });
        }
    }
    largest
}

/// Patch test: a linear field causes no force on inner nodes of distorted elements, straight or
/// about an axis.
#[test]
fn a_linear_field_makes_no_force_inside() {
    for radius in [f64::INFINITY, 0.2] {
        let mut block = Block::new(24, 1e-3, distorted(1e-3), steel(NU, radius), Support::Nothing);
        let slope = [[1e-4, 2e-5, -3e-5], [4e-5, -2e-4, 1e-5], [3e-5, 7e-5, 5e-5]];
        displace(&mut block, |x| slope.map(|row| row.iter().zip(x).map(|(g, x)| g * x).sum()));
        block.step(1e-9);
        let [inside, all] = largest(&block);
        println!("radius {radius}: {:.1e} of {all:.2e} m/s", inside / all);
        assert!(inside < 1e-12 * all, "{radius} {inside:e} {all:e}");
    }
}

/// A layer that expands by its thermal strain has no force, straight or about an axis. Tolerance:
/// second order in the strain, relative to the force of the expansion alone.
#[test]
fn a_layer_that_expands_by_its_strain_makes_no_force() {
    let (thickness, strain) = (0.8e-3, 1e-7);
    let y = |j: usize| 1e-3 * (j as f64 - 2.0 + 0.1 * (j % 2) as f64);
    let nodes = [0.0, thickness].into_iter().flat_map(|z| (0..5).map(move |j| [y(j), z])).collect();
    let section = Section { counts: [4, 1], nodes, fine: [0, 4] };
    for radius in [f64::INFINITY, 0.05] {
        // Elements about an axis have chords instead of arcs.
        let angle = 1e-3 / radius;
        let chords = if angle > 0.0 { angle.sin() / angle } else { 1.0 };
        let volume = chords * thickness * (1.0 - 0.5 * thickness / radius);
        let moved = |strained: f64| {
            let solid = steel(NU, radius);
            let mut block = Block::new(16, 1e-3, section.clone(), solid, Support::Nothing);
            displace(&mut block, |x| x.map(|x| strained * x));
            block.expand(|_, _| strain * volume);
            block.step(1e-9);
            largest(&block)[1]
        };
        let ratio = moved(strain) / moved(0.0);
        println!("radius {radius}: {ratio:.1e}");
        assert!(ratio < 1e-6, "{radius} {ratio:e}");
    }
}

/// A rotation by 0.3 causes no force. Tolerance: rounding, relative to the force of an equal
/// strain.
#[test]
fn a_rigid_rotation_makes_no_force() {
    for radius in [f64::INFINITY, 0.2] {
        let mut block = Block::new(24, 1e-3, distorted(1e-3), steel(NU, radius), Support::Nothing);
        let (sine, cosine) = 0.3_f64.sin_cos();
        displace(&mut block, |[x, y, _]| {
            let (turned_x, turned_y) = (cosine * x - sine * y, sine * x + cosine * y);
            [turned_x - x, turned_y - y, 0.0]
        });
        block.step(1e-9);
        let rigid = largest(&block)[1];
        let mut strained =
            Block::new(24, 1e-3, distorted(1e-3), steel(NU, radius), Support::Nothing);
        displace(&mut strained, |[x, _, _]| [0.3 * x, 0.0, 0.0]);
        strained.step(1e-9);
        let ratio = rigid / largest(&strained)[1];
        println!("radius {radius}: {ratio:.1e}");
        assert!(ratio < 1e-12, "{radius} {ratio:e}");
    }
}

/// A bar with one end stopped suddenly. The front travels at c0 = √(E/ρ); behind it the stress is ρ
/// c0 v and the velocity is zero. Lateral inertia spreads the front like Airy's integral, of which
/// a third is before x = c0 t (Skalak, J. Appl. Mech. 24 (1957)). Free vibration conserves energy.
/// Tolerance 1 %: higher orders of the dispersion.
#[test]
fn a_bar_that_is_stopped() {
    let (element, length) = (1e-3, 400);
    let sizes = Sizes { element, fine: [0.5e-3, 0.5e-3], whole: [10e-3, 10e-3], middle: 0.0 };
    let mut block = Block::new(
        length,
        element,
        Section::new(&sizes, circle(f64::INFINITY)),
        steel(NU, f64::INFINITY),
        Support::Nothing,
    );
    let speed = 1.0;
    block.velocity[0].iter_mut().for_each(|v| *v = -speed);
    let step = 0.9 * 2.0 / block.highest_frequency();
    let c0 = (E / DENSITY).sqrt();
    let time = 0.5 * length as f64 * element / c0;
    let steps = (time / step).round() as usize;
    let begun = block.kinetic_energy();
    let rows = block.section.nodes.len();
    let mean = |values: &[f64], stride: usize, column: usize| -> f64 {
        (0..rows).map(|row| values[row * stride + column]).sum::<f64>() / rows as f64
    };
    // Times at which a third of the front has passed two columns.
    let columns = [length / 8, 3 * length / 8];
    let mut arrivals = [0.0; 2];
    for count in 1..=steps {
        block.step(step);
        // The first column stays fixed.
        for row in 0..rows {
            let node = row * block.stride;
            (block.damped[0][node], block.velocity[0][node]) = (0.0, 0.0);
        }
        for (column, arrival) in columns.iter().zip(&mut arrivals) {
            if *arrival == 0.0
                && mean(&block.velocity[0], block.stride, *column) > -2.0 / 3.0 * speed
            {
                *arrival = count as f64 * step;
            }
        }
    }
    // Shortening of the first half: the strain is v/c0 behind the front, which is in the middle.
    let shift = |column: usize| mean(&block.damped[0], block.stride, column);
    let strain = -(shift(length / 4) - shift(length / 20)) / (0.2 * length as f64 * element);
    let way = (columns[1] - columns[0]) as f64 * element;
    let front = way / (arrivals[1] - arrivals[0]);
    println!("strain {:.5} of v/c0, front {:.5} of c0", strain * c0 / speed, front / c0);
    assert!((strain * c0 / speed - 1.0).abs() < 0.01);
    assert!((front / c0 - 1.0).abs() < 0.01);
    let elastic: f64 = block.elastic_energy().iter().sum();
    let kept = (elastic + block.kinetic_energy()) / begun;
    // The energy of the nodes stopped at once is that of one column in 800.
    println!("energy {kept:.5}");
    assert!((kept - 1.0).abs() < 0.01);
}

/// Two free blocks pressed together with friction exchange momentum and lose none. Tolerance:
/// rounding.
#[test]
fn contact_conserves_momentum() {
    let section = || {
        let sizes = Sizes { element: 1e-3, fine: [8e-3, 3e-3], whole: [20e-3, 15e-3], middle: 0.0 };
        Section::new(&sizes, circle(f64::INFINITY))
    };
    let mut upper = Block::new(32, 1e-3, section(), steel(NU, 0.2), Support::Nothing);
    let mut lower = Block::new(40, 1e-3, section(), steel(NU, f64::INFINITY), Support::Nothing);
    let row = (0..upper.section.counts[1] + 1)
        .find(|j| upper.section.nodes[*j][0] > -6.5e-3)
        .unwrap_or_default();
    let grid = Structured::contact_plane(-8e-3, upper.section.nodes[row][1], 1e-3, 1e-3, 17, 12);
    let mut plane = Plane::new(grid, row);
    let mut contact = Contact::new(&upper, &lower);
    let momentum = |block: &Block| -> [f64; 3] {
        std::array::from_fn(|k| {
            let of_row = |(row, inverse): (usize, &f64)| {
                let part = |c: usize| if c == 0 || c == block.counts[0] { 0.5 } else { 1.0 };
                let sum: f64 = (0..=block.counts[0])
                    .map(|c| part(c) * block.velocity[k][row * block.stride + c])
                    .sum();
                sum / inverse
            };
            block.inverse_mass.iter().enumerate().map(of_row).sum()
        })
    };
    // The lower body is straight: its nodes have parallel directions, so that momenta add up.
    let frame = Frame {
        approach: 20e-6,
        rising: 0.0,
        speeds: [10.1, 10.0],
        ways: [0.0, 0.0],
        ..Frame::default()
    };
    let law = Law { coefficient: 0.3, sticks: true, flexibility: [0.0; 2] };
    let before = momentum(&lower);
    upper.step(1e-7);
    lower.step(1e-7);
    let sums = contact.resolve([&mut upper, &mut lower], &frame, law, 1e-7, &mut plane);
    let after = momentum(&lower);
    let received = [before[0] - after[0], before[1] - after[1], after[2] - before[2]];
    println!("{:?} {received:?}", sums.impulse);
    assert!(sums.impulse[2] > 0.0 && sums.impulse[0].abs() > 0.0);
    for (given, received) in sums.impulse.iter().zip(received) {
        assert!((given - received).abs() < 1e-12 * sums.impulse[2], "{given} {received}");
    }
    assert!(sums.friction > 0.0);
    let tangential: f64 = plane.tangential[0].iter().sum();
    assert!(
        (plane.work.iter().sum::<f64>() / sums.friction - 1.0).abs() < 1e-12 && tangential != 0.0
    );
}

/// Flat surfaces with a flexibility L far above that of the blocks. The pressure is the overlap
/// over L, and the traction is the displacement over L until it reaches f p. The supplied energy is
/// the friction work plus the energy stored in the springs. Tolerances: the flexibility of the
/// blocks relative to L, 0.1 %, twice that in their first wave, and four times as much along the
/// surface.
#[test]
fn surfaces_that_yield_are_springs() {
    let sizes = Sizes { element: 1e-3, fine: [8e-3, 3e-3], whole: [20e-3, 15e-3], middle: 0.0 };
    let new = || {
        Block::new(
            40,
            1e-3,
            Section::new(&sizes, circle(f64::INFINITY)),
            steel(NU, f64::INFINITY),
            Support::Faces,
        )
    };
    let [mut upper, mut lower] = [new(), new()];
    let row = upper.section.fine[0] + 2;
    let grid = Structured::contact_plane(-8e-3, upper.section.nodes[row][1], 1e-3, 1e-3, 17, 10);
    let mut plane = Plane::new(grid, row);
    let mut contact = Contact::new(&upper, &lower);
    let (step, overlap, sliding) = (1e-7, 20e-6, 0.5);
    let flexibility = [1e-10, 1e-10];
    let law = Law { coefficient: 0.3, sticks: true, flexibility };
    let frame = Frame {
        approach: overlap,
        rising: 0.0,
        speeds: [10.0 + sliding, 10.0],
        ..Frame::default()
    };
    let (mut given, mut friction, mut traction) = (0.0, 0.0, 0.0);
    let pressure = overlap / flexibility[0];
    for count in 1..=200 {
        upper.step(step);
        lower.step(step);
        let sums = contact.resolve([&mut upper, &mut lower], &frame, law, step, &mut plane);
        let per_area = |impulse: f64| impulse / (step * sums.areas[0]);
        assert!((per_area(sums.pressed) / pressure - 1.0).abs() < 0.003, "{count}");
        let slid = sliding * f64::from(count) * step;
        traction = (slid / flexibility[1]).min(0.3 * pressure);
        let found = per_area(sums.impulse[0]);
        assert!((found - traction).abs() < 0.01 * traction, "{count} {found:e} {traction:e}");
        given += sums.work / sums.areas[0];
        friction += sums.friction / sums.areas[0];
    }
    let kept = 0.5 * traction * traction * flexibility[1];
    assert!(friction > kept, "{friction} {kept}");
    let balance = (friction + kept) / given;
    println!("given {given:.3} J/m², friction {friction:.3}, kept {kept:.3}: {balance:.4}");
    assert!((balance - 1.0).abs() < 0.01);
}
