//! Messages that quote code in backticks: drawn with the code in its own font, or without backticks where there is one
//! font only.

use egui::text::LayoutJob;
use egui::{Color32, FontId, TextFormat};

/// The message in one color, with its code in the monospaced font.
pub(crate) fn job(message: &str, font: &FontId, color: Color32, width: f32) -> LayoutJob {
    let mut job = LayoutJob::default();
    append(&mut job, message, font, color);
    job.wrap.max_width = width;
    job
}

/// Appends a message to others.
pub(crate) fn append(job: &mut LayoutJob, message: &str, font: &FontId, color: Color32) {
    let code = FontId::monospace(font.size);
    for (index, part) in message.split('`').enumerate() {
        let font = if index % 2 == 0 { font } else { &code };
        job.append(part, 0.0, TextFormat::simple(font.clone(), color));
    }
}

/// The message without backticks, for names of widgets and for buttons.
pub fn without_backticks(message: &str) -> String {
    message.replace('`', "")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn code_has_its_font_and_no_backticks() {
        let job = job("nothing asserts `PATH=OK` here", &FontId::proportional(12.0), Color32::WHITE, 100.0);
        assert_eq!(job.text, "nothing asserts PATH=OK here");
        let fonts: Vec<&FontId> = job.sections.iter().map(|section| &section.format.font_id).collect();
        assert_eq!(
            fonts,
            [&FontId::proportional(12.0), &FontId::monospace(12.0), &FontId::proportional(12.0)]
        );
    }
}
