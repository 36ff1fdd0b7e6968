//! Icons drawn as lines on a grid of 16, so that they need no font and follow the theme.

use egui::{Color32, Painter, Pos2, Rect, Response, Role, Sense, Shape, Stroke, Ui, Vec2, WidgetInfo};

use crate::{Tokens, space};

/// The signs on buttons and labels.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Icon {
    /// A sun: the light theme.
    Sun,
    /// A moon: the dark theme.
    Moon,
    /// A prompt: the command palette.
    Palette,
    /// A question mark: help.
    Help,
    /// A cross without a frame: close.
    Close,
    /// A cross in a circle: an error.
    Error,
    /// An exclamation mark in a triangle: a warning.
    Warning,
    /// A letter i in a circle: a note.
    Info,
    /// A tick: done, verified.
    Check,
    /// A dash in a circle: nothing.
    Nothing,
    /// Three dots: under way.
    Working,
    /// A lamp: a fix.
    Fix,
    Play,
    Pause,
    /// To the next event.
    StepForward,
    /// To the previous event.
    StepBack,
    /// To the next place at which it stops.
    Run,
    /// To the place before at which it stops.
    RunBack,
    ToStart,
    ToEnd,
    Up,
    Down,
    ChevronDown,
    /// Opens to the right.
    ChevronRight,
    Plus,
    Minus,
    /// Everything at once.
    Fit,
    /// A frame: the whole window.
    Maximize,
    /// A frame before another one: back among the others.
    Restore,
    Options,
    /// Two arrows apart: at another time.
    Moved,
    /// Two arrows past each other: decided otherwise.
    Rechosen,
    /// Not equal: done otherwise.
    Changed,
}

/// Draws `icon` in the middle of `rect`, `size` points wide.
pub fn paint(painter: &Painter, icon: Icon, rect: Rect, size: f32, color: Color32) {
    let scale = size / 16.0;
    let origin = rect.center() - Vec2::splat(size / 2.0);
    Drawing { painter, origin, scale, stroke: Stroke::new(1.4 * scale.max(0.8), color) }.icon(icon);
}

/// A flat button with an icon, named for assistive technologies and on hover.
pub fn button(ui: &mut Ui, tokens: &Tokens, icon: Icon, name: &str) -> Response {
    lit_button(ui, tokens, icon, name, false)
}

/// A flat button with an icon that is lit while what it started goes on; its name says what a click does.
pub fn lit_button(ui: &mut Ui, tokens: &Tokens, icon: Icon, name: &str, is_on: bool) -> Response {
    let (rect, response) = ui.allocate_exact_size(Vec2::splat(space::ROW), Sense::click());
    let is_enabled = ui.is_enabled();
    response.widget_info(|| WidgetInfo::labeled(Role::Button, is_enabled, name));
    let fill = match (is_on, response.is_pointer_button_down_on(), response.hovered()) {
        (_, true, _) => Some(tokens.pressed),
        (true, ..) => Some(tokens.accent_soft),
        (_, _, true) => Some(tokens.hover),
        _ => None,
    };
    if let Some(fill) = fill.filter(|_| is_enabled) {
        ui.painter().rect_filled(rect, 4.0, fill);
    }
    if response.has_focus() {
        ui.painter().rect_stroke(rect, 4.0, Stroke::new(1.0, tokens.accent), egui::StrokeKind::Inside);
    }
    let color = match (is_enabled, is_on, response.hovered()) {
        (false, ..) => tokens.text_faint,
        (_, true, _) => tokens.accent,
        (_, _, true) => tokens.text,
        _ => tokens.text_muted,
    };
    paint(ui.painter(), icon, rect, 15.0, color);
    response.on_hover_text(name)
}

/// An icon in a line of text.
pub fn label(ui: &mut Ui, icon: Icon, color: Color32) -> Response {
    let (rect, response) = ui.allocate_exact_size(Vec2::splat(15.0), Sense::hover());
    paint(ui.painter(), icon, rect, 13.0, color);
    response
}

struct Drawing<'a> {
    painter: &'a Painter,
    origin: Pos2,
    scale: f32,
    stroke: Stroke,
}

impl Drawing<'_> {
    fn at(&self, (x, y): (f32, f32)) -> Pos2 {
        self.origin + Vec2::new(x, y) * self.scale
    }

    fn line(&self, points: &[(f32, f32)]) {
        self.painter.line(points.iter().map(|&point| self.at(point)).collect(), self.stroke);
    }

    fn fill(&self, points: &[(f32, f32)]) {
        let points = points.iter().map(|&point| self.at(point)).collect();
        self.painter.add(Shape::convex_polygon(points, self.stroke.color, Stroke::NONE));
    }

    fn circle(&self, center: (f32, f32), radius: f32) {
        self.painter.circle_stroke(self.at(center), radius * self.scale, self.stroke);
    }

    fn dot(&self, center: (f32, f32), radius: f32) {
        self.painter.circle_filled(self.at(center), radius * self.scale, self.stroke.color);
    }

    fn icon(&self, icon: Icon) {
        match icon {
            Icon::Sun => self.sun(),
            Icon::Moon => self.moon(),
            Icon::Palette => {
                self.line(&[(3.0, 4.5), (6.5, 8.0), (3.0, 11.5)]);
                self.line(&[(8.5, 12.0), (13.5, 12.0)]);
            }
            Icon::Help => {
                self.line(&[
                    (5.2, 5.6),
                    (5.8, 3.9),
                    (7.4, 3.0),
                    (9.2, 3.2),
                    (10.6, 4.6),
                    (10.4, 6.4),
                    (8.2, 8.2),
                    (8.0, 10.0),
                ]);
                self.dot((8.0, 12.8), 1.0);
            }
            Icon::Close => self.cross(4.5),
            Icon::Error => {
                self.circle((8.0, 8.0), 6.2);
                self.cross(5.8);
            }
            Icon::Warning => {
                self.line(&[(8.0, 2.2), (14.2, 13.4), (1.8, 13.4), (8.0, 2.2), (8.4, 2.9)]);
                self.line(&[(8.0, 6.4), (8.0, 9.6)]);
                self.dot((8.0, 11.5), 0.9);
            }
            Icon::Info => {
                self.circle((8.0, 8.0), 6.2);
                self.line(&[(8.0, 7.4), (8.0, 11.2)]);
                self.dot((8.0, 5.0), 0.9);
            }
            Icon::Check => self.line(&[(3.0, 8.4), (6.4, 11.8), (13.0, 4.6)]),
            Icon::Nothing => {
                self.circle((8.0, 8.0), 6.2);
                self.line(&[(5.2, 8.0), (10.8, 8.0)]);
            }
            Icon::Working => {
                for x in [3.6, 8.0, 12.4] {
                    self.dot((x, 8.0), 1.3);
                }
            }
            Icon::Fix => {
                self.line(&[
                    (6.2, 11.0),
                    (6.0, 9.4),
                    (4.4, 7.6),
                    (4.2, 5.4),
                    (5.6, 3.2),
                    (8.0, 2.3),
                    (10.4, 3.2),
                    (11.8, 5.4),
                    (11.6, 7.6),
                    (10.0, 9.4),
                    (9.8, 11.0),
                    (6.2, 11.0),
                ]);
                self.line(&[(6.6, 13.6), (9.4, 13.6)]);
            }
            Icon::Play => self.fill(&[(4.6, 3.0), (13.0, 8.0), (4.6, 13.0)]),
            Icon::Pause => {
                self.fill(&[(4.0, 3.0), (6.8, 3.0), (6.8, 13.0), (4.0, 13.0)]);
                self.fill(&[(9.2, 3.0), (12.0, 3.0), (12.0, 13.0), (9.2, 13.0)]);
            }
            Icon::StepForward => {
                self.fill(&[(4.2, 4.0), (10.0, 8.0), (4.2, 12.0)]);
                self.line(&[(11.6, 4.0), (11.6, 12.0)]);
            }
            Icon::StepBack => {
                self.fill(&[(11.8, 4.0), (11.8, 12.0), (6.0, 8.0)]);
                self.line(&[(4.4, 4.0), (4.4, 12.0)]);
            }
            Icon::Run => {
                self.line(&[(3.0, 4.0), (7.0, 8.0), (3.0, 12.0)]);
                self.dot((11.4, 8.0), 2.6);
            }
            Icon::RunBack => {
                self.line(&[(13.0, 4.0), (9.0, 8.0), (13.0, 12.0)]);
                self.dot((4.6, 8.0), 2.6);
            }
            Icon::ToStart => {
                self.line(&[(3.2, 4.0), (3.2, 12.0)]);
                self.line(&[(8.2, 4.0), (4.8, 8.0), (8.2, 12.0)]);
                self.line(&[(12.6, 4.0), (9.2, 8.0), (12.6, 12.0)]);
            }
            Icon::ToEnd => {
                self.line(&[(12.8, 4.0), (12.8, 12.0)]);
                self.line(&[(3.4, 4.0), (6.8, 8.0), (3.4, 12.0)]);
                self.line(&[(7.8, 4.0), (11.2, 8.0), (7.8, 12.0)]);
            }
            Icon::Up => {
                self.line(&[(8.0, 13.0), (8.0, 3.4)]);
                self.line(&[(4.0, 7.2), (8.0, 3.2), (12.0, 7.2)]);
            }
            Icon::Down => {
                self.line(&[(8.0, 3.0), (8.0, 12.6)]);
                self.line(&[(4.0, 8.8), (8.0, 12.8), (12.0, 8.8)]);
            }
            Icon::ChevronDown => self.line(&[(4.0, 6.2), (8.0, 10.2), (12.0, 6.2)]),
            Icon::ChevronRight => self.line(&[(6.2, 4.0), (10.2, 8.0), (6.2, 12.0)]),
            Icon::Plus => {
                self.line(&[(8.0, 3.2), (8.0, 12.8)]);
                self.line(&[(3.2, 8.0), (12.8, 8.0)]);
            }
            Icon::Minus => self.line(&[(3.2, 8.0), (12.8, 8.0)]),
            Icon::Maximize => {
                self.line(&[(3.0, 3.0), (13.0, 3.0), (13.0, 13.0), (3.0, 13.0), (3.0, 3.0)]);
                self.line(&[(3.0, 5.2), (13.0, 5.2)]);
            }
            Icon::Restore => {
                self.line(&[(3.0, 6.0), (10.0, 6.0), (10.0, 13.0), (3.0, 13.0), (3.0, 6.0)]);
                self.line(&[(6.0, 6.0), (6.0, 3.0), (13.0, 3.0), (13.0, 10.0), (10.0, 10.0)]);
            }
            Icon::Fit => {
                for (x, y) in [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)] {
                    let (outer, inner) = (5.2, 2.0);
                    self.line(&[
                        (8.0 + x * inner, 8.0 + y * outer),
                        (8.0 + x * outer, 8.0 + y * outer),
                        (8.0 + x * outer, 8.0 + y * inner),
                    ]);
                }
            }
            Icon::Moved => {
                self.line(&[(2.4, 8.0), (13.6, 8.0)]);
                self.line(&[(5.4, 5.0), (2.4, 8.0), (5.4, 11.0)]);
                self.line(&[(10.6, 5.0), (13.6, 8.0), (10.6, 11.0)]);
            }
            Icon::Rechosen => {
                self.line(&[(2.6, 5.4), (12.6, 5.4)]);
                self.line(&[(10.0, 2.8), (12.8, 5.4), (10.0, 8.0)]);
                self.line(&[(13.4, 10.8), (3.4, 10.8)]);
                self.line(&[(6.0, 8.2), (3.2, 10.8), (6.0, 13.4)]);
            }
            Icon::Changed => {
                self.line(&[(3.0, 6.2), (13.0, 6.2)]);
                self.line(&[(3.0, 10.0), (13.0, 10.0)]);
                self.line(&[(10.6, 3.0), (5.4, 13.2)]);
            }
            Icon::Options => {
                for (y, x) in [(4.2, 10.0), (8.0, 5.6), (11.8, 9.0)] {
                    self.line(&[(2.6, y), (13.4, y)]);
                    self.dot((x, y), 1.7);
                }
            }
        }
    }

    fn cross(&self, inset: f32) {
        self.line(&[(inset, inset), (16.0 - inset, 16.0 - inset)]);
        self.line(&[(16.0 - inset, inset), (inset, 16.0 - inset)]);
    }

    fn sun(&self) {
        self.circle((8.0, 8.0), 3.0);
        for step in 0..8_u8 {
            let angle = f32::from(step) * std::f32::consts::FRAC_PI_4;
            let (sin, cos) = angle.sin_cos();
            self.line(&[(8.0 + cos * 5.0, 8.0 + sin * 5.0), (8.0 + cos * 6.8, 8.0 + sin * 6.8)]);
        }
    }

    /// The outline between a circle and a smaller one that covers its upper right.
    fn moon(&self) {
        let arc = |center: (f32, f32), radius: f32, from: f32, to: f32| {
            (0..=12_u8).map(move |step| {
                let angle = (from + (to - from) * f32::from(step) / 12.0).to_radians();
                (center.0 + radius * angle.cos(), center.1 + radius * angle.sin())
            })
        };
        let outer = arc((7.6, 8.4), 5.6, 10.0, 260.0);
        let inner = arc((10.4, 5.6), 4.6, 215.0, 55.0);
        let points: Vec<(f32, f32)> = outer.chain(inner).collect();
        self.line(&points);
        if let (Some(&first), Some(&last)) = (points.first(), points.last()) {
            self.line(&[last, first]);
        }
    }
}
