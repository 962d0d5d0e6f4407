//! The statics against closed forms, an independent solver, invariances and certificates.

mod baxter;
mod closed_forms;
mod compliance;
mod fixtures;
mod independent;
mod lateral;
mod measured;
mod pad_compliance;
mod properties;
mod robust;
mod sensitivity;
