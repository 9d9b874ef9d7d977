//! Text in pictures: setting, widths, and cutting of long text.

use std::sync::LazyLock;

use skrifa::charmap::Charmap;
use skrifa::instance::{LocationRef, Size};
use skrifa::metrics::GlyphMetrics;
use skrifa::{FontRef, MetadataProvider};

use super::geometry::{Colour, Position};

/// One line of text.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Text {
    pub(super) content: String,
    /// Beginning, middle or end of the baseline, according to the anchor.
    pub(super) at: Position,
    pub(super) anchor: Anchor,
    pub(super) size: f64,
    pub(super) weight: Weight,
    pub(super) colour: Colour,
    /// True if the text runs upwards rather than to the right.
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

/// The size of superscripts in that of their text, and how far above its baseline they stand.
pub(super) const RAISED_SIZE: f64 = 0.68;
pub(super) const RAISED_RISE: f64 = 0.36;

/// Widths of glyphs in the built-in font.
struct Metrics {
    charmap: Charmap<'static>,
    glyphs: GlyphMetrics<'static>,
    units_per_em: f64,
}

static REGULAR: LazyLock<Metrics> = LazyLock::new(|| Metrics::of(notosans::REGULAR_TTF));
static BOLD: LazyLock<Metrics> = LazyLock::new(|| Metrics::of(notosans::BOLD_TTF));

impl Metrics {
    fn of(font: &'static [u8]) -> Self {
        let font = FontRef::new(font).expect("the built-in font is well-formed");
        let glyphs = font.glyph_metrics(Size::unscaled(), LocationRef::default());
        let units_per_em = font.metrics(Size::unscaled(), LocationRef::default()).units_per_em;
        Self { charmap: font.charmap(), glyphs, units_per_em: f64::from(units_per_em) }
    }

    /// From a glyph's origin to that of the next, in the size of the text.
    fn advance(&self, character: char) -> f64 {
        let glyph = self.charmap.map(character).unwrap_or_default();
        f64::from(self.glyphs.advance_width(glyph).unwrap_or(0.0)) / self.units_per_em
    }
}

impl Weight {
    fn metrics(self) -> &'static Metrics {
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
}

/// Largest width of text in another font of an SVG viewer, relative to ours.
const VIEWERS_FONT: f64 = 1.12;

/// The width to keep for a line of text, in page units.
pub(super) fn room(text: &str, size: f64, weight: Weight) -> f64 {
    width(text, size, weight) * VIEWERS_FONT
}

/// The width of a line of text in the built-in font, in page units.
pub(super) fn width(text: &str, size: f64, weight: Weight) -> f64 {
    ends(text, size, weight).last().unwrap_or(0.0)
}

/// Ends of the characters of a line, from its start, in page units.
fn ends(text: &str, size: f64, weight: Weight) -> impl Iterator<Item = f64> {
    let metrics = weight.metrics();
    text.chars().scan(0.0, move |end, character| {
        let (character, size) = match plain_of_superscript(character) {
            Some(plain) => (plain, size * RAISED_SIZE),
            None => (character, size),
        };
        *end += metrics.advance(character) * size;
        Some(*end)
    })
}

/// The sign that a superscript is a raised one of.
pub(super) fn plain_of_superscript(character: char) -> Option<char> {
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
    cut(&words(text).join(" "), size, weight, max_width)
}

/// The same in at most this many lines, which break between words; none of a text without words.
pub(super) fn lines(text: &str, size: f64, weight: Weight, max_width: f64, most: usize) -> Vec<String> {
    let mut lines: Vec<String> = Vec::new();
    for word in words(text) {
        let may_break = lines.len() < most;
        match lines.last_mut() {
            Some(line) if !may_break || room(&format!("{line} {word}"), size, weight) <= max_width => {
                line.push(' ');
                line.push_str(&word);
            }
            _ => lines.push(word),
        }
    }
    lines.iter().map(|line| cut(line, size, weight, max_width)).collect()
}

fn words(text: &str) -> Vec<String> {
    let words = text.split(|c: char| c.is_whitespace() || c.is_control()).filter(|word| !word.is_empty());
    words.map(|word| word.replace(['\u{fffe}', '\u{ffff}'], "\u{fffd}")).collect()
}

fn cut(line: &str, size: f64, weight: Weight, max_width: f64) -> String {
    if room(line, size, weight) <= max_width {
        return line.to_owned();
    }
    let room = max_width - room("…", size, weight);
    let fitting = ends(line, size, weight).take_while(|end| end * VIEWERS_FONT <= room).count();
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
                assert!(weight.metrics().charmap.map(character).is_some(), "{character} in {weight:?}");
            }
        }
    }

    #[test]
    fn superscripts_are_small() {
        let widths = |text| -> Vec<f64> {
            let ends: Vec<f64> = ends(text, 12.0, Weight::Regular).collect();
            ends.iter().zip([&0.0].into_iter().chain(&ends)).map(|(end, start)| end - start).collect()
        };
        let (plain, power) = (widths("10−3"), widths("10⁻³"));
        assert_eq!(plain[..2], power[..2]);
        for (plain, raised) in plain.iter().zip(&power).skip(2) {
            assert!((raised / plain - RAISED_SIZE).abs() < 1e-12, "{raised} of {plain}");
        }
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
    #[test]
    fn text_breaks_between_words_and_is_cut_in_the_last_line() {
        let set = |text: &str| lines(text, 12.0, Weight::Regular, 100.0, 3);
        assert_eq!(set(" \t"), Vec::<String>::new());
        assert_eq!(set("two words"), ["two words"]);
        let words: Vec<String> = (0..10).map(|k| format!("word{k}")).collect();
        let few = set(&words[..5].join(" "));
        assert!(few.len() > 1 && few.join(" ") == words[..5].join(" "), "{few:?}");
        let many = set(&words.join(" ").repeat(4));
        assert!(many.len() == 3 && many[2].ends_with('…') && !many[1].ends_with('…'), "{many:?}");
        assert!(many.iter().all(|line| room(line, 12.0, Weight::Regular) <= 100.0), "{many:?}");
        let wide = set(&format!("a {} b", "w".repeat(100)));
        assert!(wide[1].ends_with('…') && wide[2] == "b", "{wide:?}");
    }
}
