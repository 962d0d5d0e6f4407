//! The targets that are called without a process: readers of files.

use std::{fmt::Display, fs, path::Path};

use benchdog::{
    robot::Robot,
    scenario::{self, import},
};
use rand_pcg::Pcg64;

use crate::{
    driver::{Files, Target, check},
    parts::{DRILL, HEAD, SCENARIO, files, paths, text, texts},
};

/// A mutation of no format.
pub fn general(_: &mut Vec<u8>, _: &mut Pcg64) -> bool {
    false
}

/// Accepts what was read, and an error that names a file in the folder and fits on a terminal.
pub fn read_or_refused<T>(read: Result<T, impl Display>, folder: &Path) -> Result<(), String> {
    let Err(error) = read else { return Ok(()) };
    let message = error.to_string();
    let names: Vec<_> = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().file_name()).collect();
    if !names.iter().any(|name| message.contains(&*name.to_string_lossy())) {
        return Err(format!("the error names no file: {message}"));
    }
    if message.len() > 50_000 {
        return Err(format!("the error has {} bytes", message.len()));
    }
    Ok(())
}

fn cases(paths: Vec<String>, name: &str) -> impl Iterator<Item = Files> {
    paths.into_iter().map(move |path| files(&[(name, &path)]))
}

fn any_scenario(folder: &Path, name: &str) -> Result<(), String> {
    let path = folder.join(name);
    match scenario::scenario_text(&path) {
        Ok(text) if scenario::is_task(&text) => read_or_refused(scenario::load_task(&path), folder),
        _ => read_or_refused(scenario::load(&path), folder),
    }
}

#[test]
fn any_scenario_is_read_or_refused() {
    let mut valid: Vec<Files> = cases(paths("scenarios", ".toml"), "a.toml").collect();
    valid.extend(cases(paths("assets/init/task/tasks", ".toml"), "a.toml"));
    valid.push(texts(&[("a.toml", SCENARIO)]));
    check(&Target { name: "scenario", valid, cases: 300, mutate: general, run: any_scenario });
}

#[test]
fn any_plan_is_read_or_refused() {
    let mut valid: Vec<Files> = cases(paths("scenarios/plans", ".json"), "plan.json").collect();
    valid.extend(cases(paths("tests/data/holds", ".json"), "plan.json").take(2));
    valid.extend(cases(paths("assets/init/your-plan/plans", ".json"), "plan.json"));
    valid.push(files(&[("plan.json", "assets/init/cut/plans/cut.json")]));
    valid.push(files(&[("plan.json", "assets/init/task/plans/pair.json")]));
    fn run(folder: &Path, name: &str) -> Result<(), String> {
        read_or_refused(scenario::load_any_plan(&folder.join(name), None), folder)
    }
    check(&Target { name: "plan", valid, cases: 300, mutate: general, run });
}

#[test]
fn any_description_and_urdf_of_a_robot_are_read_or_refused() {
    let robots = ["baxter", "dual-panda", "dual-ur5"];
    let valid = robots.map(|robot| {
        let (description, urdf) = (format!("assets/{robot}.toml"), format!("assets/{robot}.urdf"));
        files(&[("robot.toml", &description), (&format!("{robot}.urdf"), &urdf)])
    });
    fn run(folder: &Path, name: &str) -> Result<(), String> {
        read_or_refused(Robot::load(name, folder), folder)
    }
    check(&Target { name: "robot", valid: valid.to_vec(), cases: 300, mutate: general, run });
}

/// A tetrahedron as text.
const STL: &str = "solid a
facet normal 0 0 -1\nouter loop\nvertex 0 0 0\nvertex 0 0.1 0\nvertex 0.1 0 0\nendloop\nendfacet
facet normal 0 -1 0\nouter loop\nvertex 0 0 0\nvertex 0.1 0 0\nvertex 0 0 0.1\nendloop\nendfacet
facet normal -1 0 0\nouter loop\nvertex 0 0 0\nvertex 0 0 0.1\nvertex 0 0.1 0\nendloop\nendfacet
facet normal 1 1 1\nouter loop\nvertex 0.1 0 0\nvertex 0 0.1 0\nvertex 0 0 0.1\nendloop\nendfacet
endsolid a
";

/// The same with corners that are shared, materials and texture coordinates.
const OBJ: &str = "mtllib a.mtl\no a\nv 0 0 0\nv 0.1 0 0\nv 0 0.1 0\nv 0 0 0.1\nvt 0 0\nvn 0 0 1\nusemtl red
f 1/1/1 3/1/1 2/1/1\nf 1//1 2//1 4//1\nf 1 4 3\nf -3 -2 -1\nf 1 2 3 4\n";

const MTL: &str = "newmtl red\nKa 1 0 0\nKd 1 0 0\nNs 10\nillum 2\nmap_Kd a.png\n";

/// The same in COLLADA.
const DAE: &str = r##"<?xml version="1.0" encoding="utf-8"?>
<COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1">
<asset><unit name="centimeter" meter="0.01"/><up_axis>Z_UP</up_axis></asset>
<library_effects><effect id="red-effect"><profile_COMMON><technique sid="common"><phong><diffuse><color>1 0 0 1</color></diffuse>
</phong></technique></profile_COMMON></effect></library_effects>
<library_materials><material id="red" name="red"><instance_effect url="#red-effect"/></material></library_materials>
<library_geometries><geometry id="g"><mesh>
<source id="p"><float_array id="pa" count="12">0 0 0 10 0 0 0 10 0 0 0 10</float_array>
<technique_common><accessor source="#pa" count="4" stride="3">
<param name="X" type="float"/><param name="Y" type="float"/><param name="Z" type="float"/>
</accessor></technique_common></source>
<vertices id="v"><input semantic="POSITION" source="#p"/></vertices>
<triangles material="red" count="2"><input semantic="VERTEX" source="#v" offset="0"/>
<p>0 2 1 0 1 3</p></triangles>
<polylist material="red" count="2"><input semantic="VERTEX" source="#v" offset="0"/>
<vcount>3 3</vcount><p>0 3 2 1 2 3</p></polylist>
</mesh></geometry></library_geometries>
<library_visual_scenes><visual_scene id="s"><node id="n"><matrix>1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1</matrix>
<instance_geometry url="#g"><bind_material><technique_common><instance_material symbol="red" target="#red"/>
</technique_common></bind_material></instance_geometry></node></visual_scene></library_visual_scenes>
<scene><instance_visual_scene url="#s"/></scene></COLLADA>
"##;

/// The facets of [`STL`] in its binary form.
fn binary_stl() -> Vec<u8> {
    let corners = [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]];
    let points: [[f32; 3]; 4] = [[0.0; 3], [0.1, 0.0, 0.0], [0.0, 0.1, 0.0], [0.0, 0.0, 0.1]];
    let mut bytes = [&[b' '; 80][..], &(corners.len() as u32).to_le_bytes()].concat();
    for facet in corners {
        let numbers = [[0.0; 3], points[facet[0]], points[facet[1]], points[facet[2]]].concat();
        bytes.extend(numbers.iter().flat_map(|number| number.to_le_bytes()));
        bytes.extend([0, 0]);
    }
    bytes
}

/// The first file is a mesh; the robot around it is not damaged.
fn any_mesh(folder: &Path, name: &str) -> Result<(), String> {
    let mesh = format!("<geometry><mesh filename=\"{name}\"/></geometry>");
    let link = format!(
        "<link name=\"meshed\"><collision>{mesh}</collision></link><link name=\"parts\"><visual>{mesh}</visual>\
         <collision>{mesh}</collision></link>{}{}",
        joint("meshed"),
        joint("parts")
    );
    let urdf = text("assets/baxter.urdf").replacen("</robot>", &format!("{link}</robot>"), 1);
    fs::write(folder.join("baxter.urdf"), urdf).unwrap();
    let description = text("assets/baxter.toml");
    let urdf_line = description.lines().find(|line| line.starts_with("urdf")).unwrap();
    let description = description.replacen(urdf_line, &format!("{urdf_line}\ndecompose = [\"parts\"]"), 1);
    fs::write(folder.join("robot.toml"), description).unwrap();
    let robot = Robot::load("robot.toml", folder);
    if let Ok(robot) = &robot {
        let link = robot.link_index("parts").unwrap();
        assert!(!robot.drawn(link).is_empty());
    }
    read_or_refused(robot, folder)
}

fn joint(link: &str) -> String {
    format!(
        "<joint name=\"of-{link}\" type=\"fixed\"><parent link=\"base\"/><child link=\"{link}\"/>\
         <origin xyz=\"0 0 -0.4\"/></joint>"
    )
}

#[test]
fn any_mesh_is_read_or_refused() {
    let valid = vec![
        texts(&[("a.stl", STL)]),
        vec![("a.stl".to_owned(), binary_stl())],
        vec![("a.stl".to_owned(), binary_stl())],
        texts(&[("a.obj", OBJ), ("a.mtl", MTL)]),
        texts(&[("a.dae", DAE)]),
        texts(&[("a.dae", DAE)]),
    ];
    check(&Target { name: "mesh", valid, cases: 300, mutate: general, run: any_mesh });
}

/// The first file is a CSV file, that of a load, a path or a sweep by its name; the scenario that names it is not damaged.
fn any_table(folder: &Path, name: &str) -> Result<(), String> {
    let rest = match name {
        "load.csv" => format!("{DRILL}[load]\nkind = \"measured\"\nfile = \"{name}\"\n"),
        "sweep.csv" => {
            format!("{DRILL}[sweep]\nruns = 10\nfriction = {{ kind = \"csv\", file = \"{name}\", column = \"mu\" }}\n")
        }
        "holes.csv" => format!("[task]\nkind = \"drill\"\nforce_n = 10.0\nfile = \"{name}\"\n"),
        _ => format!("[task]\nkind = \"cut\"\nforce_n = 10.0\nfile = \"{name}\"\n"),
    };
    fs::write(folder.join("a.toml"), format!("{HEAD}{rest}")).unwrap();
    any_scenario(folder, "a.toml")
}

#[test]
fn any_table_of_a_scenario_is_read_or_refused() {
    let load = "time_s,fx_n,fy_n,fz_n,mx_nm,my_nm,mz_nm\n0,0,0,0,0,0,0\n0.1,1.5,0,-5,0,0,0.1\n0.25,0,0,-15,0,0,0\n1,0,0,0,0,0,0\n";
    let sweep = "run, mu ,other\n1,0.4,x\n2,0.55,y\n3,0.61,z\n4,0.7,\n";
    let path = "stroke,x_m,y_m\n1,-0.1,0\n1,0.0,0.05\n1,0.1,0.0\n2,-0.1,-0.1\n2,0.1,-0.1\n";
    let holes = "stroke,x_m,y_m\n1,-0.1,0\n2,0.0,0.05\n3,0.1,0.0\n";
    let tables = [("load.csv", load), ("sweep.csv", sweep), ("path.csv", path), ("holes.csv", holes)];
    let valid = tables.map(|table| texts(&[table])).to_vec();
    check(&Target { name: "csv", valid, cases: 400, mutate: general, run: any_table });
}

#[test]
fn any_file_of_grasps_is_read_or_refused() {
    let matrices = "# grasps\n1 0 0 0.1\n0 1 0 0\n0 0 1 0.02\n0 0 0 1\n\n[[0, -1, 0, 0.1], [1, 0, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]]\n";
    let valid = vec![
        files(&[("grasps.yaml", "tests/data/import/board.isaac_grasp.yaml")]),
        files(&[("grasps.yaml", "tests/data/import/board.moveit_grasp.yaml")]),
        texts(&[("grasps.txt", matrices)]),
        texts(&[(
            "grasps.json",
            "[[[1,0,0,0.1],[0,1,0,0],[0,0,1,0],[0,0,0,1]],[[1,0,0,-0.1],[0,1,0,0],[0,0,1,0],[0,0,0,1]]]",
        )]),
    ];
    fn run(folder: &Path, name: &str) -> Result<(), String> {
        read_or_refused(import::read_grasps(&folder.join(name)), folder)
    }
    check(&Target { name: "grasps", valid, cases: 300, mutate: general, run });
}
