//! Drawings as SVG 1.1.

use std::fmt::{self, Write};

use super::drawing::{Drawing, Mosaic, Shape};
use super::geometry::{Colour, Position, Stroke};
use super::marker::Marker;
use super::text::{Anchor, Weight};

impl Drawing {
    /// A standalone SVG 1.1 document on white ground. The same drawing gives the same bytes.
    pub fn svg(&self) -> String {
        format!("<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n{}", self.svg_element())
    }

    /// The same as an element of an HTML document. Texts are escaped, and it has no styles and no scripts.
    pub fn svg_element(&self) -> String {
        write(self)
    }
}

pub(super) fn write(drawing: &Drawing) -> String {
    let mut out = String::new();
    let (width, height) = (number(drawing.width), number(drawing.height));
    let _ = write!(
        out,
        r#"<svg xmlns="http://www.w3.org/2000/svg" version="1.1" width="{width}" height="{height}" viewBox="0 0 {width} {height}" font-family="Noto Sans, sans-serif">
<title>{}</title>
<rect width="{width}" height="{height}" fill="{}"/>
"#,
        escaped(&drawing.title),
        hex(Colour::WHITE)
    );
    shapes(&mut out, &drawing.shapes);
    out.push_str("</svg>\n");
    out
}

fn shapes(out: &mut String, all: &[Shape]) {
    for shape in all {
        // Writing to a string cannot fail.
        let _ = match shape {
            Shape::Group(class, members) => {
                let _ = writeln!(out, r#"<g class="{class}">"#);
                shapes(out, members);
                writeln!(out, "</g>")
            }
            Shape::Rectangle(area, stroke) => {
                let [x, y, width, height] = [area.left, area.top, area.width(), area.height()].map(number);
                let stroke = stroke_attributes(stroke);
                writeln!(out, r#"<rect x="{x}" y="{y}" width="{width}" height="{height}" {stroke}/>"#)
            }
            Shape::Filled(area, colour) => {
                let [x, y, width, height] = [area.left, area.top, area.width(), area.height()].map(number);
                let fill = hex(*colour);
                writeln!(out, r#"<rect x="{x}" y="{y}" width="{width}" height="{height}" fill="{fill}"/>"#)
            }
            Shape::Ground(area) => {
                let [x, y, width, height] = [area.left, area.top, area.width(), area.height()].map(number);
                let (fill, opacity) = (hex(Colour::WHITE), Shape::GROUND_OPACITY);
                writeln!(
                    out,
                    r#"<rect x="{x}" y="{y}" width="{width}" height="{height}" fill="{fill}" fill-opacity="{opacity}"/>"#
                )
            }
            Shape::Polyline(points, stroke) => {
                writeln!(out, r#"<polyline points="{}" {}/>"#, coordinates(points), stroke_attributes(stroke))
            }
            Shape::Marker(at, marker, colour) => {
                let place = format!(r#"class="marker" transform="translate({})""#, coordinates(&[*at]));
                let paint = format!(
                    r#"fill="{}" stroke="{}" stroke-width="{}""#,
                    hex(*colour),
                    hex(Colour::WHITE),
                    number(Marker::RIM)
                );
                match marker {
                    Marker::Circle => {
                        writeln!(out, r#"<circle {place} r="{}" {paint}/>"#, number(Marker::RADIUS))
                    }
                    _ => writeln!(
                        out,
                        r#"<polygon {place} points="{}" {paint}/>"#,
                        coordinates(&marker.corners())
                    ),
                }
            }
            Shape::Mosaic(tiles) => mosaic(out, tiles),
            Shape::Text(text) => {
                let [x, y] = text.at.map(number);
                let anchor = match text.anchor {
                    Anchor::Start => "start",
                    Anchor::Middle => "middle",
                    Anchor::End => "end",
                };
                let weight = if text.weight == Weight::Bold { r#" font-weight="bold""# } else { "" };
                let turn =
                    if text.upwards { format!(r#" transform="rotate(-90 {x} {y})""#) } else { String::new() };
                let (size, fill, content) = (number(text.size), hex(text.colour), escaped(&text.content));
                writeln!(
                    out,
                    r#"<text x="{x}" y="{y}" font-size="{size}"{weight} text-anchor="{anchor}" fill="{fill}"{turn}>{content}</text>"#
                )
            }
        };
    }
}

/// In units of cells, a line as wide as a row for each run: a few bytes each, since places count from the run before.
fn mosaic(out: &mut String, Mosaic { area, size: [columns, rows], runs }: &Mosaic) -> fmt::Result {
    let scale = [area.width() / *columns as f64, area.height() / *rows as f64];
    writeln!(
        out,
        r#"<g class="mosaic" transform="translate({},{}) scale({},{})" fill="none" shape-rendering="crispEdges">"#,
        number(area.left),
        number(area.top),
        scale[0],
        scale[1]
    )?;
    for (colour, runs) in runs {
        write!(out, r#"<path stroke="{}" d="M0,.5"#, hex(*colour))?;
        let mut pen = [0i64; 2];
        for [row, start, length] in runs.iter().map(|run| run.map(|value| value as i64)) {
            write!(out, "m{},{}h{length}", start - pen[0], row - pen[1])?;
            pen = [start + length, row];
        }
        writeln!(out, r#""/>"#)?;
    }
    writeln!(out, "</g>")
}

fn stroke_attributes(stroke: &Stroke) -> String {
    let dashes = if stroke.dashed {
        format!(r#" stroke-dasharray="{}""#, Stroke::DASHES.map(number).join(","))
    } else {
        String::new()
    };
    let (colour, width) = (hex(stroke.colour), number(stroke.width));
    format!(r#"fill="none" stroke="{colour}" stroke-width="{width}" stroke-linejoin="round"{dashes}"#)
}

fn coordinates(points: &[Position]) -> String {
    let pairs: Vec<String> = points.iter().map(|[x, y]| format!("{},{}", number(*x), number(*y))).collect();
    pairs.join(" ")
}

/// A coordinate to a hundredth of a unit.
fn number(value: f64) -> String {
    let text = format!("{value:.2}");
    let text = text.trim_end_matches('0').trim_end_matches('.');
    if text == "-0" { "0".to_owned() } else { text.to_owned() }
}

fn hex(Colour(red, green, blue): Colour) -> String {
    format!("#{red:02x}{green:02x}{blue:02x}")
}

fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_short() {
        assert_eq!(number(-0.001), "0");
        assert_eq!(number(12.0), "12");
        assert_eq!(number(100.0), "100");
        assert_eq!(number(0.126), "0.13");
        assert_eq!(number(-3.5), "-3.5");
    }
}
