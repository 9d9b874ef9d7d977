//! Places, rectangles, strokes and colours of a page.

/// A place on the page: from the left and from the top, in page units (CSS pixels).
pub(super) type Position = [f64; 2];

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
