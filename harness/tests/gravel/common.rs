//! Running the program, and small problems, cases and plans for it.

use serde_json::{Value, json};
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use tempfile::TempDir;

/// The folder with cases/ and harness/plans/. Tests read it and write nothing into it.
pub(crate) fn checkout() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).parent().unwrap().to_owned()
}

/// What a run of the program left.
pub(crate) struct Ran {
    code: Option<i32>,
    pub(crate) stdout: String,
    pub(crate) stderr: String,
}

/// Runs `gravel` in the checkout.
pub(crate) fn gravel(args: &[&str]) -> Ran {
    Ran::of(&mut command(args))
}

pub(crate) fn command(args: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_gravel"));
    // Whoever asks for backtraces of panics, as a build server does, must not get one with an error.
    command.args(args).current_dir(checkout()).env("RUST_BACKTRACE", "1").stdin(Stdio::null());
    command.env_remove("GRAVEL_ROOT");
    command
}

impl Ran {
    pub(crate) fn of(command: &mut Command) -> Self {
        let output = command.output().unwrap();
        Self {
            code: output.status.code(),
            stdout: String::from_utf8(output.stdout).unwrap(),
            stderr: String::from_utf8(output.stderr).unwrap(),
        }
    }

    /// The run ended well.
    #[track_caller]
    pub(crate) fn succeeded(self) -> Self {
        assert_eq!(self.code, Some(0), "{}{}", self.stdout, self.stderr);
        self
    }

    /// The run did what was asked, and found something wrong: exit code 1.
    #[track_caller]
    pub(crate) fn failed(self) -> Self {
        assert_eq!((self.code, &*self.stderr), (Some(1), ""), "{}", self.stdout);
        self
    }

    /// The run ended with this exit code.
    #[track_caller]
    pub(crate) fn ended(self, code: i32) -> Self {
        assert_eq!(self.code, Some(code), "{}{}", self.stdout, self.stderr);
        self
    }

    /// The run printed one JSON value, which is returned, and its exit code is that of the status in it, and of the time steps that
    /// missed the tolerance.
    #[track_caller]
    pub(crate) fn json(self) -> Value {
        let value: Value = serde_json::from_str(&self.stdout).unwrap_or_else(|_| panic!("{}", self.stderr));
        let some = |count: &str| value[count].as_u64().is_some_and(|count| count > 0);
        self.ended(match value["status"].as_str() {
            Some("completed") if some("infeasible_time_steps") => 4,
            Some("completed") if some("missed_time_steps") => 3,
            None | Some("converged" | "completed") => 0,
            Some("infeasible" | "no-solution") => 4,
            Some("interrupted") => 130,
            Some(_) => 3,
        });
        value
    }

    /// The run was refused: nothing on standard output, and an error of one paragraph with all of `words` in it.
    #[track_caller]
    pub(crate) fn refused(self, words: &[&str]) {
        let Self { code, stdout, stderr } = self;
        assert!(code.is_some_and(|code| code != 0), "exit code {code:?}\n{stdout}{stderr}");
        assert!(!stderr.contains("panicked"), "{stderr}");
        assert_eq!(stdout, "", "{stderr}");
        let (error, rest) = stderr.split_once("\n\n").unwrap_or((&stderr, ""));
        // The reader of arguments adds how to use them.
        assert!(rest.is_empty() || rest.ends_with("For more information, try '--help'.\n"), "{stderr}");
        assert!(error.starts_with("error: "), "{stderr}");
        for word in words {
            assert!(error.contains(word), "no `{word}` in: {error}");
        }
    }
}

/// The path as an argument.
pub(crate) fn text(path: &Path) -> &str {
    path.to_str().unwrap()
}

pub(crate) fn write(folder: &TempDir, name: &str, content: &str) -> PathBuf {
    let path = folder.path().join(name);
    fs::write(&path, content).unwrap();
    path
}

/// Lines of a journal without their checksums, as they were written once: what a test changes in them is then read.
pub(crate) fn without_checksums(lines: &str) -> String {
    let line = |line: &str| line.rsplit_once(",\"crc32\":").unwrap().0.to_owned() + "}\n";
    lines.lines().map(line).collect()
}

/// Names of all entries of a folder, in order.
pub(crate) fn entries(folder: &Path) -> Vec<String> {
    let mut names: Vec<String> = fs::read_dir(folder)
        .unwrap()
        .map(|entry| entry.unwrap().file_name().into_string().unwrap())
        .collect();
    names.sort();
    names
}

/// Names of the files of a folder of the checkout with this ending, without it.
pub(crate) fn names(folder: &str, ending: &str) -> Vec<String> {
    let files = entries(&checkout().join(folder));
    let names: Vec<String> =
        files.iter().filter_map(|file| file.strip_suffix(ending)).map(str::to_owned).collect();
    assert!(!names.is_empty(), "no *{ending} in {folder}");
    names
}

/// Names of the frozen problems of the checkout. Beside some of them lies a solution.
pub(crate) fn frozen_names() -> Vec<String> {
    let mut names = names("cases/frozen", ".json");
    names.retain(|name| !name.ends_with(".solution"));
    names
}

/// The frozen problem of two discs of 1 kg and 2 kg on each other, the first on the floor: its contacts carry
/// 0.15 N·s and 0.1 N·s.
pub(crate) fn pair() -> Value {
    json!({
        "format": "gravel/contact-problem/1",
        "name": "pair",
        "source": "made for a test",
        "time_step": 0.005,
        "grains": {
            "mass": [1.0, 2.0],
            "radius": [0.5, 0.5],
            "position": [[0.0, 0.5], [0.0, 1.5]],
            "free_velocity": [[0.0, -0.05], [0.0, -0.05]]
        },
        "contacts": {
            "candidate": [0, 1],
            "antagonist": [null, 0],
            "normal": [[0.0, 1.0], [0.0, 1.0]],
            "offset": [0.0, 0.0],
            "gap": [0.0, 0.0]
        }
    })
}

/// The pair with one value changed, at a path such as `/grains/mass`.
pub(crate) fn pair_with(pointer: &str, value: Value) -> Value {
    let mut pair = pair();
    let (folder, key) = pointer.rsplit_once('/').unwrap();
    pair.pointer_mut(folder).unwrap().as_object_mut().unwrap().insert(key.to_owned(), value);
    pair
}

/// Names and default settings of all methods of ours, as the program lists them.
pub(crate) fn methods() -> Vec<(String, Value)> {
    let mut methods = all_methods();
    let others = listed_codes(&["list", "methods"]);
    methods.retain(|(name, _)| others.iter().all(|(other, _)| other != name));
    methods
}

/// Names of the other codes that the program lists, and whether each is installed.
pub(crate) fn other_codes() -> Vec<(String, bool)> {
    listed_codes(&["list", "methods", "--installed"])
}

/// Names of the other codes that this command lists, and whether each is said to be installed.
fn listed_codes(command: &[&str]) -> Vec<(String, bool)> {
    let listed = gravel(command).succeeded().stdout;
    let lines: Vec<&str> = listed.lines().collect();
    let code = |pair: &[&str]| {
        let said = pair[1].trim_start().strip_prefix("another code, ")?;
        Some((pair[0].split_whitespace().next()?.to_owned(), said.starts_with("installed:")))
    };
    lines.windows(2).filter_map(code).collect()
}

/// Names and default settings of ours and of other codes.
pub(crate) fn all_methods() -> Vec<(String, Value)> {
    let listed = gravel(&["list", "methods"]).succeeded().stdout;
    let mut methods: Vec<(String, Value)> = Vec::new();
    for line in listed.lines() {
        if let Some(setting) = line.strip_prefix("  ").filter(|setting| !setting.starts_with(' ')) {
            let (key, rest) = setting.split_once(" = ").unwrap();
            let default = rest.split_once(": ").unwrap().0;
            let default =
                if default == "none" { Value::Null } else { serde_json::from_str(default).unwrap() };
            methods.last_mut().unwrap().1[key] = default;
        } else if !line.starts_with(' ') {
            methods.push((line.split_whitespace().next().unwrap().to_owned(), json!({})));
        }
    }
    methods
}

/// The impulses that `gravel solve` with `args` writes (N·s).
#[track_caller]
pub(crate) fn impulses(args: &[&str]) -> Vec<f64> {
    let folder = TempDir::new().unwrap();
    let file = folder.path().join("r.json");
    gravel(&[&["solve"], args, &["--impulses", text(&file)]].concat()).succeeded();
    let written: Value = serde_json::from_str(&fs::read_to_string(file).unwrap()).unwrap();
    assert_eq!(written.as_object().unwrap().len(), 1, "`impulse` and nothing else");
    written["impulse"].as_array().unwrap().iter().map(|r| r.as_f64().unwrap()).collect()
}
