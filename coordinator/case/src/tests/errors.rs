//! Every kind of error with its exact place, key, reason and fix.

use super::{GOOD, case, lines};

/// A change of the good case, and its expected errors: "line:column key: reason | fix".
struct BadCase {
    replace: &'static str,
    by: &'static str,
    errors: &'static [&'static str],
}

#[test]
fn every_error_names_its_place_and_its_fix() {
    for row in ROWS {
        assert!(GOOD.contains(row.replace), "the good case has no {:?}", row.replace);
        let text = GOOD.replacen(row.replace, row.by, 1);
        let found = lines(&case(&text).expect_err(row.by));
        assert_eq!(found, row.errors, "{:?} by {:?}", row.replace, row.by);
    }
}

/// Errors of different kinds are reported together, as the user sees them.
#[test]
fn all_errors_are_reported_at_once() {
    let bad = GOOD
        .replace("speed =", "sped =")
        .replace("radius = 0.46", "radius = \"460 kN\"")
        .replace("traction_coefficient = 0.58", "traction_coefficient = 0.62")
        .replace("[effects.partial_slip]", "[effects.partial_slp]")
        .replace("[load]\nnormal_force = \"134 kN\"\n", "");
    let shown = case(&bad).expect_err("five errors").to_string();
    assert_eq!(shown, FIVE);
}

#[test]
fn the_good_case_is_good() {
    let name = case(GOOD).map(|case| case.name).map_err(|e| e.to_string());
    assert_eq!(name, Ok("wheel-rail".to_owned()));
}

const FIVE: &str = r#"error: case.toml:6:10: wheel.radius: unit `kN` cannot be converted to m
  6 | radius = "460 kN"
    |          ^^^^^^^^
  fix: write a number in m or a text with a unit, for example "0.5 m"

error: case.toml:16:1: motion.sped: unknown key; not read by the coordinator, mech and thermal
  16 | sped = "140 km/h"
     | ^^^^
  fix: write `motion.speed`

error: case.toml:17:24: motion.traction_coefficient: 0.62 is not below friction.coefficient = 0.6
  17 | traction_coefficient = 0.62
     |                        ^^^^
  fix: lower it, or raise friction.coefficient

error: case.toml:23:1: effects.partial_slp: unknown effect `partial_slp`; did you mean `partial_slip`?
  23 | [effects.partial_slp]
     | ^^^^^^^^^^^^^^^^^^^^^
  fix: write [effects.partial_slip]; available effects: friction_heat (mech, thermal) and partial_slip (mech)

error: case.toml: load: missing section [load]
  fix: add [load] with `normal_force = "100 kN"`

5 errors in case.toml"#;

#[rustfmt::skip]
const ROWS: &[BadCase] = &[
    BadCase {
        replace: r#"speed = "140 km/h""#,
        by: r#"sped = "140 km/h""#,
        errors: &[
            "16:1 motion.sped: unknown key; not read by the coordinator, mech and thermal | write `motion.speed`",
        ],
    },
    BadCase {
        replace: "coefficient = 0.6\n",
        by: "coefficient = 0.6\ndecay_temperature = \"200 °C\"\n",
        errors: &[
            r#"22:21 friction.decay_temperature: `200 °C` is a temperature, but a temperature difference is expected | write "200 K""#,
        ],
    },
    BadCase {
        replace: "[wheel]",
        by: "[weel]",
        errors: &[
            "5:1 weel: unknown section; not read by the coordinator, mech and thermal | write [wheel]",
        ],
    },
    BadCase {
        replace: "[load]\nnormal_force = \"134 kN\"\n",
        by: "",
        errors: &[
            r#"case.toml load: missing section [load] | add [load] with `normal_force = "100 kN"`"#,
        ],
    },
    BadCase {
        replace: "[load]\nnormal_force = \"134 kN\"\n",
        by: "[load]\n",
        errors: &[
            r#"18:1 load.normal_force: missing; mech needs the load | add `normal_force = "100 kN"` to [load]"#,
        ],
    },
    BadCase {
        replace: "[case]\nname = \"wheel-rail\"\ntitle = \"A test\"\n",
        by: "",
        errors: &[
            r#"case.toml case: missing section [case] | add [case] with `name = "NAME"`"#,
        ],
    },
    BadCase {
        replace: "radius = 0.46",
        by: "radius = true",
        errors: &[
            r#"6:10 wheel.radius: is true, not a number or a text in m | write a number in m or a text with a unit, for example "0.5 m""#,
        ],
    },
    BadCase {
        replace: "radius = 0.46",
        by: r#"radius = "0.46""#,
        errors: &[
            r#"6:10 wheel.radius: `0.46` has no unit; its unit would be m | write a number in m or a text with a unit, for example "0.5 m""#,
        ],
    },
    BadCase {
        replace: "radius = 0.46",
        by: r#"radius = "460 kN""#,
        errors: &[
            r#"6:10 wheel.radius: unit `kN` cannot be converted to m | write a number in m or a text with a unit, for example "0.5 m""#,
        ],
    },
    BadCase {
        replace: "radius = 0.46",
        by: "radius = -0.46",
        errors: &[
            r#"6:10 wheel.radius: -0.46 m is not above 0 m | write a value that is above 0 m, for example "0.5 m""#,
        ],
    },
    BadCase {
        replace: "radius = 0.46",
        by: "radius = nan",
        errors: &[
            r#"6:10 wheel.radius: NaN is not a finite number | write for example "0.5 m""#,
        ],
    },
    BadCase {
        replace: "radius = 0.46",
        by: "radius = { a = 1 }",
        errors: &[
            r#"6:1 wheel.radius: is a table, not a number or a text in m | write a number in m or a text with a unit, for example "0.5 m""#,
        ],
    },
    BadCase {
        replace: "traction_coefficient = 0.58",
        by: "traction_coefficient = 0.6",
        errors: &[
            "17:24 motion.traction_coefficient: 0.6 is not below friction.coefficient = 0.6 | lower it, or raise friction.coefficient",
        ],
    },
    BadCase {
        replace: "traction_coefficient = 0.58",
        by: r#"tangential_force = "-90 kN""#,
        errors: &[
            "17:20 motion.tangential_force: -90000 N is not below friction.coefficient × load.normal_force = 80400 N in magnitude | lower it, or raise friction.coefficient or load.normal_force",
        ],
    },
    BadCase {
        replace: "traction_coefficient = 0.58",
        by: "",
        errors: &[
            r#"15:1 motion: missing; mech needs exactly one of motion.traction_coefficient, motion.tangential_force or motion.creepage | add one of `traction_coefficient = 0.3`, `tangential_force = "100 kN"` or `creepage = { xi = 0.3 }` to [motion]"#,
        ],
    },
    BadCase {
        replace: "[motion]\nspeed = \"140 km/h\"\ntraction_coefficient = 0.58\n",
        by: "",
        errors: &[
            r#"case.toml motion: missing section [motion] | add [motion] with `speed = "30 m/s"` and one of `traction_coefficient = 0.3`, `tangential_force = "100 kN"` or `creepage = { xi = 0.3 }`"#,
        ],
    },
    BadCase {
        replace: "traction_coefficient = 0.58",
        by: "traction_coefficient = 0.58\ncreepage = { xi = -0.01 }",
        errors: &[
            "18:1 motion.creepage: excludes `motion.traction_coefficient` at case.toml:17:1 | keep exactly one of motion.traction_coefficient and motion.creepage",
        ],
    },
    BadCase {
        replace: "traction_coefficient = 0.58",
        by: "creepage = { eta = 0.01 }",
        errors: &[
            "17:1 motion.creepage.xi: missing; mech needs the creepage | add `xi = 0.3` to [motion.creepage]",
        ],
    },
    BadCase {
        replace: "traction_coefficient = 0.58",
        by: "creepage = 3",
        errors: &[
            "17:12 motion.creepage: is the number 3, not a table | write it as a section: [motion.creepage]",
        ],
    },
    BadCase {
        replace: "radius = 0.46\nmaterial = \"steel\"",
        by: "radius = 0.46\nmaterial = \"steeel\"",
        errors: &[
            r#"7:12 wheel.material: unknown material `steeel`; did you mean `steel`? | write "steel", or add [materials.steeel] with `youngs_modulus = "200 GPa"` and `density = "7850 kg/m3"`"#,
        ],
    },
    BadCase {
        replace: "radius = 0.46\nmaterial = \"steel\"",
        by: "radius = 0.46\nmaterial = \"brass\"",
        errors: &[
            r#"7:12 wheel.material: unknown material `brass` | write "steel", or add [materials.brass] with `youngs_modulus = "200 GPa"` and `density = "7850 kg/m3"`"#,
        ],
    },
    BadCase {
        replace: "[materials.steel]\nyoungs_modulus = \"210 GPa\"\ndensity = 7850\n",
        by: "",
        errors: &[
            r#"7:12 wheel.material: unknown material `steel` | add [materials.steel] with `youngs_modulus = "200 GPa"` and `density = "7850 kg/m3"`"#,
            r#"10:12 rail.material: unknown material `steel` | add [materials.steel] with `youngs_modulus = "200 GPa"` and `density = "7850 kg/m3"`"#,
        ],
    },
    BadCase {
        replace: "density = 7850",
        by: "densty = 7850",
        errors: &[
            "13:1 materials.steel.densty: unknown key; not read by the coordinator, mech and thermal | write `materials.steel.density`",
        ],
    },
    BadCase {
        replace: "[effects.partial_slip]",
        by: "[effects.partial_slp]",
        errors: &[
            "25:1 effects.partial_slp: unknown effect `partial_slp`; did you mean `partial_slip`? | write [effects.partial_slip]; available effects: friction_heat (mech, thermal) and partial_slip (mech)",
        ],
    },
    BadCase {
        replace: "[effects.partial_slip]",
        by: "[effects.magic]",
        errors: &[
            "25:1 effects.magic: unknown effect `magic` | remove it; available effects: friction_heat (mech, thermal) and partial_slip (mech)",
        ],
    },
    BadCase {
        replace: "[effects.partial_slip]",
        by: "[effects]\npartial_slip = true",
        errors: &[
            "26:16 effects.partial_slip: is true, not a table | write it as a section: [effects.partial_slip]",
        ],
    },
    BadCase {
        replace: "[effects.partial_slip]",
        by: "[effects]\npartial_slip = false",
        errors: &[
            "26:16 effects.partial_slip: is false, not a table | remove it: an effect without a table is off",
        ],
    },
    BadCase {
        replace: r#"model = "half-space""#,
        by: r#"model = "hertz-carter""#,
        errors: &[
            r#"25:1 effects.partial_slip: mech.model `hertz-carter` does not support it | set mech.model to "half-space", or remove the effect"#,
        ],
    },
    BadCase {
        replace: r#"model = "half-space""#,
        by: r#"model = "halfspace""#,
        errors: &[
            r#"28:9 mech.model: unknown model `halfspace`; did you mean `half-space`? | write "hertz-carter" or "half-space""#,
        ],
    },
    BadCase {
        replace: r#"model = "half-space""#,
        by: "",
        errors: &[
            r#"27:1 mech.model: missing; the coordinator needs the model of the participant | add `model = "hertz-carter"` to [mech]"#,
        ],
    },
    BadCase {
        replace: r#"model = "columns""#,
        by: r#"model = "moving-source""#,
        errors: &[
            r#"31:9 thermal.model: model `moving-source` does not support a steady case | write "columns", or set time.mode to "transient""#,
        ],
    },
    BadCase {
        replace: "resolution = 40",
        by: "resolution = 40.0",
        errors: &[
            "29:14 mech.resolution: is the number 40.0, not a whole number | write for example 40",
        ],
    },
    BadCase {
        replace: "resolution = 40",
        by: "resolution = 0",
        errors: &[
            "29:14 mech.resolution: 0 is not at least 1 | write a value that is at least 1, for example 40",
        ],
    },
    BadCase {
        replace: "resolution = 40",
        by: r#"symmetric = "yes""#,
        errors: &[
            r#"29:13 mech.symmetric: is the text "yes", not true or false | write for example true"#,
        ],
    },
    BadCase {
        replace: r#"partition = "equal""#,
        by: r#"partition = "eqal""#,
        errors: &[
            r#"24:13 effects.friction_heat.partition: unknown partition `eqal`; did you mean `equal`? | write "equal" or "by-effusivity""#,
        ],
    },
    BadCase {
        replace: r#"partition = "equal""#,
        by: r#"partiton = "equal""#,
        errors: &[
            "24:1 effects.friction_heat.partiton: unknown key; not read by the coordinator, mech and thermal | write `effects.friction_heat.partition`",
        ],
    },
    BadCase {
        replace: "[load]",
        by: "[contact]\nsemi_axis_a = 0.01\n[load]",
        errors: &[
            r#"18:1 contact.semi_axis_b: missing; `contact.semi_axis_a` is given, and they go together | add `contact.semi_axis_b = "0.5 m"`, or remove `contact.semi_axis_a`"#,
            r#"18:1 contact.max_pressure: missing; `contact.semi_axis_a` is given, and they go together | add `contact.max_pressure = "200 GPa"`, or remove `contact.semi_axis_a`"#,
        ],
    },
    BadCase {
        replace: "[load]",
        by: "[time]\nwindow = \"1 ms\"\n[load]",
        errors: &[
            r#"19:1 time.window: has no meaning in a steady case | remove it, or write `time.mode = "transient"`"#,
        ],
    },
    BadCase {
        replace: "[load]",
        by: "[time]\nmode=\"transient\"\n[load]",
        errors: &[
            r#"18:1 time.window: missing; the coordinator needs the coupling window of a transient case | add `window = "1 ms"` to [time]"#,
            r#"18:1 time.end: missing; the coordinator needs the end of a transient case | add `end = "1 ms"` to [time]"#,
        ],
    },
    BadCase {
        replace: "[load]",
        by: "[time]\nmode=\"transient\"\nwindow = 1\nend = 0.5\n[load]",
        errors: &[
            "20:10 time.window: 1 s is longer than time.end = 0.5 s | shorten it, or raise time.end",
        ],
    },
    BadCase {
        replace: "[load]",
        by: "[coupling]\nscheme = \"serial\"\n[load]",
        errors: &[
            r#"19:10 coupling.scheme: unknown scheme `serial` | write "auto", "serial-explicit", "serial-implicit", "parallel-explicit" or "parallel-implicit""#,
        ],
    },
    BadCase {
        replace: "[load]",
        by: "[coupling]\nacceleration = \"iqn\"\nrelaxation = 3\nfilter = 0\nmin_iterations = 200\n\
             [coupling.fields.presure]\nrelative = -1\n[load]",
        errors: &[
            r#"19:16 coupling.acceleration: unknown acceleration `iqn` | write "auto", "none", "constant", "aitken", "anderson", "iqn-ils" or "iqn-imvj""#,
            "20:14 coupling.relaxation: 3 is not above 0 and at most 2 | write a value that is above 0 and at most 2, for example 0.3",
            "21:10 coupling.filter: 0 is not at least 1e-7 and at most 0.9 | write a value that is at least 1e-7 and at most 0.9, for example 0.3",
            "22:18 coupling.min_iterations: 200 is more than coupling.max_iterations = 100 | lower it, or raise coupling.max_iterations",
            "23:1 coupling.fields.presure: unknown field `presure`; did you mean `pressure`? | the participants provide friction_power and pressure",
            "24:12 coupling.fields.presure.relative: -1 is not above 0 | write a value that is above 0, for example 0.3",
        ],
    },
    BadCase {
        replace: "[load]",
        by: "[mapping]\nmethod = \"linear\"\nbasis = \"gaussian\"\nradius = 1\n[mapping.fields.presure]\nmethod = \"auto\"\n\
             [mapping.fields.pressure]\nmethod = \"intersection\"\n[load]",
        errors: &[
            r#"19:10 mapping.method: unknown method `linear` | write "auto", "nearest-neighbour", "nearest-projection", "radial-basis" or "intersection""#,
            "22:1 mapping.fields.presure: unknown field `presure`; did you mean `pressure`? | the participants provide friction_power and pressure",
            "24:1 mapping.fields.pressure: no participant consumes `pressure`: it is never mapped | remove it; the participants consume friction_power",
        ],
    },
    BadCase {
        replace: "[load]",
        by: "[mapping]\nbasis = \"wendland-c2\"\nradius = 0.1\n\
             [mapping.fields.friction_power]\nmethod = \"intersection\"\n\
             basis = \"thin-plate-splines\"\nradius = \"1 mm\"\n[load]",
        errors: &[
            r#"19:9 mapping.basis: `auto` has no radial basis function | set mapping.method to "radial-basis", or remove the key"#,
            r#"23:9 mapping.fields.friction_power.basis: `intersection` has no radial basis function | set mapping.fields.friction_power.method to "radial-basis", or remove the key"#,
            "24:10 mapping.fields.friction_power.radius: `thin-plate-splines` has no radius | remove the key",
        ],
    },
    BadCase {
        replace: "[load]",
        by: "[mapping]\nmethod = \"radial-basis\"\nradius = 0.1\n\
             [mapping.fields.friction_power]\nmethod = \"radial-basis\"\n\
             basis = \"gaussian\"\n[load]",
        errors: &[
            r#"20:10 mapping.radius: a radius needs a radial basis function | add mapping.basis, for example "wendland-c2", or remove the key"#,
            "23:9 mapping.fields.friction_power.basis: `gaussian` needs a radius | add mapping.fields.friction_power.radius, for example five times the distance between neighbouring points",
        ],
    },
    BadCase {
        replace: "[load]",
        by: "[mapping]\nmethod = \"radial-basis\"\nbasis = \"wendland\"\nradius = 0\n[load]",
        errors: &[
            r#"20:9 mapping.basis: unknown basis `wendland` | write "wendland-c0", "wendland-c2", "wendland-c4", "wendland-c6", "wendland-c8", "compact-thin-plate-splines-c2", "gaussian", "multiquadrics", "inverse-multiquadrics", "thin-plate-splines" or "volume-splines""#,
            r#"21:10 mapping.radius: 0 m is not above 0 m | write a value that is above 0 m, for example "0.5 m""#,
        ],
    },
    BadCase {
        replace: "[load]",
        by: "[output]\nfields = \"some\"\nevery = 0\n[load]",
        errors: &[
            r#"19:10 output.fields: `some` is neither `all` nor `none` | write "all", "none" or a list of field names"#,
            "20:9 output.every: 0 is not at least 1 | write a value that is at least 1, for example 40",
        ],
    },
    BadCase {
        replace: "[load]",
        by: "[output]\nfields = [\"presure\", \"friction_power\"]\n[load]",
        errors: &[
            "19:10 output.fields: unknown field `presure`; did you mean `pressure`? | the participants provide friction_power and pressure",
        ],
    },
    BadCase {
        replace: "[load]",
        by: "[limits]\nshared_memory = \"64 MW\"\n[load]",
        errors: &[
            r#"19:17 limits.shared_memory: unit `MW` cannot be converted to B | write a number in B or a text with a unit, for example "64 MB""#,
        ],
    },
    BadCase {
        replace: "[load]",
        by: "[track]\nmodel = \"x\"\n[load]",
        errors: &[
            "18:1 track: unknown section: no participant has this name | remove it; a participant of your own needs `track.command`",
        ],
    },
    BadCase {
        replace: "[load]",
        by: "[track]\ncommand = [\"x\"]\n[load]",
        errors: &[
            "18:1 track: the participant of this section has not described itself | check `track.command`, or remove [track]",
        ],
    },
    BadCase {
        replace: "[thermal]\n",
        by: "[thermal]\ncommand = \"python\"\n",
        errors: &[
            r#"31:11 thermal.command: is the text "python", not a list | write for example ["NAME"]"#,
        ],
    },
    BadCase {
        replace: "[thermal]\n",
        by: "[thermal]\ncommand = []\nattach = 1\n",
        errors: &[
            r#"31:11 thermal.command: the list is empty | write ["NAME"]"#,
            "32:10 thermal.attach: is the number 1, not true or false | write for example true",
        ],
    },
    BadCase {
        replace: r#"name = "wheel-rail""#,
        by: r#"name = """#,
        errors: &[
            r#"2:8 case.name: is empty | write a name of letters, digits, `-`, `_` and `.`, such as "rolling-1""#,
        ],
    },
    BadCase {
        replace: r#"name = "wheel-rail""#,
        by: r#"name = "../../evil""#,
        errors: &[
            r#"2:8 case.name: '/' is not allowed in the name of a result folder | write a name of letters, digits, `-`, `_` and `.`, such as "rolling-1""#,
        ],
    },
    BadCase {
        replace: r#"name = "wheel-rail""#,
        by: r#"name = "/tmp/abs""#,
        errors: &[
            r#"2:8 case.name: '/' is not allowed in the name of a result folder | write a name of letters, digits, `-`, `_` and `.`, such as "rolling-1""#,
        ],
    },
    BadCase {
        replace: r#"name = "wheel-rail""#,
        by: r#"name = "x\ny""#,
        errors: &[
            r#"2:8 case.name: the text `x\ny` holds the control character \u{a} | write one line of plain text"#,
        ],
    },
    BadCase {
        replace: r#"name = "wheel-rail""#,
        by: r#"name = "..""#,
        errors: &[
            r#"2:8 case.name: starts with a dot | write a name of letters, digits, `-`, `_` and `.`, such as "rolling-1""#,
        ],
    },
    BadCase {
        replace: r#"name = "wheel-rail""#,
        by: r#"name = ".hidden""#,
        errors: &[
            r#"2:8 case.name: starts with a dot | write a name of letters, digits, `-`, `_` and `.`, such as "rolling-1""#,
        ],
    },
    BadCase {
        replace: r#"name = "wheel-rail""#,
        by: r#"name = " x""#,
        errors: &[
            r#"2:8 case.name: starts or ends with a space | write a name of letters, digits, `-`, `_` and `.`, such as "rolling-1""#,
        ],
    },
    BadCase {
        replace: r#"name = "wheel-rail""#,
        by: r#"name = "xxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxx""#,
        errors: &[
            r#"2:8 case.name: has 65 bytes, 64 at most | write a name of letters, digits, `-`, `_` and `.`, such as "rolling-1""#,
        ],
    },
    BadCase {
        replace: r#"name = "wheel-rail""#,
        by: "name = 3",
        errors: &[
            r#"2:8 case.name: is the number 3, not a text | write "3", with quotes"#,
        ],
    },
    BadCase {
        replace: "[load]",
        by: "[materials.\"1.4301\"]\n[load]",
        errors: &[
            "18:1 materials.1.4301: a name must not be empty or contain a dot | write `1_4301`",
        ],
    },
    BadCase {
        replace: "[load]",
        by: "[[load]]",
        errors: &[
            "18:1 load: is a list, not a table | write it as a section: [load]",
        ],
    },
    BadCase {
        replace: "[mech]\nmodel = \"half-space\"\nresolution = 40\n[thermal]\nmodel = \"columns\"\n",
        by: "",
        errors: &[
            "23:1 effects.friction_heat: no participant of this case offers it | add [mech] or [thermal] with a model, or remove the effect",
            "25:1 effects.partial_slip: no participant of this case offers it | add [mech] with a model, or remove the effect",
            "case.toml : nothing would run: the case has no participant | add [mech] or [thermal] with a model",
        ],
    },
    BadCase {
        replace: "[case]",
        by: "speed = 3\n[case]",
        errors: &[
            "1:1 speed: unknown key; not read by the coordinator, mech and thermal | write `motion.speed`",
        ],
    },
    BadCase {
        replace: "[case]",
        by: "zzz = 3\n[case]",
        errors: &[
            "1:1 zzz: unknown key; not read by the coordinator, mech and thermal | remove it",
        ],
    },
    BadCase {
        replace: r#"normal_force = "134 kN""#,
        by: "normal_force = \"134 kN\"\nspeed = 3\nfriction_coefficient=3",
        errors: &[
            "20:1 load.speed: unknown key; not read by the coordinator, mech and thermal | write `motion.speed`",
            "21:1 load.friction_coefficient: unknown key; not read by the coordinator, mech and thermal | remove it, or write normal_force instead",
        ],
    },
];
