//! How much load a hold stands, against closed forms, an independent solver, invariances and proofs.

mod baxter;
mod closed_forms;
mod compliance;
mod fixtures;
mod independent;
mod properties;
mod robust;
mod sensitivity;
