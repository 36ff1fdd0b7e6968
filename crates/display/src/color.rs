//! Colors by their meaning, and what they are in the two themes, after Okabe and Ito.
#![expect(clippy::unreadable_literal, reason = "a color has six hexadecimal digits")]

/// A color as red, green and blue.
pub type Rgb = [u8; 3];

/// A color by its meaning; themes bring the colors.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum ColorRole {
    /// What is drawn upon.
    Surface,
    /// What is sunk into it: lanes.
    Sunken,
    /// What is raised from it: boxes.
    Raised,
    /// Bands beside each other, and what is under the pointer.
    Hover,
    Line,
    /// Outlines that must be seen.
    LineStrong,
    Text,
    /// Text that matters less.
    TextMuted,
    /// Text that hardly matters.
    TextFaint,
    /// What is selected, taken or active; time windows of events.
    Accent,
    /// A muted fill in the accent's hue.
    AccentSoft,
    /// Behind what is selected.
    Selection,
    /// A muted fill for what holds.
    GoodSoft,
    Warning,
    Error,
    /// What the plan selects.
    Path,
    /// What it does not.
    PathUnselected,
    /// The inside of nodes.
    NodeFill,
    Decision,
    /// Asserted conditions.
    Tell,
    /// Required conditions.
    Ask,
    Link,
    /// Added orderings.
    Ordering,
    /// Threats and negative cycles.
    Threat,
    /// What the environment chooses.
    Nature,
    /// The flexible part of a window.
    Slack,
    /// The present time.
    Now,
    /// A category such as a vehicle, starting over after the eighth; always with another sign beside the color.
    Series(u8),
    /// Ground in the light, from 0 for the darkest to 255.
    Relief(u8),
}

/// A color as it is used: by its role, and how much of it there is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Color {
    pub role: ColorRole,
    /// How much of it, from 0 to 1.
    pub strength: f32,
    /// What the rest is.
    pub ground: Ground,
}

/// What is left where a color is weak.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Ground {
    /// Whatever lies below shines through.
    Below,
    /// The surface is mixed in; nothing shines through.
    Surface,
}

impl ColorRole {
    /// The color, as much of it as `strength` says, with what lies below shining through.
    pub const fn faint(self, strength: f32) -> Color {
        Color { role: self, strength, ground: Ground::Below }
    }

    /// The color mixed into the surface: `part` 0 is the surface, 1 the color.
    pub const fn mixed(self, part: f32) -> Color {
        Color { role: self, strength: part, ground: Ground::Surface }
    }
}

impl From<ColorRole> for Color {
    fn from(role: ColorRole) -> Self {
        role.faint(1.0)
    }
}

/// Which colors the roles have.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Theme {
    /// Dark on light.
    Light,
    /// Light on dark.
    Dark,
}

impl Theme {
    /// The color of a role.
    pub const fn rgb(self, role: ColorRole) -> Rgb {
        let (light, dark) = match role {
            ColorRole::Surface => (0xFBFCFD, 0x13171D),
            ColorRole::Sunken => (0xF3F5F8, 0x0E1116),
            ColorRole::Raised => (0xF1F4F7, 0x1A2028),
            ColorRole::Hover => (0xE4EAF0, 0x222A34),
            ColorRole::Line => (0xD9DFE6, 0x242C36),
            ColorRole::LineStrong => (0xA9B5C2, 0x3C4857),
            ColorRole::Text => (0x161D26, 0xDDE4EC),
            ColorRole::TextMuted => (0x4E5B6A, 0x9AA7B6),
            ColorRole::TextFaint => (0x5A6674, 0x828F9E),
            ColorRole::Accent => (0x0068A8, 0x56B4E9),
            ColorRole::AccentSoft => (0xDBEBF7, 0x173040),
            ColorRole::Selection => (0xBFDDF2, 0x1E445C),
            ColorRole::GoodSoft => (0xDDF1EA, 0x122F29),
            ColorRole::Warning => (0x8F5A00, 0xF0B032),
            ColorRole::Error | ColorRole::Threat => (0xB84300, 0xFF8552),
            ColorRole::Path => (0x161D26, 0xE8EEF5),
            ColorRole::PathUnselected => (0xA3AEBA, 0x566270),
            ColorRole::NodeFill => (0xFFFFFF, 0x1A2028),
            ColorRole::Decision => (0x0072B2, 0x6FBFEE),
            ColorRole::Tell | ColorRole::Link => (0x007555, 0x35C49A),
            ColorRole::Ask => (0x9C3F77, 0xE09BC4),
            ColorRole::Ordering => (0x8A5700, 0xF0B032),
            ColorRole::Nature => (0x5B3FA8, 0xB49CFF),
            ColorRole::Slack => (0x1B6EA8, 0x56B4E9),
            ColorRole::Now => (0xB84300, 0xF0E442),
            ColorRole::Series(number) => SERIES[number as usize % SERIES.len()],
            ColorRole::Relief(shade) => {
                let dark = shade / 3;
                return match self {
                    Self::Light => [shade, shade, shade.saturating_sub(6)],
                    Self::Dark => [dark, dark, dark.saturating_add(4)],
                };
            }
        };
        let hex: u32 = match self {
            Self::Light => light,
            Self::Dark => dark,
        };
        [(hex >> 16) as u8, (hex >> 8) as u8, hex as u8]
    }

    /// The opaque part of a color as it is used; what is not there of it is up to [`Color::strength`] where what lies
    /// below shines through.
    pub fn resolved(self, color: Color) -> Rgb {
        let full = self.rgb(color.role);
        if color.ground == Ground::Below || color.strength >= 1.0 {
            return full;
        }
        let surface = self.rgb(ColorRole::Surface);
        std::array::from_fn(|at| {
            let (from, to) = (f32::from(surface[at]), f32::from(full[at]));
            (from + (to - from) * color.strength).round() as u8
        })
    }
}

/// The colors of categories, light and dark.
const SERIES: [(u32, u32); 8] = [
    (0x0072B2, 0x56B4E9),
    (0x9A6200, 0xE69F00),
    (0x00805C, 0x2FBF94),
    (0xA84E83, 0xDE93BE),
    (0x6E6900, 0xF0E442),
    (0x2B6FC2, 0x4C82E8),
    (0xB84300, 0xF27F3D),
    (0x4E5B6A, 0xA9B4C2),
];

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_mixed_color_lies_between_the_surface_and_the_color() {
        for theme in [Theme::Light, Theme::Dark] {
            let [surface, full] = [ColorRole::Surface, ColorRole::Threat].map(|role| theme.rgb(role));
            assert_eq!(theme.resolved(ColorRole::Threat.mixed(0.0)), surface);
            assert_eq!(theme.resolved(ColorRole::Threat.mixed(1.0)), full);
            assert_eq!(theme.resolved(ColorRole::Threat.faint(0.1)), full);
            let half = theme.resolved(ColorRole::Threat.mixed(0.5));
            let is_between =
                |at: usize| (surface[at].min(full[at])..=surface[at].max(full[at])).contains(&half[at]);
            assert!((0..3).all(is_between));
        }
    }
}
