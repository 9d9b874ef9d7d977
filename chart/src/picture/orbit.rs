//! The orbit of one node in its hole.

use std::f64::consts::{FRAC_1_SQRT_2, TAU};

use super::{
    Drawing, PictureError, PlotAxis,
    drawing::{Colour, Position, Rectangle, Shape, Stroke},
    heading,
    marker::{Marker, series_style},
    plot_area,
    text::{Anchor, Text},
};

const PAGE_WIDTH: f64 = 660.0;
const PLOT_SIDE: f64 = 540.0;
const LEFT_MARGIN: f64 = 88.0;
/// Straight lines that make up the circle of the wall.
const CIRCLE_SIDES: usize = 180;
/// Points nearer than this to the one before, in page units, do not show.
const NEAR: f64 = 0.3;
/// How much wider than what it shows the view is.
const MARGIN: f64 = 1.08;

/// The path of one node across its hole, looking down the hole, with the low side down where there is one.
///
/// Both axes have one scale. A forward orbit turns clockwise, as the string does.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct OrbitPlot {
    /// The title; may be empty.
    pub title: String,
    /// A line of smaller text below it; may be empty.
    pub subtitle: String,
    /// The displacements u and v, in order of time, in the unit of the picture.
    pub path: Vec<[f64; 2]>,
    /// The radius at which the string touches the wall, in the same unit.
    pub wall: Option<f64>,
    /// Where the low side lies: the angle from u towards v \[rad\]. Without one, u points down.
    pub low_side: Option<f64>,
    /// The unit of the picture, such as `mm`.
    pub unit: String,
}

impl OrbitPlot {
    /// The plot as a standalone SVG 1.1 document. The same plot gives the same bytes.
    pub fn svg(&self) -> String {
        self.drawing().svg()
    }

    /// The plot as a PNG image of this width in pixels.
    ///
    /// # Errors
    /// [`PictureError::Size`] if the width is zero or the image would be too large.
    pub fn png(&self, width: u32) -> Result<Vec<u8>, PictureError> {
        self.drawing().png(width)
    }

    /// The plot laid out on a page. The whole hole is shown.
    pub fn drawing(&self) -> Drawing {
        let path: Vec<Position> = self.path.iter().filter_map(|[u, v]| self.seen(*u, *v)).collect();
        let reach = path.iter().map(|[x, y]| x.abs().max(y.abs())).fold(0.0, f64::max);
        let half = MARGIN * reach.max(self.wall.filter(|wall| wall.is_finite()).unwrap_or(0.0).abs());
        let axis = PlotAxis::between(-half, half);
        let ticks = axis.map(|axis| axis.ticks()).unwrap_or_default();

        let (left, right) = (LEFT_MARGIN, LEFT_MARGIN + PLOT_SIDE);
        let mut shapes = Vec::new();
        let (title, bottom) = heading::title(&mut shapes, &self.title, left, right);
        let bottom = heading::subtitle(&mut shapes, &self.subtitle, left, right, bottom);
        let top = bottom + 10.0;
        let area = Rectangle { left, top, right, bottom: top + PLOT_SIDE };
        shapes.push(plot_area::grid(&area, &ticks, &ticks));
        let (across, vertical) = match self.low_side {
            Some(_) => ("to the right, looking down the hole", "above the axis of the hole"),
            None => ("against v, looking down the hole", "against u; no low side"),
        };
        let name = |text: &str| format!("{text} [{}]", self.unit);
        shapes.push(plot_area::axes(&area, &ticks, &ticks, &name(across), &name(vertical)));
        match axis {
            Some(axis) if !path.is_empty() => self.data(&mut shapes, &area, &axis, &path),
            _ => shapes.push(heading::no_data(plot_area::position(&area, 0.5, 0.5))),
        }
        Drawing { title, width: PAGE_WIDTH, height: area.bottom + plot_area::BELOW, shapes }
    }

    /// A displacement as it is seen: across to the right and vertical. The axes u, v and the hole's direction are
    /// right-handed, so that to one who looks down the hole v is clockwise of u.
    fn seen(&self, u: f64, v: f64) -> Option<Position> {
        let (sin, cos) = self.low_side.unwrap_or(0.0).sin_cos();
        let (along_low_side, clockwise) = (u * cos + v * sin, v * cos - u * sin);
        (u.is_finite() && v.is_finite()).then_some([-clockwise, -along_low_side])
    }

    fn data(&self, shapes: &mut Vec<Shape>, area: &Rectangle, axis: &PlotAxis, path: &[Position]) {
        let position = |[x, y]: Position| {
            plot_area::position(area, axis.fraction(x).unwrap_or(0.5), axis.fraction(y).unwrap_or(0.5))
        };
        if let Some(wall) = self.wall.filter(|wall| wall.is_finite()) {
            let circle = (0..=CIRCLE_SIDES).map(|side| {
                let (sin, cos) = (TAU * side as f64 / CIRCLE_SIDES as f64).sin_cos();
                position([wall * cos, wall * sin])
            });
            let circle = Shape::Polyline(circle.collect(), Stroke::dashed(Colour::QUIET_TEXT, 1.3));
            let [x, y] = position([wall * FRAC_1_SQRT_2, wall * FRAC_1_SQRT_2]);
            let text =
                Text::new("string touches wall", [x + 6.0, y - 6.0], Anchor::Start, 11.5, Colour::QUIET_TEXT);
            let fits = area.right - x > 130.0;
            let text = if fits {
                text
            } else {
                Text { at: [area.right - 8.0, area.top + 18.0], anchor: Anchor::End, ..text }
            };
            shapes.push(Shape::Group("wall", vec![circle, Shape::Text(text)]));
        }
        if self.low_side.is_some() {
            let [x, y] = plot_area::position(area, 0.5, 0.0);
            let text = Text::new("low side", [x + 10.0, y - 8.0], Anchor::Start, 11.5, Colour::QUIET_TEXT);
            let marker = Shape::Marker([x, y - 11.0], Marker::TriangleDown, Colour::QUIET_TEXT);
            shapes.push(Shape::Group("low-side", vec![marker, Shape::Text(text)]));
        }
        let (colour, _) = series_style(0);
        let (end_colour, end_marker) = series_style(1);
        let places = without_near(path.iter().map(|place| position(*place)));
        let end = position(path[path.len() - 1]);
        let line = Shape::Polyline(places, Stroke::solid(colour, 1.0));
        shapes.push(Shape::Group("series", vec![line, Shape::Marker(end, end_marker, end_colour)]));
    }
}

/// The positions that are distinguishable from the one before.
fn without_near(places: impl Iterator<Item = Position>) -> Vec<Position> {
    let mut kept: Vec<Position> = Vec::new();
    for [x, y] in places {
        if kept.last().is_none_or(|last| (x - last[0]).hypot(y - last[1]) >= NEAR) {
            kept.push([x, y]);
        }
    }
    kept
}

#[cfg(test)]
mod tests {
    use roxmltree::{Document, Node};
    use std::f64::consts::FRAC_PI_2;

    use super::*;

    /// The points of the polyline in a group.
    fn points(svg: &str, class: &str) -> Vec<Position> {
        let document = Document::parse(svg).expect("well-formed XML");
        let group =
            document.descendants().find(|node| node.attribute("class") == Some(class)).expect("the group");
        let line: Node = group.children().find(|node| node.has_tag_name("polyline")).expect("a line");
        let number = |text: &str| text.parse::<f64>().expect("a number");
        let pairs = line.attribute("points").expect("points").split(' ');
        pairs.map(|pair| pair.split_once(',').map(|(x, y)| [number(x), number(y)]).expect("a pair")).collect()
    }

    fn middle(circle: &[Position]) -> Position {
        let extent = |k: usize| {
            let values = || circle.iter().map(|place| place[k]);
            f64::midpoint(values().fold(f64::INFINITY, f64::min), values().fold(f64::NEG_INFINITY, f64::max))
        };
        [extent(0), extent(1)]
    }

    #[test]
    fn the_low_side_is_down_and_forward_whirl_turns_clockwise() {
        // From the low side, which lies a quarter turn from u, a quarter turn forwards.
        let low_side = FRAC_PI_2;
        let path: Vec<[f64; 2]> = (0..=25)
            .map(|k| {
                let angle = low_side + FRAC_PI_2 * f64::from(k) / 25.0;
                [30.0 * angle.cos(), 30.0 * angle.sin()]
            })
            .collect();
        let plot = OrbitPlot {
            path,
            wall: Some(38.0),
            low_side: Some(low_side),
            unit: "mm".to_owned(),
            ..OrbitPlot::default()
        };
        let svg = plot.svg();
        let [x, y] = middle(&points(&svg, "wall"));
        let (start, end) = (points(&svg, "series")[0], *points(&svg, "series").last().expect("points"));
        assert!((start[0] - x).abs() < 0.1 && start[1] > y + 100.0, "it starts below the middle: {start:?}");
        assert!((end[1] - y).abs() < 0.4 && end[0] < x - 100.0, "clockwise of below is left: {end:?}");
        assert!(svg.contains("low side"));
    }

    #[test]
    fn both_axes_have_one_scale_and_the_wall_is_round() {
        let plot = OrbitPlot { path: vec![[1.0, 0.0], [0.0, 5.0]], wall: Some(38.0), ..OrbitPlot::default() };
        let svg = plot.svg();
        let circle = points(&svg, "wall");
        let [x, y] = middle(&circle);
        let radii: Vec<f64> = circle.iter().map(|place| (place[0] - x).hypot(place[1] - y)).collect();
        let spread =
            radii.iter().copied().fold(0.0, f64::max) - radii.iter().copied().fold(f64::INFINITY, f64::min);
        assert!(spread < 0.02, "{spread}");
        let path = points(&svg, "series");
        let scale = radii[0] / 38.0;
        assert!(((path[0][1] - y) / scale - 1.0).abs() < 0.01, "u points down without a low side");
        assert!(((x - path[1][0]) / scale - 5.0).abs() < 0.01);
        assert!(!svg.contains("low side</text>"));
    }

    #[test]
    fn odd_paths_are_drawn_within_the_page() {
        let cases: [&[[f64; 2]]; 4] =
            [&[], &[[0.0, 0.0]], &[[f64::NAN, 1.0]], &[[f64::MAX, 0.0], [0.0, 1e-300]]];
        for path in cases {
            for wall in [None, Some(0.0), Some(f64::NAN), Some(38.0)] {
                let plot = OrbitPlot { path: path.to_vec(), wall, ..OrbitPlot::default() };
                let svg = plot.svg();
                assert!(
                    Document::parse(&svg).is_ok() && !svg.contains("NaN") && !svg.contains("inf"),
                    "{path:?}"
                );
                assert!(plot.png(200).is_ok());
            }
        }
    }

    #[test]
    fn an_orbit_that_rests_is_a_few_points() {
        let path = (0..20_000).map(|k| [10.0 + 1e-6 * f64::from(k % 7), 3.0]).collect();
        let plot = OrbitPlot { path, wall: Some(38.0), ..OrbitPlot::default() };
        assert_eq!(points(&plot.svg(), "series").len(), 1);
    }
}
