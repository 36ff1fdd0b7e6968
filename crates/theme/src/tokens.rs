//! The colors, each named for what it means, in both themes.
//!
//! Categories use the palette of Okabe and Ito, which stays apart for the common kinds of color blindness; shades are
//! adapted to each background so that text keeps a contrast of 4.5 : 1.
#![expect(clippy::disallowed_methods, reason = "this is the one place where colors are made")]
#![expect(clippy::mistyped_literal_suffixes, reason = "the digits stand in pairs: red, green, blue")]

use display::{ColorRole, Theme};
use egui::Color32;

/// The colors of one theme.
#[derive(Clone, Debug, PartialEq)]
pub struct Tokens {
    /// Whether the theme is light on dark.
    pub is_dark: bool,

    /// Behind everything: bars and gaps.
    pub background: Color32,
    pub surface: Color32,
    /// What lies on a panel: headers, cards, popups.
    pub raised: Color32,
    /// What is sunk into a panel: text fields, tracks.
    pub sunken: Color32,
    /// Under the pointer.
    pub hover: Color32,
    /// Pressed or switched on.
    pub pressed: Color32,
    /// Lines between things.
    pub line: Color32,
    /// Outlines that must be seen.
    pub line_strong: Color32,
    /// The shadow under popups.
    pub shadow: Color32,

    pub text: Color32,
    /// Text that matters less: captions, units.
    pub text_muted: Color32,
    /// Text that hardly matters: line numbers, placeholders.
    pub text_faint: Color32,
    /// Text on a filled accent.
    pub text_on_accent: Color32,

    /// What can be pressed, is active or has the focus.
    pub accent: Color32,
    /// A muted fill in the accent's hue.
    pub accent_soft: Color32,
    /// Behind selected text and selected rows.
    pub selection: Color32,

    /// Verified, done, feasible.
    pub good: Color32,
    pub warning: Color32,
    /// Wrong, infeasible, violated.
    pub error: Color32,
    /// Worth knowing.
    pub info: Color32,
    /// Soft fills behind the four, in the order good, warning, error, info.
    pub soft: [Color32; 4],

    /// Nodes and arcs of the network that the plan selects.
    pub path: Color32,
    /// Nodes and arcs that it does not.
    pub path_unselected: Color32,
    /// The inside of nodes.
    pub node_fill: Color32,
    /// Decisions and their alternatives.
    pub decision: Color32,
    /// Asserted conditions.
    pub tell: Color32,
    /// Required conditions.
    pub ask: Color32,
    pub link: Color32,
    /// Orderings that resolve threats.
    pub ordering: Color32,
    /// What the environment chooses.
    pub nature: Color32,
    /// Threats and negative cycles.
    pub threat: Color32,
    /// The flexible part of a window.
    pub slack: Color32,
    /// The present moment.
    pub now: Color32,
    /// Solutions in search trees.
    pub solution: Color32,
    /// Failures in search trees.
    pub failure: Color32,

    /// Categories such as vehicles and threads, in order; always with another sign beside the color.
    pub series: [Color32; 8],
    pub syntax: Syntax,
}

/// The colors of source text.
#[derive(Clone, Debug, PartialEq)]
pub struct Syntax {
    pub keyword: Color32,
    /// Activities and primitives.
    pub activity: Color32,
    /// State variables.
    pub variable: Color32,
    /// Values of state variables.
    pub value: Color32,
    /// Formal and bound parameters.
    pub parameter: Color32,
    /// Locations, obstacles, vehicles.
    pub place: Color32,
    /// Numbers and infinity.
    pub number: Color32,
    /// Texts in quotes.
    pub string: Color32,
    pub comment: Color32,
    /// Brackets, separators, operators.
    pub punctuation: Color32,
}

impl Tokens {
    /// Light lines and posts on the ground of a map, which looks the same in both themes.
    pub const ON_GROUND: Color32 = rgb(0xF7_F3_EC);
    /// What sets light lines off from light ground.
    pub const UNDER_LINES: Color32 = rgb(0x1C_14_10);
    /// Ground that an obstacle covers.
    pub const OBSTACLE: Color32 = rgb(0x16_12_14);
    /// Ground where a vehicle has no room, on clearance maps.
    pub const NO_ROOM: Color32 = rgb(0x12_0A_10);

    /// The color of a category, starting over after the last.
    pub fn series(&self, index: usize) -> Color32 {
        self.series[index % self.series.len()]
    }

    /// The color of `part`, from 0 to 1, on the ramp for heights and slopes: even to the eye, and apart for the
    /// color-blind. The terrain's shader uses the same one.
    pub fn ramp(part: f32) -> Color32 {
        const STOPS: [Color32; 4] = [rgb(0x21_30_6B), rgb(0x2B_75_8C), rgb(0x9E_B0_78), rgb(0xFC_E8_99)];
        let scaled = part.clamp(0.0, 1.0) * 3.0;
        let index = (scaled as usize).min(2);
        STOPS[index].lerp_to_gamma(STOPS[index + 1], scaled - index as f32)
    }

    /// The color of a role in a display list.
    pub fn role(&self, role: ColorRole) -> Color32 {
        match role {
            ColorRole::Surface => self.surface,
            ColorRole::Sunken => self.sunken,
            ColorRole::Raised => self.raised,
            ColorRole::Hover => self.hover,
            ColorRole::Line => self.line,
            ColorRole::LineStrong => self.line_strong,
            ColorRole::Text => self.text,
            ColorRole::TextMuted => self.text_muted,
            ColorRole::TextFaint => self.text_faint,
            ColorRole::Accent => self.accent,
            ColorRole::AccentSoft => self.accent_soft,
            ColorRole::Selection => self.selection,
            ColorRole::GoodSoft => self.soft[0],
            ColorRole::Warning => self.warning,
            ColorRole::Error => self.error,
            ColorRole::Path => self.path,
            ColorRole::PathUnselected => self.path_unselected,
            ColorRole::NodeFill => self.node_fill,
            ColorRole::Decision => self.decision,
            ColorRole::Tell => self.tell,
            ColorRole::Ask => self.ask,
            ColorRole::Link => self.link,
            ColorRole::Ordering => self.ordering,
            ColorRole::Threat => self.threat,
            ColorRole::Nature => self.nature,
            ColorRole::Slack => self.slack,
            ColorRole::Now => self.now,
            ColorRole::Series(number) => self.series(usize::from(number)),
            ColorRole::Relief(_) => {
                let [red, green, blue] = self.exported().rgb(role);
                Color32::from_rgb(red, green, blue)
            }
        }
    }

    /// The theme that pictures and files in these colors have.
    pub const fn exported(&self) -> Theme {
        if self.is_dark { Theme::Dark } else { Theme::Light }
    }

    /// `color` mixed into the surface: `part` 0 is the surface, 1 the color.
    pub fn mixed(&self, color: Color32, part: f32) -> Color32 {
        self.surface.lerp_to_gamma(color, part)
    }
}

const fn rgb(hex: u32) -> Color32 {
    Color32::from_rgb((hex >> 16) as u8, (hex >> 8) as u8, hex as u8)
}

/// Light on dark.
pub static DARK: Tokens = Tokens {
    is_dark: true,
    background: rgb(0x0C_0F_13),
    surface: rgb(0x13_17_1D),
    raised: rgb(0x1A_20_28),
    sunken: rgb(0x0E_11_16),
    hover: rgb(0x22_2A_34),
    pressed: rgb(0x2B_35_41),
    line: rgb(0x24_2C_36),
    line_strong: rgb(0x3C_48_57),
    shadow: Color32::from_black_alpha(110),
    text: rgb(0xDD_E4_EC),
    text_muted: rgb(0x9A_A7_B6),
    text_faint: rgb(0x82_8F_9E),
    text_on_accent: rgb(0x06_17_22),
    accent: rgb(0x56_B4_E9),
    accent_soft: rgb(0x17_30_40),
    selection: rgb(0x1E_44_5C),
    good: rgb(0x35_C4_9A),
    warning: rgb(0xF0_B0_32),
    error: rgb(0xFF_85_52),
    info: rgb(0x6F_BF_EE),
    soft: [rgb(0x12_2F_29), rgb(0x33_2A_14), rgb(0x3A_20_17), rgb(0x17_2C_3B)],
    path: rgb(0xE8_EE_F5),
    path_unselected: rgb(0x56_62_70),
    node_fill: rgb(0x1A_20_28),
    decision: rgb(0x6F_BF_EE),
    tell: rgb(0x35_C4_9A),
    ask: rgb(0xE0_9B_C4),
    link: rgb(0x35_C4_9A),
    ordering: rgb(0xF0_B0_32),
    nature: rgb(0xB4_9C_FF),
    threat: rgb(0xFF_85_52),
    slack: rgb(0x56_B4_E9),
    now: rgb(0xF0_E4_42),
    solution: rgb(0x35_C4_9A),
    failure: rgb(0xFF_85_52),
    series: [
        rgb(0x56_B4_E9),
        rgb(0xE6_9F_00),
        rgb(0x2F_BF_94),
        rgb(0xDE_93_BE),
        rgb(0xF0_E4_42),
        rgb(0x4C_82_E8),
        rgb(0xF2_7F_3D),
        rgb(0xA9_B4_C2),
    ],
    syntax: Syntax {
        keyword: rgb(0xDE_93_BE),
        activity: rgb(0x6F_BF_EE),
        variable: rgb(0x4F_D0_AA),
        value: rgb(0xF0_C4_62),
        parameter: rgb(0xC9_D4_E0),
        place: rgb(0x9F_CB_F0),
        number: rgb(0xF4_A8_72),
        string: rgb(0xB9_D3_8C),
        comment: rgb(0x82_91_A1),
        punctuation: rgb(0x9A_A7_B6),
    },
};

/// Dark on light.
pub static LIGHT: Tokens = Tokens {
    is_dark: false,
    background: rgb(0xE6_EA_EE),
    surface: rgb(0xFB_FC_FD),
    raised: rgb(0xF1_F4_F7),
    sunken: rgb(0xF3_F5_F8),
    hover: rgb(0xE4_EA_F0),
    pressed: rgb(0xD5_DE_E7),
    line: rgb(0xD9_DF_E6),
    line_strong: rgb(0xA9_B5_C2),
    shadow: Color32::from_black_alpha(40),
    text: rgb(0x16_1D_26),
    text_muted: rgb(0x4E_5B_6A),
    text_faint: rgb(0x5A_66_74),
    text_on_accent: rgb(0xFF_FF_FF),
    accent: rgb(0x00_68_A8),
    accent_soft: rgb(0xDB_EB_F7),
    selection: rgb(0xBF_DD_F2),
    good: rgb(0x00_75_55),
    warning: rgb(0x8F_5A_00),
    error: rgb(0xB8_43_00),
    info: rgb(0x00_68_A8),
    soft: [rgb(0xDD_F1_EA), rgb(0xFB_EF_D6), rgb(0xFC_E6_DA), rgb(0xDF_ED_F8)],
    path: rgb(0x16_1D_26),
    path_unselected: rgb(0xA3_AE_BA),
    node_fill: rgb(0xFF_FF_FF),
    decision: rgb(0x00_72_B2),
    tell: rgb(0x00_75_55),
    ask: rgb(0x9C_3F_77),
    link: rgb(0x00_75_55),
    ordering: rgb(0x8A_57_00),
    nature: rgb(0x5B_3F_A8),
    threat: rgb(0xB8_43_00),
    slack: rgb(0x1B_6E_A8),
    now: rgb(0xB8_43_00),
    solution: rgb(0x00_75_55),
    failure: rgb(0xB8_43_00),
    series: [
        rgb(0x00_72_B2),
        rgb(0x9A_62_00),
        rgb(0x00_80_5C),
        rgb(0xA8_4E_83),
        rgb(0x6E_69_00),
        rgb(0x2B_6F_C2),
        rgb(0xB8_43_00),
        rgb(0x4E_5B_6A),
    ],
    syntax: Syntax {
        keyword: rgb(0x9C_3F_77),
        activity: rgb(0x00_5F_99),
        variable: rgb(0x00_6E_50),
        value: rgb(0x84_58_00),
        parameter: rgb(0x33_40_50),
        place: rgb(0x2B_5F_A8),
        number: rgb(0xA8_47_00),
        string: rgb(0x4E_6B_14),
        comment: rgb(0x58_64_72),
        punctuation: rgb(0x4E_5B_6A),
    },
};

#[cfg(test)]
mod tests {
    use super::*;

    fn luminance(color: Color32) -> f64 {
        let linear = |channel: u8| {
            let value = f64::from(channel) / 255.0;
            if value <= 0.04045 { value / 12.92 } else { ((value + 0.055) / 1.055).powf(2.4) }
        };
        0.2126 * linear(color.r()) + 0.7152 * linear(color.g()) + 0.0722 * linear(color.b())
    }

    /// The contrast of WCAG 2.2, from 1 to 21.
    fn contrast(left: Color32, right: Color32) -> f64 {
        let (left, right) = (luminance(left) + 0.05, luminance(right) + 0.05);
        left.max(right) / left.min(right)
    }

    #[test]
    fn text_keeps_its_contrast_on_every_surface_of_both_themes() {
        for tokens in [&DARK, &LIGHT] {
            let syntax = &tokens.syntax;
            let texts = [
                tokens.text,
                tokens.text_muted,
                tokens.text_faint,
                tokens.accent,
                tokens.good,
                tokens.warning,
                tokens.error,
                tokens.info,
                tokens.tell,
                tokens.ask,
                tokens.ordering,
                tokens.nature,
                tokens.threat,
                tokens.slack,
                syntax.keyword,
                syntax.activity,
                syntax.variable,
                syntax.value,
                syntax.parameter,
                syntax.place,
                syntax.number,
                syntax.string,
                syntax.comment,
                syntax.punctuation,
            ];
            for (index, text) in texts.into_iter().enumerate() {
                for ground in [tokens.surface, tokens.sunken, tokens.raised, tokens.background] {
                    let found = contrast(text, ground);
                    let what = format!("text {index} on {ground:?}, dark {}", tokens.is_dark);
                    assert!(found >= 4.5, "{what}: contrast {found:.2}");
                }
            }
            assert!(contrast(tokens.text, tokens.selection) >= 4.5);
            assert!(contrast(tokens.text_on_accent, tokens.accent) >= 4.5);
        }
    }

    #[test]
    fn files_have_the_colors_of_the_screen() {
        let roles = [
            ColorRole::Surface,
            ColorRole::Sunken,
            ColorRole::Raised,
            ColorRole::Hover,
            ColorRole::Line,
            ColorRole::LineStrong,
            ColorRole::Text,
            ColorRole::TextMuted,
            ColorRole::TextFaint,
            ColorRole::Accent,
            ColorRole::AccentSoft,
            ColorRole::Selection,
            ColorRole::GoodSoft,
            ColorRole::Warning,
            ColorRole::Error,
            ColorRole::Path,
            ColorRole::PathUnselected,
            ColorRole::NodeFill,
            ColorRole::Decision,
            ColorRole::Tell,
            ColorRole::Ask,
            ColorRole::Link,
            ColorRole::Ordering,
            ColorRole::Threat,
            ColorRole::Nature,
            ColorRole::Slack,
            ColorRole::Now,
            ColorRole::Relief(200),
        ];
        for tokens in [&DARK, &LIGHT] {
            for role in roles.into_iter().chain((0..9).map(ColorRole::Series)) {
                let [red, green, blue, _] = tokens.role(role).to_array();
                assert_eq!([red, green, blue], tokens.exported().rgb(role), "{role:?}");
            }
        }
    }

    #[test]
    fn categories_differ_in_lightness_or_are_far_apart_in_color() {
        for tokens in [&DARK, &LIGHT] {
            for (index, left) in tokens.series.iter().enumerate() {
                for right in &tokens.series[index + 1..] {
                    let distance: i32 = (0..3)
                        .map(|at| {
                            i32::from(left.to_array()[at]).abs_diff(i32::from(right.to_array()[at])) as i32
                        })
                        .sum();
                    assert!(distance > 40, "{left:?} and {right:?} are hard to tell apart");
                }
            }
        }
    }
}
