use benchdog::{
    model::{operation::OperationKind, staged_plan::Stage, task::*, tool_path::*},
    planner::{Event, Planner, Watch},
    scenario,
};
use std::time::Instant;
struct W(Instant);
impl benchdog::model::stop::Stop for W {
    fn is_stopped(&self) -> bool {
        false
    }
}
impl Watch for W {
    fn tell(&self, e: &Event<'_>) {
        if let Event::Part(p) = e {
            if p.done == 0 {
                eprintln!("{:7.3} {}", self.0.elapsed().as_secs_f64(), p.phase);
            }
        }
    }
}
fn main() {
    let loaded = scenario::load(std::path::Path::new("scenarios/cut-rim.toml")).unwrap();
    let radius: f64 = std::env::args().nth(1).map_or(0.12, |a| a.parse().unwrap());
    let least: f64 = std::env::args().nth(2).map_or(0.5, |a| a.parse().unwrap());
    let task = Task {
        kind: OperationKind::Cut,
        force_n: 30.0,
        path: vec![Stroke::Circle { centre_m: [0.0; 2], radius_m: radius, start_deg: -11.25 }],
        speed_m_s: 0.03,
        piece_m: 0.05,
        least_comfort: least,
        regrasp_cost: 1.0,
        move_cost: 0.1,
        motion: MotionSettings::default(),
    };
    let planner = Planner::new(&loaded.robot);
    planner.prepare(&loaded.scenario).unwrap();
    let w = W(Instant::now());
    match planner.search(&loaded.scenario).watch(&w).task(&task).unwrap() {
        Ok(found) => {
            println!("{:.3} s", w.0.elapsed().as_secs_f64());
            for s in &found.staged.stages {
                match s {
                    Stage::Hold(h) => println!(
                        "hold {} pieces {:?}",
                        h.pieces.len(),
                        h.pieces
                            .iter()
                            .map(|p| (p.comfort.unwrap().objective * 10.0).round() / 10.0)
                            .collect::<Vec<_>>()
                    ),
                    Stage::Move(m) => println!("move {:?} {:.2} s", m.person, m.time_s.last().unwrap()),
                    Stage::Regrasp(r) => {
                        println!("regrasp {} {:?} {:.2} s", r.arm.name, r.person, r.time_s.last().unwrap())
                    }
                }
            }
            println!(
                "best {:?}",
                found
                    .separate
                    .iter()
                    .map(|p| (p.as_ref().unwrap().comfort.unwrap().objective * 10.0).round() / 10.0)
                    .collect::<Vec<_>>()
            );
            std::fs::write("/tmp/t22/staged.json", serde_json::to_string_pretty(&found.staged).unwrap()).unwrap();
            sim_it::go(&loaded, &found.staged);
        }
        Err(why) => println!("{why}\n{:.3} s", w.0.elapsed().as_secs_f64()),
    }
}
mod sim_it {
    use benchdog::{
        check::{CheckedPlan, StagedStates},
        judge::judge_staged,
        model::{staged_plan::StagedPlan, stop::Never},
        scenario::LoadedScenario,
        sim::{Conditions, simulate_staged},
    };
    pub fn go(loaded: &LoadedScenario, plan: &StagedPlan) {
        let t0 = std::time::Instant::now();
        let states = match StagedStates::new(&loaded.robot, plan) {
            Ok(s) => s,
            Err(f) => {
                println!("FLAW {f}");
                return;
            }
        };
        let s = &loaded.scenario;
        let mut pieces = Vec::new();
        for p in &states.pieces {
            match StagedStates::checked(&loaded.robot, p, &s.human, &s.tool) {
                Ok(c) => pieces.push(c),
                Err(f) => {
                    println!("FLAWS {} {f}", p.plan.name);
                    return;
                }
            }
        }
        for c in &pieces {
            if let Some(x) = c.first_contact(0.0) {
                println!("contact {} {}", c.plan().name, x.reason);
            }
            if let Some(x) = c.why_not_so(&s.limits) {
                println!("not so {} {x}", c.plan().name);
            }
        }
        let mut initial_plan = states.pieces[0].plan.clone();
        initial_plan.object.x_wo = states.holdings[0].x_wo;
        initial_plan.arms = states.holdings[0].arms.clone();
        initial_plan.human = None;
        let initial = CheckedPlan::new(&loaded.robot, &initial_plan, &s.human, &s.tool).unwrap();
        let mut conditions = Conditions::of(s);
        conditions.settings.ramp_s = 0.5;
        println!("checked {:?}", t0.elapsed());
        let t0 = std::time::Instant::now();
        let trace = simulate_staged(plan, &states, &initial, &pieces, &conditions, &Never).unwrap();
        println!(
            "simulated {:.1} s in {:?}; broke {:?} touch {:?} {:?}",
            trace.trace.samples.last().unwrap().time_s,
            t0.elapsed(),
            trace.trace.broke_down,
            trace.trace.person_touch,
            trace.trace.robot_touch
        );
        for i in [0usize, 1, 10, 24, 25, 26, 30, 200, 300] {
            let s = &trace.trace.samples[i];
            println!(
                "{i} {} {:?} contact {} pads {:?}",
                s.time_s,
                s.phase,
                s.has_contact(),
                s.arms.iter().flat_map(|a| a.pads.iter().map(|p| p.normal_force_n)).collect::<Vec<_>>()
            );
        }
        for j in judge_staged(&trace, plan, &s.limits) {
            println!(
                "stage {} {} {:.2}..{:.2} s: {} {:?} {:?}",
                j.span.stage,
                plan.stages[j.span.stage].name(),
                trace.trace.samples[j.span.first].time_s,
                trace.trace.samples[j.span.last].time_s,
                j.judgement.verdict,
                j.judgement.first_failure,
                j.judgement.reason
            );
            println!(
                "    {}",
                j.judgement
                    .checks
                    .iter()
                    .map(|c| format!("{} {:.2}/{}", c.name, c.value, c.limit))
                    .collect::<Vec<_>>()
                    .join(", ")
            );
        }
    }
}
