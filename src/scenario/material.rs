//! Board materials and their densities.

use std::collections::BTreeMap;

/// The built-in table: name to density, kg/m^3.
const TABLE: &str = include_str!("../../assets/materials.toml");

/// The density of a material, kg/m^3.
///
/// # Errors
/// If the name is unknown: a text that lists the known names.
pub fn density_kg_m3(name: &str) -> Result<f64, String> {
    let table = table();
    table.get(name).copied().ok_or_else(|| {
        let known: Vec<_> = table.keys().map(String::as_str).collect();
        format!("one of {}", known.join(", "))
    })
}

fn table() -> BTreeMap<String, f64> {
    // The table is compiled in, and a test parses it.
    toml::from_str(TABLE).expect("assets/materials.toml is a table of numbers")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_density_is_that_of_a_board() {
        // From the lightest foam to stone.
        assert!(table().values().all(|density| (10.0..3000.0).contains(density)));
        assert_eq!(density_kg_m3("foam"), Ok(35.0));
    }

    #[test]
    fn an_unknown_material_names_the_known_ones() {
        assert!(density_kg_m3("cheese").unwrap_err().contains("plywood"));
    }
}
