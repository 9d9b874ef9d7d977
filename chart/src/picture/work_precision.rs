//! Work-precision diagrams: cost of accuracy, by method.

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
const PLOT_HEIGHT: f64 = 440.0;
const RIGHT_MARGIN: f64 = 24.0;
const LABEL_SIZE: f64 = 11.0;
/// The widest a point's label becomes before it is cut.
const LABEL_WIDTH: f64 = 140.0;
/// Number of labels of points that are tried: far more than there is room for.
const MAX_LABELS: usize = 400;

/// A work-precision diagram: error against cost, both on logarithmic axes, one line for each method. Lower is
/// more accurate, farther left is cheaper.
///
/// A point whose work or error is zero, negative or not finite has no place on such axes and is left out. So
/// is the label of a point that finds no free room, and text that is too long for its place is cut.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct WorkPrecisionChart {
    /// The title; may be empty.
    pub title: String,
    /// Quantity across, with its unit, such as "CPU seconds per simulated second".
    pub x_label: String,
    /// Quantity vertical, with its unit, such as "relative error".
    pub y_label: String,
    /// The accuracy that is requested, drawn as a dashed line from left to right.
    pub requested: Option<RequestedAccuracy>,
    /// The methods compared, in the order of the legend. Up to 56 differ in colour and marker.
    pub series: Vec<Series>,
}

/// The largest error that is acceptable.
#[derive(Debug, Clone, PartialEq)]
pub struct RequestedAccuracy {
    /// The error, in the unit of the vertical axis.
    pub y: f64,
    /// Text at the line, such as "requested: 1 %".
    pub label: String,
}

/// Errors that one method reaches, each at its cost.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Series {
    /// The method's name in the legend.
    pub name: String,
    /// The points, joined by a line in this order.
    pub points: Vec<Point>,
}

/// One run of a method.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Point {
    /// The work, in the unit of the axis across.
    pub x: f64,
    /// The error, in the unit of the vertical axis.
    pub y: f64,
    /// Text next to the point, such as the time step "1 ms"; nothing if empty.
    pub label: String,
}

impl WorkPrecisionChart {
    /// The chart as a standalone SVG 1.1 document. The same chart gives the same bytes.
    pub fn svg(&self) -> String {
        self.drawing().svg()
    }

    /// The chart as a PNG image of this width in pixels.
    ///
    /// # Errors
    ///
    /// [`PictureError::Size`] if the width is zero or the image would be too large.
    pub fn png(&self, width: u32) -> Result<Vec<u8>, PictureError> {
        self.drawing().png(width)
    }

    /// The chart laid out on a page 800 units wide. The legend is above the plot and makes the page higher
    /// if it needs more lines.
    pub fn drawing(&self) -> Drawing {
        let axes = self.axes();
        let (x_ticks, y_ticks) = axes.map(|(x, y)| (x.ticks(), y.ticks())).unwrap_or_default();
        let (left, right) = (plot_area::left_margin(&y_ticks), PAGE_WIDTH - RIGHT_MARGIN);

        let mut shapes = Vec::new();
        let (title, title_bottom) = heading::title(&mut shapes, &self.title, left, right);
        let legend_bottom = heading::legend(&mut shapes, self.legend(), left, right, title_bottom);

        let top = legend_bottom + 10.0;
        let area = Rectangle { left, top, right, bottom: top + PLOT_HEIGHT };
        shapes.push(plot_area::grid(&area, &x_ticks, &y_ticks));
        shapes.push(plot_area::axes(&area, &x_ticks, &y_ticks, &self.x_label, &self.y_label));
        match axes {
            Some((x, y)) => self.data(&mut shapes, &area, &x, &y),
            None => shapes.push(heading::no_data(plot_area::position(&area, 0.5, 0.5))),
        }
        Drawing { title, width: PAGE_WIDTH, height: area.bottom + plot_area::BELOW, shapes }
    }

    /// The axes over all points that can be drawn and the requested accuracy; none without such a point.
    fn axes(&self) -> Option<(PlotAxis, PlotAxis)> {
        let points: Vec<&Point> = self.series.iter().flat_map(|series| series.drawable()).collect();
        let x = PlotAxis::logarithmic(points.iter().map(|point| point.x))?;
        let requested = self.requested.iter().map(|requested| requested.y);
        let y = PlotAxis::logarithmic(points.iter().map(|point| point.y).chain(requested))?;
        Some((x, y))
    }

    fn legend(&self) -> impl Iterator<Item = Entry> {
        self.series.iter().enumerate().map(|(index, series)| {
            let (colour, marker) = series_style(index);
            let no_data = if series.drawable().next().is_none() { " (no data)" } else { "" };
            Entry::line(format!("{}{no_data}", series.name), colour, Some(marker))
        })
    }

    fn data<'a>(&'a self, shapes: &mut Vec<Shape>, area: &Rectangle, x: &PlotAxis, y: &PlotAxis) {
        let position =
            |point: &Point| Some(plot_area::position(area, x.fraction(point.x)?, y.fraction(point.y)?));
        let placed = |series: &'a Series| -> Vec<(Position, &'a str)> {
            series.points.iter().filter_map(|point| Some((position(point)?, point.label.as_str()))).collect()
        };
        let lines: Vec<_> = self.series.iter().map(placed).collect();

        let mut room = LabelRoom::new(*area);
        for line in &lines {
            let positions: Vec<Position> = line.iter().map(|(at, _)| *at).collect();
            room.avoid(&positions);
            for [x, y] in positions {
                let reach = Marker::REACH;
                room.take(Rectangle { left: x - reach, top: y - reach, right: x + reach, bottom: y + reach });
            }
        }

        if let Some(requested) = &self.requested
            && let Some(height) = y.fraction(requested.y)
        {
            shapes.push(requested_line(&mut room, area, height, &requested.label));
        }
        for (index, line) in lines.iter().enumerate() {
            let (colour, marker) = series_style(index);
            let path = Shape::Polyline(line.iter().map(|(at, _)| *at).collect(), Stroke::solid(colour, 2.0));
            let markers = line.iter().map(|(at, _)| Shape::Marker(*at, marker, colour));
            shapes.push(Shape::Group("series", std::iter::once(path).chain(markers).collect()));
        }
        let labels = lines.iter().flatten().filter(|(_, label)| !label.trim().is_empty()).take(MAX_LABELS);
        let labels = labels.filter_map(|(at, label)| point_label(&mut room, *at, label)).flatten().collect();
        shapes.push(Shape::Group("labels", labels));
    }
}

impl Series {
    fn drawable(&self) -> impl Iterator<Item = &Point> {
        let has_place = |value: f64| value.is_finite() && value > 0.0;
        self.points.iter().filter(move |point| has_place(point.x) && has_place(point.y))
    }
}

/// The dashed line at the requested accuracy and its label, at the end of the line where there is most room.
fn requested_line(room: &mut LabelRoom, area: &Rectangle, height: f64, label: &str) -> Shape {
    let line = [plot_area::position(area, 0.0, height), plot_area::position(area, 1.0, height)];
    let label = text::line(label, LABEL_SIZE, Weight::Regular, area.width() / 2.0);
    let (width, y) = (text::room(&label, LABEL_SIZE, Weight::Regular), line[0][1]);
    let (above, below) = (y - 4.0 - LABEL_SIZE, y + 4.0);
    let (left, right) = (area.left + 8.0, area.right - 8.0 - width);
    let candidates = [(right, above), (right, below), (left, above), (left, below)]
        .map(|(left, top)| Rectangle { left, top, right: left + width, bottom: top + LABEL_SIZE });
    let place = room.place(candidates).filter(|_| !label.is_empty());
    room.avoid(&line);

    let mut shapes = vec![Shape::Polyline(line.to_vec(), Stroke::dashed(Colour::QUIET_TEXT, 1.3))];
    if let Some(place) = place {
        let anchor = if place.left == left { Anchor::Start } else { Anchor::End };
        shapes.extend(label_shapes(label, &place, anchor, LABEL_SIZE, Colour::QUIET_TEXT));
    }
    Shape::Group("requested", shapes)
}

/// The label of a point, if there is room. It is anchored at the point's side, to stay next to it in any font.
fn point_label(room: &mut LabelRoom, at: Position, label: &str) -> Option<[Shape; 2]> {
    let label = text::line(label, LABEL_SIZE, Weight::Regular, LABEL_WIDTH);
    let width = text::room(&label, LABEL_SIZE, Weight::Regular);
    let place = room.place(around(at, width, LABEL_SIZE, Marker::REACH + 2.0))?;
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
    use resvg::tiny_skia::Pixmap;
    use roxmltree::{Document, Node};

    use super::*;

    fn point(x: f64, y: f64, label: &str) -> Point {
        Point { x, y, label: label.to_owned() }
    }

    /// A chart of series that converge with orders 1, 2, 3, ...
    fn chart(series: usize) -> WorkPrecisionChart {
        let steps = [2.0f64, 1.0, 0.5, 0.25];
        let series = (1..=series).map(|order| Series {
            name: format!("method {order}"),
            points: steps
                .iter()
                .map(|step| point(order as f64 / step, 0.01 * step.powi(order as i32), &format!("{step} ms")))
                .collect(),
        });
        WorkPrecisionChart {
            title: "Work and precision".to_owned(),
            x_label: "CPU seconds per simulated second".to_owned(),
            y_label: "relative error".to_owned(),
            requested: Some(RequestedAccuracy { y: 0.01, label: "requested: 1 %".to_owned() }),
            series: series.collect(),
        }
    }

    fn groups<'d>(svg: &'d Document, class: &str) -> Vec<Node<'d, 'd>> {
        svg.descendants().filter(|node| node.attribute("class") == Some(class)).collect()
    }

    /// The places of all markers in a group.
    fn markers(group: &Node) -> Vec<Position> {
        let marked = group.children().filter(|node| node.attribute("class") == Some("marker"));
        marked
            .map(|node| {
                let place = node.attribute("transform").expect("a place");
                let pair = place.trim_start_matches("translate(").trim_end_matches(')');
                let (x, y) = pair.split_once(',').expect("a pair");
                [x, y].map(|number| number.parse().expect("a number"))
            })
            .collect()
    }

    fn texts(svg: &str) -> Vec<String> {
        let svg = Document::parse(svg).expect("well-formed XML");
        let texts = svg.descendants().filter(|node| node.has_tag_name("text"));
        texts.map(|node| node.text().unwrap_or_default().to_owned()).collect()
    }

    #[test]
    fn points_lie_on_the_scale_of_the_labelled_ticks() {
        let chart = chart(3);
        let svg = chart.svg();
        let svg = Document::parse(&svg).expect("well-formed XML");
        let number =
            |node: &Node, name| -> f64 { node.attribute(name).expect("set").parse().expect("a number") };
        let tick = |label: &str, name| {
            let node =
                groups(&svg, "axes")[0].children().find(|node| node.text() == Some(label)).expect("a tick");
            number(&node, name)
        };
        let (x_1, x_10) = (tick("1", "x"), tick("10", "x"));
        let (y_2, y_3) = (tick("10⁻²", "y"), tick("10⁻³", "y"));
        let requested = groups(&svg, "requested")[0].children().find(|node| node.has_tag_name("polyline"));
        let requested =
            requested.expect("the requested accuracy").attribute("points").expect("points").to_owned();
        let y_requested: f64 =
            requested.split([',', ' ']).nth(1).expect("a height").parse().expect("a number");
        let baseline = y_2 - y_requested;
        assert!((3.0..6.0).contains(&baseline), "the requested 1 % is beside the tick 10⁻²: {baseline}");

        let series = groups(&svg, "series");
        assert_eq!(series.len(), 3);
        for (group, series) in series.iter().zip(&chart.series) {
            let places = markers(group);
            assert_eq!(places.len(), series.points.len());
            for ([x, y], point) in places.iter().zip(&series.points) {
                let expected_x = x_1 + (x_10 - x_1) * point.x.log10();
                let expected_y = y_requested + (y_3 - y_2) * (-2.0 - point.y.log10());
                assert!((x - expected_x).abs() < 0.06, "{point:?}: {x} for {expected_x}");
                assert!((y - expected_y).abs() < 0.06, "{point:?}: {y} for {expected_y}");
            }
        }
    }

    #[test]
    fn series_differ_in_marker_and_colour_and_the_legend_shows_both() {
        let svg = chart(8).svg();
        let svg = Document::parse(&svg).expect("well-formed XML");
        let style = |node: &Node| {
            let colour = node.attribute("fill").expect("a colour").to_owned();
            (colour, node.attribute("points").unwrap_or("circle").to_owned())
        };
        let is_marker = |node: &Node| node.attribute("class") == Some("marker");
        let legend: Vec<_> =
            groups(&svg, "legend")[0].children().filter(is_marker).map(|n| style(&n)).collect();
        let data: Vec<_> = groups(&svg, "series")
            .iter()
            .map(|group| {
                let styles: Vec<_> = group.children().filter(is_marker).map(|node| style(&node)).collect();
                assert!(styles.windows(2).all(|pair| pair[0] == pair[1]));
                styles[0].clone()
            })
            .collect();
        assert_eq!(legend, data);
        for (n, (colour, shape)) in data.iter().enumerate() {
            assert!(data[..n].iter().all(|(_, other)| other != shape), "{shape} twice");
            assert!(n == 7 || data[..n].iter().all(|(other, _)| other != colour), "{colour} twice");
        }
    }

    #[test]
    fn the_legend_is_above_the_plot_within_the_page_and_labels_are_within_the_plot() {
        for count in [1, 3, 20] {
            let drawing = chart(count).drawing();
            let members = |requested: &str| -> Vec<Shape> {
                let found = drawing.shapes.iter().find_map(|shape| match shape {
                    Shape::Group(class, members) if *class == requested => Some(members.clone()),
                    _ => None,
                });
                found.expect("the group")
            };
            let frame = members("axes").into_iter().find_map(|shape| match shape {
                Shape::Rectangle(frame, _) => Some(frame),
                _ => None,
            });
            let frame = frame.expect("a frame");
            for shape in members("legend") {
                if let Shape::Text(text) = shape {
                    let end = text.at[0] + text::room(&text.content, text.size, text.weight);
                    assert!(text.at[1] < frame.top && end <= drawing.width, "{text:?}");
                }
            }
            let mut grounds: Vec<Rectangle> = Vec::new();
            for shape in members("labels") {
                if let Shape::Ground(ground) = shape {
                    assert!(ground.left >= frame.left && ground.right <= frame.right);
                    assert!(ground.top >= frame.top && ground.bottom <= frame.bottom);
                    for other in &grounds {
                        let apart = ground.right <= other.left || other.right <= ground.left;
                        assert!(apart || ground.bottom <= other.top || other.bottom <= ground.top);
                    }
                    grounds.push(ground);
                }
            }
            assert!(!grounds.is_empty());
        }
    }

    #[test]
    fn every_point_of_a_clear_chart_has_its_label() {
        let texts = texts(&chart(3).svg());
        for step in ["2 ms", "1 ms", "0.5 ms", "0.25 ms"] {
            assert_eq!(texts.iter().filter(|text| *text == step).count(), 3, "{step}");
        }
        assert!(texts.contains(&"requested: 1 %".to_owned()));
    }

    #[test]
    fn hostile_text_stays_text() {
        let hostile = "</text><script>alert(\"1\")</script> & ]]> \u{0}\u{1b}\u{ffff}'";
        let mut chart = chart(2);
        chart.title = hostile.to_owned();
        chart.x_label = hostile.to_owned();
        chart.y_label = hostile.to_owned();
        chart.requested = Some(RequestedAccuracy { y: 0.01, label: hostile.to_owned() });
        chart.series[0].name = hostile.to_owned();
        chart.series[0].points[0].label = hostile.to_owned();
        let svg = chart.svg();
        let document = Document::parse(&svg).expect("well-formed XML");
        assert!(document.descendants().all(|node| !node.has_tag_name("script")));
        let shown = "</text><script>alert(\"1\")</script> & ]]> \u{fffd}'";
        assert_eq!(texts(&svg).iter().filter(|text| *text == shown).count(), 5);
        assert!(texts(&svg).iter().any(|text| text.starts_with("</text>") && text.ends_with('…')));
        assert!(chart.png(200).is_ok());
    }

    #[test]
    fn points_without_a_place_are_left_out() {
        let mut chart = chart(1);
        for value in [0.0, -1.0, f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
            chart.series[0].points.insert(2, point(value, 0.1, "lost"));
            chart.series[0].points.insert(1, point(0.1, value, "lost"));
        }
        chart.requested = Some(RequestedAccuracy { y: 0.0, label: "lost".to_owned() });
        let svg = chart.svg();
        chart.series[0].points.retain(|point| point.label != "lost");
        chart.requested = None;
        assert_eq!(svg, chart.svg());
    }

    #[test]
    fn a_chart_without_points_says_so() {
        let nothing = WorkPrecisionChart::default();
        let mut zeros = chart(2);
        zeros.series.iter_mut().flat_map(|series| &mut series.points).for_each(|point| point.y = 0.0);
        for chart in [nothing, zeros.clone()] {
            assert!(texts(&chart.svg()).contains(&"no data".to_owned()));
            assert!(chart.png(300).is_ok());
        }
        assert!(texts(&zeros.svg()).contains(&"method 1 (no data)".to_owned()));
        zeros.series[0].points[0].y = 1.0;
        assert!(!texts(&zeros.svg()).contains(&"no data".to_owned()));
    }

    #[test]
    fn degenerate_data_is_drawn_within_the_page() {
        let cases: [&[(f64, f64)]; 5] = [
            &[(1.0, 1.0)],
            &[(3.0, 0.1), (3.0, 0.1), (3.0, 0.1)],
            &[(5e-324, f64::MAX), (f64::MAX, 5e-324)],
            &[(1.0, 1e-9), (2.0, 1e-9)],
            &[(1.0, 1.0), (1.0 + f64::EPSILON, 1.0)],
        ];
        for case in cases {
            let points = case.iter().map(|(x, y)| point(*x, *y, "a")).collect();
            let chart = WorkPrecisionChart {
                series: vec![Series { name: String::new(), points }],
                ..WorkPrecisionChart::default()
            };
            let drawing = chart.drawing();
            let svg = chart.svg();
            assert!(!svg.contains("NaN") && !svg.contains("inf"));
            let document = Document::parse(&svg).expect("well-formed XML");
            let places = markers(&groups(&document, "series")[0]);
            assert_eq!(places.len(), case.len());
            for [x, y] in places {
                assert!(
                    (60.0..drawing.width()).contains(&x) && (0.0..drawing.height()).contains(&y),
                    "{case:?}"
                );
            }
            assert!(chart.png(300).is_ok());
        }
    }

    #[test]
    fn the_same_chart_gives_the_same_bytes_on_every_thread() {
        let chart = chart(5);
        let written = || (chart.svg(), chart.png(400).expect("an image"));
        let here = written();
        std::thread::scope(|scope| {
            let elsewhere: Vec<_> = (0..4).map(|_| scope.spawn(written)).collect();
            for thread in elsewhere {
                assert!(thread.join().expect("no panic") == here);
            }
        });
    }

    #[test]
    fn a_png_has_the_requested_size_and_the_content_of_the_svg() {
        let chart = chart(3);
        let drawing = chart.drawing();
        let svg = chart.svg();
        let svg = Document::parse(&svg).expect("well-formed XML");
        for scale in [1u32, 2] {
            let width = 800 * scale;
            let image = Pixmap::decode_png(&chart.png(width).expect("an image")).expect("a PNG");
            assert_eq!(image.width(), width);
            assert_eq!(image.height(), (drawing.height() * f64::from(scale)).round() as u32);
            let colour_at = |x: f64, y: f64| {
                let pixel = [x, y].map(|coordinate| (coordinate * f64::from(scale)) as u32);
                let pixel = image.pixel(pixel[0], pixel[1]).expect("within the image");
                Colour(pixel.red(), pixel.green(), pixel.blue())
            };
            assert_eq!(colour_at(1.0, 1.0), Colour::WHITE);
            for (index, group) in groups(&svg, "series").iter().enumerate().skip(2) {
                for [x, y] in markers(group) {
                    assert_eq!(colour_at(x, y), series_style(index).0);
                }
            }
            let dark =
                image.pixels().iter().filter(|pixel| pixel.red() < 0x60 && pixel.blue() < 0x60).count();
            assert!(dark > 1000, "{dark} pixels of text");
        }
    }

    #[test]
    fn images_without_pixels_or_with_too_many_are_refused() {
        for width in [0, 20_000, u32::MAX] {
            assert!(
                matches!(chart(1).png(width), Err(PictureError::Size { width: refused, .. }) if refused == width)
            );
        }
        assert!(chart(1).png(1).is_ok());
    }
}
