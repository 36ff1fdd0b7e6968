//! Finding and setting up the peers: a virtual environment, an npm folder, compiled C++, programs on the path.

use std::fs;
use std::io::Read as _;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

use anyhow::{Context as _, Result};

/// Why a peer is not run, in a few words.
pub(crate) type Absent = String;

/// The folder that everything lies in, and what has been set up there so far.
pub(crate) struct Tools {
    work: PathBuf,
    python: Option<Result<PathBuf, Absent>>,
    node: Option<Result<PathBuf, Absent>>,
}

impl Tools {
    /// Works in the given folder, which is made if need be.
    pub(crate) fn new(work: &Path) -> Result<Self> {
        fs::create_dir_all(work).with_context(|| format!("making {}", work.display()))?;
        Ok(Self { work: work.canonicalize()?, python: None, node: None })
    }

    /// A folder for the instances of one subject.
    pub(crate) fn folder(&self, name: &str) -> Result<PathBuf> {
        let folder = self.work.join(name);
        fs::create_dir_all(&folder).with_context(|| format!("making {}", folder.display()))?;
        Ok(folder)
    }

    /// A Python with the packages of `requirements.txt`.
    pub(crate) fn python(&mut self) -> Result<PathBuf, Absent> {
        if self.python.is_none() {
            self.python = Some(set_up_python(&self.work));
        }
        self.python.clone().unwrap_or_else(|| Err("no Python".to_owned()))
    }

    /// The folder with the scripts and the packages of `package.json`, for Node.
    pub(crate) fn node(&mut self) -> Result<PathBuf, Absent> {
        if self.node.is_none() {
            self.node = Some(set_up_node(&self.work));
        }
        self.node.clone().unwrap_or_else(|| Err("no Node".to_owned()))
    }

    /// A C++ program of this folder, compiled against OMPL.
    pub(crate) fn ompl(&self, source: &str) -> Result<PathBuf, Absent> {
        let headers =
            ["/usr/include/ompl-1.7", "/usr/include/ompl-1.6", "/usr/include/ompl-1.5", "/usr/include/ompl"];
        let headers = headers
            .into_iter()
            .find(|folder| {
                Path::new(folder).join("ompl/config.h").is_file()
                    || *folder == "/usr/include/ompl" && Path::new(folder).join("config.h").is_file()
            })
            .ok_or("not run: no OMPL (Debian: libompl-dev)")?;
        let program = self.work.join("ompl-paths");
        let built = Command::new("c++")
            .args(["-O3", "-DNDEBUG", "-std=c++17", "-I", headers, "-I", "/usr/include/eigen3", "-o"])
            .arg(&program)
            .arg(source_path(source))
            .args(["-lompl", "-lboost_serialization"])
            .output();
        match built {
            Ok(output) if output.status.success() => Ok(program),
            Ok(output) => Err(format!("not run: does not compile ({})", last_line(&output.stderr))),
            Err(_) => Err("not run: no C++ compiler".to_owned()),
        }
    }
}

/// Returns where a file of this folder lies.
pub(crate) fn source_path(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join(name)
}

fn set_up_python(work: &Path) -> Result<PathBuf, Absent> {
    let folder = work.join("python");
    let python = folder.join("bin/python");
    let wanted =
        fs::read_to_string(source_path("requirements.txt")).map_err(|error| format!("not run: {error}"))?;
    let mark = folder.join("requirements.txt");
    if fs::read_to_string(&mark).is_ok_and(|has| has == wanted) {
        return Ok(python);
    }
    quiet(Command::new("python3").args(["-m", "venv"]).arg(&folder))
        .map_err(|why| format!("not run: no Python with venv ({why})"))?;
    quiet(
        Command::new(&python)
            .args(["-m", "pip", "install", "--quiet", "--disable-pip-version-check", "-r"])
            .arg(source_path("requirements.txt")),
    )
    .map_err(|why| format!("not run: pip can't install it ({why})"))?;
    fs::write(&mark, wanted).map_err(|error| format!("not run: {error}"))?;
    Ok(python)
}

fn set_up_node(work: &Path) -> Result<PathBuf, Absent> {
    let folder = work.join("node");
    let copy = |name: &str| -> std::io::Result<bool> {
        let wanted = fs::read(source_path(name))?;
        let is_new = fs::read(folder.join(name)).is_ok_and(|has| has == wanted);
        fs::write(folder.join(name), wanted)?;
        Ok(is_new)
    };
    let copied = fs::create_dir_all(&folder)
        .and_then(|()| copy("layouts.mjs"))
        .and_then(|_| copy("automata.mjs"))
        .and_then(|_| copy("package.json"))
        .and_then(|_| copy("package-lock.json"))
        .map_err(|error| format!("not run: {error}"))?;
    if !(copied && folder.join("node_modules/xstate").is_dir()) {
        quiet(Command::new("npm").args(["ci", "--silent", "--no-audit", "--no-fund"]).current_dir(&folder))
            .map_err(|why| format!("not run: npm can't install it ({why})"))?;
    }
    quiet(Command::new("node").arg("--version")).map_err(|why| format!("not run: no Node ({why})"))?;
    Ok(folder)
}

fn quiet(command: &mut Command) -> Result<(), Absent> {
    match command.stdin(Stdio::null()).output() {
        Ok(output) if output.status.success() => Ok(()),
        Ok(output) => Err(last_line(&output.stderr)),
        Err(error) => Err(error.to_string()),
    }
}

fn last_line(bytes: &[u8]) -> String {
    let text = String::from_utf8_lossy(bytes);
    text.lines().rev().find(|line| !line.trim().is_empty()).unwrap_or("no message").trim().to_owned()
}

/// Returns what a program wrote to standard output, unless it failed or took too long.
pub(crate) fn answer(command: &mut Command, limit: Duration) -> Result<String, Absent> {
    let mut child = command
        .stdin(Stdio::null())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .map_err(|error| format!("not run: {error}"))?;
    let (mut out, mut errors) = (child.stdout.take(), child.stderr.take());
    let reader = std::thread::spawn(move || {
        let mut text = String::new();
        out.as_mut().map(|out| out.read_to_string(&mut text));
        text
    });
    let error_reader = std::thread::spawn(move || {
        let mut bytes = Vec::new();
        errors.as_mut().map(|errors| errors.read_to_end(&mut bytes));
        bytes
    });
    let begun = Instant::now();
    let status = loop {
        match child.try_wait() {
            Ok(Some(status)) => break status,
            Ok(None) if begun.elapsed() < limit => std::thread::sleep(Duration::from_millis(5)),
            Ok(None) => {
                // Nothing to do if it has just ended.
                let _ = child.kill();
                let _ = child.wait();
                return Err(format!("over {} s", limit.as_secs()));
            }
            Err(error) => return Err(format!("not run: {error}")),
        }
    };
    let text = reader.join().unwrap_or_default();
    if status.success() {
        Ok(text)
    } else {
        Err(format!("failed: {}", last_line(&error_reader.join().unwrap_or_default())))
    }
}
