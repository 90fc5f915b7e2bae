//! Model `explicit-fe`: explicit finite elements of both bodies, rolled until that is steady ([`crate::explicit`]).
//!
//! The lower body is straight, the upper one rolls on it with a longitudinal creepage or force; both may be curved
//! across. Hertz's contact only sizes the meshes. The model has no memory: it is computed once, when the model is built, with its
//! progress reported.

use crate::ellipse::{Ellipse, Prescribed};
use crate::entry::ModelEntry;
use crate::explicit::block::{Block, Held, Solid};
use crate::explicit::contact::Law;
use crate::explicit::plane::Plane;
use crate::explicit::rolling::{Asked, Means, Rolling};
use crate::explicit::section::{Section, Sizes};
use crate::half_space::extent::Moments;
use crate::keys::CheckedParams;
use crate::models::precomputed::{self, Precomputed, count};
use crate::reference::kalker;
use crate::resolution;
use crate::scene::{Body, Drive, GivenPatch, Load, Scene};
use crate::terms::{Kind, Terms};
use proto::accuracy::{Accuracy, Refinement, Simplification};
use proto::configuration::{Configuration, Layout, Refusal};
use proto::description::{KeySpec, ModelSpec, names};
use proto::field::{self, FieldSpec};
use proto::grid::Structured;
use proto::model::{Model, Setup};
use proto::params::Params;
use proto::progress::Progress;
use serde_json::{Value, json};

/// Its entry in the list.
pub(super) const MODEL: ModelEntry = ModelEntry {
    name: "explicit-fe",
    spec,
    takes: &[Kind::Adhesion, Kind::Layer, Kind::Flow, Kind::HeatShare],
    configure,
};
/// Elements per semi-axis, unless the case says otherwise: 0.6 mm in the contact of a wheel.
const RESOLUTION: usize = 13;
/// Where its errors were measured.
const STUDY: &str = "wheel-rail-fe against wheel-rail (docs/paper-elements.md)";
/// Elements a second on a core, measured.
const ELEMENTS_PER_SECOND: f64 = 5e7;
/// Memory over the elements [byte]: state, and forces on planes.
const BYTES_PER_ELEMENT: u64 = 60;
/// Half lengths of the blocks, and of their fine zones, in semi-axes of Hertz's contact.
const WHOLE: f64 = 6.0;
const FINE: [f64; 2] = [1.4, 0.75];
/// How far behind the middle of the contact material has what the passage leaves, in semi-axes.
const PASSED: f64 = 1.8;
/// Half the width of a curved body, and its depth, over its radii, at most.
const CURVED: f64 = 0.95;
/// Where nodes are looked at for contact, in semi-axes.
const WATCHED: f64 = 1.4;
/// Part of the pressure on the plane that is rounding.
const ROUNDING: f64 = 1e-9;
/// Elements between reports of progress, about.
const REPORT: u64 = 20_000_000;

/// Density of steel [kg/m³].
const STEEL: f64 = 7850.0;
const DENSITY: &str = "density";
const LENGTH: &str = "mech.length";
const WIDTH: &str = "mech.width";
const DEPTH: &str = "mech.depth";
const PENALTY: &str = "mech.penalty_stiffness";

fn spec() -> ModelSpec {
    let mut keys = own_keys();
    keys.push(resolution::key(RESOLUTION));
    ModelSpec {
        name: MODEL.name.to_owned(),
        summary: "explicit finite elements of both bodies, rolling until that is steady".to_owned(),
        source: "Flanagan & Belytschko, Int. J. Numer. Meth. Engng 17 (1981) 679-706; Carpenter, Taylor & \
                 Katona, ibid. 32 (1991) 103-128"
            .to_owned(),
        steady: true,
        transient: true,
        rewinds: true,
        consumes: Vec::new(),
        provides: names(&[&field::PRESSURE, &field::TRACTION, &field::SLIP_VELOCITY]),
        keys,
        accuracy: Accuracy {
            refinement: Some(Refinement {
                key: resolution::RESOLUTION.to_owned(),
                levels: vec![5, 7, 10, 13, 20],
                order: 1.0,
                error: 0.05,
                source: STUDY.to_owned(),
            }),
            simplifications: vec![Simplification::always(
                "blocks of elements that are held six semi-axes away",
                0.01,
                STUDY,
            )],
        },
    }
}

fn own_keys() -> Vec<KeySpec> {
    let size = |key: &str, of: &str| {
        let help = format!(
            "{of} of the elements of a body; absent: twelve semi-axes a of Hertz's contact"
        );
        KeySpec::quantity(key, "m", &help).above(0.0)
    };
    vec![
        KeySpec::quantity(
            &format!("materials.*.{DENSITY}"),
            "kg/m^3",
            "density; steady rolling hardly depends on it",
        )
        .above(0.0)
        .default_value(STEEL),
        size(LENGTH, "length"),
        size(WIDTH, "width"),
        KeySpec::quantity(
            PENALTY,
            "Pa/m",
            "stiffness of a penalty contact, of an overlap and of a node that sticks; absent: multipliers, \
             surfaces that do not overlap",
        )
        .above(0.0),
        KeySpec::quantity(
            DEPTH,
            "m",
            "depth of the elements of a body; absent: half as much as their length",
        )
        .above(0.0),
    ]
}

/// A checked case.
struct Prepared {
    sections: [Sizes; 2],
    solids: [Solid; 2],
    columns: usize,
    asked: Asked,
    scene: Scene,
    terms: Terms,
    grid: Structured,
    first_row: usize,
    wanted: Vec<&'static FieldSpec>,
    layout: Layout,
}

fn configure(configuration: &Configuration, terms: Terms) -> Result<Box<dyn Setup>, Refusal> {
    let case = &configuration.case;
    let scene = Scene::read(case)?;
    check(configuration, &scene)?;
    let ellipse = Ellipse::solve(&scene, None)?;
    let resolution = resolution::read(case, RESOLUTION)?;
    let [a, b] = [ellipse.semi_axis_a, ellipse.semi_axis_b];
    let element = a / resolution as f64;
    let own = CheckedParams::new(case, own_keys());
    let size = |key: &str| own.maybe_number(key);
    let length = size(LENGTH)?.unwrap_or(2.0 * WHOLE * a);
    let width = size(WIDTH)?.unwrap_or(2.0 * WHOLE * a.max(b));
    let depth = size(DEPTH)?.unwrap_or(0.5 * length.max(width));
    let fine = [FINE[0] * b, FINE[1] * a.min(b)];
    for (key, given, least) in [
        (LENGTH, length, 2.0 * WATCHED * a),
        (WIDTH, width, 4.0 * fine[0]),
        (DEPTH, depth, 4.0 * fine[1]),
    ] {
        if given < least {
            let reason = format!("{given:.4e} m leave no room round the contact");
            return Err(Refusal::new(
                key,
                reason,
                format!("write more than {least:.4e} m, or leave it out"),
            ));
        }
    }
    for (key, size, of) in [(WIDTH, 0.5 * width, 0), (DEPTH, depth, 1)] {
        for body in &scene.bodies {
            let most = CURVED * [body.radius_y, body.radius_x][of].abs();
            if size > most {
                let reason =
                    format!("with {size:.4e} m elements reach the middle of a curve of a body");
                let fix =
                    format!("write less than {:.4e} m, or leave it out", [2.0, 1.0][of] * most);
                return Err(Refusal::new(key, reason, fix));
            }
        }
    }
    let sizes =
        |body: &Body| Sizes { element, fine, whole: [0.5 * width, depth], radius: body.radius_y };
    let sections = [sizes(&scene.bodies[0]), sizes(&scene.bodies[1])];
    let mesh = Section::new(&sections[1]);
    let columns = (length / element).ceil() as usize;
    let (grid, first_row) = contact_grid(&mesh, element, [WATCHED * a, WATCHED * b]);
    let asked = asked(configuration, &scene, &ellipse, &terms)?;
    let [across, deep] = mesh.counts;
    let elements = 2 * columns.next_multiple_of(8) * across * deep;
    let solids = [solid(case, &scene, &terms, 0)?, solid(case, &scene, &terms, 1)?];
    let fastest = solids.iter().map(wave_speed).fold(0.0, f64::max);
    let steps = Rolling::expected_steps(&asked, 0.85 * element / fastest);
    let cores = configuration.threads.clamp(1, 2) as f64;
    let seconds = steps * elements as f64 / (cores * ELEMENTS_PER_SECOND);
    let wanted = precomputed::wanted_fields(configuration);
    let mut layout = precomputed::layout(&wanted, grid, seconds);
    layout.memory_bytes += elements as u64 * BYTES_PER_ELEMENT;
    layout.remarks.push(format!(
        "{elements} elements of {:.4} mm in the contact, about {:.0} steps of {:.1} ns over {:.1} mm of rolling",
        1e3 * element,
        steps,
        0.85e9 * element / fastest,
        1e3 * steps * 0.85 * element / fastest * asked.speed
    ));
    Ok(Box::new(Prepared {
        sections,
        solids,
        columns,
        asked,
        scene,
        terms,
        grid,
        first_row,
        wanted,
        layout,
    }))
}

/// Refuses what this model has no answer to.
fn check(configuration: &Configuration, scene: &Scene) -> Result<(), Refusal> {
    if configuration.histories.is_some() {
        return Err(Refusal::new(
            "mech.model",
            "explicit elements do not follow histories",
            "write numbers in the place of columns, or mech.model = \"half-space\"",
        ));
    }
    Ellipse::refuse_rest(scene)?;
    if GivenPatch::read(&configuration.case)?.is_some() {
        return Err(Refusal::new(
            "contact",
            "explicit elements find their own contact",
            "remove [contact], or write mech.model = \"half-space\"",
        ));
    }
    if let Load::Approach(_) = scene.load {
        return Err(Refusal::new(
            "load.approach",
            "explicit elements are pressed by a force",
            "write load.normal_force",
        ));
    }
    let [upper, lower] = &scene.bodies;
    let names = &scene.names;
    if !(upper.radius_x.is_finite() && upper.radius_x > 0.0) {
        let reason = "explicit elements need an upper body that rolls";
        return Err(Refusal::new(&names.key(0, "radius_x"), reason, "write its radius of rolling"));
    }
    if lower.radius_x.is_finite() && lower.radius_x < 0.0 {
        let reason = "explicit elements need a lower body that is straight or convex along x";
        return Err(Refusal::new(
            &names.key(1, "radius_x"),
            reason,
            "write mech.model = \"half-space\"",
        ));
    }
    if let Drive::Creepage { eta, phi, .. } = scene.drive
        && (eta, phi) != (0.0, 0.0)
    {
        return Err(Refusal::new(
            "motion.creepage",
            "explicit elements roll straight on: lateral creepage and spin are not among what they know",
            "leave out eta and phi, or write mech.model = \"half-space\"",
        ));
    }
    if scene.speeds.prescribed.is_some() {
        return Err(Refusal::new(
            &names.key(0, "surface_speed"),
            "explicit elements roll with a speed and a creepage",
            "write motion.speed with motion.creepage or motion.traction_coefficient",
        ));
    }
    Ok(())
}

fn asked(
    configuration: &Configuration,
    scene: &Scene,
    ellipse: &Ellipse,
    terms: &Terms,
) -> Result<Asked, Refusal> {
    let [a, b] = [ellipse.semi_axis_a, ellipse.semi_axis_b];
    let shear = scene.combined_shear_modulus();
    let c11 = kalker::creep_coefficients(a / b, scene.combined_poisson_ratio().max(0.0)).c11;
    let most = scene.friction_coefficient * ellipse.normal_force;
    let own = CheckedParams::new(&configuration.case, own_keys());
    let yields = own.maybe_number(PENALTY)?.map_or(0.0, |stiffness| 1.0 / stiffness);
    // Johnson & Vermeulen with Kalker's slope.
    let saturated = 3.0 * most / (shear * a * b * c11);
    let (creepage, force) = match ellipse.prescribed(scene)? {
        Prescribed::Creepage { xi, .. } => (xi, None),
        Prescribed::ForceRatio(ratio) => {
            let creepage = -ratio.signum() * saturated * (1.0 - (1.0 - ratio.abs()).cbrt());
            (creepage + 0.0, Some(ratio).filter(|_| terms.adhesion))
        }
    };
    Ok(Asked {
        speed: scene.speeds.rolling,
        load: ellipse.normal_force,
        law: Law {
            coefficient: scene.friction_coefficient,
            sticks: terms.adhesion,
            flexibility: [yields, yields + terms.layer()],
        },
        creepage,
        force,
        half_length: a,
        stiffness: 1.5 * ellipse.normal_force / ellipse.approach.unwrap_or(a * a),
        threads: configuration.threads,
    })
}

fn solid(case: &Params, scene: &Scene, terms: &Terms, which: usize) -> Result<Solid, Refusal> {
    let body = &scene.bodies[which];
    let name = case.text(&scene.names.key(which, "material"))?;
    let density =
        CheckedParams::new(case, own_keys()).number(&format!("materials.{name}.{DENSITY}"))?;
    let (e, nu) = (body.material.youngs_modulus, body.material.poisson_ratio);
    if nu >= 0.4999 {
        return Err(Refusal::new(
            &format!("materials.{name}.poisson_ratio"),
            format!("with {nu} waves have no limit of their speed"),
            "write 0.499 or less",
        ));
    }
    let lambda = e * nu / ((1.0 + nu) * (1.0 - 2.0 * nu));
    Ok(Solid {
        lame: [lambda, body.material.shear_modulus()],
        density,
        flow: terms.flow[which],
        radius: body.radius_x,
    })
}

fn wave_speed(solid: &Solid) -> f64 {
    ((solid.lame[0] + 2.0 * solid.lame[1]) / solid.density).sqrt()
}

/// Cells whose rows are the fine rows of nodes, over the part of the contact's plane that is watched.
fn contact_grid(mesh: &Section, element: f64, reach: [f64; 2]) -> (Structured, usize) {
    let columns = 2 * (reach[0] / element).ceil() as usize + 1;
    let x0 = -0.5 * (columns - 1) as f64 * element;
    let rows: Vec<usize> = (mesh.fine[0] + 1..mesh.fine[1])
        .filter(|row| mesh.nodes[*row][0].abs() <= reach[1])
        .collect();
    let (first, y0) = (rows[0], mesh.nodes[rows[0]][0]);
    (Structured::contact_plane(x0, y0, element, element, columns, rows.len()), first)
}

impl Setup for Prepared {
    fn layout(&self) -> &Layout {
        &self.layout
    }

    fn build(self: Box<Self>, progress: &Progress) -> Result<Box<dyn Model>, Refusal> {
        let Self {
            sections, solids, columns, asked, scene, terms, grid, first_row, wanted, ..
        } = *self;
        let bodies = [0, 1].map(|which| {
            let section = Section::new(&sections[which]);
            Block::new(columns, sections[which].element, section, solids[which], Held::Faces)
        });
        let elements: usize = bodies.iter().map(Block::elements).sum();
        let mut rolling = Rolling::new(bodies, Plane::new(grid, first_row), asked);
        let every = (REPORT / elements as u64).max(1);
        let mut report = |done: u64, of: u64| {
            if done.is_multiple_of(every) {
                progress.report(done, of, "rolling");
            }
        };
        let (means, met) = rolling.settle(&mut report);
        let ratio = means.force[0] / means.force[2];
        if !ratio.is_finite() {
            return Err(Refusal::new(
                "mech.resolution",
                "the elements have become unstable",
                "write another resolution, and check materials and radii",
            ));
        }
        if !met {
            return Err(Refusal::new(
                "motion.traction_coefficient",
                format!("no creepage was found: the force came to {ratio:.4} of the normal force"),
                "write motion.creepage",
            ));
        }
        if means.unsettled > 0.0 {
            return Err(Refusal::new(
                "mech.resolution",
                format!(
                    "the contact was not solved in {:.2} % of the steps",
                    100.0 * means.unsettled
                ),
                "write another resolution, and check the friction coefficient",
            ));
        }
        let (deposited, whole) =
            (rolling.plane.normal.iter().sum::<f64>(), means.pressed * rolling.plane.time);
        if (deposited - whole).abs() > ROUNDING * whole {
            return Err(Refusal::new(
                "load.normal_force",
                format!(
                    "the contact reaches beyond {WATCHED} semi-axes of Hertz's, where it is watched"
                ),
                "check radii and load, or write mech.model = \"half-space\"",
            ));
        }
        let values = |spec: &&'static FieldSpec| (*spec, values(spec, &rolling, &scene, &terms));
        Ok(Box::new(Precomputed {
            summary: json!({ "contact": figures(&rolling, &means) }),
            work: rolling.steps * elements as u64,
            fields: wanted.iter().map(values).collect(),
        }))
    }
}

/// Values of a field, component-major.
fn values(spec: &FieldSpec, rolling: &Rolling, scene: &Scene, terms: &Terms) -> Vec<f64> {
    let plane = &rolling.plane;
    let both = |of: &dyn Fn(usize) -> Vec<f64>| [of(0), of(1)].concat();
    match *spec {
        field::PRESSURE => plane.mean(&plane.normal),
        field::TRACTION => both(&|k| plane.mean(&plane.tangential[k])),
        field::SLIP_VELOCITY => both(&|k| plane.slip_velocity(k, rolling.step)),
        field::FRICTION_POWER => {
            let mut power = plane.mean(&plane.work);
            terms.keep_heat(&mut power);
            power
        }
        field::SURFACE_SPEED => scene.speeds.of_surfaces(rolling.creepage).to_vec(),
        _ => vec![0.0; count(spec, &plane.grid)],
    }
}

fn figures(rolling: &Rolling, means: &Means) -> Value {
    let [strain, hourglass] = rolling
        .bodies
        .each_ref()
        .map(Block::elastic_energy)
        .into_iter()
        .fold([0.0; 2], |[strain, hourglass], [more, of_modes]| {
            [strain + more, hourglass + of_modes]
        });
    let plane = &rolling.plane;
    let pressure = plane.mean(&plane.normal);
    let largest = |values: [Vec<f64>; 2]| {
        let [x, y] = values;
        x.iter().zip(&y).map(|(x, y)| x.hypot(*y)).fold(0.0, f64::max)
    };
    let [semi_axis_a, semi_axis_b] = Moments::of(&plane.grid, &pressure).semi_axes;
    let [touching, sliding] = means.areas;
    let mut figures = json!({
        "semi_axis_a_m": semi_axis_a,
        "semi_axis_b_m": semi_axis_b,
        "area_m2": touching,
        "patches": 1,
        "max_pressure_pa": pressure.iter().copied().fold(0.0, f64::max),
        "approach_m": means.approach,
        "normal_force_n": means.force[2],
        "creep_force_x_n": means.force[0],
        "creep_force_y_n": means.force[1],
        "traction_coefficient": means.force[0] / means.force[2],
        "slip_area_ratio": sliding / touching,
        "creepage_xi": rolling.creepage,
        "creepage_eta": 0.0,
        "creepage_phi_per_m": 0.0,
        "max_slip_velocity_m_per_s": largest([0, 1].map(|k| plane.slip_velocity(k, rolling.step))),
        "max_traction_pa": largest([0, 1].map(|k| plane.mean(&plane.tangential[k]))),
        "friction_power_w": means.friction,
        "given_power_w": means.given,
        "elastic_energy_j": strain + hourglass,
        "hourglass_energy_ratio": hourglass / (strain + hourglass),
        "steps": rolling.steps,
        "step_s": rolling.step,
        "sweeps_per_step": means.sweeps,
        "elements": rolling.bodies.iter().map(Block::elements).sum::<usize>(),
    });
    if rolling.bodies.iter().any(|body| body.solid.flow.is_some()) {
        let (plastic, grown) = plastic(rolling);
        figures["plastic_power_w"] = json!(plastic);
        figures["max_plastic_strain"] = json!(grown);
    }
    figures
}

/// Power of plastic flow [W], which the material carries away behind the contact, and the largest plastic strain that it has
/// there.
fn plastic(rolling: &Rolling) -> (f64, f64) {
    let mut all = (0.0, 0.0_f64);
    for (body, speed) in rolling.bodies.iter().zip(rolling.speeds()) {
        let back = (PASSED * rolling.half_length() / body.length).ceil() as usize;
        let [work, largest] = body.plastic_work(body.counts[0] / 2 - back);
        all = (all.0 + work * speed / body.length, all.1.max(largest));
    }
    all
}
