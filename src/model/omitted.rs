//! Values that files omit.

/// True for values that files omit.
pub(super) fn is_default<T: Default + PartialEq>(value: &T) -> bool {
    *value == T::default()
}

/// True for a factor of 1, which files omit.
pub(super) fn is_one(factor: &f64) -> bool {
    *factor == 1.0
}
