//! Holds the table of settings in the README to the settings, and the compiler that is promised to the one that is used.

use marching_particles::math::shortest_text;
use marching_particles::session::{Condition, Setting, SettingValue, settings};
use std::path::Path;

const BEGIN: &str =
    "<!-- The table of settings is written by a test: UPDATE_GOLDEN=1 cargo test --test it readme:: -->\n";
const END: &str = "<!-- End of the table of settings. -->\n";

fn percent(share: f64) -> String {
    let percent: f64 = format!("{:.3e}", 100.0 * share).parse().expect("a number");
    format!("{} %", shortest_text(percent))
}

fn values(setting: &Setting) -> String {
    if !setting.choices.is_empty() {
        let values: Vec<String> =
            setting.choices.iter().map(|choice| format!("`{}`", choice.value)).collect();
        return values.join(", ");
    }
    let (min, max) = setting.accepted().into_inner();
    match setting.default {
        _ if setting.is_share() => format!("{} to {} of the box diagonal", percent(min), percent(max)),
        SettingValue::Integer(_) if max >= u64::MAX as f64 => "any whole number".to_owned(),
        _ => {
            format!("{} to {} {}", shortest_text(min), shortest_text(max), setting.unit).trim_end().to_owned()
        }
    }
}

fn default(setting: &Setting) -> String {
    match setting.default {
        SettingValue::Choice(value) => format!("`{value}`"),
        SettingValue::Integer(whole) => whole.to_string(),
        SettingValue::Number(share) if setting.is_share() => percent(share),
        SettingValue::Number(number) => shortest_text(number),
    }
}

fn condition(Condition { name, value, equal }: &Condition) -> String {
    format!("`{name}` {} `{value}`", if *equal { "=" } else { "≠" })
}

fn table() -> String {
    let mut rows = String::from(
        "| Setting | Option | Values | Default | Used if | Meaning |\n| --- | --- | --- | --- | --- | --- |\n",
    );
    for setting in &settings() {
        let conditions: Vec<String> = setting.when.iter().map(condition).collect();
        rows += &format!(
            "| `{}` | `--{}` | {} | {} | {} | {} |\n",
            setting.name,
            setting.option(),
            values(setting),
            default(setting),
            conditions.join(", "),
            setting.help
        );
    }
    rows
}

#[test]
fn the_oldest_compiler_that_is_promised_is_the_one_that_every_check_runs_with() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let text = |name: &str| std::fs::read_to_string(root.join(name)).expect("a file of the project");
    let promised = env!("CARGO_PKG_RUST_VERSION");
    assert!(text("rust-toolchain.toml").contains(&format!("channel = \"{promised}.0\"")), "{promised}");
    assert!(text("README.md").contains(&format!("`rust-toolchain.toml` ({promised};")), "{promised}");
}

#[test]
fn the_table_of_settings_is_that_of_the_settings() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("README.md");
    let readme = std::fs::read_to_string(&path).expect("the README can be read");
    let (before, rest) = readme.split_once(BEGIN).expect("the README has the begin mark");
    let (written, after) = rest.split_once(END).expect("the README has the end mark");
    let wanted = table();
    if std::env::var_os("UPDATE_GOLDEN").is_some_and(|value| value == "1") {
        std::fs::write(&path, [before, BEGIN, &wanted, END, after].concat())
            .expect("the README can be written");
        return;
    }
    assert_eq!(written, wanted, "UPDATE_GOLDEN=1 cargo test --test it readme:: puts it right");
}
