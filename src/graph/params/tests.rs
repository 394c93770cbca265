use serde_json::json;

use super::*;

const ALL: &[ParamSpec] = &[
    ParamSpec::float("g", 0.5).between(-1.0, 1.0).open(),
    ParamSpec::int("count", 32).between(1.0, 64.0),
    ParamSpec::int_choice("lines", &[14, 26, 50]),
    ParamSpec::bool("on", true),
    ParamSpec::text("grid", "density"),
    ParamSpec::choice("scheme", &["auto", "scan", "walk"]),
    ParamSpec::path("file").or_null(),
    ParamSpec::out_path("save", "out.exr"),
    ParamSpec::vector("window", &[30.0, 70.0]).at_least(0.0),
    ParamSpec::rgb("albedo", [1.0; 3]).between(0.0, 1.0),
    ParamSpec::direction("up", [0.0, 1.0, 0.0]),
    ParamSpec::record("emission", EMISSION),
];
const EMISSION: &[ParamSpec] =
    &[ParamSpec::text("flame", "flame"), ParamSpec::float("scale", 1.0).above(0.0)];

fn resolve(json: Json) -> Result<Params, Vec<ParamProblem>> {
    Params::resolve(ALL, json.as_object().unwrap(), Path::new("folder"), Moment::default())
}

fn messages(json: Json) -> Vec<String> {
    let problems = resolve(json).expect_err("a mistake");
    problems.into_iter().map(|problem| problem.message).collect()
}

#[test]
fn defaults_are_filled_in() {
    let params = Params::defaults(ALL).unwrap();
    assert_eq!(params.f64("g"), 0.5);
    assert_eq!(params.i64("count"), 32);
    assert_eq!(params.i64("lines"), 14);
    assert!(params.bool("on"));
    assert_eq!(params.text("grid"), "density");
    assert_eq!(params.text("scheme"), "auto");
    assert!(!params.is_set("file"));
    assert_eq!(params.path("save"), Path::new("out.exr"));
    assert_eq!(params.vec("window"), [30.0, 70.0]);
    assert_eq!(params.rgb("albedo"), [1.0; 3]);
    assert_eq!(params.unit("up"), [0.0, 1.0, 0.0]);
    assert!(params.record("emission").is_none());
    let names: Vec<&str> = params.iter().map(|(name, _)| name).collect();
    assert_eq!(names, ALL.iter().map(|spec| spec.name).collect::<Vec<_>>());
}

#[test]
fn values_of_each_form() {
    let params = resolve(json!({
        "g": -1e-3, "count": 3.0, "on": false, "grid": "", "scheme": "walk", "file": "a/b.vdb",
        "save": "/abs.exr", "window": [0, 1.5], "albedo": 0.25, "up": [0, -1e-200, 0],
        "emission": {"flame": "heat"}
    }))
    .unwrap();
    assert_eq!(params.f64("g"), -1e-3);
    assert_eq!(params.i64("count"), 3);
    assert!(!params.bool("on"));
    assert_eq!(params.text("grid"), "");
    assert_eq!(params.text("scheme"), "walk");
    assert_eq!(params.path("file"), Path::new("folder/a/b.vdb"));
    assert_eq!(params.path("save"), Path::new("/abs.exr"));
    assert_eq!(params.vec("window"), [0.0, 1.5]);
    assert_eq!(params.rgb("albedo"), [0.25; 3]);
    assert_eq!(params.unit("up"), [0.0, -1.0, 0.0]);
    let emission = params.record("emission").unwrap();
    assert_eq!(emission.text("flame"), "heat");
    assert_eq!(emission.f64("scale"), 1.0);
    assert!(!resolve(json!({"file": null})).unwrap().is_set("file"));
    assert!(resolve(json!({"emission": null})).is_ok());
}

#[test]
fn a_long_direction_becomes_unit_length() {
    let up = resolve(json!({"up": [3e300, 0, -4e300]})).unwrap().unit("up");
    // Two roundings of the scaling, one of the sum, one of the root, one of the division: 5 half ulps.
    let tolerance = 5.0 * 0.5 * f64::EPSILON;
    for (found, exact) in up.into_iter().zip([0.6, 0.0, -0.8]) {
        assert!((found - exact).abs() <= tolerance, "{found} {exact}");
    }
}

#[test]
fn wrong_forms() {
    let cases = [
        (json!({"g": "a"}), "g is \"a\"; write a number, -1 < value < 1"),
        (json!({"g": null}), "g is null; write a number, -1 < value < 1"),
        (json!({"count": 1.5}), "count is 1.5; write a whole number, 1..=64"),
        (json!({"count": 1e30}), "count is 1e+30; write a whole number, 1..=64"),
        (json!({"lines": 15}), "lines is 15; allowed are 14, 26, 50"),
        (json!({"lines": 26.5}), "lines is 26.5; allowed are 14, 26, 50"),
        (json!({"lines": "26"}), "lines is \"26\"; write one of 14, 26, 50"),
        (json!({"on": 1}), "on is 1; write true or false"),
        (json!({"grid": 5}), "grid is 5; write a string"),
        (json!({"scheme": true}), "scheme is true; write one of auto, scan, walk"),
        (json!({"scheme": "none"}), "scheme is 'none'; allowed are auto, scan, walk"),
        (json!({"scheme": "walkk"}), "scheme is 'walkk'; did you mean 'walk'? allowed are auto, scan, walk"),
        (json!({"file": 1}), "file is 1; write a path as a string, or null"),
        (json!({"save": ""}), "save is empty; write a path as a string"),
        (json!({"window": [1]}), "window is [1]; write 2 numbers in brackets, value >= 0"),
        (json!({"albedo": [1, 1]}), "albedo is [1,1]; write 3 numbers in brackets or one for grey, 0..=1"),
        (json!({"up": 1}), "up is 1; write 3 numbers in brackets, not all zero"),
        (json!({"up": [0, 0, -0.0]}), "up has no length; write 3 numbers in brackets, not all zero"),
        (json!({"emission": true}), "emission is true; write an object with flame, scale, or null"),
        (
            json!({"grid": ["a long list", "that is longer", "than one line"]}),
            "grid is [\"a long list\",\"that is longer\",\"than on…; write a string",
        ),
    ];
    for (json, message) in cases {
        assert_eq!(messages(json), [message]);
    }
}

#[test]
fn outside_the_limits() {
    let cases = [
        (json!({"g": 1}), "g = 1 is outside -1 < value < 1; the default is 0.5"),
        (json!({"g": -1.0}), "g = -1.0 is outside -1 < value < 1; the default is 0.5"),
        (json!({"count": 0}), "count = 0 is outside 1..=64; the default is 32"),
        (json!({"window": [30, -1]}), "window[1] = -1 is outside value >= 0; the default is [30,70]"),
        (json!({"albedo": -0.5}), "albedo = -0.5 is outside 0..=1; the default is [1,1,1]"),
        (json!({"emission": {"scale": 0}}), "emission.scale = 0 is outside value > 0; the default is 1"),
    ];
    for (json, message) in cases {
        assert_eq!(messages(json), [message]);
    }
}

#[test]
fn all_problems_at_once() {
    let found = messages(json!({
        "gg": 1, "albedo": [1.2, 0, -3], "emission": {"flam": "x", "scale": "y"}
    }));
    assert_eq!(
        found,
        [
            "unknown parameter 'gg'; did you mean 'g'? allowed are g, count, lines, on, grid, scheme, file, \
             save, window, albedo, up, emission",
            "albedo[0] = 1.2 is outside 0..=1; the default is [1,1,1]",
            "albedo[2] = -3 is outside 0..=1; the default is [1,1,1]",
            "unknown parameter 'emission.flam'; did you mean 'flame'? allowed are flame, scale",
            "emission.scale is \"y\"; write a number, value > 0",
        ]
    );
}

#[test]
fn what_has_no_default_is_missed() {
    const PATH: &[ParamSpec] = &[ParamSpec::path("path")];
    let problems = Params::defaults(PATH).unwrap_err();
    assert_eq!(problems[0].message, "path is missing; write a path as a string");
    assert_eq!(problems[0].field, "path");
    let given = json!({"x": 1});
    let problems =
        Params::resolve(&[], given.as_object().unwrap(), Path::new(""), Moment::default()).unwrap_err();
    assert_eq!(problems[0].message, "unknown parameter 'x'; none are taken here");
}

#[test]
#[should_panic(expected = "parameter 'h' is not declared")]
fn undeclared_name() {
    Params::defaults(ALL).unwrap().f64("h");
}

#[test]
#[should_panic(expected = "parameter 'g' was asked for as a whole number but is Float(0.5)")]
fn undeclared_form() {
    Params::defaults(ALL).unwrap().i64("g");
}

const CURVES: &[ParamSpec] = &[ParamSpec::curve("points", &["value", "r", "opacity"]).between(0.0, 1.0)];

#[test]
fn curves_rise() {
    let resolve = |json: Json| {
        let given = json!({ "points": json });
        Params::resolve(CURVES, given.as_object().unwrap(), Path::new(""), Moment::default())
    };
    let params = resolve(json!([[-3, 0, 0.5], [2.5, 1, 1]])).unwrap();
    assert_eq!(params.rows("points").unwrap(), [[-3.0, 0.0, 0.5], [2.5, 1.0, 1.0]]);
    assert!(resolve(Json::Null).unwrap().rows("points").is_none());
    let form = "1 or more rows [value, r, opacity] with rising value, the others 0..=1, or null";
    let cases = [
        (json!([]), format!("points is []; write {form}")),
        (json!([[0, 1]]), format!("points is [[0,1]]; write {form}")),
        (json!([[0, 1, "a"]]), format!(r#"points is [[0,1,"a"]]; write {form}"#)),
        (json!([[0, 1, 1], [0, 1, 1]]), "points[1].value = 0 does not rise from 0".to_owned()),
        (json!([[5, 1, 1], [4, 1, 1]]), "points[1].value = 4 does not rise from 5".to_owned()),
        (json!([[0, 1, 2]]), "points[0].opacity = 2 is outside 0..=1".to_owned()),
    ];
    for (json, message) in cases {
        let problems = resolve(json.clone()).expect_err("a mistake");
        assert_eq!((problems.len(), &problems[0].message), (1, &message), "{json}");
    }
}
