//! Several patches, lateral creepage and spin in complete runs: on the screen, in the summary, in
//! tables and sections.

use crate::harness::{Place, case, flat, number};
use std::path::{Path, PathBuf};

/// Rail with two equal crowns of radius 300 mm at ±20 mm, and a case with a straight wheel on it.
fn two_crowns(folder: &Path) -> PathBuf {
    let height = |y: f64| -0.5 * (y.abs() - 20.0).powi(2) / 300.0;
    let points = (-72..=72).map(|k| 0.5 * f64::from(k));
    let lines: String = points.map(|y| format!("{y},{:.9}\n", height(y))).collect();
    std::fs::write(folder.join("crowns.csv"), format!("y [mm], z [mm]\n{lines}")).unwrap();
    let text = std::fs::read_to_string(case("wheel-rail.toml")).unwrap();
    let text = text.replace("radius_y = 0.30", "profile = \"crowns.csv\"");
    let file = folder.join("crowns.toml");
    std::fs::write(&file, text).unwrap();
    file
}

/// Coordinates in a table of the fields [m].
fn places(place: &Place, file: &str) -> Vec<[f64; 3]> {
    place.table(&format!("fields/{file}")).columns(["x [m]", "y [m]", "z [m]"])
}

/// Both crowns carry half of the load, even at 50 N. Each patch has a row on the screen, in the
/// summary and on the page, with its own peak. Sections and tables pass through a patch, not
/// through the cold middle.
#[test]
fn two_patches_have_a_row_each_and_the_sections() {
    let folder = tempfile::tempdir().unwrap();
    let file = two_crowns(folder.path()).display().to_string();
    let place = Place::new();
    let more = [
        "--set",
        "load.normal_force=50 N",
        "--set",
        "mech.resolution=10",
        "--set",
        "effects.subsurface_stress={}",
    ];
    let ended = place.run(&file, &more);
    assert_eq!(ended.code, Some(0), "{}", ended.stderr);
    let summary = place.read_summary();
    assert_eq!(summary["contact"]["patches"], 2);
    let patches = summary["contact"]["each_patch"].as_array().unwrap();
    assert_eq!(patches.len(), 2);
    let below = summary["stress"]["rail"]["each_patch"].as_array().unwrap();
    assert_eq!(below.len(), 2);
    for (patch, below) in patches.iter().zip(below) {
        // At the surface, under tractions of 0.58 times the pressure: √3 times that, plus the
        // contribution of the pressure.
        let share = number(below, "/max_von_mises_pa") / number(patch, "/max_pressure_pa");
        assert!((1.0..1.3).contains(&share), "{share}");
        let aside = (number(below, "/y_m") - number(patch, "/y_m")).abs();
        assert!(aside < 0.5 * number(patch, "/semi_axis_b_m"), "{below} {patch}");
    }
    let peak = summary["temperature"]["rail"]["max_rise_k"].as_f64().unwrap();
    for patch in patches {
        assert!((number(patch, "/normal_force_n") - 25.0).abs() < 1e-3, "{patch}");
        // Hertz contact under 25 N, as in the tests of the model; the grid is a/10.
        assert!((number(patch, "/max_pressure_pa") / 77.96e6 - 1.0).abs() < 0.01, "{patch}");
        assert!((number(patch, "/rail_max_rise_k") / peak - 1.0).abs() < 1e-3, "{patch}");
    }
    for told in ["contact   2 patches", "patch 1   y -20.0", "patch 2   y 20.0", "1 window   "] {
        assert!(ended.stdout.contains(told), "{told}: {}", ended.stdout);
    }
    let page = place.page();
    assert!(page.contains("2 patches") && page.contains("−20.00"));
    let b = number(&patches[0], "/semi_axis_b_m");
    let through_a_patch = |[_, y, _]: &[f64; 3]| (y.abs() - 20e-3).abs() < b;
    for (file, count) in
        [("mech_rail_stress_section_000000.csv", 60), ("thermal_rail_section_000000.csv", 33)]
    {
        let line = places(&place, file);
        assert_eq!(line.len(), count, "{file} holds a depth line");
        assert!(line.iter().all(through_a_patch), "{file}: {:?}", line[0]);
        assert!(line.windows(2).all(|two| two[1][2] < two[0][2]), "{file} goes down");
    }
    for file in ["mech_contact_000000.csv", "thermal_contact_000000.csv"] {
        assert!(places(&place, file).iter().all(through_a_patch), "{file}");
    }
}

/// Lateral creepage and spin are shown on the screen, with their forces and in suitable units.
#[test]
fn lateral_creepage_and_spin_are_told() {
    let place = Place::new();
    let more = [
        "--set",
        "mech.resolution=10",
        "--unset",
        "motion.traction_coefficient",
        "--set",
        "motion.creepage={xi=0, eta=2e-3}",
    ];
    let ended = place.run(&case("wheel-rail.toml"), &more);
    assert_eq!(ended.code, Some(0), "{}", ended.stderr);
    // Continuation lines are indented below the first one.
    let line = |text: &str| {
        let (_, after) = text.split_once("\n  friction ").unwrap();
        let own = after.lines().enumerate().take_while(|(n, l)| *n == 0 || l.starts_with("     "));
        flat(&own.map(|(_, line)| line).collect::<Vec<_>>().join(" "))
    };
    let lateral = line(&ended.stdout);
    assert!(lateral.contains("F_y -") && lateral.contains("creepage η 0.2000 %"), "{lateral}");
    assert!(!lateral.contains("|F|/N 0.0000") && !lateral.contains("F_x"), "{lateral}");
    assert!(lateral.contains(" kW"), "{lateral}");
    let ended = place.run(
        &case("wheel-rail.toml"),
        &[
            "--set",
            "mech.resolution=10",
            "--unset",
            "motion.traction_coefficient",
            "--set",
            "motion.creepage={xi=0, phi=0.02}",
        ],
    );
    let spin = line(&ended.stdout);
    assert!(spin.contains("M_z ") && spin.contains("spin φ 0.02000 rad/m"), "{spin}");
    assert!(!spin.contains("kW") && spin.contains(" W"), "{spin}");
}

/// Both wheels of a wheelset: the sections pass through the patch with the highest friction power,
/// not between the rails. Every patch has the name of its wheel and all known figures. The page
/// shows each wheel on its rail.
#[test]
fn both_wheels_have_names_sections_and_a_picture() {
    let place = Place::new();
    let more = [
        "--unset",
        "load.vertical_force",
        "--set",
        "load.axle_load=200 kN",
        "--set",
        "wheelset.side=both",
        "--set",
        "mech.resolution=20",
    ];
    let ended = place.run(&case("wheel-on-track.toml"), &more);
    assert_eq!(ended.code, Some(0), "{}", ended.stderr);
    let summary = place.read_summary();
    let patches = summary["contact"]["each_patch"].as_array().unwrap();
    let names: Vec<&str> = patches.iter().map(|patch| patch["name"].as_str().unwrap()).collect();
    assert_eq!([names[0], names[names.len() - 1]], ["right wheel", "left wheel"]);
    for patch in patches {
        // y of the track is positive to the left.
        let left = number(patch, "/track_y_m") > 0.0;
        assert_eq!(patch["name"] == "left wheel", left, "{patch}");
    }
    assert!(ended.stdout.contains("left wheel   y "), "{}", ended.stdout);
    let section = place.table("fields/thermal_rail_section_000000.csv");
    let rise = section.numbers("rail_section_temperature [K]");
    let largest = rise.iter().copied().fold(0.0, f64::max);
    let peak = number(&summary, "/temperature/rail/max_rise_k");
    assert!(largest > 0.8 * peak, "{largest} K in the section, {peak} K on the surface");
    let page = place.page();
    for told in ["left wheel", "creep force x", "Wheel on rail, left", "Wheel on rail, right"] {
        assert!(page.contains(told), "{told}");
    }
    // The wheel touches its rail at the patch: the undeformed profiles overlap there by the
    // approach.
    let profile = |body: &str| -> Vec<[f64; 2]> {
        let points = summary["wheelset"]["left"]["profiles_m"][body].as_array().unwrap().iter();
        points.map(|p| [0, 1].map(|k| p[k].as_f64().unwrap())).collect()
    };
    let patch = patches.last().unwrap();
    let [y, z] = ["/track_y_m", "/track_z_m"].map(|key| number(patch, key));
    for body in ["rail", "wheel"] {
        let profile = profile(body);
        let between =
            profile.windows(2).find(|pair| (pair[0][0]..=pair[1][0]).contains(&y)).unwrap();
        let share = (y - between[0][0]) / (between[1][0] - between[0][0]);
        let height = between[0][1] + share * (between[1][1] - between[0][1]);
        let approach = number(patch, "/approach_m");
        assert!((height - z).abs() < 1.1 * approach, "{body}: {height} m, {z} m");
    }
}
