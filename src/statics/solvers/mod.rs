//! Numerical methods for the programs of a [`ContactModel`](super::ContactModel): what is computed is defined by the
//! callers, how it is computed is here.
//!
//! - `cone_program`: load program and equilibrium program in clarabel's standard form; `layout` assigns their variables
//!   and rows, `energy` their quadratic term, `units` their scaling.
//! - `clarabel`: solves them, reusing memory and symbolic factorisation.
//! - `interior_point`: the equilibrium program again, dense and of fixed size, faster than clarabel;
//!   `pad_cone` is its cone, `lower` its Cholesky factors.
//!
//! `benches/statics.rs` times both solvers on the same equilibria, and a test holds their results together.

pub mod clarabel;
pub mod cone_program;
pub mod energy;
pub mod interior_point;
pub mod layout;
pub mod lower;
pub mod pad_cone;
pub mod units;
