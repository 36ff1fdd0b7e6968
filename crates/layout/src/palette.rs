//! Colours for the inks of a drawing, for pictures that are not painted by the page.
//!
//! They are those of the page's themes, after Okabe and Ito; the page may bring its own.
#![expect(clippy::unreadable_literal, reason = "colours are read as six digits")]

use crate::look::Ink;

/// A colour as red, green and blue.
pub type Rgb = [u8; 3];

/// A colour for every ink.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Palette {
    /// Whether it is light on dark.
    pub is_dark: bool,
    /// What is drawn upon.
    pub surface: Rgb,
    /// What is sunk into it.
    pub sunken: Rgb,
    /// What is raised from it.
    pub raised: Rgb,
    /// Quiet lines.
    pub line: Rgb,
    /// Outlines that must be seen.
    pub line_strong: Rgb,
    /// Text.
    pub text: Rgb,
    /// Text that matters less.
    pub text_muted: Rgb,
    /// Text that hardly matters.
    pub text_faint: Rgb,
    /// What the plan selects.
    pub path: Rgb,
    /// What it does not.
    pub path_unselected: Rgb,
    /// The inside of nodes.
    pub node_fill: Rgb,
    /// Decisions.
    pub decision: Rgb,
    /// Asserted conditions.
    pub tell: Rgb,
    /// Required conditions.
    pub ask: Rgb,
    /// Causal links.
    pub link: Rgb,
    /// Added orderings.
    pub ordering: Rgb,
    /// Threats and negative cycles.
    pub threat: Rgb,
    /// Time windows.
    pub slack: Rgb,
    /// The present.
    pub now: Rgb,
    /// Swim lanes.
    pub lane: Rgb,
}

impl Palette {
    /// Dark on light.
    pub const LIGHT: Self = Self {
        is_dark: false,
        surface: rgb(0xFBFCFD),
        sunken: rgb(0xF3F5F8),
        raised: rgb(0xF1F4F7),
        line: rgb(0xD9DFE6),
        line_strong: rgb(0xA9B5C2),
        text: rgb(0x161D26),
        text_muted: rgb(0x4E5B6A),
        text_faint: rgb(0x6A7684),
        path: rgb(0x161D26),
        path_unselected: rgb(0xA3AEBA),
        node_fill: rgb(0xFFFFFF),
        decision: rgb(0x0072B2),
        tell: rgb(0x007555),
        ask: rgb(0x9C3F77),
        link: rgb(0x007555),
        ordering: rgb(0x9A6200),
        threat: rgb(0xB84300),
        slack: rgb(0x0068A8),
        now: rgb(0xB84300),
        lane: rgb(0xE4EAF0),
    };

    /// Light on dark.
    pub const DARK: Self = Self {
        is_dark: true,
        surface: rgb(0x13171D),
        sunken: rgb(0x0E1116),
        raised: rgb(0x1A2028),
        line: rgb(0x242C36),
        line_strong: rgb(0x3C4857),
        text: rgb(0xDDE4EC),
        text_muted: rgb(0x9AA7B6),
        text_faint: rgb(0x758291),
        path: rgb(0xE8EEF5),
        path_unselected: rgb(0x566270),
        node_fill: rgb(0x1A2028),
        decision: rgb(0x6FBFEE),
        tell: rgb(0x35C49A),
        ask: rgb(0xE09BC4),
        link: rgb(0x35C49A),
        ordering: rgb(0xF0B032),
        threat: rgb(0xFF8552),
        slack: rgb(0x56B4E9),
        now: rgb(0xF0E442),
        lane: rgb(0x222A34),
    };

    /// The colour of an ink.
    pub const fn color(&self, ink: Ink) -> Rgb {
        match ink {
            Ink::Surface => self.surface,
            Ink::Sunken => self.sunken,
            Ink::Raised => self.raised,
            Ink::Line => self.line,
            Ink::LineStrong => self.line_strong,
            Ink::Text => self.text,
            Ink::TextMuted => self.text_muted,
            Ink::TextFaint => self.text_faint,
            Ink::Path => self.path,
            Ink::PathUnselected => self.path_unselected,
            Ink::NodeFill => self.node_fill,
            Ink::Decision => self.decision,
            Ink::Tell => self.tell,
            Ink::Ask => self.ask,
            Ink::Link => self.link,
            Ink::Ordering => self.ordering,
            Ink::Threat => self.threat,
            Ink::Slack => self.slack,
            Ink::Now => self.now,
            Ink::Lane => self.lane,
        }
    }
}

const fn rgb(hex: u32) -> Rgb {
    [(hex >> 16) as u8, (hex >> 8) as u8, hex as u8]
}
