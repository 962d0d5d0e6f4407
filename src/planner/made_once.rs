//! A part of a map that is made when it is first asked for.

use std::sync::OnceLock;

/// The part, empty until then.
pub struct MadeOnce<T>(OnceLock<T>);

impl<T> MadeOnce<T> {
    /// The part, made now unless it exists. `make` must always make the same.
    ///
    /// It is made outside the lock: a thread of rayon's pool must not wait for what another thread makes in parallel, since rayon may
    /// give it work meanwhile that needs the same part. So threads that ask at once make it several times, and the first one is kept.
    ///
    /// # Errors
    /// Those of `make`; then nothing is kept.
    pub fn get_or_make<E>(&self, make: impl FnOnce() -> Result<T, E>) -> Result<&T, E> {
        if let Some(made) = self.0.get() {
            return Ok(made);
        }
        let made = make()?;
        Ok(self.0.get_or_init(|| made))
    }

    /// The part if it exists.
    pub fn get(&self) -> Option<&T> {
        self.0.get()
    }
}

impl<T> Default for MadeOnce<T> {
    fn default() -> Self {
        Self(OnceLock::new())
    }
}
