//! Reading of all formats, and of arbitrary bytes.

use super::error::ProfileError;
use super::orientation::{Body, Heights};
use super::read::{Format, Reading, read};
use crate::outline::{Outline, Smoothing};
use crate::standard::{rail_60e1, wheel_s1002};
use proptest::prelude::*;
use std::fmt::Write;
use std::path::Path;

/// Writes a curve as lines of a file in millimetres, with y and z multiplied by these signs.
fn lines(curve: &Outline, signs: [f64; 2]) -> String {
    let mut text = String::new();
    for [y, z] in curve.points() {
        writeln!(text, "{:.9}\t{:.9}", 1e3 * signs[0] * y, 1e3 * signs[1] * z).unwrap();
    }
    text
}

fn same(one: &Outline, other: &Outline) {
    let [from, to] = one.range();
    for k in 0..=200 {
        let s = from + (to - from) * f64::from(k) / 200.0;
        let (a, b) = (one.at(s).position, other.at(s).position);
        assert!((a[0] - b[0]).hypot(a[1] - b[1]) < 1e-9, "{s} {a:?} {b:?}");
    }
}

#[test]
fn every_format_and_orientation_is_the_same_curve() {
    let (rail, wheel) = (rail_60e1().unwrap(), wheel_s1002().unwrap());
    for (curve, body) in [(&rail, Body::Rail), (&wheel, Body::Wheel)] {
        let kind = f64::from(u8::from(body == Body::Wheel));
        let simpack = format!(
            "! made by hand\nheader.begin\n type = {kind}\nheader.end\nspline.begin\n mirror.y = 1\n \
             inversion = 1\n units.len.f = 1e3\n point.begin\n{} point.end\nspline.end\n",
            lines(curve, [-1.0, -1.0])
        );
        let usual = Reading::usual(Format::Simpack, body);
        same(curve, &read(simpack.as_bytes(), &usual).unwrap());
        for up in [1.0, -1.0] {
            let columns = lines(curve, [1.0, up]);
            let usual = Reading::usual(Format::Columns, body);
            let told = if up > 0.0 { Heights::Up } else { Heights::Down };
            same(curve, &read(columns.as_bytes(), &Reading { heights: told, ..usual }).unwrap());
            match read(columns.as_bytes(), &usual) {
                Ok(read) if up > 0.0 => same(curve, &read),
                other => assert_eq!(other, Err(ProfileError::HeightsDown)),
            }
            let miniprof = format!(
                "Filename=x.ban\nXYPoints={}\nColumnDef=X,Y\n\n{}",
                curve.points().len(),
                lines(curve, [-1.0, up])
            );
            let usual = Reading::usual(Format::Miniprof, body);
            same(curve, &read(miniprof.as_bytes(), &usual).unwrap());
        }
    }
    assert_eq!(Format::of(Path::new("a/b.WHL")), Format::Miniprof);
    assert_eq!(Format::of(Path::new("b.prr")), Format::Simpack);
    assert_eq!(Format::of(Path::new("b")), Format::Columns);
}

/// A shape without a flange or corners does not show which way is up. A hollow tread turned over is
/// a crown, and a cone leans to the other side.
#[test]
fn heights_of_a_table_point_up_whatever_the_shape() {
    let table = |height: &dyn Fn(f64) -> f64, ends: [i32; 2]| -> String {
        let ys = (ends[0]..=ends[1]).map(f64::from);
        ys.map(|y| format!("{y} {:.9}\n", height(y))).collect()
    };
    let hollow = table(&|y| y * y / 1000.0, [-30, 60]);
    let cones = [-50, -60, -65, -69, -70].map(|end| table(&|y| 0.05 * y, [end, -end]));
    for text in cones.iter().chain([&hollow]) {
        let read = |heights| {
            let usual = Reading::usual(Format::Columns, Body::Wheel);
            read(text.as_bytes(), &Reading { heights, ..usual })
        };
        same(&read(Heights::UpByConvention).unwrap(), &read(Heights::Up).unwrap());
        assert_eq!(read(Heights::Detected), Err(ProfileError::UnclearHeights));
    }
    // A wheel measured up to the tip of its flange is lower there than at the field side.
    let wheel = wheel_s1002().unwrap();
    let tip = wheel.points().iter().min_by(|a, b| a[1].total_cmp(&b[1])).unwrap()[0];
    let to_tip: String = wheel
        .points()
        .iter()
        .filter(|point| point[0] >= tip)
        .map(|[y, z]| format!("{:.9} {:.9}\n", 1e3 * y, 1e3 * z))
        .collect();
    for heights in [Heights::UpByConvention, Heights::Detected] {
        let usual = Reading::usual(Format::Columns, Body::Wheel);
        let cut = read(to_tip.as_bytes(), &Reading { heights, ..usual }).unwrap();
        assert!((cut.at(0.0).position[1] - wheel.at(0.0).position[1]).abs() < 1e-6);
    }
}

#[test]
fn units_shifts_and_bounds() {
    let rail = rail_60e1().unwrap();
    let metres = format!("# by hand\ny [m], z [mm]\n{}", {
        let mut text = String::new();
        for [y, z] in rail.points() {
            writeln!(text, "{y:.12}, {:.9}", 1e3 * z).unwrap();
        }
        text
    });
    same(&rail, &read(metres.as_bytes(), &Reading::usual(Format::Columns, Body::Rail)).unwrap());
    let cut = format!(
        "spline.begin\nshift.y = 3\nbound.y.min = -20\nbound.y.max = 20\npoint.begin\n{}point.end\n",
        lines(&rail, [1.0, -1.0])
    );
    let cut = read(cut.as_bytes(), &Reading::usual(Format::Simpack, Body::Rail)).unwrap();
    let ends = [cut.points()[0][0], cut.points()[cut.points().len() - 1][0]];
    assert!(ends[0] >= -20e-3 && ends[1] <= 20e-3 && ends[1] > 19e-3, "{ends:?}");
    // The crown is now at y = 3 mm, and s = 0 stays at y = 0.
    assert!((cut.at(3e-3).position[0] - 3e-3).abs() < 1e-6);
}

#[test]
fn errors_name_the_line_and_what_would_do() {
    let columns = |text: &str, body| read(text.as_bytes(), &Reading::usual(Format::Columns, body));
    let wrong = columns("1 2\n3 x\n", Body::Rail).unwrap_err();
    assert_eq!(wrong.to_string(), "has no number in column 2 of line 2");
    let unit = columns("y [ft], z [mm]\n1, 2\n", Body::Rail).unwrap_err().to_string();
    assert!(unit.contains("column `y` of line 1") && unit.contains("unknown unit `ft`"), "{unit}");
    let unitless = columns("y, z\n1, 2\n", Body::Rail).unwrap_err().to_string();
    assert!(unitless.contains("write `y [mm]`"), "{unitless}");
    assert_eq!(columns("", Body::Rail), Err(ProfileError::Table("has no rows".to_owned())));
    let metres = columns("-0.03 0.0\n0 0.001\n0.01 0.0\n0.03 0\n", Body::Rail).unwrap_err();
    assert!(matches!(metres, ProfileError::Size(_)));
    let wheel = wheel_s1002().unwrap();
    let reading = Reading { mirrored: true, ..Reading::usual(Format::Columns, Body::Wheel) };
    let mirrored = read(lines(&wheel, [1.0, 1.0]).as_bytes(), &reading).unwrap_err().to_string();
    assert!(mirrored.contains("flange") && mirrored.contains("mirror"), "{mirrored}");
    let miniprof = "XYPoints=3\nColumnDef=X,Y\n1 2\n2 3\n";
    let few = read(miniprof.as_bytes(), &Reading::usual(Format::Miniprof, Body::Rail));
    assert_eq!(few, Err(ProfileError::Count { announced: 3, found: 2 }));
    let simpack = "header.begin\ntype = 1\nheader.end\npoint.begin\n1 2\npoint.end\n";
    let other = read(simpack.as_bytes(), &Reading::usual(Format::Simpack, Body::Rail));
    assert_eq!(other, Err(ProfileError::OtherBody("wheel")));
}

proptest! {
    #[test]
    fn no_bytes_panic(
        bytes in prop::collection::vec(any::<u8>(), 0..400),
        format in 0..3_usize,
        wheel: bool,
    ) {
        let format = [Format::Miniprof, Format::Simpack, Format::Columns][format];
        let body = if wheel { Body::Wheel } else { Body::Rail };
        let _ = read(&bytes, &Reading::usual(format, body));
    }

    /// Numbers of any size in place of points.
    #[test]
    fn no_numbers_panic(
        points in prop::collection::vec((any::<f64>(), any::<f64>(), -80.0..80.0_f64), 0..30),
        tolerance in 0.0..1e-3_f64,
        halves: bool,
        format in 0..3_usize,
    ) {
        let format = [Format::Miniprof, Format::Simpack, Format::Columns][format];
        let mut text = String::new();
        if format == Format::Simpack {
            text.push_str("point.begin\n");
        }
        for (at, (a, b, tame)) in points.iter().enumerate() {
            let (y, z) = if at % 4 == 0 { (*a, *b) } else { (*tame, 0.1 * tame) };
            writeln!(text, "{y:e} {z:e}").unwrap();
        }
        for body in [Body::Rail, Body::Wheel] {
            let reading = Reading {
                smoothing: if halves { Smoothing::Halving(tolerance) } else { Smoothing::Within(tolerance) },
                heights: Heights::Detected,
                ..Reading::usual(format, body)
            };
            let _ = read(text.as_bytes(), &reading);
        }
    }
}
