//! One column of a sweep over two of its parameters.

use super::{
    Drawing, PictureError, PlotAxis, Tick, axis,
    drawing::{Colour, Rectangle, Shape, Stroke},
    heading,
    marker::Marker,
    plot_area,
    text::{self, Anchor, Text, Weight},
};

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
/// Values of one parameter, at most, up to which a sweep is drawn as a field of cells.
const MOST_CELLS: usize = 200;

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
/// Where the points fill a grid, cells of equal size stand for its values, whatever their distance; else each point
/// is a mark at its place. A point without a value is crossed out; one that stands out has a diamond.
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
    /// What the colours mean, with its unit.
    pub value_label: String,
    /// The points.
    pub points: Vec<MapPoint>,
}

/// One point of a sweep.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct MapPoint {
    /// The parameter across.
    pub x: f64,
    /// The parameter vertical.
    pub y: f64,
    /// The value; not finite where there is none.
    pub value: f64,
    /// Whether the point stands out among the others: it gets a diamond.
    pub is_marked: bool,
}

impl SweepMap {
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
        let places = Places::of(&points);
        let (x_ticks, y_ticks) = places.as_ref().map(Places::ticks).unwrap_or_default();
        let (left, right) = (plot_area::left_margin(&y_ticks), PAGE_WIDTH - SCALE_ROOM);
        let mut shapes = Vec::new();
        let (title, bottom) = heading::title(&mut shapes, &self.title, left, PAGE_WIDTH - 24.0);
        let bottom = heading::subtitle(&mut shapes, &self.subtitle, left, PAGE_WIDTH - 24.0, bottom);
        let top = bottom + 10.0;
        let area = Rectangle { left, top, right, bottom: top + PLOT_HEIGHT };

        let values = points.iter().map(|point| point.value);
        let scale = PlotAxis::tight(values);
        let mut axes = plot_area::axes(&area, &x_ticks, &y_ticks, &self.x_label, &self.y_label);
        match (&places, &scale) {
            (Some(places), Some(scale)) => {
                shapes.push(places.draw(&area, &points, scale, &x_ticks, &y_ticks));
                shapes.push(self.scale(&area, scale));
            }
            _ => {
                shapes.push(heading::no_data(plot_area::position(&area, 0.5, 0.5)));
                axes = plot_area::axes(&area, &[], &[], &self.x_label, &self.y_label);
            }
        }
        shapes.push(axes);
        Drawing { title, width: PAGE_WIDTH, height: area.bottom + plot_area::BELOW, shapes }
    }

    /// What the colours mean, at the right of the plot.
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

/// Where points lie.
enum Places {
    /// Cells of a grid, with the values of both parameters in order.
    Grid(Vec<f64>, Vec<f64>),
    /// Anywhere.
    Scattered(PlotAxis, PlotAxis),
}

impl Places {
    fn of(points: &[&MapPoint]) -> Option<Self> {
        let (xs, ys) =
            (distinct(points.iter().map(|point| point.x)), distinct(points.iter().map(|point| point.y)));
        let is_grid = xs.len() * ys.len() <= 2 * points.len() && xs.len().max(ys.len()) <= MOST_CELLS;
        if is_grid && !points.is_empty() {
            return Some(Places::Grid(xs, ys));
        }
        Some(Places::Scattered(PlotAxis::linear(xs)?, PlotAxis::linear(ys)?))
    }

    fn ticks(&self) -> (Vec<Tick>, Vec<Tick>) {
        match self {
            Places::Grid(xs, ys) => (cell_ticks(xs, 10), cell_ticks(ys, 16)),
            Places::Scattered(x, y) => (x.ticks(), y.ticks()),
        }
    }

    fn draw(
        &self,
        area: &Rectangle,
        points: &[&MapPoint],
        scale: &PlotAxis,
        x_ticks: &[Tick],
        y_ticks: &[Tick],
    ) -> Shape {
        let (mut shapes, mut marks) = (Vec::new(), Vec::new());
        match self {
            Places::Grid(xs, ys) => {
                let (width, height) = (area.width() / xs.len() as f64, area.height() / ys.len() as f64);
                for point in points {
                    let (column, row) = (rank(xs, point.x), rank(ys, point.y));
                    let left = area.left + width * column as f64;
                    let bottom = area.bottom - height * row as f64;
                    let cell = Rectangle { left, right: left + width, top: bottom - height, bottom };
                    draw_cell(&mut shapes, &cell, point.value, scale);
                    if point.is_marked {
                        // In the corner, clear of the value; in the middle of a cell that is too small for both.
                        let (x, y) = (MARK_INSET.min(0.5 * width), MARK_INSET.min(0.5 * height));
                        marks.push(Shape::Marker(
                            [cell.left + x, cell.top + y],
                            Marker::Diamond,
                            Colour::TEXT,
                        ));
                    }
                }
                // Above all cells, which small ones would else cover.
                shapes.append(&mut marks);
            }
            Places::Scattered(x, y) => {
                shapes.push(plot_area::grid(area, x_ticks, y_ticks));
                for point in points {
                    let (Some(x), Some(y)) = (x.fraction(point.x), y.fraction(point.y)) else { continue };
                    let at = plot_area::position(area, x, y);
                    shapes.push(match scale.fraction(point.value) {
                        Some(fraction) => {
                            let marker = if point.is_marked { Marker::Diamond } else { Marker::Circle };
                            Shape::Marker(at, marker, colour(fraction))
                        }
                        None => Shape::Marker(at, Marker::Cross, Colour::FRAME),
                    });
                }
            }
        }
        Shape::Group("map", shapes)
    }
}

fn draw_cell(shapes: &mut Vec<Shape>, cell: &Rectangle, value: f64, scale: &PlotAxis) {
    let Some(fraction) = scale.fraction(value) else {
        let stroke = Stroke::solid(Colour::GRID, 1.0);
        shapes.push(Shape::Polyline(vec![[cell.left, cell.top], [cell.right, cell.bottom]], stroke));
        shapes.push(Shape::Polyline(vec![[cell.left, cell.bottom], [cell.right, cell.top]], stroke));
        return;
    };
    let ground = colour(fraction);
    shapes.push(Shape::Filled(*cell, ground));
    let text = axis::three_digits(value);
    if text::room(&text, VALUE_SIZE, Weight::Regular) < cell.width() - 6.0 && VALUE_SIZE < cell.height() - 4.0
    {
        let at =
            [f64::midpoint(cell.left, cell.right), f64::midpoint(cell.top, cell.bottom) + VALUE_SIZE * 0.36];
        let colour = if fraction < 0.6 { Colour::WHITE } else { Colour::TEXT };
        shapes.push(Shape::Text(Text::new(text, at, Anchor::Middle, VALUE_SIZE, colour)));
    }
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

/// A tick in the middle of each cell; so many at most have a label.
fn cell_ticks(values: &[f64], most: usize) -> Vec<Tick> {
    let stride = values.len().div_ceil(most);
    let cell = 1.0 / values.len() as f64;
    let label = |(index, value): (usize, &f64)| Tick {
        fraction: (index as f64 + 0.5) * cell,
        label: (index % stride == 0).then(|| axis::three_digits(*value)),
    };
    values.iter().enumerate().map(label).collect()
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
        let light = |Colour(red, green, blue)| {
            0.2126 * f64::from(red) + 0.7152 * f64::from(green) + 0.0722 * f64::from(blue)
        };
        for k in 0..100 {
            let (below, above) = (f64::from(k) / 100.0, f64::from(k + 1) / 100.0);
            assert!(light(colour(below)) < light(colour(above)), "at {below}");
        }
        assert_eq!((colour(-1.0), colour(2.0)), (colour(0.0), colour(1.0)));
    }

    #[test]
    fn a_design_without_a_grid_is_scattered() {
        let points: Vec<MapPoint> = (0..40)
            .map(|k| (f64::from(k), f64::from(k * 17 % 40)))
            .map(|(x, y)| MapPoint { x, y, value: x + y, is_marked: false })
            .collect();
        let svg = map(points).svg();
        let document = Document::parse(&svg).expect("well-formed XML");
        assert_eq!(
            document.descendants().filter(|node| node.attribute("class") == Some("marker")).count(),
            40
        );
    }

    #[test]
    fn points_that_stand_out_have_a_diamond_above_all_cells() {
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
            vec![MapPoint { x: 1.0, y: 1.0, value: f64::NAN, is_marked: true }],
            vec![
                MapPoint { x: f64::MAX, y: f64::MIN, value: 1e300, is_marked: true },
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
}
