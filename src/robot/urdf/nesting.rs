//! The depth of the elements of an XML text. The parser of URDFs calls itself for each level, so a deep text would end the process.

use quick_xml::{Reader, events::Event};

/// The deepest level of an element. Those of a URDF are at most six deep.
const MOST_LEVELS: usize = 64;

/// Requires elements that are not nested too deep. What is no XML is left to the parser.
///
/// # Errors
/// What was found and what was expected.
pub(super) fn check(text: &str) -> Result<(), String> {
    let mut reader = Reader::from_str(text);
    reader.config_mut().check_end_names = false;
    let mut levels = 0_usize;
    loop {
        match reader.read_event() {
            Ok(Event::Start(_)) => levels += 1,
            Ok(Event::End(_)) => levels = levels.saturating_sub(1),
            Ok(Event::Eof) | Err(_) => return Ok(()),
            Ok(_) => {}
        }
        if levels > MOST_LEVELS {
            let before = &text.as_bytes()[..(reader.buffer_position() as usize).min(text.len())];
            let line = 1 + before.iter().filter(|&&byte| byte == b'\n').count();
            return Err(format!("found elements nested {levels} deep in line {line}, expected at most {MOST_LEVELS}"));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn deep_elements_are_told_with_their_line() {
        assert_eq!(check("<robot name=\"a\">\n<link name=\"b\"/>\n</robot>"), Ok(()));
        assert_eq!(check(&format!("{}{}", "<a>".repeat(64), "</a>".repeat(64))), Ok(()));
        let error = check(&format!("\n\n{}", "<a>".repeat(100_000))).unwrap_err();
        assert_eq!(error, "found elements nested 65 deep in line 3, expected at most 64");
    }
}
