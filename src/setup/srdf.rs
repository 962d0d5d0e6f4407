//! The pairs of links whose collisions an SRDF disables.

/// The pairs that an SRDF's `disable_collisions` elements name.
///
/// # Errors
/// What is wrong with the text.
pub(super) fn disabled_pairs(text: &str) -> Result<Vec<[String; 2]>, String> {
    let document = roxmltree::Document::parse(text).map_err(|error| format!("found malformed xml: {error}"))?;
    let root = document.root_element();
    if root.tag_name().name() != "robot" {
        return Err(format!("found the element {}, expected an SRDF, whose root is robot", root.tag_name().name()));
    }
    let elements = root.descendants().filter(|node| node.has_tag_name("disable_collisions"));
    elements
        .map(|node| {
            let link = |key: &str| {
                let line = document.text_pos_at(node.range().start).row;
                let missing = || format!("line {line}: found disable_collisions without {key}, expected two links");
                node.attribute(key).map(str::to_owned).ok_or_else(missing)
            };
            Ok([link("link1")?, link("link2")?])
        })
        .collect()
}
