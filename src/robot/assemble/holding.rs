//! With what a gripper holds: pads with friction, or measured wrench limits.

use std::ops::RangeInclusive;

use nalgebra::Vector6;
use toml::Spanned;

use super::Assembler;
use crate::{
    model::{
        wrench::Wrench,
        wrench_limits::{LimitShape, WrenchLimits},
    },
    robot::{
        description::{Exactly, GripperEntry, LimitEntry, LimitsEntry, ShapeEntry},
        holding::{Holding, MeasuredGrip, PadGrip},
    },
};

/// Stiffness of a pad, N/m, from softer than a foam cushion to stiffer than a steel block of its size.
const PAD_STIFFNESS_N_M: RangeInclusive<f64> = 1e4..=1e9;

/// Stiffness of a measured gripper, N/m and N m/rad: from the softest bellows of a suction cup to a steel block.
const HOLD_STIFFNESS_N_M: RangeInclusive<f64> = 1e2..=1e9;
const HOLD_STIFFNESS_NM_RAD: RangeInclusive<f64> = 0.1..=1e7;

/// The largest friction coefficient: soft rubber on a rough board has less than 2.
const MOST_FRICTION: f64 = 5.0;

/// The largest limits of a wrench, N and N m (docs/method.md#13-bounds-of-input).
const MOST_FORCE_N: f64 = 1e4;
const MOST_MOMENT_NM: f64 = 1e3;

impl Assembler<'_> {
    /// With what the gripper of an entry holds.
    pub(super) fn holding(&mut self, entry: &GripperEntry) -> Option<Holding> {
        match &entry.wrench_limits {
            Some(limits) => self.measured_grip(entry, limits).map(Holding::Measured),
            None => self.pad_grip(entry).map(Holding::Pads),
        }
    }

    fn pad_grip(&mut self, entry: &GripperEntry) -> Option<PadGrip> {
        for (key, given) in
            [("hold_stiffness_n_m", &entry.hold_stiffness_n_m), ("hold_stiffness_nm_rad", &entry.hold_stiffness_nm_rad)]
        {
            if let Some(given) = given {
                self.fault(
                    given.span(),
                    key,
                    "a stiffness",
                    "no such key without wrench_limits: pads have pad_stiffness_n_m",
                );
            }
        }
        let Some(max_force) = &entry.max_force_n else {
            self.fault(entry.frame_link.span(), "max_force_n", "none", "the force of each finger, N, or wrench_limits");
            return None;
        };
        self.positive("max_force_n", max_force, &[*max_force.get_ref()]);
        let pad_stiffness_n_m = self.pad_stiffness(entry);
        let max_force_n = *max_force.get_ref();
        let (grip_force_n, friction) = self.grip_defaults(entry, max_force_n);
        Some(PadGrip { max_force_n, grip_force_n, friction, pad_stiffness_n_m })
    }

    fn measured_grip(&mut self, entry: &GripperEntry, limits: &Spanned<LimitsEntry>) -> Option<MeasuredGrip> {
        for (key, given) in [
            ("max_force_n", &entry.max_force_n),
            ("grip_force_n", &entry.grip_force_n),
            ("friction", &entry.friction),
            ("pad_stiffness_n_m", &entry.pad_stiffness_n_m),
        ] {
            if let Some(given) = given {
                let expected = "no such key beside wrench_limits, which say what the gripper holds";
                self.fault(given.span(), key, given.get_ref(), expected);
            }
        }
        let LimitsEntry { shape, force_n, moment_nm } = limits.get_ref();
        let force = self.limits("wrench_limits.force_n", force_n, MOST_FORCE_N, "N");
        let moment = self.limits("wrench_limits.moment_nm", moment_nm, MOST_MOMENT_NM, "N m");
        let stiffness = self.hold_stiffness(entry);
        let ([low_n, high_n], [low_nm, high_nm]) = (force?, moment?);
        let shape = match shape {
            ShapeEntry::Box => LimitShape::Box,
            ShapeEntry::Ellipsoid => LimitShape::Ellipsoid,
        };
        let (low, high) = (Wrench::new(low_n.into(), low_nm.into()), Wrench::new(high_n.into(), high_nm.into()));
        Some(MeasuredGrip { limits: WrenchLimits { shape, low, high }, stiffness })
    }

    /// The lower and the upper limits of three components.
    fn limits(
        &mut self,
        key: &str,
        entries: &Spanned<Exactly<LimitEntry, 3>>,
        most: f64,
        unit: &str,
    ) -> Option<[[f64; 3]; 2]> {
        let pairs = entries.get_ref().0.each_ref().map(|entry| entry.0);
        for [low, high] in pairs {
            let met = low >= -most && low < 0.0 && high > 0.0 && high <= most;
            let found = if low == -high || high.is_nan() { high.to_string() } else { format!("[{low}, {high}]") };
            let expected =
                format!("a number above 0 and up to {most} {unit}, or [low, high] with low below and high above 0");
            self.check(met, entries.span(), key, found, &expected)?;
        }
        Some([pairs.map(|[low, _]| low), pairs.map(|[_, high]| high)])
    }

    /// The stiffness of a measured gripper, if the description has one; both of its keys, or none.
    fn hold_stiffness(&mut self, entry: &GripperEntry) -> Option<Vector6<f64>> {
        let (along, about) = (&entry.hold_stiffness_n_m, &entry.hold_stiffness_nm_rad);
        if let (Some(one), None) | (None, Some(one)) = (along, about) {
            let expected = "both hold_stiffness_n_m and hold_stiffness_nm_rad, or none for a rigid grip";
            self.fault(one.span(), "hold_stiffness", "one of two keys", expected);
        }
        let along = self.stiffness_within("hold_stiffness_n_m", along.as_ref()?, HOLD_STIFFNESS_N_M, "N/m");
        let about = self.stiffness_within("hold_stiffness_nm_rad", about.as_ref()?, HOLD_STIFFNESS_NM_RAD, "N m/rad");
        let ([x, y, z], [rx, ry, rz]) = (along?, about?);
        Some(Vector6::new(x, y, z, rx, ry, rz))
    }

    fn stiffness_within(
        &mut self,
        key: &str,
        given: &Spanned<Exactly<f64, 3>>,
        range: RangeInclusive<f64>,
        unit: &str,
    ) -> Option<[f64; 3]> {
        let values = given.get_ref().0;
        let odd = values.into_iter().find(|value| !range.contains(value));
        let expected = format!("three numbers from {} to {} {unit}", range.start(), range.end());
        self.check(odd.is_none(), given.span(), key, odd.unwrap_or_default(), &expected)?;
        Some(values)
    }

    /// Grip force and friction for scenarios that have none.
    fn grip_defaults(&mut self, entry: &GripperEntry, most_n: f64) -> (Option<f64>, Option<f64>) {
        if let Some(force) = &entry.grip_force_n {
            let force_n = *force.get_ref();
            let expected = format!("more than 0 and at most max_force_n, {most_n} N");
            self.check(force_n > 0.0 && force_n <= most_n, force.span(), "grip_force_n", force_n, &expected);
        }
        if let Some(friction) = &entry.friction {
            let found = *friction.get_ref();
            self.check((0.0..=MOST_FRICTION).contains(&found), friction.span(), "friction", found, "0 to 5");
        }
        let value = |given: &Option<Spanned<f64>>| given.as_ref().map(|given| *given.get_ref());
        (value(&entry.grip_force_n), value(&entry.friction))
    }

    /// The stiffness of a pad, if the description has one.
    fn pad_stiffness(&mut self, entry: &GripperEntry) -> Option<f64> {
        let given = entry.pad_stiffness_n_m.as_ref()?;
        let stiffness_n_m = *given.get_ref();
        let expected = "10000 to 1000000000 N/m, or no such key for rigid pads";
        let met = PAD_STIFFNESS_N_M.contains(&stiffness_n_m);
        self.check(met, given.span(), "pad_stiffness_n_m", stiffness_n_m, expected)?;
        Some(stiffness_n_m)
    }
}
