//! Charts as SVG, of whatever figures: lines over levels, columns over levels, bars and dots a scene.

use std::ops::Range;

use plotters::coord::Shift;
use plotters::coord::ranged1d::SegmentValue;
use plotters::prelude::*;

/// Small enough that letters stay readable where a phone shrinks them.
const WIDTH: u32 = 560;
const HEIGHT: u32 = 340;

/// Height of a scene's bar.
const ROW: u32 = 36;

/// Colours that the colour-blind tell apart, and that differ in lightness.
const COLOURS: [RGBColor; 8] = [
    RGBColor(0x33, 0x22, 0x88),
    RGBColor(0xcc, 0x66, 0x77),
    RGBColor(0x11, 0x77, 0x33),
    RGBColor(0x88, 0xcc, 0xee),
    RGBColor(0x99, 0x99, 0x33),
    RGBColor(0x88, 0x22, 0x55),
    RGBColor(0x44, 0xaa, 0x99),
    RGBColor(0xaa, 0x44, 0x99),
];

/// Named values; the name is for the legend.
pub(super) struct Series {
    pub(super) name: String,
    pub(super) points: Vec<[f64; 2]>,
}

/// What the axes say.
pub(super) struct Axes {
    pub(super) x: &'static str,
    pub(super) y: &'static str,
}

/// The mark of a series in legends: a shape, and its colour in CSS.
pub(super) fn mark(index: usize) -> (char, String) {
    let RGBColor(r, g, b) = colour(index);
    (['●', '▲', '✖'][index % 3], format!("#{r:02x}{g:02x}{b:02x}"))
}

fn colour(index: usize) -> RGBColor {
    COLOURS[index % COLOURS.len()]
}

/// Draws into a string.
fn svg(
    height: u32,
    draw: impl FnOnce(&DrawingArea<SVGBackend<'_>, Shift>) -> anyhow::Result<()>,
) -> anyhow::Result<String> {
    let mut text = String::new();
    {
        let area = SVGBackend::with_string(&mut text, (WIDTH, height)).into_drawing_area();
        draw(&area)?;
        area.present()?;
    }
    Ok(text)
}

/// The least range that has all of the values, which are above zero.
fn logarithmic_range(values: impl Iterator<Item = f64>) -> Range<f64> {
    let (mut least, mut most) = (f64::INFINITY, 0.0_f64);
    for value in values {
        (least, most) = (least.min(value), most.max(value));
    }
    if most > 0.0 { least / 1.3..most * 1.3 } else { 1.0..10.0 }
}

/// Lines over levels, the values on a logarithmic scale; values of zero are left out. A `guide` is
/// dashed and has no mark.
pub(super) fn lines(axes: &Axes, series: &[Series], guide: &[[f64; 2]]) -> anyhow::Result<String> {
    let points = || series.iter().flat_map(|series| &series.points).chain(guide);
    let levels = points().map(|[x, _]| *x).fold(1.0, f64::max);
    let range = logarithmic_range(points().map(|[_, y]| *y).filter(|y| *y > 0.0));
    svg(HEIGHT, |area| {
        let mut chart = ChartBuilder::on(area)
            .margin(8)
            .x_label_area_size(40)
            .y_label_area_size(64)
            .build_cartesian_2d(-0.5..levels + 0.5, range.log_scale())?;
        let label = |y: &f64| short(*y);
        let mut mesh = chart.configure_mesh();
        mesh.x_desc(axes.x).y_desc(axes.y).light_line_style(TRANSPARENT);
        mesh.label_style(("sans-serif", 14)).x_label_formatter(&|x| format!("{x:.0}"));
        mesh.y_label_formatter(&label).draw()?;
        let dashed = guide.iter().map(|[x, y]| (*x, *y));
        chart.draw_series(DashedLineSeries::new(dashed, 6, 4, BLACK.stroke_width(1)))?;
        for (index, series) in series.iter().enumerate() {
            let above_zero = series.points.iter().filter(|[_, y]| *y > 0.0);
            let points: Vec<_> = above_zero.map(|[x, y]| (*x, *y)).collect();
            let style = colour(index).stroke_width(2);
            chart.draw_series(LineSeries::new(points.iter().copied(), style))?;
            let solid = colour(index).filled();
            match index % 3 {
                0 => chart.draw_series(points.iter().map(|at| Circle::new(*at, 3, solid)))?,
                1 => {
                    chart.draw_series(points.iter().map(|at| TriangleMarker::new(*at, 4, solid)))?
                }
                _ => chart.draw_series(points.iter().map(|at| Cross::new(*at, 3, style)))?,
            };
        }
        Ok(())
    })
}

/// A column a level, of parts on top of each other. All parts have the same levels.
pub(super) fn columns(axes: &Axes, parts: &[Series]) -> anyhow::Result<String> {
    let rows = parts.iter().map(|part| part.points.len()).max().unwrap_or(0);
    let mut tops = vec![0.0; rows];
    let mut boxes = Vec::new();
    for (index, part) in parts.iter().enumerate() {
        for ([x, y], top) in part.points.iter().zip(&mut tops) {
            boxes.push((index, [(x - 0.4, *top), (x + 0.4, *top + y)]));
            *top += y;
        }
    }
    let most = tops.iter().copied().fold(f64::MIN_POSITIVE, f64::max);
    svg(HEIGHT, |area| {
        let mut chart = ChartBuilder::on(area)
            .margin(8)
            .x_label_area_size(40)
            .y_label_area_size(64)
            .build_cartesian_2d(-0.5..rows as f64 - 0.5, 0.0..1.05 * most)?;
        let mut mesh = chart.configure_mesh();
        mesh.disable_x_mesh().x_desc(axes.x).y_desc(axes.y).light_line_style(TRANSPARENT);
        mesh.label_style(("sans-serif", 14)).x_label_formatter(&|x| format!("{x:.0}"));
        mesh.y_label_formatter(&|y| short(*y)).draw()?;
        let filled =
            boxes.iter().map(|(index, ends)| Rectangle::new(*ends, colour(*index).filled()));
        chart.draw_series(filled)?;
        Ok(())
    })
}

/// A bar a scene, of parts behind each other. A part's points are places of scenes and values.
pub(super) fn bars(x: &str, scenes: &[&str], parts: &[Series]) -> anyhow::Result<String> {
    let mut ends = vec![0.0; scenes.len()];
    let mut boxes = Vec::new();
    for (index, part) in parts.iter().enumerate() {
        for [scene, value] in &part.points {
            let end = &mut ends[*scene as usize];
            boxes.push((index, *scene as usize, *end, *end + value));
            *end += value;
        }
    }
    let most = ends.iter().copied().fold(f64::MIN_POSITIVE, f64::max);
    by_scene(x, scenes, most, |chart| {
        let bar = |(index, scene, start, end): &(usize, usize, f64, f64)| {
            let row = scenes.len() - 1 - scene;
            let [low, high] = [row, row + 1].map(SegmentValue::Exact);
            let mut bar = Rectangle::new([(*start, low), (*end, high)], colour(*index).filled());
            bar.set_margin(5, 5, 0, 0);
            bar
        };
        chart.draw_series(boxes.iter().map(bar))?;
        Ok(())
    })
}

/// A row a scene with a mark for each series. A series' points are places of scenes and values.
pub(super) fn dots(x: &str, scenes: &[&str], series: &[Series]) -> anyhow::Result<String> {
    let values = series.iter().flat_map(|series| &series.points).map(|[_, value]| *value);
    let most = values.fold(f64::MIN_POSITIVE, f64::max);
    by_scene(x, scenes, 1.05 * most, |chart| {
        for (index, series) in series.iter().enumerate() {
            let row = |scene: f64| SegmentValue::CenterOf(scenes.len() - 1 - scene as usize);
            let place = |[scene, value]: &[f64; 2]| (*value, row(*scene));
            let places = series.points.iter().map(place);
            let solid = colour(index).filled();
            match index % 3 {
                0 => chart.draw_series(places.map(|at| Circle::new(at, 6, solid)))?,
                1 => chart.draw_series(places.map(|at| TriangleMarker::new(at, 7, solid)))?,
                _ => chart.draw_series(
                    places.map(|at| Cross::new(at, 5, colour(index).stroke_width(3))),
                )?,
            };
        }
        Ok(())
    })
}

type ByScene<'a, 'b> = ChartContext<
    'a,
    SVGBackend<'b>,
    Cartesian2d<
        plotters::coord::types::RangedCoordf64,
        plotters::coord::ranged1d::SegmentedCoord<plotters::coord::types::RangedCoordusize>,
    >,
>;

/// A chart with a row a scene, the first on top.
fn by_scene(
    x: &str,
    scenes: &[&str],
    most: f64,
    draw: impl FnOnce(&mut ByScene<'_, '_>) -> anyhow::Result<()>,
) -> anyhow::Result<String> {
    let last = scenes.len().saturating_sub(1);
    // An axis of one row would have no height.
    let rows = scenes.len().max(2);
    svg(60 + ROW * rows as u32, |area| {
        let mut chart = ChartBuilder::on(area)
            .margin(8)
            .margin_right(20)
            .x_label_area_size(40)
            .y_label_area_size(90)
            .build_cartesian_2d(0.0..most, (0..rows - 1).into_segmented())?;
        let scene = |row: &SegmentValue<usize>| match row {
            SegmentValue::CenterOf(row) => {
                last.checked_sub(*row).and_then(|scene| scenes.get(scene)).copied().unwrap_or("")
            }
            _ => "",
        };
        let mut mesh = chart.configure_mesh();
        mesh.disable_y_mesh().x_desc(x).light_line_style(TRANSPARENT);
        mesh.label_style(("sans-serif", 14)).x_label_formatter(&|x| short(*x));
        let name = |row: &SegmentValue<usize>| scene(row).to_owned();
        mesh.y_labels(rows).y_label_formatter(&name).draw()?;
        draw(&mut chart)
    })
}

/// A number with as few digits as tell it from its neighbours on an axis.
fn short(value: f64) -> String {
    match value.abs() {
        0.0 => "0".into(),
        size if size >= 1e6 => format!("{}M", value / 1e6),
        size if size >= 1e4 => format!("{}k", value / 1e3),
        _ => format!("{value:.4}").trim_end_matches('0').trim_end_matches('.').to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn series(points: &[[f64; 2]]) -> Series {
        Series { name: "a".into(), points: points.to_vec() }
    }

    #[test]
    fn every_value_above_zero_has_its_mark() {
        let axes = Axes { x: "level", y: "count" };
        let all = [series(&[[0.0, 1.0], [1.0, 0.0], [2.0, 100.0]]), series(&[[0.0, 5.0]])];
        let chart = lines(&axes, &all, &[[0.0, 1.0], [2.0, 4.0]]).expect("drawn");
        assert_eq!(chart.matches("<circle").count(), 2);
        assert_eq!(chart.matches("<polygon").count(), 1);
        assert!(chart.contains("level") && chart.contains("count"));
    }

    #[test]
    fn parts_add_up_to_columns_and_bars() {
        let axes = Axes { x: "level", y: "ms" };
        let parts = [series(&[[0.0, 1.0], [1.0, 2.0]]), series(&[[0.0, 3.0], [1.0, 0.5]])];
        let filled = |chart: String| chart.matches("<rect").count();
        assert_eq!(filled(columns(&axes, &parts).expect("drawn")), 4);
        assert_eq!(filled(bars("share", &["one", "two"], &parts).expect("drawn")), 4);
        let chart = dots("ratio", &["one", "two"], &parts).expect("drawn");
        assert!(chart.contains("one") && chart.contains("two"));
    }

    #[test]
    fn bars_of_one_scene_and_of_two_are_high_and_wide() {
        for scenes in [&["one"][..], &["one", "two"]] {
            let points: Vec<[f64; 2]> = (0..scenes.len()).map(|i| [i as f64, 1.0]).collect();
            let chart = bars("percent", scenes, &[series(&points)]).expect("drawn");
            let rectangles: Vec<&str> = chart.split("<rect").skip(1).collect();
            let bars = rectangles.iter().filter(|it| it.contains(r##"fill="#332288""##));
            let is_seen = |bar: &&&str| !bar.contains("=\"-") && !bar.contains("height=\"0\"");
            assert_eq!(bars.filter(is_seen).count(), scenes.len(), "{chart}");
        }
    }

    #[test]
    fn nothing_can_be_drawn() {
        let axes = Axes { x: "level", y: "count" };
        assert!(lines(&axes, &[], &[]).is_ok() && columns(&axes, &[]).is_ok());
        assert!(bars("share", &["one"], &[]).is_ok() && dots("ratio", &[], &[]).is_ok());
    }

    #[test]
    fn numbers_on_axes_are_short() {
        let texts = [0.0, 0.25, 10.0, 20_000.0, 3e6].map(short);
        assert_eq!(texts, ["0", "0.25", "10", "20k", "3M"]);
    }
}
