//! The scaling plot: time of a step over the number of cars, both axes logarithmic, one line per loop.

use super::Figure;
use plotters::prelude::*;
use std::error::Error;
use std::path::Path;

/// Loops from the cheapest to the dearest, with their colours.
const LINES: [(&str, RGBColor); 5] = [
    ("Python one by one", RGBColor(150, 150, 150)),
    ("Python subscriptions", RGBColor(90, 90, 90)),
    ("adaptive", RGBColor(213, 94, 0)),
    ("ideal", RGBColor(0, 114, 178)),
    ("SUMO alone", RGBColor(0, 0, 0)),
];

/// Draws the grids' figures.
pub fn draw(path: &Path, figures: &[Figure]) -> Result<(), Box<dyn Error>> {
    let grids: Vec<&Figure> = figures.iter().filter(|f| f.scene.starts_with("grid")).collect();
    if grids.is_empty() {
        return Ok(());
    }
    let (low, high) = grids.iter().fold((f64::INFINITY, 0.0_f64), |(a, b), f| (a.min(f.step_ms), b.max(f.step_ms)));
    let area = SVGBackend::new(path, (720, 440)).into_drawing_area();
    area.fill(&WHITE)?;
    let mut chart = ChartBuilder::on(&area)
        .margin(12)
        .x_label_area_size(42)
        .y_label_area_size(64)
        .build_cartesian_2d((80.0..25_000.0).log_scale(), (0.5 * low..2.0 * high).log_scale())?;
    chart
        .configure_mesh()
        .x_desc("cars, every one with a body")
        .y_desc("time of a step [ms]")
        .x_label_formatter(&|x| format!("{x:.0}"))
        .y_label_formatter(&|y| if *y < 1.0 { format!("{y:.1}") } else { format!("{y:.0}") })
        .light_line_style(WHITE)
        .draw()?;
    // A step of 0.1 s that takes 100 ms.
    let real_time = DashedLineSeries::new([(80.0, 100.0), (25_000.0, 100.0)], 4, 4, BLACK.mix(0.5).into());
    chart
        .draw_series(real_time)?
        .label("real time")
        .legend(|(x, y)| PathElement::new([(x, y), (x + 18, y)], BLACK.mix(0.5)));
    for (name, colour) in LINES {
        let points: Vec<(f64, f64)> = grids.iter().filter(|f| f.name == name).map(|f| (f.cars, f.step_ms)).collect();
        chart
            .draw_series(LineSeries::new(points.iter().copied(), colour.stroke_width(2)).point_size(3))?
            .label(name)
            .legend(move |(x, y)| PathElement::new([(x, y), (x + 18, y)], colour.stroke_width(2)));
    }
    chart
        .configure_series_labels()
        .position(SeriesLabelPosition::UpperLeft)
        .background_style(WHITE.mix(0.8))
        .border_style(BLACK.mix(0.3))
        .draw()?;
    area.present()?;
    Ok(())
}
