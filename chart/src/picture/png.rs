//! Drawings as pixels: the SVG, rasterised with the built-in font.

use std::error::Error;
use std::sync::{Arc, LazyLock};

use resvg::tiny_skia::{Pixmap, Transform};
use resvg::usvg::fontdb::{Database, Source};
use resvg::usvg::{Options, Tree};

use super::drawing::Drawing;
use super::svg;
use super::text::{RAISED_RISE, RAISED_SIZE, plain_of_superscript};

/// The most pixels in an image: 256 MiB of memory while it is made.
const MAX_PIXELS: f64 = 67_108_864.0;

/// Errors of drawing a picture.
#[derive(Debug, thiserror::Error)]
pub enum PictureError {
    /// The image would have no pixels, or more than 64 Mi.
    #[error("an image of {width} x {height} pixels cannot be made")]
    Size {
        /// The requested width, in pixels.
        width: u32,
        /// The height that follows from the picture's proportions, in pixels.
        height: u32,
    },
    /// The drawing could not be rasterised, such as one of more than a million elements.
    #[error("the drawing cannot be rasterised")]
    Drawing(#[source] Box<dyn Error + Send + Sync>),
    /// The pixels could not be encoded.
    #[error("the image cannot be encoded as PNG")]
    Encoding(#[source] Box<dyn Error + Send + Sync>),
}

/// The built-in font and no other: nothing depends on the fonts of the machine.
static FONTS: LazyLock<Arc<Database>> = LazyLock::new(|| {
    let mut fonts = Database::new();
    for font in [notosans::REGULAR_TTF, notosans::BOLD_TTF] {
        fonts.load_font_source(Source::Binary(Arc::new(font)));
    }
    Arc::new(fonts)
});

impl Drawing {
    /// A PNG image on white ground, `width` pixels wide and as high as the picture's proportions want.
    ///
    /// # Errors
    ///
    /// [`PictureError::Size`] if the width is zero or the image would be too large, [`PictureError::Drawing`] if the drawing
    /// has more shapes than the rasteriser takes.
    pub fn png(&self, width: u32) -> Result<Vec<u8>, PictureError> {
        write(self, width)
    }
}

fn write(drawing: &Drawing, width: u32) -> Result<Vec<u8>, PictureError> {
    let scale = f64::from(width) / drawing.width;
    let height = (drawing.height * scale).round() as u32;
    let size_error = PictureError::Size { width, height };
    if f64::from(width) * f64::from(height) > MAX_PIXELS {
        return Err(size_error);
    }
    let mut pixels = Pixmap::new(width, height).ok_or(size_error)?;
    let options = Options { fontdb: Arc::clone(&FONTS), ..Options::default() };
    let tree = Tree::from_str(&raised(&svg::write(drawing)), &options)
        .map_err(|error| PictureError::Drawing(error.into()))?;
    resvg::render(&tree, Transform::from_scale(scale as f32, scale as f32), &mut pixels.as_mut());
    pixels.encode_png().map_err(|error| PictureError::Encoding(error.into()))
}

/// The SVG with its superscripts as small raised signs: the built-in font has no superscript minus. Superscripts stand in no
/// attribute, so that each is in a text.
fn raised(svg: &str) -> String {
    let start = format!(
        r#"<tspan font-size="{}%" baseline-shift="{}%">"#,
        100.0 * RAISED_SIZE,
        100.0 * RAISED_RISE / RAISED_SIZE
    );
    let mut out = String::with_capacity(svg.len());
    let mut is_raised = false;
    for character in svg.chars() {
        let plain = plain_of_superscript(character);
        if plain.is_some() != is_raised {
            is_raised = plain.is_some();
            out.push_str(if is_raised { &start } else { "</tspan>" });
        }
        out.push(plain.unwrap_or(character));
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::picture::drawing::Shape;
    use crate::picture::geometry::Colour;
    use crate::picture::text::{Anchor, Text, Weight, width};

    const SCALE: u32 = 8;
    const PAGE: f64 = 200.0;

    /// Darkness of each pixel of texts at (content, start, baseline, size), magnified.
    fn ink(texts: &[(&str, f64, f64, f64)]) -> Pixmap {
        let text = |&(content, x, y, size): &(&str, f64, f64, f64)| {
            Shape::Text(Text::new(content, [x, y], Anchor::Start, size, Colour(0, 0, 0)))
        };
        let shapes = texts.iter().map(text).collect();
        let drawing = Drawing { title: String::new(), width: PAGE, height: 40.0, shapes };
        let png = write(&drawing, SCALE * PAGE as u32).expect("an image");
        Pixmap::decode_png(&png).expect("a PNG")
    }

    #[test]
    fn superscripts_are_small_raised_signs() {
        let size = 16.0;
        let power = ink(&[("10⁻³", 10.0, 30.0, size)]);
        let start = 10.0 + width("10", size, Weight::Regular);
        let (rise, small) = (RAISED_RISE * size, RAISED_SIZE * size);
        let by_hand = ink(&[("10", 10.0, 30.0, size), ("−3", start, 30.0 - rise, small)]);
        let dark = |image: &Pixmap| image.pixels().iter().filter(|pixel| pixel.red() < 128).count();
        let differing =
            power.pixels().iter().zip(by_hand.pixels()).filter(|(a, b)| a.red().abs_diff(b.red()) > 128);
        // Both are placed to a hundredth of a unit, which is less than a tenth of a pixel.
        assert!(differing.count() * 100 < dark(&power), "{} dark pixels", dark(&power));
        assert_eq!(raised("<text>10⁻³ m</text>").matches("tspan").count(), 2);
        assert_eq!(raised("<text>10 m</text>"), "<text>10 m</text>");
    }

    #[test]
    fn text_is_as_wide_as_labels_take_it_to_be() {
        for text in ["measured depth [m]", "10⁻³", "−0.25 m3/s", "ESDIRK4(3)6L, 2 iterations"] {
            let image = ink(&[(text, 10.0, 30.0, 12.0)]);
            let columns = image.pixels().iter().zip((0..image.width()).cycle());
            let last = columns.filter(|(pixel, _)| pixel.red() < 128).map(|(_, column)| column).max();
            let end = f64::from(last.expect("ink")) / f64::from(SCALE) - 10.0;
            let expected = width(text, 12.0, Weight::Regular);
            // Less the room next to the last sign, and kerning.
            assert!((expected - 2.0..=expected).contains(&end), "{text}: {end} for {expected}");
        }
    }
}
