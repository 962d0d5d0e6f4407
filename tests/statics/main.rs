//! The statics against closed forms, an independent solver, invariances and certificates.

mod baxter;
mod closed_forms;
mod compliance;
mod criteria;
mod fixtures;
mod independent;
mod lateral;
mod local;
mod measured;
mod mechanisms;
mod pad_compliance;
mod properties;
mod robust;
mod sensitivity;
mod springs;
