//! A display in memory for browsers that draw nothing without one, and hands that press its real keys.

use std::{
    env,
    io::{BufRead as _, BufReader, Write as _},
    process::{Child, ChildStdin, Command, Stdio},
};

use anyhow::{Context as _, Result};

use crate::process::find_program;

/// A display; one that was started ends when it is dropped.
pub struct Display {
    server: Option<Child>,
    name: String,
}

impl Display {
    /// The display that there is, or else one in memory, where there is a program for that.
    pub(super) fn open() -> Result<Option<Self>> {
        if let Ok(name) = env::var("DISPLAY") {
            return Ok(Some(Self { server: None, name }));
        }
        let Some(program) = find_program(&["Xvfb"]) else { return Ok(None) };
        let mut server = Command::new(program)
            .args(["-displayfd", "1", "-screen", "0", "1400x1000x24", "-nolisten", "tcp"])
            .stdin(Stdio::null())
            .stdout(Stdio::piped())
            .stderr(Stdio::null())
            .spawn()
            .context("Xvfb could not be started")?;
        let output = server.stdout.take();
        let mut display = Self { server: Some(server), name: String::new() };
        let mut number = String::new();
        BufReader::new(output.context("Xvfb has no output")?).read_line(&mut number)?;
        display.name = format!(":{}", number.trim());
        Ok(Some(display))
    }

    /// Returns whether there is one, or a program that makes one.
    pub(super) fn is_there() -> bool {
        env::var_os("DISPLAY").is_some() || find_program(&["Xvfb"]).is_some()
    }

    /// Returns what programs that draw on it are told.
    pub(super) fn name(&self) -> &str {
        &self.name
    }

    /// Hands for its keyboard and mouse, if `xdotool` is installed.
    pub(super) fn hands(&self) -> Result<Option<Hands>> {
        let Some(program) = find_program(&["xdotool"]) else { return Ok(None) };
        let mut xdotool = Command::new(program)
            .arg("-")
            .env("DISPLAY", &self.name)
            .stdin(Stdio::piped())
            .stdout(Stdio::null())
            .stderr(Stdio::null())
            .spawn()
            .context("xdotool could not be started")?;
        let commands = xdotool.stdin.take().context("xdotool takes no commands")?;
        Ok(Some(Hands { xdotool, commands }))
    }
}

impl Drop for Display {
    fn drop(&mut self) {
        if let Some(server) = &mut self.server {
            let _ = server.kill();
            let _ = server.wait();
        }
    }
}

/// `xdotool`, which does to a display what it is told.
pub struct Hands {
    xdotool: Child,
    commands: ChildStdin,
}

impl Hands {
    /// Does what a command of `xdotool` says, such as `key a` or `click 5`. Nobody hears when it is done.
    pub fn act(&mut self, command: &str) -> Result<()> {
        writeln!(self.commands, "{command}")?;
        Ok(self.commands.flush()?)
    }
}

impl Drop for Hands {
    fn drop(&mut self) {
        let _ = self.xdotool.kill();
        let _ = self.xdotool.wait();
    }
}
