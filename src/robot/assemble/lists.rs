//! Allowed collisions and body points.

use nalgebra::Point3;

use super::Assembler;
use crate::robot::{
    description::Description,
    tree::{Arm, BodyPoint, Robot},
};

/// Placeholders for the name of an arm and for its first letter.
const PLACEHOLDERS: [&str; 2] = ["{arm}", "{a}"];

impl Assembler<'_> {
    pub(super) fn allowed_collisions(&mut self, description: &Description) {
        self.carriers = self.robot.carriers();
        let mut pairs = self.rigid_pairs();
        for entry in &description.allowed_collisions {
            let [a, b] = &entry.get_ref().0;
            for [a, b] in expand(&self.robot, [a, b]) {
                let a = self.link_named("allowed_collisions", &a, entry.span());
                let b = self.link_named("allowed_collisions", &b, entry.span());
                let (Some(a), Some(b)) = (a, b) else { continue };
                if a == b {
                    let found = format!("{} twice", self.robot.links[a].name);
                    self.fault(entry.span(), "allowed_collisions", found, "two links");
                }
                pairs.push([a.min(b), a.max(b)]);
            }
        }
        pairs.sort_unstable();
        pairs.dedup();
        self.robot.allowed_collisions = pairs;
    }

    /// Pairs of links that do not move relative to each other.
    fn rigid_pairs(&self) -> Vec<[usize; 2]> {
        let solid = |link: &usize| !self.robot.links[*link].shapes.is_empty();
        let solid: Vec<usize> = (0..self.robot.links.len()).filter(solid).collect();
        let mut pairs = Vec::new();
        for (number, &a) in solid.iter().enumerate() {
            let others = solid[number + 1..].iter().filter(|&&b| self.carriers[a] == self.carriers[b]);
            pairs.extend(others.map(|&b| [a, b]));
        }
        pairs
    }

    pub(super) fn body_points(&mut self, description: &Description) {
        let mut points = Vec::new();
        let entries = description.body_points.get_ref();
        if entries.is_empty() {
            let problem =
                "body_points: found none, expected at least one: the distance to the person is measured to them";
            self.problem(description.body_points.span(), problem.into());
        }
        for entry in entries {
            let Some(p_m) = self.finite("p_m", &entry.p_m, "m") else { continue };
            for [name] in expand(&self.robot, [entry.link.get_ref()]) {
                if let Some(link) = self.link_named("body_points", &name, entry.link.span()) {
                    points.push(BodyPoint { link, p_l: Point3::from(p_m) });
                }
            }
        }
        self.robot.body_points = points;
    }
}

/// Names with placeholders once per arm, names without unchanged.
fn expand<const N: usize>(robot: &Robot, names: [&String; N]) -> Vec<[String; N]> {
    if !names.iter().any(|name| PLACEHOLDERS.iter().any(|placeholder| name.contains(placeholder))) {
        return vec![names.map(Clone::clone)];
    }
    let of_arm = |arm: &Arm| {
        let initial: String = arm.name.chars().take(1).collect();
        names.map(|name| name.replace(PLACEHOLDERS[0], &arm.name).replace(PLACEHOLDERS[1], &initial))
    };
    robot.arms.iter().map(of_arm).collect()
}
