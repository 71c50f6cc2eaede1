//! Published curves and measured points.

use plotters::coord::ranged1d::{Ranged, ValueFormatter};
use plotters::prelude::*;

/// A published curve, and measured points.
pub(crate) struct Plot {
    pub(crate) title: String,
    /// The labels of the horizontal and the vertical axis.
    pub(crate) axes: [&'static str; 2],
    pub(crate) curve: Vec<(f64, f64)>,
    pub(crate) points: Vec<(f64, f64)>,
    /// True if both axes are logarithmic.
    pub(crate) is_logarithmic: bool,
}

const SIZE: (u32, u32) = (720, 400);
/// Colours of lines, text and background that are readable on light and dark pages.
const CURVE: RGBColor = RGBColor(31, 119, 180);
const POINTS: RGBColor = RGBColor(214, 39, 40);
const GRID: RGBColor = RGBColor(225, 225, 225);

impl Plot {
    /// Renders the plot as SVG. Its numbers are rounded to pixels, so that every machine gives the same.
    pub(crate) fn svg(&self) -> String {
        let all = || self.curve.iter().chain(&self.points);
        let most = |of: fn(&(f64, f64)) -> f64| all().map(of).fold(f64::MIN, f64::max);
        let least = |of: fn(&(f64, f64)) -> f64| all().map(of).fold(f64::MAX, f64::min);
        let (right, top) = (most(|at| at.0), most(|at| at.1) * 1.1);
        let mut text = String::new();
        {
            let area = SVGBackend::with_string(&mut text, SIZE).into_drawing_area();
            area.fill(&WHITE).unwrap();
            let mut builder = ChartBuilder::on(&area);
            builder
                .caption(&self.title, ("sans-serif", 18))
                .margin(12)
                .x_label_area_size(42)
                .y_label_area_size(64);
            if self.is_logarithmic {
                let across = (least(|at| at.0)..right).log_scale();
                let up = (least(|at| at.1) / 1.5..top * 1.3).log_scale();
                self.draw(&mut builder.build_cartesian_2d(across, up).unwrap());
            } else {
                self.draw(&mut builder.build_cartesian_2d(0.0..right * 1.02, 0.0..top).unwrap());
            }
            area.present().unwrap();
        }
        text
    }

    fn draw<'a, X, Y>(&self, chart: &mut ChartContext<'a, SVGBackend<'a>, Cartesian2d<X, Y>>)
    where
        X: Ranged<ValueType = f64> + ValueFormatter<f64>,
        Y: Ranged<ValueType = f64> + ValueFormatter<f64>,
    {
        chart
            .configure_mesh()
            .light_line_style(TRANSPARENT)
            .bold_line_style(GRID)
            .x_desc(self.axes[0])
            .y_desc(self.axes[1])
            .label_style(("sans-serif", 13))
            .x_label_formatter(&|value| super::page::digits(*value))
            .y_label_formatter(&|value| super::page::digits(*value))
            .draw()
            .unwrap();
        chart
            .draw_series(LineSeries::new(self.curve.iter().copied(), CURVE.stroke_width(2)))
            .unwrap()
            .label("published")
            .legend(|(x, y)| PathElement::new([(x, y), (x + 18, y)], CURVE.stroke_width(2)));
        chart
            .draw_series(self.points.iter().map(|at| Circle::new(*at, 4, POINTS.filled())))
            .unwrap()
            .label("measured")
            .legend(|(x, y)| Circle::new((x + 9, y), 4, POINTS.filled()));
        chart
            .configure_series_labels()
            .position(if self.is_logarithmic {
                SeriesLabelPosition::UpperRight
            } else {
                SeriesLabelPosition::UpperLeft
            })
            .label_font(("sans-serif", 13))
            .background_style(WHITE)
            .border_style(GRID)
            .draw()
            .unwrap();
    }
}

/// Samples a curve between two values.
pub(crate) fn curve([from, to]: [f64; 2], value: impl Fn(f64) -> f64) -> Vec<(f64, f64)> {
    (0..=200).map(|step| from + (to - from) * f64::from(step) / 200.0).map(|at| (at, value(at))).collect()
}
