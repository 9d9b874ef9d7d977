//! A laid-out picture: shapes on a page, in the order in which they are painted.

use indexmap::IndexMap;

use super::{PictureError, marker::Marker, png, svg, text::Text};

/// A place on the page: from the left and from the top, in page units (CSS pixels).
pub(super) type Position = [f64; 2];

/// A picture that is laid out and can be written.
#[derive(Debug, Clone, PartialEq)]
pub struct Drawing {
    pub(super) title: String,
    pub(super) width: f64,
    pub(super) height: f64,
    pub(super) shapes: Vec<Shape>,
}

impl Drawing {
    /// A standalone SVG 1.1 document on white ground. The same drawing gives the same bytes.
    pub fn svg(&self) -> String {
        svg::write(self)
    }

    /// A PNG image on white ground, `width` pixels wide and as high as the picture's proportions want.
    ///
    /// # Errors
    ///
    /// [`PictureError::Size`] if the width is zero or the image would be too large, [`PictureError::Drawing`] if the drawing
    /// has more shapes than the rasteriser takes.
    pub fn png(&self, width: u32) -> Result<Vec<u8>, PictureError> {
        png::write(self, width)
    }

    /// The width of the page in CSS pixels: the width at which text has its natural size.
    pub fn width(&self) -> f64 {
        self.width
    }

    /// The height of the page in CSS pixels.
    pub fn height(&self) -> f64 {
        self.height
    }

    /// This picture with another below it, on one page as wide as the wider of them.
    #[must_use]
    pub(crate) fn above(mut self, mut below: Drawing) -> Drawing {
        below.shapes.iter_mut().for_each(|shape| shape.move_down(self.height));
        self.shapes.append(&mut below.shapes);
        self.width = self.width.max(below.width);
        self.height += below.height;
        self
    }
}

#[derive(Debug, Clone, PartialEq)]
pub(super) enum Shape {
    /// Shapes that belong together, under a name that SVG shows as their class.
    Group(&'static str, Vec<Shape>),
    Rectangle(Rectangle, Stroke),
    /// A rectangle full of one colour.
    Filled(Rectangle, Colour),
    /// White that lets little of what is below show through, for text to stand on.
    Ground(Rectangle),
    Polyline(Vec<Position>, Stroke),
    Marker(Position, Marker, Colour),
    Mosaic(Mosaic),
    Text(Text),
}

/// A rectangle in rows and columns of cells, for more cells than a picture should have rectangles: a line of the page each.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Mosaic {
    pub(super) area: Rectangle,
    /// Cells across and down.
    pub(super) size: [usize; 2],
    /// By colour the runs of cells: row from the top, first column, number of cells.
    pub(super) runs: Vec<(Colour, Vec<[usize; 3]>)>,
}

impl Mosaic {
    /// The mosaic of cells given row by row from the top; one without a colour stays empty.
    pub(super) fn new(area: Rectangle, columns: usize, cells: &[Option<Colour>]) -> Self {
        let mut runs: IndexMap<[u8; 3], Vec<[usize; 3]>> = IndexMap::new();
        for (row, cells) in cells.chunks(columns.max(1)).enumerate() {
            let mut start = 0;
            for run in cells.chunk_by(|a, b| a == b) {
                if let Some(Colour(red, green, blue)) = run[0] {
                    runs.entry([red, green, blue]).or_default().push([row, start, run.len()]);
                }
                start += run.len();
            }
        }
        let runs = runs.into_iter().map(|([red, green, blue], runs)| (Colour(red, green, blue), runs));
        Self { area, size: [columns, cells.len() / columns.max(1)], runs: runs.collect() }
    }
}

impl Shape {
    fn move_down(&mut self, distance: f64) {
        match self {
            Self::Group(_, members) => members.iter_mut().for_each(|member| member.move_down(distance)),
            Self::Rectangle(area, _)
            | Self::Filled(area, _)
            | Self::Ground(area)
            | Self::Mosaic(Mosaic { area, .. }) => {
                area.top += distance;
                area.bottom += distance;
            }
            Self::Polyline(places, _) => places.iter_mut().for_each(|place| place[1] += distance),
            Self::Marker(at, _, _) | Self::Text(Text { at, .. }) => at[1] += distance,
        }
    }

    pub(super) const GROUND_OPACITY: f32 = 0.8;
}

/// A rectangle with vertical sides.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Rectangle {
    pub(super) left: f64,
    pub(super) top: f64,
    pub(super) right: f64,
    pub(super) bottom: f64,
}

impl Rectangle {
    pub(super) fn width(&self) -> f64 {
        self.right - self.left
    }

    pub(super) fn height(&self) -> f64 {
        self.bottom - self.top
    }
}

#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Stroke {
    pub(super) colour: Colour,
    pub(super) width: f64,
    pub(super) dashed: bool,
}

impl Stroke {
    /// The lengths of dash and gap of a dashed stroke.
    pub(super) const DASHES: [f64; 2] = [6.0, 4.0];

    pub(super) const fn solid(colour: Colour, width: f64) -> Self {
        Self { colour, width, dashed: false }
    }

    pub(super) const fn dashed(colour: Colour, width: f64) -> Self {
        Self { colour, width, dashed: true }
    }
}

/// Red, green and blue in sRGB.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Colour(pub(super) u8, pub(super) u8, pub(super) u8);

impl Colour {
    pub(super) const WHITE: Self = Self(0xff, 0xff, 0xff);
    pub(super) const TEXT: Self = Self(0x22, 0x22, 0x22);
    pub(super) const QUIET_TEXT: Self = Self(0x55, 0x55, 0x55);
    pub(super) const FRAME: Self = Self(0x77, 0x77, 0x77);
    pub(super) const GRID: Self = Self(0xd9, 0xd9, 0xd9);
    pub(super) const FINE_GRID: Self = Self(0xf0, 0xf0, 0xf0);
    pub(super) const SHADE: Self = Self(0xf6, 0xe9, 0xd8);
}
