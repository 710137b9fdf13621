//! `docs/accuracy.md` and its figure say what the engines do: every figure on the page is measured anew.
//!
//! `cargo xtask accuracy` writes both; it is this test with `MCKIBBEN_WRITE` set.

mod accuracy_table;
mod common;

use accuracy_table::{CASES, page};
use common::of_repository;

const PAGE: &str = "docs/accuracy.md";
const FIGURE: &str = "docs/accuracy.svg";

/// What two figures on the page may differ by on another machine: half a unit of the second digit, and its rounding.
const DIGITS: f64 = 0.11;

/// The page's words, and its numbers with exponents apart, which another machine may round another way.
fn read(page: &str) -> (Vec<&str>, Vec<f64>) {
    let number = |word: &str| word.contains("e-").then(|| word.parse().ok()).flatten();
    let words = page.split_whitespace();
    (words.clone().filter(|word| number(word).is_none()).collect(), words.filter_map(number).collect())
}

#[test]
fn the_page_says_what_is_measured() {
    let rows: Vec<_> = CASES.iter().map(accuracy_table::Case::measure).collect();
    let text = page(&rows);
    let path = of_repository(PAGE);
    if std::env::var_os("MCKIBBEN_WRITE").is_some() {
        std::fs::write(&path, &text).expect("writable");
        let figure = accuracy_table::figure(&rows);
        figure.write(&of_repository(FIGURE), mckibben_cli::plot::Theme::Light).expect("a figure");
        println!("wrote {PAGE} and {FIGURE}");
        return;
    }
    let written = std::fs::read_to_string(&path).expect("the page");
    let ((words, numbers), (said, figures)) = (read(&text), read(&written));
    assert_eq!(said, words, "run `cargo xtask accuracy`");
    assert_eq!(figures.len(), numbers.len());
    for (said, measured) in figures.into_iter().zip(numbers) {
        assert!((said / measured - 1.0).abs() < DIGITS, "{PAGE} says {said:e}, but {measured:e} is measured");
    }
}

#[test]
fn runge_kutta_is_of_order_four_where_nothing_has_a_kink_and_the_stable_method_of_order_two() {
    // The ring-down is sealed: no flow law, no valve.
    let rows = CASES[1].measure();
    for (errors, order) in rows.errors.iter().zip([4.0, 2.0]) {
        let [coarse, fine] = [0, 1].map(|index| errors[index].as_ref().expect("steps").greatest());
        let observed = (coarse / fine).log2();
        assert!((observed - order).abs() < 0.1, "{observed}");
    }
}
