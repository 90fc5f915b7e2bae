//! Effect `stress_at_points`: the stress tensor at points given by the case.
//!
//! The case names blocks of points, each in one body. A block is a lattice of coordinates along x,
//! y and z (a point, a line, a plane or a box), or a list from a file. The outputs at each point
//! are the six stress components, the von Mises stress, the largest shear stress ½(σ₁ − σ₃), the
//! mean normal stress, and the principal stresses σ₁ ≥ σ₂ ≥ σ₃ with their directions. They are the
//! stresses of the elastic half-spaces under pressure and tractions ([`half_space::subsurface`]).
//! If the bodies expand thermally, their thermal stress is added
//! ([`crate::terms::thermal_stress`]).
//!
//! Axes and signs are the same as for all fields: x along rolling, y to the left, z up. The lower
//! body therefore has z ≤ 0, and the upper one z ≥ 0. The origin is that of the contact's grid.
//! Tension is positive. A principal direction is unique except for its sign; its largest component
//! is positive.
//!
//! Source: Johnson, *Contact Mechanics* (1985) §3.2 and §3.6; for thermal stress Goodier, Phil.
//! Mag. 23 (1937). CONTACT offers similar blocks of points.

mod blocks;

use crate::advice::situation::{PRESSURE, Situation};
use crate::case::keys::CheckedParams;
use crate::registry::entry::Effect;
use crate::terms::thermal_stress::{self, ThermalStress};
use crate::terms::{Accepted, Kind, Observation, Place, State, Terms};
use blocks::PointBlock;
use elastic::Stress;
use half_space::subsurface::{Nodes, SurfaceLoad};
use proto::advice::Advice;
use proto::bodies::LOWER;
use proto::configuration::{Configuration, Refusal};
use proto::description::KeySpec;
use proto::field::{self, FieldSpec};
use proto::figure::FigureSpec;
use proto::grid::{Block, Places, Points, Shape, Structured};
use proto::model::Outputs;
use serde_json::{Value, json};

/// Registry entry of the effect.
pub const EFFECT: Effect = Effect {
    name: "stress_at_points",
    law: "stress tensor, sqrt(3 J2), (s1 - s3)/2, (s1 + s2 + s3)/3 and principal stresses of the elastic half-spaces at \
          points that the case names, with the thermal stress of bodies that expand as they move steadily",
    source: "Johnson, Contact Mechanics (1985) par. 3.2, 3.6; Love, Phil. Trans. R. Soc. A 228 (1929); \
             Goodier, Phil. Mag. 23 (1937) 1017-1032",
    kinds: &[Kind::Observation],
    consumes: &[],
    provides: &[
        &field::POINT_VON_MISES,
        &field::POINT_MAX_SHEAR,
        &field::POINT_HYDROSTATIC,
        &field::POINT_STRESS,
        &field::POINT_PRINCIPAL_1,
        &field::POINT_PRINCIPAL_2,
        &field::POINT_PRINCIPAL_3,
        &field::POINT_DIRECTION_1,
        &field::POINT_DIRECTION_2,
        &field::POINT_DIRECTION_3,
    ],
    keys,
    figures,
    advise: Some(advise),
    terms,
};

/// Name of the grid of all blocks.
const GRID: &str = "stress";
const PRINCIPAL: [FieldSpec; 3] =
    [field::POINT_PRINCIPAL_1, field::POINT_PRINCIPAL_2, field::POINT_PRINCIPAL_3];
const DIRECTIONS: [FieldSpec; 3] =
    [field::POINT_DIRECTION_1, field::POINT_DIRECTION_2, field::POINT_DIRECTION_3];

fn keys() -> Vec<KeySpec> {
    let mut keys = blocks::keys();
    keys.extend(thermal_stress::keys());
    keys
}

fn terms(configuration: &Configuration) -> Result<Terms, Refusal> {
    let case = CheckedParams::new(&configuration.case, keys());
    let thermal = ThermalStress::read(configuration, &case, EFFECT.name)?;
    let asked = blocks::read(configuration, &case, &thermal.names)?;
    let points = AtPoints { asked, thermal, on: None, stresses: None };
    Ok(Terms { observations: vec![Box::new(points)], ..Terms::default() })
}

/// Requested points and their stresses.
#[derive(Debug)]
struct AtPoints {
    asked: Vec<PointBlock>,
    thermal: ThermalStress,
    /// Grid of the contact and blocks of points, once the contact is placed.
    on: Option<(Structured, Points)>,
    /// Stresses in the axes of all fields [Pa].
    stresses: Option<Vec<Stress>>,
}

impl State for AtPoints {}

impl AtPoints {
    /// Stresses in a body [Pa], in the frame of the body: z is the depth.
    fn in_body(
        &self,
        places: &Places,
        body: usize,
        accepted: &Accepted<'_>,
        on: &SurfaceLoad<'_>,
    ) -> Vec<Stress> {
        let poisson_ratio = self.thermal.materials[body].poisson_ratio;
        let warm = self.thermal.of(accepted, body);
        let down = if body == LOWER { -1.0 } else { 1.0 };
        match places {
            Places::List(points) => {
                let nodes = Nodes::of(on, poisson_ratio);
                let at = |&[x, y, z]: &[f64; 3]| {
                    let depth = (down * z).max(0.0);
                    let elastic = nodes.stress([x, y, depth]);
                    warm.iter().fold(elastic, |sum, (warm, rise)| {
                        sum + warm.stresses(rise, &[x], y, &[depth])[0]
                    })
                };
                points.iter().map(at).collect()
            }
            Places::Lattice([xs, ys, zs]) => {
                let depths: Vec<f64> = zs.iter().map(|z| (down * z).max(0.0)).collect();
                let mut stresses = on.on_lattice(poisson_ratio, [xs, ys, &depths]);
                if let Some((warm, rise)) = &warm {
                    // Sorted from the surface down, whatever the direction of z.
                    let mut layers: Vec<usize> = (0..depths.len()).collect();
                    layers.sort_by(|a, b| depths[*a].total_cmp(&depths[*b]));
                    let sorted: Vec<f64> = layers.iter().map(|layer| depths[*layer]).collect();
                    for (j, y) in ys.iter().enumerate() {
                        let added = warm.stresses(rise, xs, *y, &sorted);
                        for (layer, row) in layers.iter().zip(added.chunks_exact(xs.len())) {
                            let first = (layer * ys.len() + j) * xs.len();
                            for (stress, more) in stresses[first..].iter_mut().zip(row) {
                                *stress = *stress + *more;
                            }
                        }
                    }
                }
                stresses
            }
        }
    }
}

impl Observation for AtPoints {
    fn place(&mut self, place: &Place) {
        let block = |asked: &PointBlock| Block {
            name: asked.name.clone(),
            places: asked.places(&place.grid),
        };
        let points = Points { blocks: self.asked.iter().map(block).collect() };
        self.on = Some((place.grid, points));
    }

    fn expand(&mut self, coefficients: [f64; 2], speeds: [f64; 2]) -> Result<(), Refusal> {
        self.thermal.expand(coefficients, speeds)
    }

    fn grids(&self) -> Vec<(&'static str, Shape)> {
        self.on.iter().map(|(_, points)| (GRID, Shape::Points(points.clone()))).collect()
    }

    fn grid_of(&self, field: &FieldSpec) -> Option<&'static str> {
        EFFECT.provides.contains(&field).then_some(GRID)
    }

    fn observe(&mut self, accepted: &Accepted<'_>) {
        let Some((contact, points)) = &self.on else { return };
        let turned: Vec<f64> = accepted.traction.iter().map(|value| -value).collect();
        let mut stresses = Vec::with_capacity(points.count());
        for (asked, block) in self.asked.iter().zip(&points.blocks) {
            let lower = asked.body == LOWER;
            let traction = if lower { &turned } else { accepted.traction };
            let load = SurfaceLoad::new(contact, accepted.pressure, traction);
            let own = self.in_body(&block.places, asked.body, accepted, &load);
            let up = if lower { -1.0 } else { 1.0 };
            stresses.extend(own.into_iter().map(|own| Stress {
                yz: up * own.yz,
                xz: up * own.xz,
                ..own
            }));
        }
        self.stresses = Some(stresses);
    }

    fn write(&self, outputs: &mut dyn Outputs) {
        let Some(stresses) = &self.stresses else { return };
        let mut scalar = |spec: &FieldSpec, of: fn(&Stress) -> f64| {
            if let Some(place) = outputs.get(spec) {
                place.iter_mut().zip(stresses).for_each(|(value, stress)| *value = of(stress));
            }
        };
        scalar(&field::POINT_VON_MISES, Stress::von_mises);
        scalar(&field::POINT_MAX_SHEAR, Stress::max_shear);
        scalar(&field::POINT_HYDROSTATIC, Stress::mean);
        if let Some(place) = outputs.get(&field::POINT_STRESS) {
            for (at, stress) in stresses.iter().enumerate() {
                let Stress { xx, yy, zz, yz, xz, xy } = *stress;
                for (part, value) in [xx, yy, zz, xy, yz, xz].into_iter().enumerate() {
                    place[part * stresses.len() + at] = value;
                }
            }
        }
        let principal: Vec<_> = stresses.iter().map(Stress::principal_directions).collect();
        for (which, (value, direction)) in PRINCIPAL.iter().zip(&DIRECTIONS).enumerate() {
            if let Some(place) = outputs.get(value) {
                place.iter_mut().zip(&principal).for_each(|(value, all)| *value = all[which].0);
            }
            if let Some(place) = outputs.get(direction) {
                for (at, all) in principal.iter().enumerate() {
                    for (axis, value) in positive(all[which].1).into_iter().enumerate() {
                        place[axis * principal.len() + at] = value;
                    }
                }
            }
        }
    }

    /// Largest von Mises stress of every block and its position.
    fn summary(&self) -> Option<(&'static str, Value)> {
        let ((_, points), stresses) = (self.on.as_ref()?, self.stresses.as_ref()?);
        let largest = |(first, block): (usize, &Block)| {
            let own = stresses[first..first + block.places.count()].iter().map(Stress::von_mises);
            let (at, value) = own.enumerate().max_by(|a, b| a.1.total_cmp(&b.1))?;
            let [x, y, z] = block.places.point(at);
            let points = block.places.count();
            Some(json!({
                "block": block.name, "points": points, "max_von_mises_pa": value, "x_m": x, "y_m": y, "z_m": z,
            }))
        };
        let each: Vec<Value> = points.parts().filter_map(largest).collect();
        Some((EFFECT.name, json!({ "each_block": each })))
    }
}

/// Returns the direction with the sign that makes its largest component positive.
fn positive(direction: [f64; 3]) -> [f64; 3] {
    let largest = direction.into_iter().fold(0.0_f64, |a, b| if b.abs() > a.abs() { b } else { a });
    if largest < 0.0 { direction.map(|component| -component) } else { direction }
}

fn figures() -> Vec<FigureSpec> {
    let figure = |name: &str, unit, words| {
        FigureSpec::new(&format!("stress_at_points.each_block.#.{name}"), unit, words)
    };
    vec![
        figure("max_von_mises_pa", "Pa", "largest von Mises stress of the block")
            .on("block", "von Mises")
            .digits(4)
            .headline(),
        figure("x_m", "m", "x of the largest von Mises stress").on("block", "at x"),
        figure("y_m", "m", "y of the largest von Mises stress").on("block", "y"),
        figure("z_m", "m", "z of the largest von Mises stress").on("block", "z"),
    ]
}

fn advise(_: &Situation<'_>) -> Advice {
    Advice::new(EFFECT.name, "computed from the contact, without influence on it")
        .moves(PRESSURE, 0.0)
}
