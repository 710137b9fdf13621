//! The fewest points that draw the same curve.
//!
//! A run of points is reduced in two steps, both in points of the page, so that the scale of an axis does not matter:
//!
//! 1. Where x does not run back, each column of [`COLUMN`] keeps its first, lowest, highest and last point, in their
//!    order. What a pen draws of the column is the same, and no peak is lost. (U. Jugel et al., "M4: a
//!    visualization-oriented time series data aggregation", VLDB 2014.)
//! 2. Points that lie within [`TOLERANCE`] of the chord of their neighbours are dropped, as D. Douglas and T. Peucker
//!    did (Cartographica, 1973). This also serves loops, where x runs back.
//!
//! What is left is clipped to the axes here, in numbers, so that no back end needs a clip and a figure no identifiers.

use super::scene::{Area, Point};

/// The width of a column in pt: 0.09 mm, a quarter of the thinnest curve.
pub(super) const COLUMN: f64 = 0.25;
/// How far a drawn curve may pass from a point in pt: 7 µm.
const TOLERANCE: f64 = 0.02;
/// Runs are simplified in pieces of this many points, which bounds the work at one chord per point and piece.
const PIECE: usize = 512;

/// The stretches of a series that have places on the page. A point without one ends a stretch.
pub(super) fn runs(x: &[f64], y: &[f64], page: impl Fn(f64, f64) -> Option<Point>) -> Vec<Vec<Point>> {
    let mut runs = vec![Vec::new()];
    for (x, y) in x.iter().zip(y) {
        match (page(*x, *y), runs.last_mut()) {
            (Some(point), Some(run)) => run.push(point),
            (None, Some(run)) if !run.is_empty() => runs.push(Vec::new()),
            _ => {}
        }
    }
    runs.retain(|run| !run.is_empty());
    runs
}

/// The points of a run that are needed to draw it.
pub(super) fn reduce(run: &[Point]) -> Vec<Point> {
    let forth = run.windows(2).all(|w| w[0][0] <= w[1][0]);
    simplify(if forth { columns(run) } else { run.to_vec() })
}

/// First, lowest, highest and last point of each column of a run whose x does not run back.
fn columns(run: &[Point]) -> Vec<Point> {
    let mut kept = Vec::new();
    for column in run.chunk_by(|a, b| (a[0] / COLUMN).floor() == (b[0] / COLUMN).floor()) {
        let by_y = |a: &usize, b: &usize| column[*a][1].total_cmp(&column[*b][1]);
        let lowest = (0..column.len()).min_by(by_y).unwrap_or(0);
        let highest = (0..column.len()).max_by(by_y).unwrap_or(0);
        let mut indices = [0, lowest.min(highest), lowest.max(highest), column.len() - 1].to_vec();
        indices.dedup();
        kept.extend(indices.into_iter().map(|i| column[i]));
    }
    kept
}

/// Drops what lies within the tolerance of a chord.
fn simplify(run: Vec<Point>) -> Vec<Point> {
    if run.len() < 3 {
        return run;
    }
    let mut keep = vec![false; run.len()];
    let mut chords: Vec<(usize, usize)> =
        (0..run.len() - 1).step_by(PIECE).map(|i| (i, (i + PIECE).min(run.len() - 1))).collect();
    while let Some((a, b)) = chords.pop() {
        (keep[a], keep[b]) = (true, true);
        let far = (a + 1..b).map(|i| (i, distance(run[i], run[a], run[b]))).max_by(|p, q| p.1.total_cmp(&q.1));
        if let Some((i, _)) = far.filter(|(_, d)| *d > TOLERANCE) {
            chords.extend([(a, i), (i, b)]);
        }
    }
    run.into_iter().zip(keep).filter_map(|(p, keep)| keep.then_some(p)).collect()
}

/// From a point to the nearest of a chord, whose ends may coincide.
fn distance(p: Point, a: Point, b: Point) -> f64 {
    let (u, v) = ([b[0] - a[0], b[1] - a[1]], [p[0] - a[0], p[1] - a[1]]);
    let square = u[0] * u[0] + u[1] * u[1];
    let t = if square > 0.0 { ((u[0] * v[0] + u[1] * v[1]) / square).clamp(0.0, 1.0) } else { 0.0 };
    (v[0] - t * u[0]).hypot(v[1] - t * u[1])
}

/// Each value held until the next point.
pub(super) fn staircase(run: &[Point]) -> Vec<Point> {
    let mut stairs: Vec<Point> = run.first().copied().into_iter().collect();
    for w in run.windows(2) {
        if w[0][1] != w[1][1] {
            stairs.push([w[1][0], w[0][1]]);
        }
        stairs.push(w[1]);
    }
    stairs
}

/// The parts of a polyline inside an area. A single point stays one.
pub(super) fn clip(run: &[Point], area: Area) -> Vec<Vec<Point>> {
    if let [point] = run {
        return if area.contains(*point) { vec![vec![*point]] } else { Vec::new() };
    }
    let mut parts: Vec<Vec<Point>> = Vec::new();
    let mut open = false;
    for w in run.windows(2) {
        let Some([a, b]) = chord(w[0], w[1], area) else {
            open = false;
            continue;
        };
        match parts.last_mut().filter(|_| open) {
            Some(part) => part.push(b),
            None => parts.push(vec![a, b]),
        }
        open = b == w[1];
    }
    parts
}

/// The part of a chord inside an area. (Y.-D. Liang and B. Barsky, ACM Trans. Graphics, 1984.)
pub(super) fn chord(a: Point, b: Point, area: Area) -> Option<[Point; 2]> {
    let (mut enter, mut leave) = (0.0_f64, 1.0_f64);
    let sides = [(0, area.left, area.right), (1, area.top, area.bottom)];
    for (axis, low, high) in sides {
        let (from, along) = (a[axis], b[axis] - a[axis]);
        if along == 0.0 {
            if from < low || from > high {
                return None;
            }
            continue;
        }
        let (s, t) = ((low - from) / along, (high - from) / along);
        enter = enter.max(s.min(t));
        leave = leave.min(s.max(t));
    }
    let at = |t: f64| [a[0] + t * (b[0] - a[0]), a[1] + t * (b[1] - a[1])];
    // The ends themselves, not their recomputed twins, so that neighbours join.
    let start = if enter == 0.0 { a } else { at(enter) };
    let end = if leave == 1.0 { b } else { at(leave) };
    (enter <= leave).then_some([start, end])
}

/// The part of a polygon inside an area. (I. Sutherland and G. Hodgman, CACM, 1974.)
pub(super) fn clip_polygon(polygon: &[Point], area: Area) -> Vec<Point> {
    let sides = [(0, area.left, 1.0), (0, area.right, -1.0), (1, area.top, 1.0), (1, area.bottom, -1.0)];
    sides.iter().fold(polygon.to_vec(), |corners, (axis, at, sign)| {
        let depth = |p: Point| (p[*axis] - at) * sign;
        let mut inside = Vec::with_capacity(corners.len() + 4);
        for (i, b) in corners.iter().enumerate() {
            let a = corners[if i == 0 { corners.len() - 1 } else { i - 1 }];
            let (da, db) = (depth(a), depth(*b));
            if (da < 0.0) != (db < 0.0) {
                let t = da / (da - db);
                inside.push([a[0] + t * (b[0] - a[0]), a[1] + t * (b[1] - a[1])]);
            }
            if db >= 0.0 {
                inside.push(*b);
            }
        }
        inside
    })
}

/// One point of those that share a cell of a column's width, for clouds that cover themselves.
pub(super) fn thin(points: impl IntoIterator<Item = Point>) -> Vec<Point> {
    let mut taken = std::collections::BTreeSet::new();
    let cell = |v: f64| (v / COLUMN).round() as i64;
    points.into_iter().filter(|p| taken.insert((cell(p[0]), cell(p[1])))).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    const AREA: Area = Area { left: 0.0, top: 0.0, right: 10.0, bottom: 10.0 };

    #[test]
    fn gaps_split_a_series() {
        let x = [0.0, 1.0, 2.0, 3.0, f64::INFINITY, 5.0];
        let y = [0.0, f64::NAN, f64::NAN, 1.0, 1.0, 1.0];
        let page = |x: f64, y: f64| (x.is_finite() && y.is_finite()).then_some([x, y]);
        assert_eq!(runs(&x, &y, page), [[[0.0, 0.0]], [[3.0, 1.0]], [[5.0, 1.0]]]);
        assert!(runs(&[], &[], page).is_empty());
        assert!(runs(&[f64::NAN], &[1.0], page).is_empty());
    }

    #[test]
    fn extremes_survive() {
        // A ripple with two spikes of one sample each, over 200 pt.
        let mut run: Vec<Point> = (0..100_000).map(|i| [f64::from(i) * 2e-3, (f64::from(i) * 0.7).sin()]).collect();
        run[31_415][1] = 9.0;
        run[77_777][1] = -7.0;
        let kept = reduce(&run);
        assert!(kept.len() <= 4 * 801, "{}", kept.len());
        assert!(kept.contains(&run[31_415]) && kept.contains(&run[77_777]));
        assert_eq!((kept[0], kept[kept.len() - 1]), (run[0], run[99_999]));
        assert!(kept.windows(2).all(|w| w[0][0] <= w[1][0]));
    }

    #[test]
    fn no_point_is_farther_from_the_drawn_curve_than_the_tolerance() {
        // A spiral runs back, so only chords are dropped.
        let spiral = |i: i32| {
            let a = f64::from(i) * 1e-3;
            [40.0 + a * a.cos(), 40.0 + a * a.sin()]
        };
        let run: Vec<Point> = (0..20_000).map(spiral).collect();
        let kept = reduce(&run);
        assert!(kept.len() < 700, "{}", kept.len());
        for p in run.iter().step_by(7) {
            let nearest = kept.windows(2).map(|w| distance(*p, w[0], w[1])).fold(f64::INFINITY, f64::min);
            assert!(nearest <= TOLERANCE);
        }
    }

    #[test]
    fn straight_lines_need_two_points() {
        let run: Vec<Point> = (0..400).map(|i| [f64::from(i), 2.0 * f64::from(i)]).collect();
        assert_eq!(reduce(&run), [[0.0, 0.0], [399.0, 798.0]]);
        assert_eq!(reduce(&[[1.0, 1.0]]), [[1.0, 1.0]]);
    }

    #[test]
    fn what_leaves_the_axes_comes_back_at_the_edge() {
        let parts = clip(&[[-5.0, 5.0], [5.0, 5.0], [5.0, 15.0], [8.0, 15.0], [8.0, 5.0]], AREA);
        assert_eq!(parts, [vec![[0.0, 5.0], [5.0, 5.0], [5.0, 10.0]], vec![[8.0, 10.0], [8.0, 5.0]]]);
        assert!(clip(&[[20.0, 20.0], [30.0, 5.0]], AREA).is_empty());
        assert!(clip(&[[11.0, 1.0]], AREA).is_empty());
        let square = clip_polygon(&[[-5.0, -5.0], [5.0, -5.0], [5.0, 5.0], [-5.0, 5.0]], AREA);
        assert!(square.len() >= 4 && square.iter().all(|p| AREA.contains(*p)));
        assert!(clip_polygon(&[], AREA).is_empty());
    }

    #[test]
    fn stairs_hold_each_value() {
        assert_eq!(staircase(&[[0.0, 0.0], [1.0, 0.0], [2.0, 1.0]]), [[0.0, 0.0], [1.0, 0.0], [2.0, 0.0], [2.0, 1.0]]);
        assert!(staircase(&[]).is_empty());
    }
}
