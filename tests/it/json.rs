//! Holds the JSON of the core to serde_json's.

use marching_particles::field::formula::Parameter;
use marching_particles::field::model::{ModelInfo, NormalSource};
use marching_particles::json::{from_str, to_string};
use marching_particles::math::Bounds;
use marching_particles::sampler::{GapPolicy, LawKind, Placement, Sampling, Settings, SizeMode};
use marching_particles::session::{FieldRequest, PointsRequest, Session, describe};
use proptest::prelude::{ProptestConfig, any, proptest};
use serde::Serialize;
use serde_json::Value;
use std::collections::BTreeMap;

/// The same value, where `1` and `1.0` are the same.
fn same(a: &Value, b: &Value) -> bool {
    match (a, b) {
        (Value::Number(a), Value::Number(b)) => {
            // serde_json reads numbers to within a unit in the last place only.
            let (x, y) = (a.as_f64().unwrap_or(f64::NAN), b.as_f64().unwrap_or(f64::NAN));
            a == b || (a.is_f64() || b.is_f64()) && (x - y).abs() <= 4.0e-16 * x.abs()
        }
        (Value::Array(a), Value::Array(b)) => a.len() == b.len() && a.iter().zip(b).all(|(a, b)| same(a, b)),
        (Value::Object(a), Value::Object(b)) => {
            a.len() == b.len() && a.iter().all(|(key, a)| b.get(key).is_some_and(|b| same(a, b)))
        }
        _ => a == b,
    }
}

fn assert_same(value: &impl Serialize) {
    let written = to_string(value).expect("it can be written");
    let ours: Value = serde_json::from_str(&written).unwrap_or_else(|error| panic!("{error} in {written}"));
    let theirs = serde_json::to_value(value).expect("it can be written");
    assert!(same(&ours, &theirs), "{ours}\n{theirs}");
}

#[test]
fn what_the_core_says_is_what_serde_json_would_say() {
    assert_same(&describe());
    assert_same(&Settings::default());
    let mut session = Session::new();
    assert_same(&session.answer());
    session.start(&Settings { radius_share: 0.03, ..Settings::default() }).expect("the settings are valid");
    while session.step(1000).stop_reason.is_none() {
        assert_same(&session.sampler().counts().fates);
    }
    assert_same(&session.report());
    assert_same(&(
        1_u8,
        -7_i64,
        u64::MAX,
        i64::MIN,
        f64::NAN,
        None::<f64>,
        "\u{1}\u{1f}\n\t\"\\/é😀\u{7f}",
        'q',
        (),
    ));
    assert!(to_string(&BTreeMap::from([(1, 2)])).is_err(), "a number is no key");
}

#[test]
fn requests_and_settings_are_read() {
    let request = r#" { "surface" : "torus", "formula":null,
        "parameters":{"a":1,"b":-2.5e-3,"\u00e9\ud83d\ude00\n\"":0.1},
        "declare":[{"name":"k","label":"K","value":1.0,"min":0,"max":2,"step":0.1}],
        "bounds":{"min":[-1,-1.5,-2],"max":[1,2,3e0]}, "unknown":[{},[],"",true,false,null,{"x":[1,2]}] } "#;
    let ours: FieldRequest = from_str(request).expect("it is a request");
    assert_eq!((ours.surface.as_deref(), ours.formula.as_deref()), (Some("torus"), None));
    assert_eq!(ours.parameters.get("é😀\n\""), Some(&0.1));
    assert_eq!(
        ours.declare[0],
        Parameter { label: "K".into(), max: 2.0, step: 0.1, ..Parameter::automatic("k") }
    );
    assert_eq!(ours.bounds, Some(Bounds { min: [-1.0, -1.5, -2.0], max: [1.0, 2.0, 3.0] }));
    let settings: Settings =
        from_str(r#"{"seed":18446744073709551615,"count":77,"gaps":"leave","radius_share":0.02}"#)
            .expect("settings");
    assert_eq!((settings.seed, settings.count, settings.gaps), (u64::MAX, 77, GapPolicy::Leave));
    assert_eq!((settings.radius_share, settings.relax_steps), (0.02, Settings::default().relax_steps));
}

#[test]
fn whatever_is_written_can_be_read_back() {
    let settings = Settings {
        sampling: Sampling::Adaptive,
        size_mode: SizeMode::Count,
        radius_law: LawKind::SumOfCurvatures,
        placement: Placement::Faithful,
        gaps: GapPolicy::Leave,
        radius_share: 0.1,
        chord_error: 0.2,
        curvature_scale: 0.3,
        radius_min_share: 0.4,
        radius_max_share: 0.5,
        grading: 0.6,
        match_tolerance: 0.7,
        count: 1,
        relax_steps: 2,
        seed: 3,
        max_particles: 4,
    };
    for settings in [settings, Settings::default()] {
        let written = to_string(&settings).expect("it can be written");
        assert_eq!(from_str::<Settings>(&written), Ok(settings));
    }
    for normals in [NormalSource::Given, NormalSource::FromMesh, NormalSource::Estimated] {
        let info = ModelInfo {
            name: "hare".into(),
            credit: "field".into(),
            points: 7,
            normals,
            ..ModelInfo::default()
        };
        let request = PointsRequest { info, bounds: Bounds::cube(2.0) };
        let written = to_string(&request).expect("it can be written");
        assert_eq!(from_str::<PointsRequest>(&written), Ok(request));
    }
}

#[test]
fn what_is_malformed_is_refused() {
    let nested = "[".repeat(100_000);
    for text in [
        "",
        "{",
        "}",
        "{}x",
        "{,}",
        "{\"seed\"}",
        "{\"seed\":}",
        "{\"seed\":1,}",
        "{\"seed\":1 \"count\":2}",
        "{seed:1}",
        "{\"seed\":-1}",
        "{\"seed\":1.5}",
        "{\"seed\":\"1\"}",
        "{\"seed\":null}",
        "{\"count\":4294967296}",
        "{\"seed\":01}",
        "{\"seed\":1.}",
        "{\"radius_share\":.5}",
        "{\"radius_share\":1.e5}",
        "{\"radius_share\":1e999}",
        "{\"radius_share\":NaN}",
        "{\"radius_share\":+1}",
        "{\"radius_share\":1-2}",
        "{\"gaps\":\"sometimes\"}",
        "{\"gaps\":1}",
        "{\"seed\":1,\"seed\":2}",
        "{\"x\":\"\\q\"}",
        "{\"gaps\":\"\\ud800\"}",
        "{\"gaps\":\"\\ud800\\u0041\"}",
        "{\"x\":\"\\u00g0\"}",
        "{\"x\":\"\\u+123\"}",
        "{\"x\":\"\n\"}",
        "{\"x\":\"",
        "{\"x\":\"\\",
        "{\"x\":\"\\u12",
        "{\"x\":nul}",
        "3",
        "\"text\"",
        "[1",
        &nested,
    ] {
        assert!(from_str::<Settings>(text).is_err(), "{text}");
    }
    let error = from_str::<Settings>(r#"{"count":"many"}"#).expect_err("a text is no count");
    assert_eq!(error.to_string(), "this text cannot stand where a whole number below 2^32 is expected");
    assert!(
        from_str::<Bounds>(r#"{"min":[0,0,0,0],"max":[1,1,1]}"#).is_err(),
        "a corner has three coordinates"
    );
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 100, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn texts_and_numbers_come_back(text in any::<String>(), number in any::<f64>(), names in any::<Vec<String>>()) {
        let written = to_string(&(&text, number, &names)).expect("it can be written");
        let theirs: Vec<Value> = serde_json::from_str(&written).expect("it can be read");
        let part = |k: usize| theirs[k].to_string();
        assert_eq!(from_str::<String>(&part(0)), Ok(text));
        assert_eq!(from_str::<Option<f64>>(&to_string(&number).expect("a number")), Ok(Some(number).filter(|n| n.is_finite())));
        assert_eq!(from_str::<Vec<String>>(&part(2)), Ok(names));
    }

    #[test]
    fn any_text_is_read_as_by_serde_json(text in "[\\[\\]{}:,\"0-9.eE \\\\utrfalsn+-]{0,12}") {
        let ours = from_str::<Vec<f64>>(&text).ok();
        let theirs = serde_json::from_str::<Vec<f64>>(&text).ok();
        assert_eq!(ours, theirs, "{text}");
    }
}
