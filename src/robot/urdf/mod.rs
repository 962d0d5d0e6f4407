//! Reads a URDF into links and joints.
//!
//! urdf-rs parses the XML; this module checks the result and converts it into a [`Tree`] with parents before children.
//! Arms and grippers are defined by the description.

mod joints;
mod links;
mod nesting;
mod pose;

use std::{
    collections::{BTreeMap, BTreeSet},
    path::PathBuf,
};

use super::{
    faults::Collector,
    packages::{Packages, XACRO_HINT},
    tree::{Joint, Link},
};
use crate::model::frames::Pose;

/// A URDF to be read.
pub(super) struct UrdfSource<'a> {
    /// Name of the file, for messages.
    pub file: &'a str,
    /// Its content.
    pub text: &'a str,
    /// Where its meshes are.
    pub packages: &'a Packages,
    /// Links whose collision meshes are decomposed into convex parts.
    pub decomposed: &'a [String],
}

/// The content of a URDF, parents before children.
#[derive(Default)]
pub(super) struct Tree {
    /// The root comes first.
    pub links: Vec<Link>,
    /// In the order in which the links are reached from the root.
    pub joints: Vec<Joint>,
    /// The effort limit of each joint, N m or N; 0 where the URDF gives none.
    pub effort: Vec<f64>,
    /// What was changed or left out.
    pub notes: Vec<String>,
    /// The meshes that were read.
    pub files: Vec<PathBuf>,
}

/// The most links of a robot, and the most collision shapes of all of them: times grow with the square of both.
const MOST_LINKS: usize = 4000;
const MOST_SHAPES: usize = 10_000;

/// Requires a robot of a size that can be computed with.
fn check_size(robot: &urdf_rs::Robot) -> Result<(), String> {
    let shapes: usize = robot.links.iter().map(|link| link.collision.len()).sum();
    for (found, what, most) in [(robot.links.len(), "links", MOST_LINKS), (shapes, "collision shapes", MOST_SHAPES)] {
        if found > most {
            return Err(format!("found {found} {what}, expected at most {most}"));
        }
    }
    Ok(())
}

/// Reads a URDF. Faults name the link or joint, the value found and the value expected; `None` if there is one.
pub(super) fn read(source: &UrdfSource<'_>, faults: &mut Collector) -> Option<Tree> {
    let mut own = Collector::default();
    let tree = read_tree(source, &mut own);
    let complete = own.is_empty();
    faults.append(own);
    tree.filter(|_| complete)
}

fn read_tree(source: &UrdfSource<'_>, faults: &mut Collector) -> Option<Tree> {
    faults.keep(source.file, nesting::check(source.text))?;
    let text = without_empty_textures(source.text);
    let parsed = urdf_rs::read_from_string(&text).map_err(|error| parse_problem(source.text, &error.to_string()));
    let robot = faults.keep(source.file, parsed)?;
    faults.keep(source.file, check_size(&robot))?;
    let index = names("link", robot.links.iter().map(|link| link.name.as_str()));
    let index = faults.keep(source.file, index)?;
    let joint_names = names("joint", robot.joints.iter().map(|joint| joint.name.as_str()));
    faults.keep(source.file, joint_names)?;
    let hierarchy = Hierarchy::new(&robot, &index).map_err(|problem| with_hint(source.text, problem));
    let hierarchy = faults.keep(source.file, hierarchy)?;
    let mut builder = Builder {
        source,
        robot: &robot,
        hierarchy: &hierarchy,
        colours: links::global_colours(&robot.materials),
        tree: Tree::default(),
    };
    builder.add_all(faults);
    let mut tree = builder.tree;
    let reached: BTreeSet<&str> = tree.links.iter().map(|link| link.name.as_str()).collect();
    if let Some(lost) = robot.links.iter().find(|link| !reached.contains(link.name.as_str())) {
        let root = &tree.links.first()?.name;
        let problem = format!("link {}: found no chain of joints from the root {root}, expected one tree", lost.name);
        faults.add_to(source.file, problem);
    }
    let mimics = joints::resolve_mimics(&robot, &mut tree.joints, &mut tree.notes);
    faults.keep(source.file, mimics)?;
    Some(tree)
}

/// The text without textures that name no file, which urdf-rs refuses. Nothing here reads textures.
fn without_empty_textures(text: &str) -> String {
    text.replace("<texture />", "").replace("<texture/>", "")
}

/// A message about a text that is not a URDF.
fn parse_problem(text: &str, error: &str) -> String {
    with_hint(text, format!("found malformed urdf: {}", error.replace('\n', "; ")))
}

/// Adds how to expand a xacro if the text is one.
fn with_hint(text: &str, problem: String) -> String {
    let is_xacro = text.contains("xmlns:xacro") || text.contains("<xacro:");
    if is_xacro { format!("{problem}; {XACRO_HINT}") } else { problem }
}

/// The tree by indices into the URDF's lists.
struct Hierarchy {
    root: usize,
    /// For each link its child joints and child links, in file order.
    children: Vec<Vec<(usize, usize)>>,
}

impl Hierarchy {
    fn new(robot: &urdf_rs::Robot, index: &BTreeMap<&str, usize>) -> Result<Self, String> {
        let mut children = vec![Vec::new(); robot.links.len()];
        let mut carrier: Vec<Option<&str>> = vec![None; robot.links.len()];
        for (number, joint) in robot.joints.iter().enumerate() {
            let find = |name: &str| {
                index.get(name).copied().ok_or_else(|| {
                    format!("joint {}: found link \"{name}\", expected the name of a link of this file", joint.name)
                })
            };
            let (parent, child) = (find(&joint.parent.link)?, find(&joint.child.link)?);
            if let Some(other) = carrier[child].replace(&joint.name) {
                return Err(format!(
                    "link {}: found two joints that carry it, {other} and {}, expected one",
                    joint.child.link, joint.name
                ));
            }
            children[parent].push((number, child));
        }
        let roots: Vec<usize> = (0..robot.links.len()).filter(|&link| carrier[link].is_none()).collect();
        match roots[..] {
            [root] => Ok(Self { root, children }),
            [] => Err("found no link that no joint carries, expected one, the root".into()),
            _ => {
                let names = roots.iter().map(|&link| robot.links[link].name.as_str()).collect::<Vec<_>>().join(", ");
                Err(format!("found {} links that no joint carries, {names}, expected one, the root", roots.len()))
            }
        }
    }
}

/// A joint and its child link, by indices into the URDF's lists, that are still to be added below a link of the tree.
struct Waiting {
    joint: usize,
    link: usize,
    parent: usize,
}

/// Builds the tree.
struct Builder<'a> {
    source: &'a UrdfSource<'a>,
    robot: &'a urdf_rs::Robot,
    hierarchy: &'a Hierarchy,
    colours: BTreeMap<&'a str, [f64; 4]>,
    tree: Tree,
}

impl Builder<'_> {
    /// Adds all links and joints, each link before its descendants and these before its next sibling. A list of what is still to
    /// be added takes the place of recursion, since a chain may be longer than the stack is deep.
    fn add_all(&mut self, faults: &mut Collector) {
        let mut waiting = Vec::new();
        let root = self.add_link(self.hierarchy.root, None, faults);
        self.enqueue_children(self.hierarchy.root, root, &mut waiting);
        while let Some(Waiting { joint, link, parent }) = waiting.pop() {
            let parent_joint = self.add_joint(joint, parent, faults);
            let placed = self.add_link(link, Some(parent_joint), faults);
            self.enqueue_children(link, placed, &mut waiting);
        }
    }

    /// Appends the children of a link, the first one last.
    fn enqueue_children(&self, link: usize, parent: usize, waiting: &mut Vec<Waiting>) {
        let children = self.hierarchy.children[link].iter().rev();
        waiting.extend(children.map(|&(joint, link)| Waiting { joint, link, parent }));
    }

    /// Adds a link and returns its place in the tree.
    fn add_link(&mut self, link: usize, parent_joint: Option<usize>, faults: &mut Collector) -> usize {
        let reader = links::Reader {
            packages: self.source.packages,
            decomposed: self.source.decomposed,
            colours: &self.colours,
        };
        let read = reader.read(&self.robot.links[link], parent_joint);
        faults.extend(self.source.file, read.problems);
        self.tree.links.push(read.link);
        self.tree.notes.extend(read.notes);
        self.tree.files.extend(read.files);
        self.tree.links.len() - 1
    }

    /// Adds the joint that carries the next link and returns its place in the tree.
    fn add_joint(&mut self, joint: usize, parent: usize, faults: &mut Collector) -> usize {
        let joint = &self.robot.joints[joint];
        let links = [parent, self.tree.links.len()];
        let read = joints::read(joint, links[0], links[1], &mut self.tree.notes);
        // After a fault the tree is not used, but what follows is still read for its faults.
        let in_place = || (Joint::fixed(&joint.name, links, Pose::identity()), 0.0);
        let (read, effort) = faults.keep(self.source.file, read).unwrap_or_else(in_place);
        self.tree.joints.push(read);
        self.tree.effort.push(effort);
        self.tree.joints.len() - 1
    }
}

/// Indices by name.
fn names<'a>(what: &str, names: impl Iterator<Item = &'a str>) -> Result<BTreeMap<&'a str, usize>, String> {
    let mut index = BTreeMap::new();
    for (number, name) in names.enumerate() {
        if index.insert(name, number).is_some() {
            return Err(format!("{what} {name}: found this name twice, expected names to be unique"));
        }
    }
    Ok(index)
}
