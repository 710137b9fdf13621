//! Whole figures: determinism, size, hostile words and data that are hardly data.

use super::*;

fn simple(x: Vec<f64>, y: Vec<f64>) -> Figure {
    Figure::new(Axis::new("time", "s")).panel(Panel::new(Axis::new("length", "mm")).series(Series::line("run", x, y)))
}

/// A figure with one of everything.
fn full() -> Figure {
    let t: Vec<f64> = (0..500).map(|i| f64::from(i) * 0.01).collect();
    let y: Vec<f64> = t.iter().map(|t| 180.0 + 20.0 * (-t).exp() * (6.0 * t).cos()).collect();
    let low: Vec<f64> = y.iter().map(|y| y - 1.0).collect();
    let high: Vec<f64> = y.iter().map(|y| y + 1.0).collect();
    let upper = Panel::new(Axis::new("length", "mm"))
        .series(Series::line("model", t.clone(), y.clone()))
        .series(Series::points("measured", t.clone(), y.clone()).colour(Colour::Category(1)))
        .span(Span::between("95 %", t.clone(), low, high))
        .span(Span::strip("target", 178.0, 182.0))
        .marks(Marks::at("peak", Symbol::Triangle, vec![1.0], vec![187.0]))
        .marks(Marks::on_edge("edge", Symbol::TriangleDown, vec![0.5, 2.5]))
        .horizontal(180.0, "rest")
        .vertical(3.0, "release");
    let lower = Panel::new(Axis::new("valve", "").words([(0.0, "closed"), (1.0, "open")]))
        .series(Series::steps("valve", vec![0.0, 1.0, 2.0, 5.0], vec![0.0, 1.0, 0.0, 0.0]))
        .span(Span::intervals("open", vec![(1.0, 2.0)]))
        .height_mm(8.0);
    Figure::new(Axis::new("time", "s")).title("A run").caption("What is seen.").panel(upper).panel(lower)
}

#[test]
fn the_same_figure_gives_the_same_bytes() {
    for theme in [Theme::Light, Theme::Dark, Theme::Auto] {
        assert_eq!(full().to_svg(theme).unwrap(), full().to_svg(theme).unwrap());
    }
    assert_eq!(full().to_png(Theme::Light, 1.0).unwrap(), full().to_png(Theme::Light, 1.0).unwrap());
    assert_eq!(full().to_pdf(Theme::Light).unwrap(), full().to_pdf(Theme::Light).unwrap());
}

#[test]
fn a_field_shows_its_extremes_its_gaps_and_its_scale() {
    let field = |values: Vec<f64>| Field {
        label: "tension".to_owned(),
        unit: "N".to_owned(),
        x: vec![1.0, 2.0, 4.0],
        y: vec![10.0, 20.0],
        values,
    };
    let figure = |values| {
        let panel = Panel::new(Axis::new("pressure", "kPa")).field(field(values));
        Figure::new(Axis::new("mass", "kg")).panel(panel)
    };
    let hex = |place: u8| {
        let [r, g, b] = scale::colour(place);
        format!("#{r:02x}{g:02x}{b:02x}")
    };
    let svg = figure(vec![1.0, 2.0, 3.0, 4.0, f64::NAN, 6.0]).to_svg(Theme::Light).unwrap();
    // The bar has each colour once.
    let cells = |place| svg.matches(&format!(r#"fill="{}""#, hex(place))).count() - 1;
    assert_eq!([0, 255, 51, 102, 153, 25].map(cells), [1, 1, 1, 1, 1, 0], "{svg}");
    // Values of two signs have a scale that is symmetrical about zero, and many decades a logarithmic one.
    let two_signs = figure(vec![-6.0, -3.0, 0.0, 1.0, 2.0, 3.0]).to_svg(Theme::Light).unwrap();
    for tick in [">−5<", ">0<", ">5<"] {
        assert!(two_signs.contains(tick), "{tick}");
    }
    assert!(!two_signs.contains(&hex(0)), "the other scale");
    let decades = figure(vec![1.0, 1e1, 1e2, 1e3, 1e4, 1e5]).to_svg(Theme::Light).unwrap();
    let cells = |place| decades.matches(&format!(r#"fill="{}""#, hex(place))).count() - 1;
    assert_eq!([0, 51, 102, 153, 204, 255].map(cells), [1; 6], "equal ratios are equal steps");
    for word in [">tension (N)<", ">mass (kg)<", ">pressure (kPa)<"] {
        assert!(svg.contains(word), "{word}");
    }
    // What cannot be drawn is refused, what has one value or none is drawn.
    assert!(figure(vec![1.0; 5]).to_svg(Theme::Light).is_err());
    let mut falling = figure(vec![1.0; 6]);
    falling.panels[0].field.as_mut().unwrap().x.reverse();
    assert!(matches!(falling.to_svg(Theme::Light), Err(PlotError::Range { .. })));
    for values in [vec![5.0; 6], vec![f64::NAN; 6]] {
        assert!(figure(values).to_png(Theme::Dark, 1.0).is_ok());
    }
}

#[test]
fn figures_stand_side_by_side() {
    let one = simple(vec![0.0, 1.0], vec![1.0, 2.0]);
    let both = SideBySide {
        title: "two".to_owned(),
        note: String::new(),
        caption: "of them".to_owned(),
        figures: vec![one.clone(), one],
    };
    let svg = both.to_svg(Theme::Light).unwrap();
    assert_eq!((svg.matches(">time (s)<").count(), svg.matches(">two</text>").count()), (2, 1));
    assert!(svg.contains("width=\"170mm\"") && svg.contains(">of them<"), "{svg}");
    assert!(SideBySide::default().to_svg(Theme::Light).is_ok());
}

#[test]
fn themes_differ_only_in_colour() {
    let [light, dark, auto] = [Theme::Light, Theme::Dark, Theme::Auto].map(|t| full().to_svg(t).unwrap());
    let bare = |svg: &str| {
        let style = svg.lines().filter(|l| !l.starts_with("<style")).collect::<Vec<_>>().join("\n");
        let mut out = String::new();
        for part in style.split(" class=\"") {
            out.push_str(part.split_once('"').filter(|_| !out.is_empty()).map_or(part, |p| p.1));
        }
        let mut plain = String::new();
        for part in out.split('#') {
            plain.push_str(if plain.is_empty() { part } else { part.get(6..).unwrap_or("") });
        }
        plain
    };
    assert_eq!(bare(&light), bare(&dark));
    assert_eq!(bare(&light), bare(&auto));
    assert!(auto.contains("prefers-color-scheme:dark") && !light.contains("<style"));
}

#[test]
fn a_long_series_gives_a_small_file() {
    let t: Vec<f64> = (0..100_000).map(|i| f64::from(i) * 1e-4).collect();
    let ripple: Vec<f64> = t.iter().map(|t| 200.0 + 5.0 * (t * 300.0).sin() + (t * 7919.0).sin()).collect();
    let svg = simple(t, ripple).to_svg(Theme::Light).unwrap();
    assert!(svg.len() < 60_000, "{}", svg.len());
    let a: Vec<f64> = (0..100_000).map(|i| f64::from(i) * 1e-3).collect();
    let smooth = simple(a.iter().map(|a| a.cos()).collect(), a.iter().map(|a| (a * 1.01).sin()).collect());
    let svg = smooth.to_svg(Theme::Light).unwrap();
    assert!(svg.len() < 60_000, "{}", svg.len());
}

#[test]
fn many_intervals_are_shaded_by_their_share() {
    let spans = |n: i32| (0..n).map(|i| (f64::from(i), f64::from(i) + 0.5)).collect::<Vec<_>>();
    let svg = |n| {
        let panel = Panel::new(Axis::new("p", "kPa")).span(Span::intervals("open", spans(n)));
        Figure::new(Axis::new("t", "s")).panel(panel).to_svg(Theme::Light).unwrap()
    };
    assert!(svg(10).contains(r#"fill-opacity="0.16""#));
    let dense = svg(100_000);
    assert!(dense.contains(r#"fill-opacity="0.08""#) && dense.len() < 40_000, "{}", dense.len());
}

#[test]
fn hostile_words_stay_words() {
    let evil = "</text><script>alert(1)</script> \" & ' \u{0} \u{7} \u{fffe} ]]>";
    let mut figure = full().title(evil).caption(evil);
    figure.x = Axis::new(evil, evil);
    figure.panels[0].y.label = evil.to_string();
    figure.panels[0].series[0].label = evil.to_string();
    figure.panels[0].references.push(Reference::Horizontal {
        y: 181.0,
        label: evil.to_string(),
        colour: Colour::Neutral,
    });
    let svg = figure.to_svg(Theme::Auto).unwrap();
    assert!(!svg.contains("<script") && !svg.contains('\u{0}') && !svg.contains('\u{7}'));
    assert_eq!(svg.matches("<text").count(), svg.matches("</text>").count());
    assert!(figure.to_png(Theme::Light, 1.0).is_ok() && figure.to_pdf(Theme::Dark).is_ok());
}

#[test]
fn data_that_are_hardly_data_are_drawn() {
    let nan = f64::NAN;
    let inf = f64::INFINITY;
    let cases: Vec<(Vec<f64>, Vec<f64>)> = vec![
        (vec![], vec![]),
        (vec![1.0], vec![2.0]),
        (vec![nan], vec![nan]),
        (vec![0.0, 1.0, 2.0], vec![5.0, 5.0, 5.0]),
        (vec![0.0, 1.0, 2.0, 3.0], vec![1.0, nan, inf, 2.0]),
        (vec![1.0, 1.0, 1.0], vec![0.0, 1.0, 2.0]),
        (vec![0.0, 1.0], vec![1e-9, 3e-9]),
        (vec![0.0, 1e9], vec![-1e9, 1e9]),
        (vec![0.0, f64::MAX], vec![f64::MIN, f64::MAX]),
        (vec![0.0, f64::MIN_POSITIVE], vec![0.0, 5e-324]),
        (vec![0.0, 1.0], vec![101_325.0, 101_325.000_1]),
        (vec![3.0, 2.0, 1.0], vec![-0.0, 0.0, -0.0]),
    ];
    for (x, y) in cases {
        for style in [Style::Line, Style::Points, Style::LineAndPoints, Style::Steps] {
            for legend in [Legend::Auto, Legend::Above, Legend::Direct, Legend::Hidden] {
                let mut figure = simple(x.clone(), y.clone());
                figure.panels[0].series[0].style = style;
                figure.panels[0].legend = legend;
                let panel = figure.panels.remove(0);
                figure = figure.panel(panel.horizontal(nan, "nowhere").vertical(inf, "nowhere"));
                let svg = figure.to_svg(Theme::Light).unwrap();
                assert!(!svg.contains("NaN") && !svg.contains("inf"), "{x:?} {y:?} {svg}");
                assert!(figure.to_png(Theme::Dark, 0.5).is_ok());
            }
        }
    }
    assert!(Figure::default().to_svg(Theme::Light).is_ok() && Figure::default().to_png(Theme::Light, 1.0).is_ok());
}

#[test]
fn a_fixed_axis_over_distant_data_keeps_them_inside() {
    let mut figure = simple(vec![0.0, 1.0, 2.0], vec![-1e300, 1e300, 0.5]);
    figure.panels[0].y = Axis::new("y", "").starting_at(0.0).ending_at(1.0);
    figure.x = Axis::new("x", "").starting_at(0.5).ending_at(1.5);
    let svg = figure.to_svg(Theme::Light).unwrap();
    let numbers = svg.split([' ', 'M', 'L', 'H', 'V', 'Z', '"']).filter_map(|s| s.parse::<f64>().ok());
    assert!(numbers.into_iter().all(|v| v.abs() < 1000.0));
}

#[test]
fn contradictions_are_refused_by_name() {
    let uneven = simple(vec![0.0, 1.0], vec![0.0]).to_svg(Theme::Light).unwrap_err();
    assert_eq!(uneven.to_string(), r#"series "run" has 2 values of x and 1 of y; give as many of one as of the other"#);
    let mut backwards = full();
    backwards.x = Axis::new("time", "s").starting_at(2.0).ending_at(1.0);
    assert!(matches!(backwards.to_svg(Theme::Light), Err(PlotError::Range { .. })));
    assert!(matches!(full().size_mm(f64::NAN, 30.0).to_svg(Theme::Light), Err(PlotError::Dimension { .. })));
    assert!(matches!(full().to_png(Theme::Light, 100.0), Err(PlotError::Dimension { .. })));
}

#[test]
fn a_name_is_written_once() {
    let svg = full().to_svg(Theme::Light).unwrap();
    // The lower panel's only series repeats its axis; its span is new.
    assert_eq!(svg.matches(">valve</text>").count(), 1);
    let twice = full().panel(full().panels.remove(0)).to_svg(Theme::Light).unwrap();
    assert_eq!(twice.matches(">measured</text>").count(), 1);
}

#[test]
fn words_on_a_vertical_line_leave_before_they_cover_data_and_those_of_horizontal_ones_are_in_the_legend() {
    let svg = |points: i32, line: Reference| {
        let t: Vec<f64> = (0..points).map(|i| f64::from(i) * 0.01).collect();
        let y = t.iter().map(|t| (40.0 * t).sin()).collect();
        let mut figure = simple(t, y);
        figure.panels[0].references.push(line);
        figure.x.max = Some(10.0);
        figure.to_svg(Theme::Light).unwrap()
    };
    // Half of the axes is empty: the words stand on the line, set off from it. All is full: they are in the legend.
    let vertical = |x| Reference::Vertical { x, label: "rest".to_string() };
    let (beside, above) = (svg(500, vertical(7.5)), svg(1000, vertical(7.5)));
    assert!(beside.contains("paint-order") && beside.matches(">rest</text>").count() == 1);
    assert!(!above.contains("paint-order") && above.matches(">rest</text>").count() == 1);
    let twice = |points| {
        let horizontal = |y| Reference::Horizontal { y, label: "rest".to_string(), colour: Colour::Neutral };
        let svg = svg(points, horizontal(0.0));
        (svg.contains("paint-order"), svg.matches(">rest</text>").count())
    };
    assert_eq!([twice(500), twice(1000)], [(false, 1); 2]);
}

#[test]
fn the_ending_of_a_name_says_how_to_draw() {
    let of = |name: &str| Format::of(Path::new(name));
    assert!(full().bytes(of("a.svg").unwrap()).unwrap().starts_with(b"<svg"));
    assert!(full().bytes(of("b.PNG").unwrap()).unwrap().starts_with(b"\x89PNG"));
    assert!(full().bytes(of("c.pdf").unwrap()).unwrap().starts_with(b"%PDF"));
    let wrong = of("d.jpg").unwrap_err().to_string();
    assert!(wrong.contains("d.jpg") && [".svg", ".png", ".pdf"].iter().all(|known| wrong.contains(known)), "{wrong}");
}

/// A figure with both axes logarithmic: x from 0.1 to 1000, y from 1 to 100.
fn logarithmic(x: Vec<f64>, y: Vec<f64>) -> Figure {
    let panel = Panel::new(Axis::logarithmic("gain", "mm").starting_at(1.0).ending_at(100.0));
    let axis = Axis::logarithmic("frequency", "Hz").starting_at(0.1).ending_at(1000.0);
    Figure::new(axis).panel(panel.series(Series::line("", x, y)))
}

/// The points of the only curve, and the edges of its axes: left, top, right, bottom.
fn curve(figure: &Figure) -> (Vec<Vec<scene::Point>>, [f64; 4]) {
    let scene = layout::scene(figure).unwrap();
    let of = |ink| {
        let outlines = scene.items.iter().filter_map(|item| match item {
            scene::Item::Outline(outline) if outline.stroke.is_some_and(|stroke| stroke.ink == ink) => Some(outline),
            _ => None,
        });
        let mut lines: Vec<Vec<scene::Point>> = Vec::new();
        for step in outlines.flat_map(|outline| &outline.steps) {
            match (step, lines.last_mut()) {
                (scene::Step::Move(point), _) => lines.push(vec![*point]),
                (scene::Step::Line(point), Some(line)) => line.push(*point),
                _ => {}
            }
        }
        lines
    };
    let edges = of(scene::Ink::Axis).into_iter().find(|line| line.len() == 3).unwrap();
    (of(scene::Ink::Category(0)), [edges[0][0], edges[0][1], edges[2][0], edges[2][1]])
}

#[test]
fn equal_ratios_are_equally_far_apart_on_the_page() {
    let (lines, [left, top, right, bottom]) =
        curve(&logarithmic(vec![0.1, 1.0, 20.0, 1000.0], vec![1.0, 10.0, 5.0, 100.0]));
    // Decimal logarithms: 20 lies 2.301 of 4 decades along, 5 lies 0.699 of 2 decades up.
    let expected = [[0.0, 0.0], [0.25, 0.5], [0.575_257_5, 0.349_485], [1.0, 1.0]];
    for (point, [along, up]) in lines[0].iter().zip(expected) {
        assert!((point[0] - (left + along * (right - left))).abs() < 1e-4, "{lines:?}");
        assert!((point[1] - (bottom - up * (bottom - top))).abs() < 1e-4, "{lines:?}");
    }
    assert_eq!((lines.len(), lines[0].len()), (1, 4));
}

#[test]
fn what_has_no_logarithm_is_a_gap() {
    let inf = f64::INFINITY;
    let x = vec![1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0, -9.0, 10.0, 11.0];
    let y = vec![2.0, 3.0, 0.0, 4.0, 9.0, -5.0, 6.0, 7.0, 8.0, inf, 5.0];
    let (lines, _) = curve(&logarithmic(x, y));
    assert_eq!(lines.iter().map(Vec::len).collect::<Vec<_>>(), [2, 2, 2]);
    // What is hardly data is drawn, in every style, with every kind of span, mark, line and field.
    let bad = vec![0.0, -0.0, -1.0, f64::NAN, inf, -inf, 5e-324, f64::MAX, 1.0];
    for (x, y) in
        [(vec![0.0; 9], bad.clone()), (bad.clone(), vec![-1.0; 9]), (bad.clone(), bad.clone()), (vec![], vec![])]
    {
        for style in [Style::Line, Style::Points, Style::LineAndPoints, Style::Steps, Style::Dots] {
            let mut panel = Panel::new(Axis::logarithmic("gain", ""))
                .series(Series { style, ..Series::line("a", x.clone(), y.clone()) })
                .span(Span::between("b", x.clone(), y.clone(), vec![1.0; y.len()]))
                .span(Span::strip("c", -1.0, 0.5))
                .span(Span::intervals("d", vec![(-1.0, 0.0), (0.0, 2.0), (3.0, inf)]))
                .marks(Marks::at("e", Symbol::Plus, x.clone(), y.clone()))
                .marks(Marks::on_edge("f", Symbol::Cross, x.clone()))
                .horizontal(0.0, "nowhere")
                .vertical(-1.0, "nowhere");
            for legend in [Legend::Auto, Legend::Direct] {
                panel.legend = legend;
                let svg = Figure::new(Axis::logarithmic("x", "")).panel(panel.clone()).to_svg(Theme::Light).unwrap();
                assert!(
                    !svg.contains("NaN") && !svg.contains("inf") && !svg.contains(">nowhere<"),
                    "{x:?} {y:?} {svg}"
                );
            }
        }
    }
}

#[test]
fn spans_that_begin_at_zero_begin_at_the_edge() {
    let mut figure = logarithmic(vec![0.1, 1000.0], vec![1.0, 100.0]);
    let panel = figure.panels.remove(0);
    let (x, lower) = (vec![0.1, 1000.0], vec![-1.0, 0.0]);
    let spans = [Span::strip("", 0.0, 10.0), Span::between("", x, lower, vec![10.0; 2])];
    let [left, top, right, bottom] = curve(&logarithmic(vec![], vec![])).1;
    for span in spans {
        let scene = layout::scene(&figure.clone().panel(panel.clone().span(span))).unwrap();
        let shades = scene.items.iter().filter_map(|item| match item {
            scene::Item::Outline(outline) if outline.fill.is_some_and(|fill| fill.opacity < 1.0) => Some(outline),
            _ => None,
        });
        let points: Vec<_> = shades
            .flat_map(|outline| &outline.steps)
            .filter_map(|step| match step {
                scene::Step::Move(point) | scene::Step::Line(point) => Some(*point),
                _ => None,
            })
            .collect();
        let middle = 0.5 * (top + bottom);
        for corner in [[left, middle], [right, middle], [left, bottom], [right, bottom]] {
            let near = |point: &scene::Point| (point[0] - corner[0]).hypot(point[1] - corner[1]) < 0.05;
            assert!(points.iter().any(near), "{corner:?} {points:?}");
        }
        assert!(points.iter().all(|[_, y]| *y > middle - 0.05 && *y < bottom + 0.05));
    }
}

/// A power law is a straight line over logarithmic axes, of a point for each piece that is reduced, and a spike of one sample stays: series are
/// reduced where they are drawn, not where they are given.
#[test]
fn long_series_are_reduced_as_they_are_drawn() {
    let x: Vec<f64> = (0..200_000).map(|i| 10_f64.powf(-1.0 + f64::from(i) * 2e-5)).collect();
    let mut y: Vec<f64> = x.iter().map(|x| 10.0 * x.powf(0.25)).collect();
    assert!(curve(&logarithmic(x.clone(), y.clone())).0[0].len() < 8);
    y[40_000] = 99.0;
    let (lines, [_, top, _, bottom]) = curve(&logarithmic(x, y));
    let highest = lines[0].iter().map(|point| point[1]).fold(f64::MAX, f64::min);
    assert!((highest - (bottom - 0.5 * 99_f64.log10() * (bottom - top))).abs() < 0.03, "{lines:?}");
    assert!(lines[0].len() < 10, "{lines:?}");
}

#[test]
fn cells_of_a_logarithmic_field_meet_half_way_between_the_logarithms() {
    let field = Field { x: vec![0.0, 1.0, 100.0], y: vec![1.0], values: vec![7.0, 1.0, 2.0], ..Field::default() };
    let panel = Panel::new(Axis::new("", "")).field(field);
    let svg = Figure::new(Axis::logarithmic("x", "")).panel(panel).to_svg(Theme::Light).unwrap();
    // The cell of x = 0 has no place; two are drawn, from 0.1 over 10 to 1000.
    let hex = |place: u8| scale::colour(place).map(|c| format!("{c:02x}")).concat();
    // The value without a place is on the scale all the same: 1 is its lower end, 2 a sixth of the way to 7.
    let cell = |place| svg.matches(&hex(place)).count() - 1;
    assert_eq!((cell(0), cell(42) + cell(43), cell(255)), (1, 1, 0), "{svg}");
    for label in [">0.1<", ">1<", ">10<", ">100<", ">1000<"] {
        assert!(svg.contains(label), "{label}");
    }
}

#[test]
fn labels_of_logarithmic_axes_are_written_in_one_way() {
    let panel = |y: Vec<f64>| {
        Panel::new(Axis::logarithmic("y", "")).series(Series::line("", (1..=y.len()).map(|x| x as f64).collect(), y))
    };
    let plain = Figure::new(Axis::logarithmic("x", "")).panel(panel(vec![1.0, 10.0, 100.0]));
    assert!(plain.to_svg(Theme::Light).unwrap().contains(">100<"));
    let mixed = plain.panel(panel(vec![1e-7, 1.0, 1e7])).to_svg(Theme::Light).unwrap();
    assert!(!mixed.contains(">100<") && mixed.contains(">2</tspan>"), "{mixed}");
}

#[test]
fn a_legend_has_no_entry_twice() {
    let line = |x: f64| Series::line("run", vec![0.0, 1.0], vec![x, 2.0 * x]).dash(Dash::Solid);
    let panel = Panel::new(Axis::new("y", "")).series(line(1.0)).series(line(2.0)).legend(Legend::Above);
    let svg = Figure::new(Axis::new("x", "")).panel(panel).to_svg(Theme::Light).unwrap();
    assert_eq!(svg.matches(">run<").count(), 1);
}

/// Two lines of one name in the colours of two curves are two entries of the legend, each drawn in its colour.
#[test]
fn lines_in_the_colours_of_their_curves_are_distinct() {
    let panel = Panel::new(Axis::new("length", "mm"))
        .series(Series::line("a", vec![0.0, 1.0], vec![0.0, 4.0]))
        .horizontal(1.0, "max length")
        .horizontal_of(2.0, "max length, a", Colour::Category(0))
        .horizontal_of(3.0, "max length, b", Colour::Category(1));
    let svg = Figure::new(Axis::new("time", "s")).panel(panel).to_svg(Theme::Light).unwrap();
    let lines: Vec<&str> = svg.split('<').filter(|part| part.contains("stroke-dasharray")).collect();
    let strokes: Vec<&str> =
        lines.iter().map(|line| line.split("stroke=\"").nth(1).unwrap().split('"').next().unwrap()).collect();
    // The line and its sample in the legend, of each.
    let mut distinct = strokes.clone();
    distinct.sort_unstable();
    distinct.dedup();
    assert_eq!((strokes.len(), distinct.len()), (6, 3), "{svg}");
    for word in [">max length<", ">max length, a<", ">max length, b<"] {
        assert_eq!(svg.matches(word).count(), 1, "{word}");
    }
}

/// Marks that say where they are stay there, also on each other, and those that come later keep away from them.
#[test]
fn marks_that_are_read_are_not_moved() {
    let of = |stay: bool| {
        let at = || Marks::at("point", Symbol::Square, vec![1.0, 1.0], vec![2.0, 2.02]);
        let marks = if stay { at().staying() } else { at() };
        let panel = Panel::new(Axis::new("y", "").starting_at(0.0).ending_at(4.0)).marks(marks);
        Figure::new(Axis::new("x", "").starting_at(0.0).ending_at(2.0)).panel(panel).to_svg(Theme::Light).unwrap()
    };
    // A mark that is moved has a line to where it belongs.
    let leaders = |svg: &str| svg.matches(r#"stroke-width="0.5""#).count();
    assert_eq!(leaders(&of(false)), leaders(&of(true)) + 1);
}

/// A mark that would hide another stands beside it, with a line to where it belongs.
#[test]
fn marks_that_coincide_can_both_be_seen() {
    let area = scene::Area { left: 0.0, top: 0.0, right: 100.0, bottom: 50.0 };
    let mut taken = Vec::new();
    let mut all = Vec::new();
    for _ in 0..4 {
        let (moved, leaders) = draw::apart(&[[50.0, 3.0], [80.0, 20.0]], &mut taken, area);
        assert_eq!(leaders.steps.is_empty(), all.is_empty());
        all.extend(moved);
    }
    for (index, a) in all.iter().enumerate() {
        assert!(area.contains(*a));
        assert!(all[index + 1..].iter().all(|b| (a[0] - b[0]).hypot(a[1] - b[1]) > 4.0), "{all:?}");
    }
}

#[test]
fn panels_side_by_side_stand_level_whatever_stands_above_them() {
    let panel = || Panel::new(Axis::new("y", "")).series(Series::line("run", vec![0.0, 1.0], vec![1.0, 2.0]));
    let strip = Strip { label: "open".to_owned(), intervals: vec![(0.2, 0.4)], colour: Colour::Category(0) };
    let tall = Figure::new(Axis::new("x", "")).panel(panel().strip(strip).legend(Legend::Above));
    let low = Figure::new(Axis::new("x", "")).panel(panel().legend(Legend::Hidden));
    let heads = layout::laid_out(&tall, &[]).unwrap().1;
    let (scene, own) = layout::laid_out(&low, &heads).unwrap();
    assert!(own[0] < heads[0]);
    assert_eq!(scene.height, layout::laid_out(&tall, &heads).unwrap().0.height);
}
