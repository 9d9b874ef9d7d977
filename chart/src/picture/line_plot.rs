//! Lines over an axis: histories, spectra, profiles along the hole, and columns of a sweep along one parameter.

use super::axis::PlotAxis;
use super::drawing::{Drawing, Shape};
use super::geometry::{Colour, Position, Rectangle, Stroke};
use super::heading::{self, Entry};
use super::label::{LabelRoom, around, label_shapes};
use super::marker::{Marker, series_style};
use super::plot_area;
use super::png::PictureError;
use super::text::{self, Anchor, Weight};

const PAGE_WIDTH: f64 = 800.0;
const PLOT_HEIGHT: f64 = 380.0;
/// A plot along the hole is as tall as a page wants it.
const PAGE_WIDTH_DOWNWARDS: f64 = 620.0;
const PLOT_HEIGHT_DOWNWARDS: f64 = 600.0;
const RIGHT_MARGIN: f64 = 28.0;
const LABEL_SIZE: f64 = 11.5;
/// The widest a label becomes before it is cut.
const LABEL_WIDTH: f64 = 180.0;
/// Columns of the page, each of which shows at most a first, a lowest, a highest and a last point of a line.
const COLUMNS: usize = 900;
/// The same over all lines of a plot: with more than 20 lines each has less than the page.
const COLUMNS_OF_ALL: usize = 18_000;
/// The most points of a line that has markers; of more, markers would cover each other and the line.
const MOST_MARKERS: usize = 200;

/// Lines over one axis, each value vertical over its place across; or, downwards, each value across at its depth.
///
/// A point that is not finite breaks its line. If a line has more points than the page has room for, the extremes
/// of each column of the page stay, no gap that is thinner than a column does, and markers are left out. Without [`VerticalAxis::Depth`] the order of points is that of the axis across.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct LinePlot {
    /// The title; may be empty.
    pub title: String,
    /// A line of smaller text below it; may be empty.
    pub subtitle: String,
    /// Quantity across, with its unit.
    pub x_label: String,
    /// Quantity vertical, with its unit.
    pub y_label: String,
    /// The lines, in the order of the legend. A single line without a name has no legend.
    pub lines: Vec<Line>,
    /// Points of the lines whose values cannot be trusted: they get crosses.
    pub crosses: Vec<[f64; 2]>,
    /// Kind of values on the vertical axis.
    pub vertical: VerticalAxis,
    /// Places that are named, the most important first; those that find no room are left out.
    pub labels: Vec<Label>,
    /// Part shaded behind the lines.
    pub shade: Option<Shade>,
}

/// The parts of the axis across that lie beyond plus and minus a value.
#[derive(Debug, Clone, PartialEq)]
pub struct Shade {
    /// The value; not negative.
    pub beyond: f64,
    /// Its name in the legend.
    pub name: String,
}

/// Kind of values on the vertical axis of a [`LinePlot`].
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum VerticalAxis {
    /// Values, growing upwards.
    #[default]
    Values,
    /// Values that are not negative, growing upwards from zero.
    FromZero,
    /// Depth, growing downwards.
    Depth,
}

/// One line.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Line {
    /// Its name in the legend.
    pub name: String,
    /// Its points, across and vertical, joined in this order.
    pub points: Vec<[f64; 2]>,
    /// True if the points have markers.
    pub is_marked: bool,
}

/// A place that is named.
#[derive(Debug, Clone, PartialEq)]
pub struct Label {
    /// Position, across and vertical.
    pub at: [f64; 2],
    /// Text written there.
    pub text: String,
}

impl LinePlot {
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
        let (page_width, plot_height) = match self.vertical {
            VerticalAxis::Depth => (PAGE_WIDTH_DOWNWARDS, PLOT_HEIGHT_DOWNWARDS),
            VerticalAxis::Values | VerticalAxis::FromZero => (PAGE_WIDTH, PLOT_HEIGHT),
        };
        let axes = self.axes();
        let (x_ticks, y_ticks) = axes.map(|(x, y)| (x.ticks(), y.ticks())).unwrap_or_default();
        let (left, right) = (plot_area::left_margin(&y_ticks), page_width - RIGHT_MARGIN);
        let mut shapes = Vec::new();
        let (title, bottom) = heading::title(&mut shapes, &self.title, left, right);
        let bottom = heading::subtitle(&mut shapes, &self.subtitle, left, right, bottom);
        let bottom = heading::legend(&mut shapes, self.legend(), left, right, bottom);

        let top = bottom + 10.0;
        let area = Rectangle { left, top, right, bottom: top + plot_height };
        if let (Some((x, _)), Some(shade)) = (&axes, &self.shade) {
            shapes.push(shaded(&area, x, shade.beyond));
        }
        shapes.push(plot_area::grid(&area, &x_ticks, &y_ticks));
        shapes.push(plot_area::axes(&area, &x_ticks, &y_ticks, &self.x_label, &self.y_label));
        match axes {
            Some((x, y)) => self.data(&mut shapes, &area, &x, &y),
            None => shapes.push(heading::no_data(plot_area::position(&area, 0.5, 0.5))),
        }
        Drawing { title, width: page_width, height: area.bottom + plot_area::BELOW, shapes }
    }

    fn legend(&self) -> Vec<Entry> {
        let shade = self.shade.iter().map(|shade| Entry::area(shade.name.clone(), Colour::SHADE));
        if let [only] = self.lines.as_slice()
            && only.name.is_empty()
        {
            return shade.collect();
        }
        let entry = |(index, line): (usize, &Line)| {
            let (colour, marker) = series_style(index);
            Entry::line(
                line.name.clone(),
                colour,
                (line.is_marked && line.points.len() <= MOST_MARKERS).then_some(marker),
            )
        };
        self.lines.iter().enumerate().map(entry).chain(shade).collect()
    }

    /// The axes over all points that can be drawn; none without such a point.
    fn axes(&self) -> Option<(PlotAxis, PlotAxis)> {
        let points = || self.lines.iter().flat_map(|line| &line.points).filter(|point| is_finite(point));
        let (across, vertical) = (|| points().map(|point| point[0]), || points().map(|point| point[1]));
        let has_markers = self.lines.iter().any(|line| line.is_marked);
        Some(match self.vertical {
            VerticalAxis::Depth => (PlotAxis::linear(across())?, PlotAxis::tight(vertical())?.downwards()),
            VerticalAxis::Values if has_markers => {
                (PlotAxis::linear(across())?, PlotAxis::linear(vertical())?)
            }
            VerticalAxis::Values => (PlotAxis::tight(across())?, PlotAxis::linear(vertical())?),
            VerticalAxis::FromZero => (PlotAxis::tight(across())?, PlotAxis::from_zero(vertical())?),
        })
    }

    fn data(&self, shapes: &mut Vec<Shape>, area: &Rectangle, x: &PlotAxis, y: &PlotAxis) {
        let position =
            |point: &[f64; 2]| Some(plot_area::position(area, x.fraction(point[0])?, y.fraction(point[1])?));
        let mut room = LabelRoom::new(*area);
        let width = if self.lines.len() > 1 { 1.4 } else { 1.6 };
        for (index, line) in self.lines.iter().enumerate() {
            let (colour, marker) = series_style(index);
            let mut members = Vec::new();
            let page = Columns {
                is_downwards: self.vertical == VerticalAxis::Depth,
                count: COLUMNS.min(COLUMNS_OF_ALL / self.lines.len()).max(1),
                area,
            };
            for places in
                page.pieces(line.points.iter().map(|point| position(point).filter(|_| is_finite(point))))
            {
                let places = page.thinned(places);
                room.avoid(&places);
                members.push(Shape::Polyline(places, Stroke::solid(colour, width)));
            }
            if line.is_marked && line.points.len() <= MOST_MARKERS {
                let places = line.points.iter().filter_map(position);
                members.extend(places.map(|at| Shape::Marker(at, marker, colour)));
            }
            shapes.push(Shape::Group("series", members));
        }
        let crosses = self.crosses.iter().filter(|point| is_finite(point)).filter_map(position);
        let crosses: Vec<_> = crosses.map(|at| Shape::Marker(at, Marker::Cross, Colour::TEXT)).collect();
        if !crosses.is_empty() {
            shapes.push(Shape::Group("doubtful", crosses));
        }
        let labels = self.labels.iter().filter_map(|label| Some((position(&label.at)?, &label.text)));
        let labels = labels.filter_map(|(at, text)| place_label(&mut room, at, text)).flatten().collect();
        shapes.push(Shape::Group("labels", labels));
    }
}

/// The parts of the area beyond plus and minus a value of the axis across.
fn shaded(area: &Rectangle, x: &PlotAxis, beyond: f64) -> Shape {
    let place = |value: f64| {
        let fraction = x.fraction(value).map_or(0.0, |fraction| fraction.clamp(0.0, 1.0));
        plot_area::position(area, fraction, 0.0)[0]
    };
    let parts = [Rectangle { right: place(-beyond), ..*area }, Rectangle { left: place(beyond), ..*area }];
    let parts = parts.into_iter().filter(|part| part.width() > 0.0);
    Shape::Group("shade", parts.map(|part| Shape::Filled(part, Colour::SHADE)).collect())
}

fn is_finite(point: &[f64; 2]) -> bool {
    point.iter().all(|coordinate| coordinate.is_finite())
}

/// The columns of a page that lines are drawn in; rows for lines that run downwards.
struct Columns<'a> {
    is_downwards: bool,
    count: usize,
    area: &'a Rectangle,
}

impl Columns<'_> {
    /// The coordinates of a position along the columns and across them.
    fn axes(&self) -> (usize, usize) {
        if self.is_downwards { (1, 0) } else { (0, 1) }
    }

    /// The width of a column.
    fn width(&self) -> f64 {
        let length = if self.is_downwards { self.area.height() } else { self.area.width() };
        length / self.count as f64
    }

    /// The parts of a line that are whole; of a line with more points than the columns have room for, gaps within a column count as
    /// none.
    fn pieces(&self, places: impl ExactSizeIterator<Item = Option<Position>>) -> Vec<Vec<Position>> {
        let (along, _) = self.axes();
        let bridged = if places.len() > 4 * self.count { self.width() } else { 0.0 };
        let mut pieces: Vec<Vec<Position>> = Vec::new();
        let mut is_broken = true;
        for place in places {
            let Some(place) = place else {
                is_broken = true;
                continue;
            };
            match pieces.last_mut() {
                Some(piece)
                    if !is_broken
                        || piece.last().is_some_and(|last| (place[along] - last[along]).abs() < bridged) =>
                {
                    piece.push(place);
                }
                _ => pieces.push(vec![place]),
            }
            is_broken = false;
        }
        pieces
    }

    /// The first, lowest, highest and last point of each column.
    fn thinned(&self, places: Vec<Position>) -> Vec<Position> {
        if places.len() <= 4 * self.count {
            return places;
        }
        let (along, across) = self.axes();
        let start = if self.is_downwards { self.area.top } else { self.area.left };
        let column = |place: &Position| ((place[along] - start) / self.width()).floor() as i64;
        let mut kept = Vec::new();
        for run in places.chunk_by(|a, b| column(a) == column(b)) {
            let by_value = |a: &usize, b: &usize| run[*a][across].total_cmp(&run[*b][across]);
            let extremes = [(0..run.len()).min_by(by_value), (0..run.len()).max_by(by_value)];
            let mut indices: Vec<usize> =
                [Some(0), Some(run.len() - 1)].into_iter().chain(extremes).flatten().collect();
            indices.sort_unstable();
            indices.dedup();
            kept.extend(indices.into_iter().map(|index| run[index]));
        }
        kept
    }
}

fn place_label(room: &mut LabelRoom, at: Position, label: &str) -> Option<[Shape; 2]> {
    let label = text::line(label, LABEL_SIZE, Weight::Regular, LABEL_WIDTH);
    let width = text::room(&label, LABEL_SIZE, Weight::Regular);
    let place = room.place(around(at, width, LABEL_SIZE, Marker::REACH))?;
    let anchor = if place.left >= at[0] {
        Anchor::Start
    } else if place.right <= at[0] {
        Anchor::End
    } else {
        Anchor::Middle
    };
    Some(label_shapes(label, &place, anchor, LABEL_SIZE, Colour::TEXT))
}

#[cfg(test)]
mod tests {
    use roxmltree::Document;

    use super::*;

    fn line(name: &str, points: impl IntoIterator<Item = [f64; 2]>) -> Line {
        Line { name: name.to_owned(), points: points.into_iter().collect(), is_marked: false }
    }

    fn polylines(svg: &str) -> Vec<Vec<Position>> {
        let document = Document::parse(svg).expect("well-formed XML");
        let series = document.descendants().filter(|node| node.attribute("class") == Some("series"));
        let lines = series.flat_map(|group| group.children().filter(|node| node.has_tag_name("polyline")));
        let number = |text: &str| text.parse::<f64>().expect("a number");
        lines
            .map(|line| {
                let pairs = line.attribute("points").expect("points").split(' ');
                pairs
                    .map(|pair| pair.split_once(',').map(|(x, y)| [number(x), number(y)]).expect("a pair"))
                    .collect()
            })
            .collect()
    }

    fn texts(svg: &str) -> Vec<String> {
        let document = Document::parse(svg).expect("well-formed XML");
        let texts = document.descendants().filter(|node| node.has_tag_name("text"));
        texts.map(|node| node.text().unwrap_or_default().to_owned()).collect()
    }

    #[test]
    fn a_long_history_keeps_its_extremes_on_the_page() {
        let sine = |k: u32| [f64::from(k) * 1e-3, (f64::from(k) * 0.37).sin()];
        let mut points: Vec<[f64; 2]> = (0..60_000).map(sine).collect();
        points[31_415][1] = 3.0;
        points[27_182][1] = -2.0;
        let svg = LinePlot { lines: vec![line("", points)], ..LinePlot::default() }.svg();
        let lines = polylines(&svg);
        assert_eq!(lines.len(), 1);
        assert!(lines[0].len() <= 4 * (COLUMNS + 1), "{}", lines[0].len());
        let top = lines[0].iter().copied().min_by(|a, b| a[1].total_cmp(&b[1])).expect("points");
        let bottom = lines[0].iter().copied().max_by(|a, b| a[1].total_cmp(&b[1])).expect("points");
        let (first, last) = (lines[0][0], lines[0][lines[0].len() - 1]);
        let time = |x: f64| 59.999 * (x - first[0]) / (last[0] - first[0]);
        assert!((time(top[0]) - 31.415).abs() < 0.1 && (time(bottom[0]) - 27.182).abs() < 0.1);
        assert!(!svg.contains("legend"), "one line without a name needs none");
    }

    #[test]
    fn long_lines_many_lines_and_broken_lines_stay_below_a_megabyte() {
        let value = |k: u32| (f64::from(k) * 0.37).sin();
        let marked = Line { is_marked: true, ..line("", (0..100_000).map(|k| [f64::from(k), value(k)])) };
        let broken = (0..100_000).map(|k| [f64::from(k), if k % 2 == 0 { value(k) } else { f64::NAN }]);
        let many = (0..100).map(|n| line("u", (0..10_000).map(move |k| [f64::from(k), value(k + n)])));
        for (which, lines) in [vec![marked], vec![line("", broken)], many.collect()].into_iter().enumerate() {
            let size = LinePlot { lines, ..LinePlot::default() }.svg().len();
            assert!(size < 1_000_000, "{which}: {size} bytes");
        }
        // A gap that is wide enough to be seen stays.
        let gap = (0..100_000).map(|k| [f64::from(k), if k / 1000 == 50 { f64::NAN } else { value(k) }]);
        assert_eq!(polylines(&LinePlot { lines: vec![line("", gap)], ..LinePlot::default() }.svg()).len(), 2);
    }

    #[test]
    fn depth_grows_downwards() {
        let points = [[0.01, 0.0], [0.02, 100.0], [0.03, 200.0]];
        let plot =
            LinePlot { lines: vec![line("", points)], vertical: VerticalAxis::Depth, ..LinePlot::default() };
        let places = polylines(&plot.svg()).remove(0);
        assert!(
            places.windows(2).all(|pair| pair[0][1] < pair[1][1] && pair[0][0] < pair[1][0]),
            "{places:?}"
        );
        assert!((places[1][1] - places[0][1] - (places[2][1] - places[1][1])).abs() < 0.02);
    }

    #[test]
    fn non_finite_values_break_a_line_and_are_not_drawn() {
        let points = [[0.0, 1.0], [1.0, 2.0], [2.0, f64::NAN], [3.0, 1.0], [f64::INFINITY, 1.0], [4.0, 3.0]];
        let svg = LinePlot { lines: vec![line("u", points)], ..LinePlot::default() }.svg();
        assert_eq!(polylines(&svg).iter().map(Vec::len).collect::<Vec<_>>(), [2, 1, 1]);
        assert!(!svg.contains("NaN") && !svg.contains("inf"));
        let nothing = LinePlot { lines: vec![line("u", [[f64::NAN, 1.0]])], ..LinePlot::default() };
        assert!(texts(&nothing.svg()).contains(&"no data".to_owned()));
        assert!(nothing.png(300).is_ok());
    }

    #[test]
    fn an_axis_from_zero_begins_there_and_places_are_named() {
        let points = (0..100).map(|k| [f64::from(k), if k == 40 { 9.0 } else { 1.0 }]);
        let label = Label { at: [40.0, 9.0], text: "+2.16 Hz".to_owned() };
        let plot = LinePlot {
            lines: vec![line("", points)],
            vertical: VerticalAxis::FromZero,
            labels: vec![label],
            ..LinePlot::default()
        };
        let svg = plot.svg();
        assert!(texts(&svg).contains(&"+2.16 Hz".to_owned()));
        let document = Document::parse(&svg).expect("well-formed XML");
        let frame = document
            .descendants()
            .filter(|node| node.attribute("class") == Some("axes"))
            .find_map(|axes| axes.children().find(|node| node.has_tag_name("rect")))
            .expect("a frame");
        let number = |name: &str| frame.attribute(name).expect("set").parse::<f64>().expect("a number");
        let (top, height) = (number("y"), number("height"));
        let places = polylines(&svg).remove(0);
        // 1 lies at a ninth of the height that 9 lies at, when both are counted from the frame's lower edge.
        let above = |place: Position| top + height - place[1];
        assert!((above(places[40]) / above(places[0]) - 9.0).abs() < 0.01);
    }

    #[test]
    fn unresolved_ranges_are_shaded_on_both_sides_of_the_axis() {
        let shade = |beyond: f64| Some(Shade { beyond, name: "not resolved".to_owned() });
        let points = [[-10.0, 1.0], [10.0, 1.0]];
        let shaded = |beyond: f64| {
            let plot =
                LinePlot { lines: vec![line("", points)], shade: shade(beyond), ..LinePlot::default() };
            let svg = plot.svg();
            assert!(texts(&svg).contains(&"not resolved".to_owned()));
            let document = Document::parse(&svg).expect("well-formed XML");
            let class = |node: &roxmltree::Node| node.attribute("class") == Some("shade");
            let group = document.descendants().find(class).expect("a group");
            let widths = group.children().filter_map(|node| node.attribute("width"));
            widths.map(|width| width.parse().expect("a number")).collect::<Vec<f64>>()
        };
        let (half, none) = (shaded(5.0), shaded(20.0));
        assert_eq!(half.len(), 2);
        // A quarter of the axis on each side.
        assert!((half[0] - half[1]).abs() < 0.02 && half[0] > 100.0, "{half:?}");
        assert_eq!(none, Vec::<f64>::new());
    }
}
