//! Arms: their joints and the joints' limits.

use toml::Spanned;

use super::Assembler;
use crate::robot::{
    description::{ArmEntry, Description},
    tree::{Arm, JointKind},
};

/// The most arms that hold one board.
const MOST_ARMS: usize = 4;

impl Assembler<'_> {
    pub(super) fn arms(&mut self, description: &Description) {
        let entries = description.arms.get_ref();
        if entries.is_empty() || entries.len() > MOST_ARMS {
            let expected = format!("one to {MOST_ARMS} arms");
            self.fault(description.arms.span(), "arms", entries.len(), expected);
        }
        for entry in entries {
            let known = self.robot.arm_index(entry.name.get_ref()).is_some();
            self.check(!known, entry.name.span(), "name", entry.name.get_ref(), "a name that no other arm has");
            if let Some(arm) = self.arm(entry) {
                self.robot.arms.push(arm);
            }
        }
    }

    /// One arm; all its faults are found.
    fn arm(&mut self, entry: &ArmEntry) -> Option<Arm> {
        let joints = self.arm_joints(entry);
        let count = entry.joints.get_ref().len();
        let effort_nm = match (&entry.effort_nm, &joints) {
            (Some(overrides), _) => self.positive_list("effort_nm", overrides, count),
            (None, Some(joints)) => self.urdf_efforts(entry, joints),
            (None, None) => None,
        };
        let stiffness_nm_rad = self.positive_list("stiffness_nm_rad", &entry.stiffness_nm_rad, count);
        let damping_nm_s_rad = self.positive_list("damping_nm_s_rad", &entry.damping_nm_s_rad, count);
        let gripper = self.gripper(entry.name.get_ref(), &entry.gripper);
        Some(Arm {
            name: entry.name.get_ref().clone(),
            joints: joints?,
            effort_nm: effort_nm?,
            stiffness_nm_rad: stiffness_nm_rad?,
            damping_nm_s_rad: damping_nm_s_rad?,
            gripper: gripper?,
        })
    }

    fn urdf_efforts(&mut self, entry: &ArmEntry, joints: &[usize]) -> Option<Vec<f64>> {
        let efforts: Vec<f64> = joints.iter().map(|&joint| self.effort[joint]).collect();
        let bad = efforts.iter().position(|effort| !(effort.is_finite() && *effort > 0.0));
        if let Some(number) = bad {
            let joint = entry.joints.get_ref()[number].get_ref();
            let found = format!("an effort of {} for {joint} in the urdf", efforts[number]);
            self.fault(entry.joints.span(), "joints", found, "efforts above 0, or effort_nm beside the joints");
            return None;
        }
        Some(efforts)
    }

    /// The joints of an arm: exactly the moving joints between its base link and its gripper's frame.
    fn arm_joints(&mut self, entry: &ArmEntry) -> Option<Vec<usize>> {
        let base = self.link("base_link", &entry.base_link);
        let mut link = self.link("frame_link", &entry.gripper.frame_link)?;
        let base = base?;
        let mut on_the_way = Vec::new();
        while link != base {
            let Some(joint) = self.robot.links[link].parent_joint else {
                let expected = format!("a link between the root and {}", entry.gripper.frame_link.get_ref());
                self.fault(entry.base_link.span(), "base_link", entry.base_link.get_ref(), expected);
                return None;
            };
            if self.robot.joints[joint].kind != JointKind::Fixed {
                on_the_way.push(joint);
            }
            link = self.robot.joints[joint].parent_link;
        }
        on_the_way.reverse();
        let named: Vec<_> = entry.joints.get_ref().iter().map(|name| self.moving_joint("joints", name)).collect();
        let named: Vec<usize> = named.into_iter().collect::<Option<_>>()?;
        let names = |joints: &[usize]| {
            joints.iter().map(|&joint| self.robot.joints[joint].name.as_str()).collect::<Vec<_>>().join(" ")
        };
        if named != on_the_way || named.is_empty() {
            let expected = format!("the moving joints from base_link to frame_link: {}", names(&on_the_way));
            let found = names(&named);
            self.fault(entry.joints.span(), "joints", found, expected);
            return None;
        }
        let follows = |joint: &&usize| self.robot.joints[**joint].mimic.is_some();
        if let Some(&joint) = named.iter().find(follows) {
            let found = format!("{}, which mimics another joint", self.robot.joints[joint].name);
            self.fault(entry.joints.span(), "joints", found, "joints of an arm that move by themselves");
            return None;
        }
        let led = self.robot.joints.iter().find(|joint| joint.mimic.is_some_and(|mimic| named.contains(&mimic.leader)));
        if let Some(joint) = led {
            let found = format!("{}, which mimics one of them", joint.name);
            self.fault(entry.joints.span(), "joints", found, "joints of an arm that move no other");
            return None;
        }
        Some(named)
    }

    /// A joint by its name that can move.
    pub(super) fn moving_joint(&mut self, key: &str, name: &Spanned<String>) -> Option<usize> {
        let found = self.robot.joints.iter().position(|joint| joint.name == *name.get_ref());
        let found = found.filter(|&joint| self.robot.joints[joint].kind != JointKind::Fixed);
        if found.is_none() {
            let expected = "the name of a revolute or prismatic joint of the urdf";
            self.fault(name.span(), key, format!("\"{}\"", name.get_ref()), expected);
        }
        found
    }

    fn positive_list(&mut self, key: &str, list: &Spanned<Vec<f64>>, count: usize) -> Option<Vec<f64>> {
        let numbers = list.get_ref();
        if numbers.len() != count {
            self.fault(list.span(), key, format!("{} numbers", numbers.len()), format!("{count}, one a joint"));
            return None;
        }
        self.positive(key, list, numbers)?;
        Some(numbers.clone())
    }

    pub(super) fn positive<T>(&mut self, key: &str, at: &Spanned<T>, numbers: &[f64]) -> Option<()> {
        match numbers.iter().find(|number| !(number.is_finite() && **number > 0.0)) {
            Some(number) => {
                self.fault(at.span(), key, number, "finite numbers above 0");
                None
            }
            None => Some(()),
        }
    }
}
