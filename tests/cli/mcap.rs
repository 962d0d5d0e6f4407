//! MCAP files: written by `--mcap`, read with the library, and as measured forces.

use std::{
    collections::{BTreeMap, BTreeSet},
    fs,
    path::Path,
};

use mcap::MessageStream;

use crate::{
    process::{benchdog, folder, json, slipping_scenario, stderr},
    task::too_fast,
};

/// The type of a topic, and its messages: times, ns, and bytes.
type Topic = (String, Vec<(u64, Vec<u8>)>);

/// The topics of a file.
fn topics(bytes: &[u8]) -> BTreeMap<String, Topic> {
    let mut topics = BTreeMap::<String, Topic>::new();
    for message in MessageStream::new(bytes).unwrap() {
        let message = message.unwrap();
        let schema = message.channel.schema.as_ref().unwrap();
        assert_eq!((schema.encoding.as_str(), message.channel.message_encoding.as_str()), ("ros2msg", "cdr"));
        let entry = topics.entry(message.channel.topic.clone());
        let entry = entry.or_insert_with(|| (schema.name.clone(), Vec::new()));
        entry.1.push((message.log_time, message.data.to_vec()));
    }
    topics
}

/// The number of 64 bits at a place after the header of a message.
fn number(data: &[u8], at: usize) -> f64 {
    f64::from_le_bytes(data[4 + at..12 + at].try_into().unwrap())
}

/// Runs a hold that slips with `--mcap` in a folder, and the bytes of its file.
fn slipped(folder: &Path) -> Vec<u8> {
    slipping_scenario(folder, "a", "slips");
    let output = benchdog(folder, &["run", "a.toml", "--mcap", "--record", "never"]);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    fs::read(folder.join("out/a/trace.mcap")).unwrap()
}

#[test]
fn an_mcap_file_has_joints_wrenches_board_links_and_checks_as_ros_messages() {
    let folder = tempfile::tempdir().unwrap();
    let bytes = slipped(folder.path());
    let topics = topics(&bytes);
    let kinds: Vec<_> = topics.iter().map(|(topic, (kind, _))| (topic.as_str(), kind.as_str())).collect();
    for (topic, kind) in [
        ("/joint_states", "sensor_msgs/msg/JointState"),
        ("/board/pose", "geometry_msgs/msg/PoseStamped"),
        ("/tool/wrench", "geometry_msgs/msg/WrenchStamped"),
        ("/hands/left/wrench", "geometry_msgs/msg/WrenchStamped"),
        ("/hands/right/wrench", "geometry_msgs/msg/WrenchStamped"),
        ("/checks/slip", "std_msgs/msg/Float64"),
        ("/load_factor", "std_msgs/msg/Float64"),
        ("/tf", "tf2_msgs/msg/TFMessage"),
        ("/rosout", "rcl_interfaces/msg/Log"),
    ] {
        assert!(kinds.contains(&(topic, kind)), "{topic}: {kinds:?}");
    }
    // The slip exceeds its limit first at the time of the verdict's first failure.
    let verdict = json(&folder.path().join("out/a/verdict.json"));
    let limit_mm = verdict["checks"][0]["limit"].as_f64().unwrap();
    let slips = &topics["/checks/slip"].1;
    let (crossed_ns, _) = slips.iter().find(|(_, data)| number(data, 0) > limit_mm).unwrap();
    let failure_s = verdict["first_failure"]["time_s"].as_f64().unwrap();
    assert_eq!(*crossed_ns, (failure_s * 1e9).round() as u64);
    // Of every sample one message.
    assert_eq!(topics["/board/pose"].1.len(), topics["/joint_states"].1.len());
}

/// The judge has a series for each stage, the recording has one for the task.
#[test]
fn the_checks_of_a_task_are_at_the_times_of_its_joints_and_one_is_at_the_failure() {
    let (plan, _) = too_fast();
    let folder = folder(&[("plan.json", &plan.to_string())]);
    let output = benchdog(folder.path(), &["simulate", "plan.json", "--mcap", "--record", "never"]);
    assert_eq!(output.status.code(), Some(1), "{}", stderr(&output));
    let results = folder.path().join("out").join(plan["name"].as_str().unwrap());
    let topics = topics(&fs::read(results.join("trace.mcap")).unwrap());
    let times = |topic: &str| topics[topic].1.iter().map(|(time_ns, _)| *time_ns).collect::<BTreeSet<_>>();
    let joints = times("/joint_states");
    assert!(joints.len() > 100);
    for topic in topics.keys().filter(|topic| topic.starts_with("/checks/")) {
        assert!(times(topic).is_subset(&joints), "{topic}");
    }
    let verdict = json(&results.join("verdict.json"));
    let failure = &verdict["failed"]["first_failure"];
    let failed = verdict["stages"].as_array().unwrap().last().unwrap();
    let is_crossed = |check: &&serde_json::Value| check["name"] == failure["check"];
    let limit = failed["checks"].as_array().unwrap().iter().find(is_crossed).unwrap()["limit"].as_f64().unwrap();
    let failure_ns = (failure["time_s"].as_f64().unwrap() * 1e9).round() as u64;
    let at_failure = &topics[&format!("/checks/{}", failure["check"].as_str().unwrap())].1;
    let (_, data) = at_failure.iter().find(|(time_ns, _)| *time_ns == failure_ns).expect("a message at the failure");
    assert!(number(data, 0) > limit);
}

#[test]
fn equal_runs_give_equal_mcap_files_and_a_run_without_removes_that_of_an_earlier_one() {
    let [one, two] = [tempfile::tempdir().unwrap(), tempfile::tempdir().unwrap()];
    assert!(slipped(one.path()) == slipped(two.path()), "two files of one run differ");
    let output = benchdog(one.path(), &["run", "a.toml", "--record", "never"]);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    assert!(!one.path().join("out/a/trace.mcap").exists());
}

/// The scenario of a plan under the forces of a file.
fn measured(name: &str, file: &str, topic: &str) -> String {
    let text = fs::read_to_string(crate::common::root().join("scenarios/fails-weak-grip.toml")).unwrap();
    let text = text.replace("fails-weak-grip", name);
    format!("{text}\n[load]\nkind = \"measured\"\nfile = \"{file}\"\n{topic}")
}

#[test]
fn measured_forces_are_read_from_a_topic_of_an_mcap_file() {
    let folder = tempfile::tempdir().unwrap();
    slipped(folder.path());
    fs::copy(folder.path().join("out/a/trace.mcap"), folder.path().join("forces.mcap")).unwrap();
    let chosen = measured("b", "forces.mcap", "topic = \"/tool/wrench\"\n");
    fs::write(folder.path().join("b.toml"), chosen).unwrap();
    let output = benchdog(folder.path(), &["run", "b.toml"]);
    assert!([Some(0), Some(1)].contains(&output.status.code()), "{}", stderr(&output));
    // The recorded scenario has the forces of the file. They grow from 0 to 30 N.
    let scenario =
        benchdog(folder.path(), &["simulate", "out/b/plan.json", "--scenario", "b.toml", "--mcap", "--out", "again"]);
    assert!([Some(0), Some(1)].contains(&scenario.status.code()), "{}", stderr(&scenario));
    let again = fs::read(folder.path().join("again/b/trace.mcap")).or_else(|_| {
        let name = json(&folder.path().join("out/b/plan.json"))["name"].as_str().unwrap().to_owned();
        fs::read(folder.path().join("again").join(name).join("trace.mcap"))
    });
    let wrenches = &topics(&again.unwrap())["/tool/wrench"].1;
    // After the header: stamp, length and text of the frame `world`, padding to 16 bytes.
    let force_n = |data: &[u8]| (0..3).map(|axis| number(data, 24 + 8 * axis).powi(2)).sum::<f64>().sqrt();
    let most_n = wrenches.iter().map(|(_, data)| force_n(data)).fold(0.0, f64::max);
    assert!(most_n > 10.0 && most_n < 31.0, "{most_n}");
}

#[test]
fn errors_of_mcap_files_name_file_topic_and_what_was_found() {
    let folder = tempfile::tempdir().unwrap();
    let bytes = slipped(folder.path());
    let refused = |name: &str, bytes: &[u8], topic: &str| {
        fs::write(folder.path().join("forces.mcap"), bytes).unwrap();
        fs::write(folder.path().join(format!("{name}.toml")), measured(name, "forces.mcap", topic)).unwrap();
        let output = benchdog(folder.path(), &["run", &format!("{name}.toml")]);
        assert_eq!(output.status.code(), Some(2), "{name}: {}", stderr(&output));
        stderr(&output)
    };
    let several = refused("several", &bytes, "");
    assert!(several.contains("forces.mcap: found the topics ") && several.contains("\"/tool/wrench\""), "{several}");
    assert!(several.contains("expected one topic with wrenches, or load.topic"), "{several}");
    let other = refused("other", &bytes, "topic = \"/wrench\"\n");
    assert!(other.contains("expected the topic \"/wrench\" with messages geometry_msgs/WrenchStamped"), "{other}");
    let cut = refused("cut", &bytes[..bytes.len() / 2], "topic = \"/tool/wrench\"\n");
    assert!(cut.contains("forces.mcap: found a damaged MCAP file: "), "{cut}");
    let empty = refused("empty", b"", "");
    assert!(empty.contains("forces.mcap: found a damaged MCAP file: "), "{empty}");
}

#[test]
fn a_topic_is_for_mcap_files_only() {
    let scenario = measured("c", "forces.csv", "topic = \"/wrench\"\n");
    let forces = "time_s,fx_n,fy_n,fz_n,mx_nm,my_nm,mz_nm\n0,0,0,0,0,0,0\n1,0,30,0,0,0,0\n";
    let plan = fs::read_to_string(crate::common::root().join("scenarios/plans/cut-rim-weak-grip.json")).unwrap();
    let folder = folder(&[("c.toml", &*scenario), ("forces.csv", forces), ("plans/cut-rim-weak-grip.json", &*plan)]);
    let output = benchdog(folder.path(), &["run", "c.toml"]);
    let message = stderr(&output);
    assert_eq!(output.status.code(), Some(2), "{message}");
    assert!(message.contains("load.topic: ") && message.contains("MCAP file"), "{message}");
}
