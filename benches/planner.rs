//! The planner: a plan of a cut and of a hole on maps that are at hand, and the maps themselves.

use std::hint::black_box;

use benchdog::{
    planner::{self, RobotMap, WorkMap},
    scenario::paper,
};
use criterion::{Criterion, criterion_group, criterion_main};

fn planner(criterion: &mut Criterion) {
    let operation = |name: &str| {
        let found = paper::operations().into_iter().find(|operation| operation.name == name);
        found.expect("the paper's operations").load().expect("they are sound")
    };
    let loaded = operation("drill-5");
    let map = RobotMap::new(&loaded.robot, loaded.scenario.object.size_m);
    let mut group = criterion.benchmark_group("planner");
    group.sample_size(10);
    group.bench_function("map of the robot", |bencher| {
        bencher.iter(|| RobotMap::new(black_box(&loaded.robot), loaded.scenario.object.size_m));
    });
    for name in ["cut-05", "drill-5"] {
        let scenario = operation(name).scenario;
        group.bench_function(format!("map of the work/{name}"), |bencher| {
            bencher.iter(|| WorkMap::new(black_box(&scenario), &map).expect("a sound person"));
        });
        let work = WorkMap::new(&scenario, &map).expect("a sound person");
        group.bench_function(format!("plan/{name}"), |bencher| {
            bencher.iter(|| planner::plan_with(black_box(&scenario), &map, &work, &mut planner::nobody));
        });
    }
    group.finish();
}

criterion_group!(benches, planner);
criterion_main!(benches);
