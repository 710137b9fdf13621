//! probe
mod accuracy_table;
mod common;
#[test]
fn probe() {
    for case in accuracy_table::CASES {
        let began = std::time::Instant::now();
        let rows = case.measure();
        println!("{} ({:?})\n{}", case.command(), began.elapsed(), accuracy_table::table(&rows));
        for steps in &rows.steps {
            println!("{:?}", steps.iter().map(accuracy_table::chosen).collect::<Vec<_>>());
        }
    }
}
