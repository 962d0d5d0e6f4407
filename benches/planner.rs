//! The planner: its maps, and a plan of a cut and of a hole on kept maps; the maps of two Panda arms beside those of Baxter.

#[path = "../tests/common/serial.rs"]
mod serial;

use std::hint::black_box;

use benchdog::{planner::Planner, reproduce::paper};
use criterion::{Criterion, criterion_group, criterion_main};

fn planner(criterion: &mut Criterion) {
    let operation = |name: &str| {
        let found = paper::printed_operations().into_iter().find(|operation| operation.name == name);
        found.expect("the paper's operations").load().expect("they are valid")
    };
    let loaded = operation("drill-5");
    let mut group = criterion.benchmark_group("planner");
    group.sample_size(10);
    group.bench_function("grasp library", |bencher| {
        bencher.iter(|| Planner::new(black_box(&loaded.robot)).prepare_library(&loaded.scenario));
    });
    for name in ["cut-05", "drill-5"] {
        let scenario = operation(name).scenario;
        group.bench_function(format!("library and warm starts/{name}"), |bencher| {
            bencher.iter(|| Planner::new(black_box(&loaded.robot)).prepare(&scenario).expect("a valid person"));
        });
        let planner = Planner::new(&loaded.robot);
        planner.prepare(&scenario).expect("a valid person");
        group.bench_function(format!("plan/{name}"), |bencher| bencher.iter(|| planner.plan(black_box(&scenario))));
    }
    let pandas = serial::pandas(&[0.45, -0.45].map(|y_m| [[0.0, y_m, 0.0], [0.0; 3]]));
    group.bench_function("library and warm starts/drill-5, two Pandas", |bencher| {
        bencher.iter(|| Planner::new(black_box(&pandas)).prepare(&loaded.scenario).expect("a valid person"));
    });
    group.finish();
}

criterion_group!(benches, planner);
criterion_main!(benches);
