//! The orbit of one node in its hole.

use std::f64::consts::{FRAC_1_SQRT_2, TAU};

use super::axis::PlotAxis;
use super::drawing::{Drawing, Shape};
use super::geometry::{Colour, Position, Rectangle, Stroke};
use super::heading;
use super::marker::{Marker, series_style};
use super::plot_area;
use super::png::PictureError;
use super::simplify::simplified;
use super::text::{Anchor, Text};

const PAGE_WIDTH: f64 = 660.0;
const PLOT_SIDE: f64 = 540.0;
const LEFT_MARGIN: f64 = 88.0;
/// Straight lines that make up the circle of the wall.
const CIRCLE_SIDES: usize = 180;
/// Width of the view relative to its contents.
const MARGIN: f64 = 1.08;
/// Side of the inset that shows the whole hole next to a view of the motion alone.
const INSET_SIDE: f64 = 120.0;
/// Distance of the inset from the corner of the plot.
const INSET_GAP: f64 = 10.0;
/// A motion below this part of the hole is shown by itself unless the whole hole is requested.
const SMALL_MOTION: f64 = 0.1;
/// A motion below this part of the hole is rest: histories have seven digits, and their last one would fill the picture.
const LEAST_MOTION: f64 = 1e-5;

/// The path of one node across its hole, looking down the hole, with the low side down if there is one.
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
    /// Angle of the low side, from u towards v \[rad\]. Without one, u points down.
    pub low_side: Option<f64>,
    /// The unit of the picture, such as `mm`.
    pub unit: String,
    /// True if the motion alone fills the picture, with the whole hole as an inset; none fills it with a motion below a tenth of
    /// the hole.
    pub zoom: Option<bool>,
}

/// A square part of the cross-section.
#[derive(Debug, Clone, Copy)]
struct View {
    middle: Position,
    half: f64,
}

impl View {
    /// The smallest about these places; none if there is none.
    fn about(path: &[Position]) -> Option<Self> {
        let extent = |k: usize| {
            let values = path.iter().map(|place| place[k]);
            values.fold(None, |extent: Option<(f64, f64)>, value| {
                Some(extent.map_or((value, value), |(least, most)| (least.min(value), most.max(value))))
            })
        };
        let (x, y) = (extent(0)?, extent(1)?);
        let half = 0.5 * (x.1 - x.0).max(y.1 - y.0);
        Some(Self { middle: [f64::midpoint(x.0, x.1), f64::midpoint(y.0, y.1)], half })
    }

    fn axis(self, k: usize) -> Option<PlotAxis> {
        PlotAxis::between(self.middle[k] - self.half, self.middle[k] + self.half)
    }

    fn holds(self, place: Position) -> bool {
        (0..2).all(|k| (place[k] - self.middle[k]).abs() <= self.half)
    }
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

    /// The plot laid out on a page.
    pub fn drawing(&self) -> Drawing {
        let path: Vec<Position> = self.path.iter().filter_map(|[u, v]| self.seen(*u, *v)).collect();
        let wall = self.wall.filter(|wall| wall.is_finite()).map(f64::abs);
        let reach = path.iter().map(|[x, y]| x.abs().max(y.abs())).fold(0.0, f64::max);
        let whole = View { middle: [0.0, 0.0], half: MARGIN * reach.max(wall.unwrap_or(0.0)) };
        let motion = View::about(&path).map(|view| View { half: MARGIN * view.half, ..view });
        let is_small = |motion: &View| wall.is_some_and(|wall| motion.half < SMALL_MOTION * wall);
        let motion = motion
            .filter(|motion| self.zoom.unwrap_or_else(|| is_small(motion)))
            .filter(|motion| motion.half > LEAST_MOTION * whole.half);
        let view = motion.unwrap_or(whole);
        let (across, down) = (view.axis(0), view.axis(1));
        let ticks = |axis: Option<PlotAxis>| axis.map(|axis| axis.ticks()).unwrap_or_default();
        let (x_ticks, y_ticks) = (ticks(across), ticks(down));

        let (left, right) = (LEFT_MARGIN, LEFT_MARGIN + PLOT_SIDE);
        let mut shapes = Vec::new();
        let (title, bottom) = heading::title(&mut shapes, &self.title, left, right);
        let bottom = heading::subtitle(&mut shapes, &self.subtitle, left, right, bottom);
        let top = bottom + 10.0;
        let area = Rectangle { left, top, right, bottom: top + PLOT_SIDE };
        shapes.push(plot_area::grid(&area, &x_ticks, &y_ticks));
        let (x_name, y_name) = match self.low_side {
            Some(_) => ("to the right, looking down the hole", "above the axis of the hole"),
            None => ("against v, looking down the hole", "against u; no low side"),
        };
        let name = |text: &str| format!("{text} [{}]", self.unit);
        shapes.push(plot_area::axes(&area, &x_ticks, &y_ticks, &name(x_name), &name(y_name)));
        match across.zip(down) {
            Some(axes) if !path.is_empty() => {
                self.data(&mut shapes, &area, axes, view, &path, motion.is_none());
                if motion.is_some() {
                    shapes.push(inset(&area, whole, view, wall, &path));
                }
            }
            _ => shapes.push(heading::no_data(plot_area::position(&area, 0.5, 0.5))),
        }
        Drawing { title, width: PAGE_WIDTH, height: area.bottom + plot_area::BELOW, shapes }
    }

    /// A displacement as it is seen: across to the right and vertical. The axes u, v and the hole's direction are
    /// right-handed, so that seen down the hole v is clockwise of u.
    fn seen(&self, u: f64, v: f64) -> Option<Position> {
        let (sin, cos) = self.low_side.unwrap_or(0.0).sin_cos();
        let (along_low_side, clockwise) = (u * cos + v * sin, v * cos - u * sin);
        (u.is_finite() && v.is_finite()).then_some([-clockwise, -along_low_side])
    }

    fn data(
        &self,
        shapes: &mut Vec<Shape>,
        area: &Rectangle,
        (across, down): (PlotAxis, PlotAxis),
        view: View,
        path: &[Position],
        is_whole: bool,
    ) {
        let position = |[x, y]: Position| {
            plot_area::position(area, across.fraction(x).unwrap_or(0.5), down.fraction(y).unwrap_or(0.5))
        };
        if let Some(wall) = self.wall.filter(|wall| wall.is_finite()) {
            let mut group: Vec<Shape> = arcs(wall, view)
                .into_iter()
                .map(|arc| {
                    let places = arc.into_iter().map(position).collect();
                    Shape::Polyline(places, Stroke::dashed(Colour::QUIET_TEXT, 1.3))
                })
                .collect();
            if is_whole {
                let [x, y] = position([wall * FRAC_1_SQRT_2, wall * FRAC_1_SQRT_2]);
                let words = "string touches wall";
                let text = Text::new(words, [x + 6.0, y - 6.0], Anchor::Start, 11.5, Colour::QUIET_TEXT);
                let fits = area.right - x > 130.0;
                group.push(Shape::Text(if fits {
                    text
                } else {
                    Text { at: [area.right - 8.0, area.top + 18.0], anchor: Anchor::End, ..text }
                }));
            }
            shapes.push(Shape::Group("wall", group));
        }
        if self.low_side.is_some() {
            let [x, y] = plot_area::position(area, 0.5, 0.0);
            let text = Text::new("low side", [x + 10.0, y - 8.0], Anchor::Start, 11.5, Colour::QUIET_TEXT);
            let marker = Shape::Marker([x, y - 11.0], Marker::TriangleDown, Colour::QUIET_TEXT);
            shapes.push(Shape::Group("low-side", vec![marker, Shape::Text(text)]));
        }
        let (colour, _) = series_style(0);
        let (end_colour, end_marker) = series_style(1);
        let places = simplified(path.iter().map(|place| position(*place)));
        let end = position(path[path.len() - 1]);
        let line = Shape::Polyline(places, Stroke::solid(colour, 1.0));
        shapes.push(Shape::Group("series", vec![line, Shape::Marker(end, end_marker, end_colour)]));
    }
}

/// The parts of the wall's circle that a view holds.
fn arcs(wall: f64, view: View) -> Vec<Vec<Position>> {
    /// Number of sides that makes a circle round at any magnification that is drawn.
    const MOST_SIDES: f64 = 1e6;
    let magnification = (wall.abs() / view.half).clamp(1.0, MOST_SIDES / CIRCLE_SIDES as f64);
    let sides = CIRCLE_SIDES * magnification.ceil() as usize;
    let mut arcs = Vec::new();
    let mut arc = Vec::new();
    for side in 0..=sides {
        let (sin, cos) = (TAU * side as f64 / sides as f64).sin_cos();
        let place = [wall * cos, wall * sin];
        if view.holds(place) {
            arc.push(place);
        } else if !arc.is_empty() {
            arcs.push(std::mem::take(&mut arc));
        }
    }
    arcs.push(arc);
    arcs.retain(|arc| !arc.is_empty());
    arcs
}

/// The whole hole in a corner of the plot, with the place of the view in it.
fn inset(area: &Rectangle, whole: View, view: View, wall: Option<f64>, path: &[Position]) -> Shape {
    let right = area.right - INSET_GAP;
    let top = area.top + INSET_GAP;
    let frame = Rectangle { left: right - INSET_SIDE, top, right, bottom: top + INSET_SIDE };
    let scale = INSET_SIDE / (2.0 * whole.half);
    let middle = [f64::midpoint(frame.left, frame.right), f64::midpoint(frame.top, frame.bottom)];
    let position = |[x, y]: Position| [middle[0] + scale * x, middle[1] - scale * y];
    let mut shapes =
        vec![Shape::Filled(frame, Colour::WHITE), Shape::Rectangle(frame, Stroke::solid(Colour::FRAME, 1.0))];
    for arc in wall.iter().flat_map(|wall| arcs(*wall, whole)) {
        let places = arc.into_iter().map(position).collect();
        shapes.push(Shape::Polyline(places, Stroke::dashed(Colour::QUIET_TEXT, 1.0)));
    }
    let (colour, _) = series_style(0);
    shapes.push(Shape::Polyline(
        simplified(path.iter().map(|place| position(*place))),
        Stroke::solid(colour, 1.0),
    ));
    // A view too small to see is marked all the same.
    let half = (scale * view.half).max(2.0);
    let [x, y] = position(view.middle);
    let marked = Rectangle { left: x - half, top: y - half, right: x + half, bottom: y + half };
    shapes.push(Shape::Rectangle(marked, Stroke::solid(Colour::TEXT, 1.0)));
    let text =
        Text::new("whole hole", [frame.left, frame.bottom + 13.0], Anchor::Start, 10.5, Colour::QUIET_TEXT);
    shapes.push(Shape::Text(text));
    Shape::Group("inset", shapes)
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
        let plot = OrbitPlot {
            path: vec![[1.0, 0.0], [0.0, 5.0]],
            wall: Some(38.0),
            zoom: Some(false),
            ..OrbitPlot::default()
        };
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
    fn a_small_motion_fills_the_picture_and_the_hole_is_an_inset() {
        // A circle of 1 mm about (30, 5) in a hole of 38 mm; without a low side u points down and v to the left.
        let path: Vec<[f64; 2]> = (0..=200)
            .map(|k| {
                let (sin, cos) = (TAU * f64::from(k) / 200.0).sin_cos();
                [30.0 + cos, 5.0 + sin]
            })
            .collect();
        let plot = OrbitPlot { path, wall: Some(38.0), ..OrbitPlot::default() };
        let width = |svg: &str| {
            let xs = points(svg, "series").into_iter().map(|place| place[0]);
            xs.clone().fold(f64::NEG_INFINITY, f64::max) - xs.fold(f64::INFINITY, f64::min)
        };
        let zoomed = plot.svg();
        assert!((width(&zoomed) - PLOT_SIDE / MARGIN).abs() < 1.0, "{}", width(&zoomed));
        assert!(zoomed.contains(r#"class="inset""#) && zoomed.contains("whole hole"));
        assert!(Document::parse(&zoomed).is_ok() && plot.png(300).is_ok());
        // The ticks show its position: from 29 to 31 below the axis, from 4 to 6 to the left.
        assert!(zoomed.contains(">−30") && zoomed.contains(">−5"), "{zoomed}");

        let whole = OrbitPlot { zoom: Some(false), ..plot.clone() }.svg();
        assert!((width(&whole) - PLOT_SIDE / MARGIN / 38.0).abs() < 1.0 && !whole.contains("inset"));
        let large = OrbitPlot { wall: Some(9.0), ..plot.clone() };
        assert!(!large.svg().contains("inset"), "a motion of a ninth of the hole");
        assert!(OrbitPlot { zoom: Some(true), ..large }.svg().contains("inset"));
        let resting = OrbitPlot { path: vec![[30.0, 5.0]; 3], zoom: Some(true), ..plot };
        assert!(!resting.svg().contains("inset"), "what rests has no motion to show");
    }

    #[test]
    fn the_wall_next_to_a_small_motion_is_an_arc() {
        let arcs = arcs(38.0, View { middle: [38.0, 0.0], half: 0.1 });
        assert_eq!(arcs.len(), 2, "the circle begins in the view");
        let places: Vec<Position> = arcs.concat();
        assert!(
            places.len() > 50
                && places.iter().all(|[x, y]| (x.hypot(*y) - 38.0).abs() < 1e-9 && y.abs() <= 0.1)
        );
    }

    #[test]
    fn an_orbit_that_rests_is_a_few_points() {
        let path = (0..20_000).map(|k| [10.0 + 1e-6 * f64::from(k % 7), 3.0]).collect();
        let plot = OrbitPlot { path, wall: Some(38.0), ..OrbitPlot::default() };
        assert_eq!(points(&plot.svg(), "series").len(), 1);
    }
}
