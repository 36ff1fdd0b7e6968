//! One file per command: its flags and what it does with the core's answer.
