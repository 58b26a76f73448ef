//! Runs a command as a named step: prints its name and time, and on failure the command, its output
//! and advice.

use std::io::{Read, Write as _};
use std::process::{Command, Stdio};
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use anyhow::{Result, anyhow};

static VERBOSE: AtomicBool = AtomicBool::new(false);

/// Sets whether the output of commands is shown as it comes.
pub(crate) fn set_verbose(verbose: bool) {
    VERBOSE.store(verbose, Ordering::Relaxed);
}

/// A running step. It prints a line at its start and one at its end, since other steps may run
/// meanwhile.
pub(crate) struct Step {
    label: String,
    started: Instant,
}

impl Step {
    /// Announces a step.
    pub(crate) fn begin(label: &str) -> Self {
        println!("  {label} …");
        Self { label: label.to_owned(), started: Instant::now() }
    }

    /// Reports success, with `note` after the time.
    pub(crate) fn done(self, note: &str) {
        let gap = if note.is_empty() { "" } else { "  " };
        println!("  {} … ok {}{gap}{note}", self.label, seconds(self.started.elapsed()));
    }

    /// Reports failure.
    pub(crate) fn failed(self) {
        println!("  {} … FAILED {}", self.label, seconds(self.started.elapsed()));
    }
}

/// Runs `work` as a step.
pub(crate) fn task<T>(label: &str, work: impl FnOnce() -> Result<T>) -> Result<T> {
    let step = Step::begin(label);
    match work() {
        Ok(value) => {
            step.done("");
            Ok(value)
        }
        Err(error) => {
            step.failed();
            Err(error)
        }
    }
}

/// Runs `command` as a step and returns its standard output. An error contains the command line,
/// all its output, and `advice`.
pub(crate) fn run(label: &str, command: &mut Command, advice: &str) -> Result<String> {
    task(label, || capture(command, advice))
}

/// Runs `command` as [`run`] does, without announcing it.
pub(crate) fn capture(command: &mut Command, advice: &str) -> Result<String> {
    let line = command_line(command);
    let with_advice = |text: String| {
        let gap = if advice.is_empty() { "" } else { "\n\n" };
        anyhow!("{text}{gap}{advice}")
    };
    let mut child = command
        .stdin(Stdio::null())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .map_err(|error| with_advice(format!("could not start `{line}`: {error}")))?;
    let out = child.stdout.take().map(|pipe| std::thread::spawn(move || drain(pipe, false)));
    let err = child.stderr.take().map(|pipe| std::thread::spawn(move || drain(pipe, true)));
    let status = child.wait()?;
    let join = |handle: Option<std::thread::JoinHandle<Vec<u8>>>| {
        let bytes = handle.and_then(|handle| handle.join().ok()).unwrap_or_default();
        String::from_utf8_lossy(&bytes).into_owned()
    };
    let (out, err) = (join(out), join(err));
    if status.success() {
        return Ok(out);
    }
    let mut text = format!("`{line}` failed ({status})");
    for part in [without_progress(&out), without_progress(&err)] {
        if !part.is_empty() {
            text.push_str("\n\n");
            text.push_str(&part);
        }
    }
    Err(with_advice(text))
}

/// A command's output without cargo's progress lines.
fn without_progress(output: &str) -> String {
    const WELL: [&str; 7] =
        ["Compiling ", "Checking ", "Downloading ", "Downloaded ", "Blocking ", "Updating ", "Documenting "];
    let kept: Vec<&str> =
        output.lines().filter(|line| !WELL.iter().any(|verb| line.trim_start().starts_with(verb))).collect();
    kept.join("\n").trim_end().to_owned()
}

/// Reads a pipe to its end; passes it on as it comes when verbose.
fn drain(mut pipe: impl Read, is_error: bool) -> Vec<u8> {
    let mut all = Vec::new();
    let mut buffer = [0_u8; 8192];
    loop {
        match pipe.read(&mut buffer) {
            Ok(0) | Err(_) => return all,
            Ok(n) => {
                all.extend_from_slice(&buffer[..n]);
                if VERBOSE.load(Ordering::Relaxed) {
                    // The output is kept for the failure report even if the terminal is closed.
                    let _ = if is_error {
                        std::io::stderr().write_all(&buffer[..n])
                    } else {
                        std::io::stdout().write_all(&buffer[..n])
                    };
                }
            }
        }
    }
}

/// The command as one could type it, with its variables and its folder.
pub(crate) fn command_line(command: &Command) -> String {
    let mut words = Vec::new();
    for (key, value) in command.get_envs() {
        let value = value.map(|value| value.to_string_lossy().replace('\u{1f}', " ")).unwrap_or_default();
        words.push(format!("{}={}", key.to_string_lossy(), quoted(&value)));
    }
    words.push(quoted(&command.get_program().to_string_lossy()));
    words.extend(command.get_args().map(|argument| quoted(&argument.to_string_lossy())));
    let line = words.join(" ");
    match command.get_current_dir() {
        Some(folder) => format!("cd {} && {line}", quoted(&folder.display().to_string())),
        None => line,
    }
}

fn quoted(word: &str) -> String {
    let plain =
        !word.is_empty() && word.chars().all(|c| c.is_ascii_alphanumeric() || "-_=./:+,@%".contains(c));
    if plain { word.to_owned() } else { format!("'{}'", word.replace('\'', r"'\''")) }
}

/// A duration as a person reads it.
pub(crate) fn seconds(duration: Duration) -> String {
    format!("{:.1} s", duration.as_secs_f64())
}

#[cfg(test)]
mod tests {
    use std::process::Command;

    use super::{capture, command_line, without_progress};

    #[test]
    fn a_failure_shows_command_output_and_advice() {
        let mut command = Command::new("cargo");
        command.args(["no-such-subcommand", "a b"]);
        let error = capture(&mut command, "Try another.").unwrap_err().to_string();
        assert!(error.starts_with("`cargo no-such-subcommand 'a b'` failed"), "{error}");
        assert!(error.contains("no such command"), "{error}");
        assert!(error.ends_with("Try another."), "{error}");
    }

    #[test]
    fn command_lines_can_be_pasted() {
        let mut command = Command::new("tool");
        command.arg("it's").env("KEY", "a\u{1f}b").current_dir("/some where");
        assert_eq!(command_line(&command), r"cd '/some where' && KEY='a b' tool 'it'\''s'");
    }

    #[test]
    fn progress_is_left_out_of_failures() {
        assert_eq!(without_progress("   Compiling a v1\nerror: b\n    Checking c v2\n"), "error: b");
    }
}
