//! Drawings as pixels.

use std::error::Error;

use tiny_skia::{
    FillRule, LineJoin, Paint, Path, PathBuilder, Pixmap, Rect, Stroke as Pen, StrokeDash, Transform,
};
use ttf_parser::OutlineBuilder;

use super::{
    drawing::{Colour, Drawing, Position, Rectangle, Shape, Stroke},
    marker::Marker,
    text::Text,
};

/// The most pixels in an image: 256 MiB of memory while it is made.
const MAX_PIXELS: f64 = 67_108_864.0;

/// Why a picture was not made.
#[derive(Debug, thiserror::Error)]
pub enum PictureError {
    /// The image would have no pixels, or more than 64 Mi.
    #[error("an image of {width} x {height} pixels cannot be made")]
    Size {
        /// The width asked for, in pixels.
        width: u32,
        /// The height that follows from the picture's proportions, in pixels.
        height: u32,
    },
    /// The pixels could not be encoded.
    #[error("the image cannot be encoded as PNG")]
    Encoding(#[source] Box<dyn Error + Send + Sync>),
}

pub(super) fn png(drawing: &Drawing, width: u32) -> Result<Vec<u8>, PictureError> {
    let scale = f64::from(width) / drawing.width;
    let height = (drawing.height * scale).round() as u32;
    let size_error = PictureError::Size { width, height };
    if f64::from(width) * f64::from(height) > MAX_PIXELS {
        return Err(size_error);
    }
    let mut canvas = Canvas {
        pixmap: Pixmap::new(width, height).ok_or(size_error)?,
        to_pixels: Transform::from_scale(scale as f32, scale as f32),
    };
    canvas.pixmap.fill(skia_colour(Colour::WHITE));
    canvas.shapes(&drawing.shapes);
    canvas.pixmap.encode_png().map_err(|error| PictureError::Encoding(error.into()))
}

struct Canvas {
    pixmap: Pixmap,
    to_pixels: Transform,
}

impl Canvas {
    fn shapes(&mut self, shapes: &[Shape]) {
        for shape in shapes {
            match shape {
                Shape::Group(_, members) => self.shapes(members),
                Shape::Rectangle(area, stroke) => {
                    self.stroke(rectangle(area).map(PathBuilder::from_rect), stroke);
                }
                Shape::Filled(area, colour) => {
                    if let Some(area) = rectangle(area) {
                        self.pixmap.fill_rect(area, &paint(*colour), self.to_pixels, None);
                    }
                }
                Shape::Ground(area) => {
                    let mut paint = paint(Colour::WHITE);
                    paint.shader.apply_opacity(Shape::GROUND_OPACITY);
                    if let Some(area) = rectangle(area) {
                        self.pixmap.fill_rect(area, &paint, self.to_pixels, None);
                    }
                }
                Shape::Polyline(points, stroke) => self.stroke(polyline(points).finish(), stroke),
                Shape::Marker(at, marker, colour) => self.marker(*at, *marker, *colour),
                Shape::Text(text) => self.text(text),
            }
        }
    }

    fn stroke(&mut self, path: Option<Path>, stroke: &Stroke) {
        let Some(path) = path else { return };
        let dash = if stroke.dashed {
            StrokeDash::new(Stroke::DASHES.map(|length| length as f32).to_vec(), 0.0)
        } else {
            None
        };
        let pen = Pen { width: stroke.width as f32, line_join: LineJoin::Round, dash, ..Pen::default() };
        self.pixmap.stroke_path(&path, &paint(stroke.colour), &pen, self.to_pixels, None);
    }

    fn fill(&mut self, path: Option<&Path>, colour: Colour, transform: Transform) {
        if let Some(path) = path {
            self.pixmap.fill_path(path, &paint(colour), FillRule::Winding, transform, None);
        }
    }

    fn marker(&mut self, at: Position, marker: Marker, colour: Colour) {
        let [x, y] = at.map(|coordinate| coordinate as f32);
        let path = match marker {
            Marker::Circle => PathBuilder::from_circle(x, y, Marker::RADIUS as f32),
            _ => {
                let corners: Vec<Position> = marker
                    .corners()
                    .into_iter()
                    .map(|corner| [at[0] + corner[0], at[1] + corner[1]])
                    .collect();
                let mut outline = polyline(&corners);
                outline.close();
                outline.finish()
            }
        };
        self.fill(path.as_ref(), colour, self.to_pixels);
        if let Some(path) = path {
            let rim = Pen { width: Marker::RIM as f32, ..Pen::default() };
            self.pixmap.stroke_path(&path, &paint(Colour::WHITE), &rim, self.to_pixels, None);
        }
    }

    fn text(&mut self, text: &Text) {
        let face = text.weight.face();
        let anchor = text.anchor_offset();
        let mut outline = GlyphOutline { path: PathBuilder::new(), origin: [0.0, 0.0], scale: 0.0 };
        for glyph in text.glyphs() {
            outline.origin = [(glyph.start - anchor) as f32, -glyph.rise as f32];
            outline.scale = (glyph.size / f64::from(face.units_per_em())) as f32;
            face.outline_glyph(glyph.id, &mut outline);
        }
        let [x, y] = text.at.map(|coordinate| coordinate as f32);
        let turn = if text.upwards { -90.0 } else { 0.0 };
        let transform = self.to_pixels.pre_translate(x, y).pre_concat(Transform::from_rotate(turn));
        self.fill(outline.path.finish().as_ref(), text.colour, transform);
    }
}

/// Collects the outlines of glyphs, whose height counts upwards, on a page whose height counts downwards.
struct GlyphOutline {
    path: PathBuilder,
    origin: [f32; 2],
    scale: f32,
}

impl GlyphOutline {
    fn on_page(&self, x: f32, y: f32) -> (f32, f32) {
        (self.origin[0] + x * self.scale, self.origin[1] - y * self.scale)
    }
}

impl OutlineBuilder for GlyphOutline {
    fn move_to(&mut self, x: f32, y: f32) {
        let (x, y) = self.on_page(x, y);
        self.path.move_to(x, y);
    }

    fn line_to(&mut self, x: f32, y: f32) {
        let (x, y) = self.on_page(x, y);
        self.path.line_to(x, y);
    }

    fn quad_to(&mut self, x1: f32, y1: f32, x: f32, y: f32) {
        let ((x1, y1), (x, y)) = (self.on_page(x1, y1), self.on_page(x, y));
        self.path.quad_to(x1, y1, x, y);
    }

    fn curve_to(&mut self, x1: f32, y1: f32, x2: f32, y2: f32, x: f32, y: f32) {
        let ((x1, y1), (x2, y2), (x, y)) = (self.on_page(x1, y1), self.on_page(x2, y2), self.on_page(x, y));
        self.path.cubic_to(x1, y1, x2, y2, x, y);
    }

    fn close(&mut self) {
        self.path.close();
    }
}

fn polyline(points: &[Position]) -> PathBuilder {
    let mut path = PathBuilder::new();
    for (n, point) in points.iter().enumerate() {
        let [x, y] = point.map(|coordinate| coordinate as f32);
        if n == 0 { path.move_to(x, y) } else { path.line_to(x, y) }
    }
    path
}

fn rectangle(area: &Rectangle) -> Option<Rect> {
    let [left, top, right, bottom] = [area.left, area.top, area.right, area.bottom].map(|side| side as f32);
    Rect::from_ltrb(left, top, right, bottom)
}

fn paint(colour: Colour) -> Paint<'static> {
    let mut paint = Paint { anti_alias: true, ..Paint::default() };
    paint.set_color(skia_colour(colour));
    paint
}

fn skia_colour(Colour(red, green, blue): Colour) -> tiny_skia::Color {
    tiny_skia::Color::from_rgba8(red, green, blue, 255)
}
