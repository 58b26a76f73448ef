//! The time of the checks: the seconds of every part, and the slowest tests.

use std::fs;
use std::path::Path;
use std::sync::Mutex;
use std::time::Duration;

use serde_json::Value;

/// Number of tests in the table.
const SLOWEST: usize = 10;

/// Parts and tests, with their seconds.
static PARTS: Mutex<Vec<(String, f64)>> = Mutex::new(Vec::new());
static TESTS: Mutex<Vec<(String, f64)>> = Mutex::new(Vec::new());

fn add(list: &Mutex<Vec<(String, f64)>>, name: String, seconds: f64) {
    // A panic elsewhere cannot leave a list of times half-written.
    list.lock().unwrap_or_else(std::sync::PoisonError::into_inner).push((name, seconds));
}

/// Records the time of a part.
pub(crate) fn part(name: &str, took: Duration) {
    add(&PARTS, name.to_owned(), took.as_secs_f64());
}

/// Records the time of a test in seconds.
pub(crate) fn test(name: impl Into<String>, seconds: f64) {
    add(&TESTS, name.into(), seconds);
}

/// Records the times from a Vitest report, a JSON file.
pub(crate) fn vitest(file: &Path) {
    let report = read(file);
    for group in array(&report["testResults"]) {
        for test in array(&group["assertionResults"]) {
            if let (Some(name), Some(ms)) = (test["fullName"].as_str(), test["duration"].as_f64()) {
                self::test(format!("node: {name}"), ms / 1000.0);
            }
        }
    }
}

/// Records the times from a Playwright report, a JSON file.
pub(crate) fn playwright(file: &Path) {
    fn walk(suite: &Value) {
        array(&suite["suites"]).iter().for_each(walk);
        for spec in array(&suite["specs"]) {
            for test in array(&spec["tests"]) {
                let ms: f64 = array(&test["results"]).iter().filter_map(|run| run["duration"].as_f64()).sum();
                let name = spec["title"].as_str().unwrap_or_default();
                let project = test["projectName"].as_str().unwrap_or_default();
                self::test(format!("chromium, {project}: {name}"), ms / 1000.0);
            }
        }
    }
    walk(&read(file));
}

/// A missing report has no times.
fn read(file: &Path) -> Value {
    fs::read(file).ok().and_then(|text| serde_json::from_slice(&text).ok()).unwrap_or_default()
}

fn array(value: &Value) -> &[Value] {
    value.as_array().map_or(&[], Vec::as_slice)
}

/// Prints the parts in the order in which they ended, and the slowest tests; writes all tests to
/// `file`, slowest first.
pub(crate) fn print(whole: Duration, file: &Path) {
    let take = |list: &Mutex<Vec<(String, f64)>>| {
        std::mem::take(&mut *list.lock().unwrap_or_else(std::sync::PoisonError::into_inner))
    };
    println!("\n  {:>7}  part", "s");
    for (name, seconds) in take(&PARTS) {
        println!("  {seconds:>7.1}  {name}");
    }
    println!("  {:>7.1}  the whole, two parts at a time", whole.as_secs_f64());
    let mut tests = take(&TESTS);
    tests.sort_by(|a, b| b.1.total_cmp(&a.1));
    let lines: Vec<String> =
        tests.iter().map(|(name, seconds)| format!("  {seconds:>7.1}  {name}")).collect();
    if !lines.is_empty() {
        println!("\n  {:>7}  the slowest of {} tests", "s", lines.len());
        println!("{}", lines[..SLOWEST.min(lines.len())].join("\n"));
        match fs::write(file, lines.join("\n") + "\n") {
            Ok(()) => println!("  all of them: {}", file.display()),
            Err(error) => println!("  {} could not be written: {error}", file.display()),
        }
    }
    println!();
}
