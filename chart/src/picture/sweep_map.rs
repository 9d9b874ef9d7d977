//! One column of a sweep over two of its parameters.

use std::collections::HashSet;

use super::axis::{self, PlotAxis, Tick};
use super::drawing::{Drawing, Mosaic, Shape};
use super::geometry::{Colour, Position, Rectangle, Stroke};
use super::heading::{self, Entry};
use super::marker::{KINDS, Marker, kind_colour};
use super::plot_area;
use super::png::PictureError;
use super::text::{self, Anchor, Text, Weight};

const PAGE_WIDTH: f64 = 800.0;
const PLOT_HEIGHT: f64 = 420.0;
/// Room for the scale of colours at the right.
const SCALE_ROOM: f64 = 130.0;
const SCALE_WIDTH: f64 = 18.0;
/// Steps of the scale of colours.
const SCALE_STEPS: usize = 128;
const VALUE_SIZE: f64 = 12.0;
/// From the corner of a cell to the middle of its mark.
const MARK_INSET: f64 = 10.0;
/// Points up to which each has a shape of its own; more are a mosaic, so that the size of the picture has a bound.
const MANY_POINTS: usize = 2000;
/// Columns and rows of a mosaic of even cells, at most: one a unit of the page.
const MOST_CELLS: [usize; 2] = [640, 420];
/// Side of the cells of a mosaic whose points are not even \[page units\].
const TILE: f64 = 2.0;
/// Between marks on a mosaic, at least \[page units\].
const MARK_DISTANCE: f64 = 18.0;

/// The scale of colours viridis (van der Walt and Smith): even to the eye, in grey print too.
const VIRIDIS: [[f64; 3]; 9] = [
    [68.0, 1.0, 84.0],
    [71.0, 44.0, 122.0],
    [59.0, 81.0, 139.0],
    [44.0, 113.0, 142.0],
    [33.0, 144.0, 141.0],
    [39.0, 173.0, 129.0],
    [92.0, 200.0, 99.0],
    [170.0, 220.0, 50.0],
    [253.0, 231.0, 37.0],
];

/// One value a point of a sweep, by colour, over two parameters.
///
/// If the points fill a grid, cells stand for its values, of equal size or to scale; else each point is a mark at its place. A
/// point without a value is crossed out; one that stands out has a diamond. More than 2000 points are a mosaic: cells without
/// text, one colour in 128 each, no thinner than a unit of the page, or squares at the points' places, of which the last one shows.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct SweepMap {
    /// The title; may be empty.
    pub title: String,
    /// A line of smaller text below it; may be empty.
    pub subtitle: String,
    /// The parameter across, with its unit.
    pub x_label: String,
    /// The parameter vertical, with its unit.
    pub y_label: String,
    /// Quantity that the colours show, with its unit.
    pub value_label: String,
    /// The points.
    pub points: Vec<MapPoint>,
    /// Words that the values are the indices of, in the order of the legend; none if values are numbers.
    pub words: Vec<Word>,
    /// Spacing of the values of a parameter on a grid.
    pub spacing: Spacing,
}

/// A word with the colour of its points.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Word {
    /// The word.
    pub text: String,
    /// Red, green and blue in sRGB.
    pub colour: [u8; 3],
}

impl Word {
    /// A word of a colour by its number, below [`SweepMap::MOST_WORDS`].
    pub fn numbered(number: usize, text: String) -> Self {
        let Colour(red, green, blue) = kind_colour(number);
        Self { text, colour: [red, green, blue] }
    }

    fn ground(&self) -> Colour {
        let [red, green, blue] = self.colour;
        Colour(red, green, blue)
    }
}

/// Spacing of the values of a parameter on its axis.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Spacing {
    /// At equal distances, whatever the values.
    #[default]
    Even,
    /// As far apart as the values are. A cell reaches half-way to the next value.
    ToScale,
}

/// One point of a sweep.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct MapPoint {
    /// The parameter across.
    pub x: f64,
    /// The parameter vertical.
    pub y: f64,
    /// The value; not finite if there is none.
    pub value: f64,
    /// True if the point stands out among the others: it gets a diamond.
    pub is_marked: bool,
    /// Marks a value that cannot be trusted: it gets a cross.
    pub is_doubtful: bool,
}

impl SweepMap {
    /// The most words that have colours of their own by number.
    pub const MOST_WORDS: usize = KINDS;

    /// The map as a standalone SVG 1.1 document. The same map gives the same bytes.
    pub fn svg(&self) -> String {
        self.drawing().svg()
    }

    /// The map as a PNG image of this width in pixels.
    ///
    /// # Errors
    /// [`PictureError::Size`] if the width is zero or the image would be too large.
    pub fn png(&self, width: u32) -> Result<Vec<u8>, PictureError> {
        self.drawing().png(width)
    }

    /// The map laid out on a page 800 units wide.
    pub fn drawing(&self) -> Drawing {
        let points: Vec<&MapPoint> =
            self.points.iter().filter(|point| point.x.is_finite() && point.y.is_finite()).collect();
        let places = Places::of(&points, self.spacing);
        let (x_ticks, mut y_ticks) = places.as_ref().map(Places::ticks).unwrap_or_default();
        if self.y_label.is_empty() {
            // A single row, over one parameter.
            y_ticks.clear();
        }
        let (left, right) = (plot_area::left_margin(&y_ticks), PAGE_WIDTH - SCALE_ROOM);
        let mut shapes = Vec::new();
        let (title, bottom) = heading::title(&mut shapes, &self.title, left, PAGE_WIDTH - 24.0);
        let bottom = heading::subtitle(&mut shapes, &self.subtitle, left, PAGE_WIDTH - 24.0, bottom);
        let scale = self.colours(&points);
        let bottom = heading::legend(&mut shapes, self.legend(&points), left, right, bottom);
        let top = bottom + 10.0;
        let area = Rectangle { left, top, right, bottom: top + PLOT_HEIGHT };

        let mut axes = plot_area::axes(&area, &x_ticks, &y_ticks, &self.x_label, &self.y_label);
        match (&places, &scale) {
            (Some(places), Some(scale)) => {
                shapes.push(places.draw(&area, &points, scale, &x_ticks, &y_ticks));
                if let Colours::Numbers(axis) = scale {
                    shapes.push(self.scale(&area, axis));
                }
            }
            _ => {
                shapes.push(heading::no_data(plot_area::position(&area, 0.5, 0.5)));
                axes = plot_area::axes(&area, &[], &[], &self.x_label, &self.y_label);
            }
        }
        shapes.push(axes);
        Drawing { title, width: PAGE_WIDTH, height: area.bottom + plot_area::BELOW, shapes }
    }

    fn colours(&self, points: &[&MapPoint]) -> Option<Colours<'_>> {
        if self.words.is_empty() {
            PlotAxis::tight(points.iter().map(|point| point.value)).map(Colours::Numbers)
        } else {
            Some(Colours::Words(&self.words))
        }
    }

    /// The words by their colours, and on a mosaic cells without a value.
    fn legend(&self, points: &[&MapPoint]) -> Vec<Entry> {
        let label = &self.value_label;
        let word = |word: &Word| Entry::area(format!("{label}: {}", word.text), word.ground());
        let lacks = points.len() > MANY_POINTS && points.iter().any(|point| !point.value.is_finite());
        let none = lacks.then(|| Entry::area("no value".to_owned(), Colour::GRID));
        self.words.iter().map(word).chain(none).collect()
    }

    /// Scale of the colours, at the right of the plot.
    fn scale(&self, area: &Rectangle, axis: &PlotAxis) -> Shape {
        let bar = Rectangle { left: area.right + 22.0, right: area.right + 22.0 + SCALE_WIDTH, ..*area };
        let step = bar.height() / SCALE_STEPS as f64;
        let mut shapes: Vec<Shape> = (0..SCALE_STEPS)
            .map(|k| {
                let bottom = bar.bottom - step * k as f64;
                // A hair of overlap, so that nothing shines through between the steps.
                let cell = Rectangle { top: (bottom - step - 0.5).max(bar.top), bottom, ..bar };
                Shape::Filled(cell, colour((k as f64 + 0.5) / SCALE_STEPS as f64))
            })
            .collect();
        shapes.push(Shape::Rectangle(bar, Stroke::solid(Colour::FRAME, 1.0)));
        for tick in axis.ticks() {
            let y = bar.bottom - tick.fraction * bar.height();
            let at = [bar.right + 6.0, y + plot_area::TICK_SIZE * 0.36];
            let label = tick.label.map(|label| {
                Shape::Text(Text::new(label, at, Anchor::Start, plot_area::TICK_SIZE, Colour::TEXT))
            });
            shapes.extend(label);
        }
        let name = text::line(&self.value_label, 13.0, Weight::Regular, area.height());
        let at = [PAGE_WIDTH - 14.0, f64::midpoint(area.top, area.bottom)];
        shapes.push(Shape::Text(Text {
            upwards: true,
            ..Text::new(name, at, Anchor::Middle, 13.0, Colour::TEXT)
        }));
        Shape::Group("scale", shapes)
    }
}

/// Colours of values.
enum Colours<'m> {
    Numbers(PlotAxis),
    Words(&'m [Word]),
}

impl Colours<'_> {
    /// The colour of a value, if there is a value.
    fn of(&self, value: f64) -> Option<Colour> {
        match self {
            Colours::Numbers(axis) => axis.fraction(value).map(colour),
            Colours::Words(words) => {
                value.is_finite().then(|| words.get(value as usize)).flatten().map(Word::ground)
            }
        }
    }

    /// The same in so few colours that neighbours often share theirs.
    fn coarse(&self, value: f64) -> Option<Colour> {
        let steps = SCALE_STEPS as f64 - 1.0;
        match self {
            Colours::Numbers(axis) => axis.fraction(value).map(|part| colour((part * steps).round() / steps)),
            Colours::Words(_) => self.of(value),
        }
    }

    fn text(&self, value: f64) -> String {
        match self {
            Colours::Numbers(_) => axis::three_digits(value),
            Colours::Words(words) => {
                words.get(value as usize).map(|word| word.text.clone()).unwrap_or_default()
            }
        }
    }
}

/// Positions of points.
enum Places {
    /// Cells of a grid.
    Grid(Cells, Cells),
    /// Anywhere.
    Scattered(PlotAxis, PlotAxis),
}

/// The cells along one axis of a grid.
struct Cells {
    /// The values, in order.
    values: Vec<f64>,
    /// Position of each value along the axis, from 0 to 1.
    middles: Vec<f64>,
    /// The ends of the cells along the axis, one more than there are values.
    edges: Vec<f64>,
}

impl Cells {
    fn new(values: Vec<f64>, spacing: Spacing) -> Self {
        let count = values.len();
        let [first, last] = [values[0], values[count - 1]];
        if spacing == Spacing::Even || count < 2 || !(last - first).is_finite() {
            let edges: Vec<f64> = (0..=count).map(|index| index as f64 / count as f64).collect();
            let middles = (0..count).map(|index| (index as f64 + 0.5) / count as f64).collect();
            return Self { values, middles, edges };
        }
        let mut edges = vec![first - 0.5 * (values[1] - first)];
        edges.extend(values.windows(2).map(|pair| f64::midpoint(pair[0], pair[1])));
        edges.push(last + 0.5 * (last - values[count - 2]));
        let (low, high) = (edges[0], edges[count]);
        let place = |value: &f64| (value - low) / (high - low);
        let (middles, edges) = (values.iter().map(place).collect(), edges.iter().map(place).collect());
        Self { values, middles, edges }
    }

    /// A tick at each value; labels are at least this part of the axis apart.
    fn ticks(&self, apart: f64) -> Vec<Tick> {
        let mut last = f64::NEG_INFINITY;
        let tick = |(fraction, value): (&f64, &f64)| {
            let is_clear = fraction - last >= apart * (1.0 - 1e-9);
            if is_clear {
                last = *fraction;
            }
            Tick { fraction: *fraction, label: is_clear.then(|| axis::three_digits(*value)) }
        };
        self.middles.iter().zip(&self.values).map(tick).collect()
    }

    /// The index of the cell at this part of the axis.
    fn at(&self, fraction: f64) -> usize {
        (self.edges.partition_point(|edge| *edge <= fraction).max(1) - 1).min(self.values.len() - 1)
    }

    /// True if all cells are of one size.
    fn is_even(&self) -> bool {
        let even = 1.0 / self.values.len() as f64;
        self.edges.windows(2).all(|pair| (pair[1] - pair[0] - even).abs() < 1e-6 * even)
    }
}

impl Places {
    fn of(points: &[&MapPoint], spacing: Spacing) -> Option<Self> {
        let (xs, ys) =
            (distinct(points.iter().map(|point| point.x)), distinct(points.iter().map(|point| point.y)));
        let is_grid = xs.len().saturating_mul(ys.len()) <= 2 * points.len();
        if is_grid && !points.is_empty() {
            return Some(Places::Grid(Cells::new(xs, spacing), Cells::new(ys, spacing)));
        }
        Some(Places::Scattered(PlotAxis::linear(xs)?, PlotAxis::linear(ys)?))
    }

    fn ticks(&self) -> (Vec<Tick>, Vec<Tick>) {
        match self {
            Places::Grid(xs, ys) => (xs.ticks(0.075), ys.ticks(1.0 / 16.0)),
            Places::Scattered(x, y) => (x.ticks(), y.ticks()),
        }
    }

    fn draw(
        &self,
        area: &Rectangle,
        points: &[&MapPoint],
        scale: &Colours,
        x_ticks: &[Tick],
        y_ticks: &[Tick],
    ) -> Shape {
        let mut shapes = Vec::new();
        if points.len() > MANY_POINTS {
            if let Places::Scattered(..) = self {
                shapes.push(plot_area::grid(area, x_ticks, y_ticks));
            }
            shapes.push(Shape::Mosaic(self.mosaic(area, points, scale)));
            shapes.extend(self.distant_marks(area, points));
            return Shape::Group("map", shapes);
        }
        match self {
            Places::Grid(xs, ys) => {
                let mut marks = Vec::new();
                for point in points {
                    let cell = cell_of(area, xs, ys, point);
                    draw_cell(&mut shapes, &cell, point.value, scale);
                    if point.is_marked {
                        // In the corner, clear of the value; in the middle of a cell that is too small for both.
                        let (x, y) =
                            (MARK_INSET.min(0.5 * cell.width()), MARK_INSET.min(0.5 * cell.height()));
                        let at = [cell.left + x, cell.top + y];
                        marks.push(Shape::Marker(at, Marker::Diamond, Colour::TEXT));
                    }
                    if point.is_doubtful {
                        let (x, y) =
                            (MARK_INSET.min(0.5 * cell.width()), MARK_INSET.min(0.5 * cell.height()));
                        let at = [cell.left + cell.width() - x, cell.top + y];
                        marks.push(Shape::Marker(at, Marker::Cross, Colour::TEXT));
                    }
                }
                // Above all cells, which small ones would else cover.
                shapes.append(&mut marks);
            }
            Places::Scattered(..) => {
                shapes.push(plot_area::grid(area, x_ticks, y_ticks));
                for point in points {
                    let Some(at) = self.position(area, point) else { continue };
                    shapes.push(match scale.of(point.value) {
                        Some(colour) => {
                            let marker = if point.is_marked { Marker::Diamond } else { Marker::Circle };
                            let marker = if point.is_doubtful { Marker::Cross } else { marker };
                            Shape::Marker(at, marker, colour)
                        }
                        None => Shape::Marker(at, Marker::Cross, Colour::FRAME),
                    });
                }
            }
        }
        Shape::Group("map", shapes)
    }

    /// The middle of a point's place on the page.
    fn position(&self, area: &Rectangle, point: &MapPoint) -> Option<Position> {
        match self {
            Places::Grid(xs, ys) => {
                let (x, y) = (xs.middles[rank(&xs.values, point.x)], ys.middles[rank(&ys.values, point.y)]);
                Some(plot_area::position(area, x, y))
            }
            Places::Scattered(x, y) => {
                Some(plot_area::position(area, x.fraction(point.x)?, y.fraction(point.y)?))
            }
        }
    }

    fn mosaic(&self, area: &Rectangle, points: &[&MapPoint], scale: &Colours) -> Mosaic {
        let colour = |point: &MapPoint| Some(scale.coarse(point.value).unwrap_or(Colour::GRID));
        let tiles = [area.width(), area.height()].map(|length| (length / TILE).ceil() as usize);
        match self {
            Places::Grid(xs, ys) => {
                let mut grid = vec![None; xs.values.len() * ys.values.len()];
                for point in points {
                    grid[rank(&ys.values, point.y) * xs.values.len() + rank(&xs.values, point.x)] =
                        colour(point);
                }
                let size = |cells: &Cells, most: usize, tiles: usize| match cells.is_even() {
                    true => cells.values.len().min(most),
                    false => tiles,
                };
                let (columns, rows) = (size(xs, MOST_CELLS[0], tiles[0]), size(ys, MOST_CELLS[1], tiles[1]));
                let middle = |index: usize, count: usize| (index as f64 + 0.5) / count as f64;
                let across: Vec<usize> = (0..columns).map(|column| xs.at(middle(column, columns))).collect();
                let cells: Vec<Option<Colour>> = (0..rows)
                    .rev()
                    .map(|row| ys.at(middle(row, rows)) * xs.values.len())
                    .flat_map(|start| across.iter().map(move |column| start + column))
                    .map(|cell| grid[cell])
                    .collect();
                Mosaic::new(*area, columns, &cells)
            }
            Places::Scattered(..) => {
                let [columns, rows] = tiles;
                let mut cells = vec![None; columns * rows];
                for point in points {
                    let Some([x, y]) = self.position(area, point) else { continue };
                    let column = ((x - area.left) / area.width() * columns as f64) as usize;
                    let row = ((y - area.top) / area.height() * rows as f64) as usize;
                    cells[row.min(rows - 1) * columns + column.min(columns - 1)] = colour(point);
                }
                Mosaic::new(*area, columns, &cells)
            }
        }
    }

    /// Diamonds at marked points and crosses at doubtful ones, but for those that would cover another.
    fn distant_marks(&self, area: &Rectangle, points: &[&MapPoint]) -> Vec<Shape> {
        let mut taken = HashSet::new();
        let mark = |point: &MapPoint| match (point.is_doubtful, point.is_marked) {
            (true, _) => Some(Marker::Cross),
            (false, true) => Some(Marker::Diamond),
            (false, false) => None,
        };
        let marked = points.iter().filter_map(|point| Some((self.position(area, point)?, mark(point)?)));
        let clear = marked.filter(|(at, _)| taken.insert(at.map(|place| (place / MARK_DISTANCE) as i64)));
        clear.map(|(at, marker)| Shape::Marker(at, marker, Colour::TEXT)).collect()
    }
}

fn cell_of(area: &Rectangle, xs: &Cells, ys: &Cells, point: &MapPoint) -> Rectangle {
    let (column, row) = (rank(&xs.values, point.x), rank(&ys.values, point.y));
    let [left, bottom] = plot_area::position(area, xs.edges[column], ys.edges[row]);
    let [right, top] = plot_area::position(area, xs.edges[column + 1], ys.edges[row + 1]);
    Rectangle { left, top, right, bottom }
}

fn draw_cell(shapes: &mut Vec<Shape>, cell: &Rectangle, value: f64, scale: &Colours) {
    let Some(ground) = scale.of(value) else {
        let stroke = Stroke::solid(Colour::GRID, 1.0);
        shapes.push(Shape::Polyline(vec![[cell.left, cell.top], [cell.right, cell.bottom]], stroke));
        shapes.push(Shape::Polyline(vec![[cell.left, cell.bottom], [cell.right, cell.top]], stroke));
        return;
    };
    shapes.push(Shape::Filled(*cell, ground));
    let text = scale.text(value);
    if text::room(&text, VALUE_SIZE, Weight::Regular) < cell.width() - 6.0 && VALUE_SIZE < cell.height() - 4.0
    {
        let at =
            [f64::midpoint(cell.left, cell.right), f64::midpoint(cell.top, cell.bottom) + VALUE_SIZE * 0.36];
        let colour = if lightness(ground) < DARK { Colour::WHITE } else { Colour::TEXT };
        shapes.push(Shape::Text(Text::new(text, at, Anchor::Middle, VALUE_SIZE, colour)));
    }
}

/// Grounds below this lightness have white text.
const DARK: f64 = 135.0;

/// Lightness of a colour, from 0 to 255, by the weights of ITU-R BT.709.
fn lightness(Colour(red, green, blue): Colour) -> f64 {
    0.2126 * f64::from(red) + 0.7152 * f64::from(green) + 0.0722 * f64::from(blue)
}

/// The values that occur, in order.
fn distinct(values: impl Iterator<Item = f64>) -> Vec<f64> {
    let mut values: Vec<f64> = values.collect();
    values.sort_by(f64::total_cmp);
    values.dedup();
    values
}

fn rank(values: &[f64], value: f64) -> usize {
    values.partition_point(|other| *other < value)
}

/// A colour of the scale: 0 is its low end, 1 its high end.
fn colour(fraction: f64) -> Colour {
    let place = fraction.clamp(0.0, 1.0) * (VIRIDIS.len() - 1) as f64;
    let index = (place as usize).min(VIRIDIS.len() - 2);
    let part = place - index as f64;
    let mix =
        |k: usize| (VIRIDIS[index][k] + part * (VIRIDIS[index + 1][k] - VIRIDIS[index][k])).round() as u8;
    Colour(mix(0), mix(1), mix(2))
}

#[cfg(test)]
mod tests {
    use resvg::tiny_skia::Pixmap;
    use roxmltree::Document;

    use super::*;

    fn map(points: Vec<MapPoint>) -> SweepMap {
        SweepMap { points, value_label: "orbit size [mm]".to_owned(), ..SweepMap::default() }
    }

    /// x times 10 plus y at 3 by 4 places, uneven across.
    fn grid() -> Vec<MapPoint> {
        let places = [0.01, 0.04, 0.06].into_iter().enumerate();
        places
            .flat_map(|(i, x)| {
                (0..4).map(move |j| MapPoint {
                    x,
                    y: f64::from(j),
                    value: (10 * i as i32 + j).into(),
                    is_marked: false,
                    is_doubtful: false,
                })
            })
            .collect()
    }

    #[test]
    fn every_cell_has_the_colour_of_its_value() {
        let points = grid();
        let map = map(points.clone());
        let drawing = map.drawing();
        let members = |wanted: &str| -> Vec<Shape> {
            let found = drawing.shapes.iter().find_map(|shape| match shape {
                Shape::Group(class, members) if *class == wanted => Some(members.clone()),
                _ => None,
            });
            found.expect("the group")
        };
        let cells: Vec<(Rectangle, Colour)> = members("map")
            .into_iter()
            .filter_map(|shape| match shape {
                Shape::Filled(cell, colour) => Some((cell, colour)),
                _ => None,
            })
            .collect();
        assert_eq!(cells.len(), 12);
        let image = Pixmap::decode_png(&map.png(800).expect("an image")).expect("a PNG");
        for ((cell, expected), point) in cells.iter().zip(&points) {
            assert_eq!(*expected, colour(point.value / 23.0));
            let pixel = image.pixel(cell.left as u32 + 4, cell.top as u32 + 4).expect("within the image");
            assert_eq!(Colour(pixel.red(), pixel.green(), pixel.blue()), *expected);
        }
        // Larger x to the right, larger y higher up.
        assert!(cells[0].0.left < cells[4].0.left && cells[4].0.left < cells[8].0.left);
        assert!(cells[0].0.top > cells[1].0.top && cells[0].0.left == cells[1].0.left);
    }

    #[test]
    fn the_scale_of_colours_gets_lighter_all_the_way() {
        for k in 0..100 {
            let (below, above) = (f64::from(k) / 100.0, f64::from(k + 1) / 100.0);
            assert!(lightness(colour(below)) < lightness(colour(above)), "at {below}");
        }
        assert_eq!((colour(-1.0), colour(2.0)), (colour(0.0), colour(1.0)));
    }

    #[test]
    fn a_design_without_a_grid_is_scattered() {
        let points: Vec<MapPoint> = (0..40)
            .map(|k| (f64::from(k), f64::from(k * 17 % 40)))
            .map(|(x, y)| MapPoint { x, y, value: x + y, ..MapPoint::default() })
            .collect();
        let svg = map(points).svg();
        let document = Document::parse(&svg).expect("well-formed XML");
        assert_eq!(
            document.descendants().filter(|node| node.attribute("class") == Some("marker")).count(),
            40
        );
    }

    #[test]
    fn highlighted_points_have_a_diamond_above_all_cells() {
        let mut points = grid();
        assert!(!map(points.clone()).svg().contains(r#"class="marker""#));
        for marked in [2, 7] {
            points[marked].is_marked = true;
        }
        let svg = map(points).svg();
        assert_eq!(svg.matches(r#"class="marker""#).count(), 2);
        let last_cell = svg[..svg.find(r#"class="scale""#).expect("a scale")].rfind("<rect").expect("cells");
        assert!(svg.find(r#"class="marker""#).expect("a marker") > last_cell);
    }

    #[test]
    fn points_without_a_value_are_crossed_out_and_odd_values_stay_on_the_page() {
        let mut points = grid();
        points[5].value = f64::NAN;
        let crossed = map(points).svg();
        assert_eq!(crossed.matches("<polyline").count(), 2);
        let cases = [
            vec![],
            vec![MapPoint { x: f64::NAN, value: 1.0, ..MapPoint::default() }],
            vec![MapPoint { x: 1.0, y: 1.0, value: f64::NAN, is_marked: true, is_doubtful: true }],
            vec![
                MapPoint { x: f64::MAX, y: f64::MIN, value: 1e300, is_marked: true, is_doubtful: true },
                MapPoint { value: -1e300, ..MapPoint::default() },
            ],
            vec![MapPoint::default(); 3],
        ];
        for case in cases {
            let map = map(case.clone());
            let svg = map.svg();
            assert!(
                Document::parse(&svg).is_ok() && !svg.contains("NaN") && !svg.contains("inf"),
                "{case:?}"
            );
            assert!(map.png(300).is_ok());
        }
    }

    fn cells(map: &SweepMap) -> Vec<Rectangle> {
        let drawing = map.drawing();
        let group = drawing.shapes.iter().find_map(|shape| match shape {
            Shape::Group("map", members) => Some(members.clone()),
            _ => None,
        });
        let filled = group.expect("a map").into_iter().filter_map(|shape| match shape {
            Shape::Filled(cell, _) => Some(cell),
            _ => None,
        });
        filled.collect()
    }

    #[test]
    fn uneven_values_are_drawn_evenly_or_to_scale() {
        let point = |x: f64| MapPoint { x, value: x, ..MapPoint::default() };
        let points: Vec<MapPoint> = [1.0, 2.0, 5.0, 10.0].map(point).into();
        let widths = |spacing| -> Vec<f64> {
            let cells = cells(&SweepMap { spacing, ..map(points.clone()) });
            let whole: f64 = cells.iter().map(Rectangle::width).sum();
            cells.iter().map(|cell| cell.width() / whole).collect()
        };
        let near = |widths: Vec<f64>, expected: [f64; 4]| {
            assert!(widths.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-9), "{widths:?}");
        };
        near(widths(Spacing::Even), [0.25; 4]);
        // Ends half-way between the values: 0.5, 1.5, 3.5, 7.5, 12.5.
        near(widths(Spacing::ToScale), [1.0, 2.0, 4.0, 5.0].map(|width| width / 12.0));
        let ticks = Cells::new(vec![1.0, 2.0, 5.0, 10.0], Spacing::ToScale).ticks(0.0);
        for (tick, value) in ticks.iter().zip([1.0, 2.0, 5.0, 10.0]) {
            assert!((tick.fraction - (value - 0.5) / 12.0).abs() < 1e-12, "{tick:?}");
        }
    }

    #[test]
    fn words_have_colours_and_a_legend_but_no_scale() {
        let words =
            [(0, "failed"), (1, "succeeded")].map(|(number, text)| Word::numbered(number, text.to_owned()));
        let value = |index: usize| (index % 2) as f64;
        let points = grid().into_iter().enumerate().map(|(k, point)| MapPoint { value: value(k), ..point });
        let map = SweepMap { points: points.collect(), words: words.into(), ..SweepMap::default() };
        let svg = map.svg();
        assert!(
            svg.contains(": failed<") && svg.contains(": succeeded<") && !svg.contains(r#"class="scale""#)
        );
        let Colour(red, green, blue) = kind_colour(1);
        let fill = format!("#{red:02x}{green:02x}{blue:02x}");
        assert_eq!(svg.matches(&format!(r#"fill="{fill}"/>"#)).count(), 6 + 1, "six cells and the legend");
    }

    /// Noise, which has no runs of one colour.
    fn noise(index: usize) -> f64 {
        (index as f64 * 0.618_033_988_749_895).fract()
    }

    #[test]
    fn a_hundred_thousand_points_stay_below_a_megabyte() {
        let point = |index: usize, x: f64, y: f64| MapPoint {
            x: x.powi(2),
            y,
            value: if index % 10 == 3 { f64::NAN } else { (noise(index) * 7919.0).fract() },
            is_marked: index.is_multiple_of(10),
            is_doubtful: index.is_multiple_of(7),
        };
        let grid = |columns: usize| -> Vec<MapPoint> {
            let at = |index: usize| point(index, (index % columns) as f64 + 1.0, (index / columns) as f64);
            (0..100_000).map(at).collect()
        };
        let scattered = |index: usize| point(index, noise(index), (index as f64 * 0.754_877_666_2).fract());
        let designs = [grid(316), grid(1000), grid(100), (0..100_000).map(scattered).collect()];
        for (design, points) in designs.into_iter().enumerate() {
            for spacing in [Spacing::Even, Spacing::ToScale] {
                let map = SweepMap { spacing, ..map(points.clone()) };
                let size = map.svg().len();
                assert!(size < 1_000_000, "design {design}, {spacing:?}: {size} bytes");
            }
        }
    }

    #[test]
    fn a_mosaic_shows_the_colours_of_its_cells_at_their_places() {
        let points: Vec<MapPoint> = (0..60 * 50)
            .map(|index| (f64::from(index % 60), f64::from(index / 60)))
            .map(|(x, y)| MapPoint { x, y, value: x + 100.0 * y, ..MapPoint::default() })
            .collect();
        let map = map(points.clone());
        let drawing = map.drawing();
        let area = drawing.shapes.iter().find_map(|shape| match shape {
            Shape::Group("map", members) => members.iter().find_map(|member| match member {
                Shape::Mosaic(mosaic) => Some(mosaic.area),
                _ => None,
            }),
            _ => None,
        });
        let area = area.expect("a mosaic");
        let image = Pixmap::decode_png(&map.png(1600).expect("an image")).expect("a PNG");
        for point in points.iter().step_by(37) {
            let [x, y] = plot_area::position(&area, (point.x + 0.5) / 60.0, (point.y + 0.5) / 50.0);
            let pixel = image.pixel((2.0 * x) as u32, (2.0 * y) as u32).expect("within the image");
            let expected = colour(point.value / 4959.0);
            for (seen, expected) in
                [(pixel.red(), expected.0), (pixel.green(), expected.1), (pixel.blue(), expected.2)]
            {
                // Half a step of the scale changes a channel by at most 61 * 8 / 254, and each is rounded.
                assert!(seen.abs_diff(expected) <= 4, "{point:?}: {pixel:?} for {expected:?}");
            }
        }
    }
}
