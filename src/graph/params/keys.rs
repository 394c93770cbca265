//! Keyframes: `{"keys": [[1, 0.2], [48, 0.9]]}`, a frame and a value each, for a number, vector, color or
//! direction that changes with the frame.
//!
//! Linear from key to key, component by component; before the first key its value, after the last its. Each
//! key is a value as the parameter takes it without keys, and what lies between is inside of any range
//! that both are in. A direction may lose its length on the way; that is a problem of the frame. Tested
//! by values between keys and the exact text of what is refused.

use serde_json::{Map, Value as Json};

use super::{ParamProblem, ParamValue, Reading, describe, has_no_length, whole};
use crate::graph::spec::{ParamKind, ParamSpec};

/// What stands for a parameter that can have keys, if it is an object.
pub(super) fn of<'a>(spec: &ParamSpec, json: &'a Json) -> Option<&'a Map<String, Json>> {
    json.as_object().filter(|_| spec.kind.takes_keys())
}

/// The value at the moment.
///
/// # Errors
/// What is wrong with each key.
pub(super) fn parse(
    field: &str,
    spec: &ParamSpec,
    given: &Map<String, Json>,
    reading: &Reading,
) -> Result<ParamValue, Vec<ParamProblem>> {
    let refuse = |message: String| vec![ParamProblem { field: field.to_owned(), message }];
    let wrong_form = || {
        let found = describe(&Json::Object(given.clone()));
        let form = r#"{"keys": [[frame, value], …]} with rising whole frames"#;
        refuse(format!("{field} is {found}; write {form}, each value {}", spec.form()))
    };
    let list = given.get("keys").and_then(Json::as_array).filter(|list| !list.is_empty() && given.len() == 1);
    let mut keys: Vec<(i64, Vec<f64>)> = Vec::new();
    let mut problems = Vec::new();
    for json in list.ok_or_else(wrong_form)? {
        let Some([Json::Number(frame), value]) = json.as_array().map(Vec::as_slice) else {
            return Err(wrong_form());
        };
        let frame = whole(frame).filter(|frame| keys.last().is_none_or(|(before, _)| before < frame));
        let frame = frame.ok_or_else(wrong_form)?;
        if of(spec, value).is_some() {
            return Err(wrong_form());
        }
        match super::parse(&format!("{field} at frame {frame}"), spec, value, reading) {
            Ok(value) => keys.push((frame, numbers(value))),
            Err(found) => {
                problems
                    .extend(found.into_iter().map(|found| ParamProblem { field: field.to_owned(), ..found }));
                keys.push((frame, Vec::new()));
            }
        }
    }
    if !problems.is_empty() {
        return Err(problems);
    }
    let values = between(&keys, reading.moment.frame.unwrap_or(i64::MIN));
    match spec.kind {
        ParamKind::Float => Ok(ParamValue::Float(values[0])),
        ParamKind::Direction if has_no_length(&values) => {
            let frame = reading.moment.frame.unwrap_or_default();
            Err(refuse(format!("{field} has no length at frame {frame}; add a key, so that it turns around")))
        }
        _ => Ok(ParamValue::Floats(values)),
    }
}

fn numbers(value: ParamValue) -> Vec<f64> {
    match value {
        ParamValue::Float(x) => vec![x],
        ParamValue::Floats(values) => values,
        other => unreachable!("{other:?} takes no keys"),
    }
}

/// The values at a frame; `keys` rise and are not empty.
fn between(keys: &[(i64, Vec<f64>)], frame: i64) -> Vec<f64> {
    let next = keys.partition_point(|(key, _)| *key <= frame);
    if next == 0 || next == keys.len() {
        return keys[next.saturating_sub(1)].1.clone();
    }
    let ((from, a), (to, b)) = (&keys[next - 1], &keys[next]);
    // As f64, because frames may be further apart than an i64 holds.
    let share = (frame as f64 - *from as f64) / (*to as f64 - *from as f64);
    a.iter().zip(b).map(|(a, b)| (1.0 - share) * a + share * b).collect()
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use serde_json::json;

    use super::*;
    use crate::graph::params::{Moment, Params};
    use crate::graph::spec::Timing;

    const MEMBERS: &[ParamSpec] = &[ParamSpec::float("scale", 1.0)];
    const ALL: &[ParamSpec] = &[
        ParamSpec::float("g", 0.0).between(-1.0, 1.0),
        ParamSpec::rgb("albedo", [1.0; 3]),
        ParamSpec::vector("eye", &[0.0, 0.0]),
        ParamSpec::direction("up", [0.0, 1.0, 0.0]),
        ParamSpec::int("count", 3),
        ParamSpec::record("glow", MEMBERS),
    ];
    const TIMED: &[ParamSpec] = &[
        ParamSpec::int("frame", 0).or_null().timed(Timing::Frame),
        ParamSpec::bool("hold", false).timed(Timing::Aside),
    ];

    fn resolve(json: Json, frame: Option<i64>) -> Result<Params, Vec<ParamProblem>> {
        let moment = Moment { frame, is_aside: false };
        Params::resolve(ALL, json.as_object().unwrap(), Path::new(""), moment)
    }

    #[test]
    fn values_between_keys_are_linear() {
        let given = json!({
            "g": {"keys": [[-4, -0.5], [0, 0.5], [10, 1]]},
            "albedo": {"keys": [[0, 0.25], [4, [0.25, 0.5, 0.75]]]},
            "eye": {"keys": [[7, [1, 2]]]},
            "up": {"keys": [[0, [0, 1, 0]], [2, [1, 0, 0]]]},
            "glow": {"scale": {"keys": [[0, 1], [2, 2]]}}
        });
        let at = |frame| resolve(given.clone(), frame).unwrap();
        // Halves and quarters: exact.
        let g = [
            (None, -0.5),
            (Some(-9), -0.5),
            (Some(-4), -0.5),
            (Some(-2), 0.0),
            (Some(0), 0.5),
            (Some(5), 0.75),
        ];
        for (frame, g) in g.into_iter().chain([(Some(10), 1.0), (Some(i64::MAX), 1.0)]) {
            assert_eq!(at(frame).f64("g"), g, "{frame:?}");
        }
        assert_eq!(at(Some(2)).rgb("albedo"), [0.25, 0.375, 0.5]);
        assert_eq!(at(Some(0)).vec("eye"), [1.0, 2.0]);
        assert_eq!(at(Some(1)).vec("up"), [0.5, 0.5, 0.0]);
        assert_eq!(at(Some(1)).record("glow").unwrap().f64("scale"), 1.5);
        assert_eq!(at(Some(1)).i64("count"), 3);
    }

    #[test]
    fn wrong_keys() {
        let form = r#"write {"keys": [[frame, value], …]} with rising whole frames, each value "#;
        let number = format!("{form}a number, -1..=1");
        let cases = [
            (json!({"g": {}}), format!("g is {{}}; {number}")),
            (json!({"g": {"keys": []}}), format!(r#"g is {{"keys":[]}}; {number}"#)),
            (json!({"g": {"key": [[1, 1]]}}), format!(r#"g is {{"key":[[1,1]]}}; {number}"#)),
            (json!({"g": {"keys": [[1, 1]], "a": 1}}), format!(r#"g is {{"keys":[[1,1]],"a":1}}; {number}"#)),
            (json!({"g": {"keys": [[1.5, 1]]}}), format!(r#"g is {{"keys":[[1.5,1]]}}; {number}"#)),
            (json!({"g": {"keys": [[1, 1], [1, 0]]}}), format!(r#"g is {{"keys":[[1,1],[1,0]]}}; {number}"#)),
            (json!({"g": {"keys": [[1]]}}), format!(r#"g is {{"keys":[[1]]}}; {number}"#)),
            (
                json!({"g": {"keys": [[1, {"keys": [[1, 1]]}]]}}),
                format!(r#"g is {{"keys":[[1,{{"keys":[[1,1]]}}]]}}; {number}"#),
            ),
            (
                json!({"g": {"keys": [[1, 0], [2, 3]]}}),
                "g at frame 2 = 3 is outside -1..=1; the default is 0".to_owned(),
            ),
            (
                json!({"up": {"keys": [[1, [0, 0, 0]]]}}),
                "up at frame 1 has no length; write 3 numbers in brackets, not all zero".to_owned(),
            ),
            (
                json!({"up": {"keys": [[1, [0, 1, 0]], [3, [0, -1, 0]]]}}),
                "up has no length at frame 2; add a key, so that it turns around".to_owned(),
            ),
            (
                json!({"count": {"keys": [[1, 1]]}}),
                r#"count is {"keys":[[1,1]]}; write a whole number"#.to_owned(),
            ),
        ];
        for (json, message) in cases {
            let problems = resolve(json.clone(), Some(2)).expect_err("a mistake");
            let messages: Vec<&str> = problems.iter().map(|problem| problem.message.as_str()).collect();
            assert_eq!(messages, [message], "{json}");
            let field = json.as_object().unwrap().keys().next().unwrap();
            assert_eq!(problems[0].field, *field);
        }
    }

    #[test]
    fn what_varies_is_known() {
        let vary = |specs, json: Json| Params::vary(specs, json.as_object().unwrap());
        assert!(vary(ALL, json!({"g": {"keys": [[1, 1]]}})));
        assert!(vary(ALL, json!({"glow": {"scale": {"keys": [[0, 1]]}}})));
        assert!(!vary(ALL, json!({"g": 0.5, "glow": {"scale": 2}})));
        assert!(vary(TIMED, json!({})) && !vary(&TIMED[1..], json!({})));
    }

    #[test]
    fn the_frame_sets_what_is_timed() {
        let given = json!({"frame": 3});
        let at = |frame, is_aside| {
            let moment = Moment { frame, is_aside };
            Params::resolve(TIMED, given.as_object().unwrap(), Path::new(""), moment).unwrap()
        };
        assert_eq!((at(None, false).i64("frame"), at(Some(7), false).i64("frame")), (3, 7));
        assert!(!at(Some(7), false).bool("hold") && at(Some(7), true).bool("hold"));
    }
}
