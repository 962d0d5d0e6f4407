//! Board materials: density, elasticity and strength.

use std::collections::BTreeMap;

use serde::Deserialize;

use crate::model::scenario::BendingProperties;

/// The built-in table.
const TABLE: &str = include_str!("../../assets/materials.toml");

/// A material of the table.
#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct Material {
    density_kg_m3: f64,
    youngs_modulus_pa: f64,
    bending_strength_pa: f64,
}

/// The density of a material, kg/m^3.
///
/// # Errors
/// If the name is unknown: a text that lists the known names.
pub fn density_kg_m3(name: &str) -> Result<f64, String> {
    let table = table();
    table.get(name).map(|material| material.density_kg_m3).ok_or_else(|| {
        let known: Vec<_> = table.keys().map(String::as_str).collect();
        format!("one of {}", known.join(", "))
    })
}

/// Elasticity and strength of a material; `None` if the name is unknown, as that of a plan without a scenario.
#[must_use]
pub fn bending_properties(name: &str) -> Option<BendingProperties> {
    let Material { youngs_modulus_pa, bending_strength_pa, .. } = *table().get(name)?;
    Some(BendingProperties { youngs_modulus_pa, strength_pa: bending_strength_pa })
}

fn table() -> BTreeMap<String, Material> {
    // The table is compiled in, and a test parses it.
    toml::from_str(TABLE).expect("assets/materials.toml is a table of materials")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_material_is_that_of_a_board() {
        // From the lightest foam to stone.
        assert!(table().values().all(|material| (10.0..3000.0).contains(&material.density_kg_m3)));
        assert_eq!(density_kg_m3("foam"), Ok(35.0));
        // A material breaks at a strain of a thousandth to a tenth.
        for (name, Material { youngs_modulus_pa, bending_strength_pa, .. }) in table() {
            assert!((1e-3..0.1).contains(&(bending_strength_pa / youngs_modulus_pa)), "{name}");
            assert_eq!(bending_properties(&name).unwrap().youngs_modulus_pa, youngs_modulus_pa);
        }
        assert_eq!(bending_properties("unknown"), None);
    }

    #[test]
    fn an_unknown_material_names_the_known_ones() {
        assert!(density_kg_m3("cheese").unwrap_err().contains("plywood"));
    }
}
