//! Text in pictures: what is set, how wide it is, and how long text is cut.

use std::sync::LazyLock;

use ttf_parser::{Face, GlyphId};

use super::drawing::{Colour, Position};

/// One line of text.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Text {
    pub(super) content: String,
    /// Where the baseline begins, has its middle, or ends, according to the anchor.
    pub(super) at: Position,
    pub(super) anchor: Anchor,
    pub(super) size: f64,
    pub(super) weight: Weight,
    pub(super) colour: Colour,
    /// Whether the text runs upwards rather than to the right.
    pub(super) upwards: bool,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Anchor {
    Start,
    Middle,
    End,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Weight {
    Regular,
    Bold,
}

static REGULAR: LazyLock<Face<'static>> = LazyLock::new(|| parse(notosans::REGULAR_TTF));
static BOLD: LazyLock<Face<'static>> = LazyLock::new(|| parse(notosans::BOLD_TTF));

fn parse(font: &'static [u8]) -> Face<'static> {
    Face::parse(font, 0).expect("the built-in font is well-formed")
}

impl Weight {
    pub(super) fn face(self) -> &'static Face<'static> {
        match self {
            Self::Regular => &REGULAR,
            Self::Bold => &BOLD,
        }
    }
}

impl Text {
    /// Regular text that runs to the right.
    pub(super) fn new(
        content: impl Into<String>,
        at: Position,
        anchor: Anchor,
        size: f64,
        colour: Colour,
    ) -> Self {
        Self { content: content.into(), at, anchor, size, weight: Weight::Regular, colour, upwards: false }
    }

    /// The glyphs from left to right.
    pub(super) fn glyphs(&self) -> impl Iterator<Item = Glyph> {
        glyphs(&self.content, self.size, self.weight)
    }

    /// The distance from the start of the text to its anchor.
    pub(super) fn anchor_offset(&self) -> f64 {
        match self.anchor {
            Anchor::Start => 0.0,
            Anchor::Middle => width(&self.content, self.size, self.weight) / 2.0,
            Anchor::End => width(&self.content, self.size, self.weight),
        }
    }
}

/// How much wider text may be in the font of an SVG viewer that has not got ours.
const VIEWERS_FONT: f64 = 1.12;

/// The width to keep for a line of text, in page units.
pub(super) fn room(text: &str, size: f64, weight: Weight) -> f64 {
    width(text, size, weight) * VIEWERS_FONT
}

/// The width of a line of text in the built-in font, in page units.
fn width(text: &str, size: f64, weight: Weight) -> f64 {
    glyphs(text, size, weight).last().map_or(0.0, |glyph| glyph.end)
}

/// A glyph in its place in a line; lengths are in page units.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Glyph {
    pub(super) id: GlyphId,
    pub(super) size: f64,
    /// From the start of the line to the glyph's origin.
    pub(super) start: f64,
    /// From the start of the line to the next glyph's origin.
    end: f64,
    /// How far above the baseline the glyph stands.
    pub(super) rise: f64,
}

fn glyphs(text: &str, size: f64, weight: Weight) -> impl Iterator<Item = Glyph> {
    let face = weight.face();
    text.chars().scan(0.0, move |pen, character| {
        let (character, size, rise) = match plain_of_superscript(character) {
            Some(plain) => (plain, size * 0.68, size * 0.36),
            None => (character, size, 0.0),
        };
        let id = face.glyph_index(character).unwrap_or_default();
        let advance = f64::from(face.glyph_hor_advance(id).unwrap_or(0)) / f64::from(face.units_per_em());
        let start = *pen;
        *pen += advance * size;
        Some(Glyph { id, size, start, end: *pen, rise })
    })
}

/// Superscripts are set as small raised signs: the font has no superscript minus.
fn plain_of_superscript(character: char) -> Option<char> {
    const SUPERSCRIPTS: &str = "⁰¹²³⁴⁵⁶⁷⁸⁹⁻";
    SUPERSCRIPTS
        .chars()
        .zip("0123456789−".chars())
        .find_map(|(raised, plain)| (raised == character).then_some(plain))
}

/// Text as it can be set in one line of at most this width: white space and control characters become single
/// spaces, characters that XML does not allow the replacement character, and what is too long ends in an
/// ellipsis.
pub(super) fn line(text: &str, size: f64, weight: Weight, max_width: f64) -> String {
    let words: Vec<&str> =
        text.split(|c: char| c.is_whitespace() || c.is_control()).filter(|w| !w.is_empty()).collect();
    let line = words.join(" ").replace(['\u{fffe}', '\u{ffff}'], "\u{fffd}");
    if room(&line, size, weight) <= max_width {
        return line;
    }
    let room = max_width - room("…", size, weight);
    let fitting = glyphs(&line, size, weight).take_while(|glyph| glyph.end * VIEWERS_FONT <= room).count();
    let start: String = line.chars().take(fitting).collect();
    format!("{}…", start.trim_end())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn width_grows_with_text_size_and_weight() {
        let regular = width("error", 10.0, Weight::Regular);
        assert!((20.0..35.0).contains(&regular), "{regular}");
        assert!((width("error", 20.0, Weight::Regular) - 2.0 * regular).abs() < 1e-9);
        assert!(width("error", 10.0, Weight::Bold) > regular);
        assert!(width("errors", 10.0, Weight::Regular) > regular);
        assert_eq!(width("", 10.0, Weight::Regular), 0.0);
    }

    #[test]
    fn the_font_has_the_signs_of_axes_and_units() {
        for character in "0123456789×−…·°µωΔ %".chars() {
            for weight in [Weight::Regular, Weight::Bold] {
                assert!(weight.face().glyph_index(character).is_some(), "{character} in {weight:?}");
            }
        }
    }

    #[test]
    fn superscripts_are_small_and_raised() {
        let plain: Vec<_> = glyphs("10−3", 12.0, Weight::Regular).collect();
        let power: Vec<_> = glyphs("10⁻³", 12.0, Weight::Regular).collect();
        for (plain, raised) in plain.iter().zip(&power).skip(2) {
            assert_eq!(raised.id, plain.id);
            assert!(raised.size < plain.size && raised.rise > 0.0);
        }
        assert_eq!(plain[..2], power[..2]);
        assert!(power[3].end < plain[3].end);
    }

    #[test]
    fn lines_are_cut_to_their_room() {
        let long = line(&"word ".repeat(1000), 12.0, Weight::Regular, 100.0);
        assert!(long.ends_with('…') && long.starts_with("word word"), "{long}");
        assert!(room(&long, 12.0, Weight::Regular) <= 100.0);
        assert_eq!(line(" two\n\twords \u{0} ", 12.0, Weight::Regular, 100.0), "two words");
        assert_eq!(line("a\u{ffff}", 12.0, Weight::Regular, 100.0), "a\u{fffd}");
        assert_eq!(line("anything", 12.0, Weight::Regular, 0.0), "…");
    }
}
