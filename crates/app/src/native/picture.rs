//! Drawings as PNG, which the page leaves to its browser.

use std::sync::Arc;

use resvg::tiny_skia::{Pixmap, Transform};
use resvg::usvg::{Options, Tree, fontdb::Database};
use theme;

/// The picture of an SVG in pixels of this many across and down, in the fonts of the app.
///
/// # Errors
///
/// Says why there is none: the SVG cannot be read, or the picture would be too large.
pub(super) fn png(svg: &str, [width, height]: [u32; 2]) -> Result<Vec<u8>, String> {
    let mut fonts = Database::new();
    for font in theme::FONTS {
        fonts.load_font_data(font.to_vec());
    }
    fonts.set_sans_serif_family("Inter");
    let options = Options { fontdb: Arc::new(fonts), font_family: "Inter".to_owned(), ..Options::default() };
    let tree = Tree::from_str(svg, &options).map_err(|reason| reason.to_string())?;
    let mut pixels = Pixmap::new(width, height)
        .ok_or_else(|| format!("cannot create an image of {width} × {height} pixels"))?;
    let size = tree.size();
    let scale = Transform::from_scale(width as f32 / size.width(), height as f32 / size.height());
    resvg::render(&tree, scale, &mut pixels.as_mut());
    pixels.encode_png().map_err(|reason| reason.to_string())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn pixels(svg: &str, size: [u32; 2]) -> Pixmap {
        let bytes = png(svg, size).expect("a picture");
        Pixmap::decode_png(&bytes).expect("a PNG")
    }

    #[test]
    fn a_picture_has_the_size_that_was_asked_for_and_the_colors_of_the_drawing() {
        let svg = r##"<svg xmlns="http://www.w3.org/2000/svg" width="10" height="5">
            <rect width="10" height="5" fill="#102030"/></svg>"##;
        let picture = pixels(svg, [40, 20]);
        assert_eq!((picture.width(), picture.height()), (40, 20));
        let middle = picture.pixel(20, 10).expect("a pixel").demultiply();
        assert_eq!([middle.red(), middle.green(), middle.blue()], [0x10, 0x20, 0x30]);
    }

    #[test]
    fn texts_are_written_in_the_fonts_of_the_app() {
        let svg = r#"<svg xmlns="http://www.w3.org/2000/svg" width="80" height="20">
            <g font-family="Inter, sans-serif"><text x="4" y="15" font-size="14">Drive</text></g></svg>"#;
        let inked = pixels(svg, [80, 20]).pixels().iter().filter(|pixel| pixel.alpha() > 128).count();
        assert!(inked > 40, "{inked} pixels are inked");
    }

    #[test]
    fn what_is_no_svg_is_refused_with_a_reason() {
        assert!(png("<svg", [10, 10]).is_err_and(|reason| !reason.is_empty()));
    }
}
