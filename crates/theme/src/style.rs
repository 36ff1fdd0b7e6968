//! The tokens as an egui style, and the fonts.

use std::sync::Arc;

use egui::{
    Context, CornerRadius, FontData, FontDefinitions, FontFamily, FontId, Margin, RichText, Shadow, Stroke,
    Style, TextStyle, Theme, Vec2, Visuals,
    style::{ScrollAnimation, ScrollStyle},
};

use crate::{Tokens, size, space};

/// Makes `context` look like the theme of `tokens`, with text scaled by `text_scale`; nothing moves by itself if
/// `reduces_motion`.
pub fn apply(context: &Context, tokens: &Tokens, text_scale: f32, reduces_motion: bool) {
    let (wanted, visuals) =
        if tokens.is_dark { (Theme::Dark, Visuals::dark()) } else { (Theme::Light, Visuals::light()) };
    let mut style = Style { visuals, ..Style::default() };
    set_type(&mut style);
    set_spacing(&mut style);
    set_visuals(&mut style.visuals, tokens);
    if reduces_motion {
        style.animation_time = 0.0;
        style.scroll_animation = ScrollAnimation::none();
        style.visuals.text_cursor.blink = false;
    }
    context.set_theme(wanted);
    context.set_style_of(wanted, style);
    context.set_zoom_factor(text_scale);
    context.options_mut(|options| options.zoom_with_keyboard = false);
}

/// Gives `context` the app's fonts.
pub fn install_fonts(context: &Context) {
    let mut fonts = FontDefinitions::default();
    for (name, bytes) in
        [("Inter", INTER), ("Inter SemiBold", INTER_STRONG), ("JetBrains Mono", JETBRAINS_MONO)]
    {
        fonts.font_data.insert(name.to_owned(), Arc::new(FontData::from_static(bytes)));
    }
    // What none of them has is drawn as a box: egui's own fonts would be a quarter of the page's download.
    let fallback = fonts.families.get(&FontFamily::Proportional).cloned().unwrap_or_default();
    let family = |first: [&str; 2]| -> Vec<String> {
        first.into_iter().map(str::to_owned).chain(fallback.iter().cloned()).collect()
    };
    fonts.families.insert(FontFamily::Proportional, family(["Inter", "JetBrains Mono"]));
    fonts.families.insert(FontFamily::Monospace, family(["JetBrains Mono", "Inter"]));
    fonts.families.insert(FontFamily::Name(STRONG.into()), family(["Inter SemiBold", "JetBrains Mono"]));
    context.set_fonts(fonts);
}

/// The fonts of drawings that are saved as pictures.
#[cfg(not(target_arch = "wasm32"))]
pub const FONTS: [&[u8]; 3] = [INTER, INTER_STRONG, JETBRAINS_MONO];

/// Text that carries weight: titles and verdicts.
pub fn strong(text: impl Into<String>) -> RichText {
    RichText::new(text).family(strong_family())
}

/// The font family of titles and verdicts.
pub fn strong_family() -> FontFamily {
    FontFamily::Name(STRONG.into())
}

/// The family of titles.
const STRONG: &str = "strong";

const INTER: &[u8] = include_bytes!("../fonts/Inter-Regular.otf");
const INTER_STRONG: &[u8] = include_bytes!("../fonts/Inter-SemiBold.otf");
const JETBRAINS_MONO: &[u8] = include_bytes!("../fonts/JetBrainsMono-Regular.ttf");

fn set_type(style: &mut Style) {
    style.text_styles = [
        (TextStyle::Small, FontId::new(size::SMALL, FontFamily::Proportional)),
        (TextStyle::Body, FontId::new(size::BODY, FontFamily::Proportional)),
        (TextStyle::Button, FontId::new(size::BODY, FontFamily::Proportional)),
        (TextStyle::Heading, FontId::new(size::TITLE, FontFamily::Name(STRONG.into()))),
        (TextStyle::Monospace, FontId::new(size::CODE, FontFamily::Monospace)),
    ]
    .into();
}

fn set_spacing(style: &mut Style) {
    let spacing = &mut style.spacing;
    spacing.item_spacing = Vec2::new(space::M, space::S);
    spacing.button_padding = Vec2::new(space::M, 3.0);
    spacing.interact_size = Vec2::new(28.0, space::ROW);
    spacing.window_margin = Margin::same(12);
    spacing.menu_margin = Margin::same(6);
    spacing.indent = 14.0;
    spacing.scroll = ScrollStyle { bar_width: 8.0, floating_width: 4.0, ..ScrollStyle::floating() };
    style.animation_time = 0.08;
    style.interaction.tooltip_delay = 0.35;
}

fn set_visuals(visuals: &mut Visuals, tokens: &Tokens) {
    visuals.dark_mode = tokens.is_dark;
    visuals.override_text_color = None;
    visuals.weak_text_color = Some(tokens.text_muted);
    visuals.hyperlink_color = tokens.accent;
    visuals.faint_bg_color = tokens.raised;
    visuals.extreme_bg_color = tokens.sunken;
    visuals.text_edit_bg_color = Some(tokens.sunken);
    visuals.code_bg_color = tokens.raised;
    visuals.warn_fg_color = tokens.warning;
    visuals.error_fg_color = tokens.error;
    visuals.panel_fill = tokens.surface;
    visuals.window_fill = tokens.raised;
    visuals.window_stroke = Stroke::new(1.0, tokens.line_strong);
    visuals.window_corner_radius = CornerRadius::same(8);
    visuals.menu_corner_radius = CornerRadius::same(6);
    let shadow = Shadow { offset: [0, 6], blur: 18, spread: 0, color: tokens.shadow };
    visuals.window_shadow = shadow;
    visuals.popup_shadow = shadow;
    visuals.selection.bg_fill = tokens.accent_soft;
    visuals.selection.stroke = Stroke::new(1.0, tokens.accent);
    visuals.striped = false;
    visuals.indent_has_left_vline = false;
    visuals.text_cursor.stroke = Stroke::new(1.5, tokens.accent);

    let radius = CornerRadius::same(4);
    let widgets = &mut visuals.widgets;
    let states = [
        (&mut widgets.noninteractive, tokens.surface, tokens.line, tokens.text),
        (&mut widgets.inactive, tokens.raised, tokens.line, tokens.text),
        (&mut widgets.hovered, tokens.hover, tokens.line_strong, tokens.text),
        (&mut widgets.active, tokens.pressed, tokens.accent, tokens.text),
        (&mut widgets.open, tokens.hover, tokens.line_strong, tokens.text),
    ];
    for (widget, fill, line, text) in states {
        widget.bg_fill = fill;
        widget.weak_bg_fill = fill;
        widget.bg_stroke = Stroke::new(1.0, line);
        widget.fg_stroke = Stroke::new(1.0, text);
        widget.corner_radius = radius;
        widget.expansion = 0.0;
    }
    // Checkboxes and slider rails need contrast in menus and dialogs, too.
    widgets.inactive.bg_fill = tokens.sunken;
    visuals.slider_trailing_fill = true;
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nothing_moves_by_itself_where_the_user_wants_that() {
        let context = Context::default();
        let looks = |reduces_motion| {
            apply(&context, &crate::DARK, 1.0, reduces_motion);
            let style = context.style_of(Theme::Dark);
            (style.animation_time, style.visuals.text_cursor.blink, style.scroll_animation)
        };
        assert_eq!(looks(true), (0.0, false, ScrollAnimation::none()));
        let (seconds, blinks, scrolls) = looks(false);
        assert!(seconds > 0.0 && blinks && scrolls != ScrollAnimation::none());
    }
}
