//! `docs/accuracy.md` and its figure say what the engines do: every figure on the page is measured again.
//!
//! `cargo xtask accuracy` writes both; it is this test with `MCKIBBEN_WRITE` set.

use crate::accuracy_table::{CASES, Case, STEPS, figure, page};
use crate::common::of_repository;

const PAGE: &str = "docs/accuracy.md";
const FIGURE: &str = "docs/accuracy.svg";

/// The page's words, and the cells that are numbers, which another machine may round another way.
fn read(page: &str) -> (Vec<&str>, Vec<&str>) {
    let cells = page.split(['|', '\n']).map(str::trim);
    cells.partition(|cell| cell.parse::<f64>().is_err())
}

/// Whether two cells agree within their last digit: an error to two digits, an order to a tenth.
fn agree(one: &str, other: &str) -> bool {
    let [a, b] = [one, other].map(|cell| cell.parse::<f64>().expect("a number"));
    let last = if one.contains('e') { 0.1 * a.abs().max(b.abs()) } else { 0.1 };
    (a - b).abs() < 1.01 * last
}

#[test]
fn the_page_says_what_is_measured() {
    let rows: Vec<_> = CASES.iter().map(Case::measure).collect();
    let text = page(&rows);
    let path = of_repository(PAGE);
    if std::env::var_os("MCKIBBEN_WRITE").is_some() {
        std::fs::write(&path, &text).expect("writable");
        let figure = figure(&rows);
        let path = of_repository(FIGURE);
        let bytes = figure.bytes(mckibben_plot::Format::of(&path).expect("a known ending")).expect("a figure");
        std::fs::write(&path, bytes).expect("writable");
        println!("wrote {PAGE} and {FIGURE}");
        return;
    }
    let written = std::fs::read_to_string(&path).expect("the page");
    let ((words, numbers), (said, figures)) = (read(&text), read(&written));
    assert_eq!((said, figures.len()), (words, numbers.len()), "run `cargo xtask accuracy`");
    for (said, measured) in figures.into_iter().zip(numbers) {
        assert!(agree(said, measured), "{PAGE} says {said}, but {measured} is measured; run `cargo xtask accuracy`");
    }
}

#[test]
fn runge_kutta_is_of_order_four_where_nothing_has_a_kink_and_the_stable_method_of_order_two() {
    // The ring-down is sealed: no flow law, no valve.
    let rows = CASES[1].measure();
    for (errors, order) in rows.errors.iter().zip([4.0, 2.0]) {
        let at = |step: f64| STEPS.iter().position(|of| *of == step).expect("on the page");
        let [coarse, fine] = [2e-3, 1e-3].map(|step| errors[at(step)].as_ref().expect("steps").greatest());
        let observed = (coarse / fine).log2();
        assert!((observed - order).abs() < 0.1, "{observed}");
    }
}
