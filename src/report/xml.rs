//! Characters that XML 1.0 has.

/// Text with U+FFFD in place of what no document of XML 1.0 may contain, not even escaped: control characters but tab, line feed and
/// carriage return, and U+FFFE and U+FFFF. Names of files and messages of others may have them.
pub(crate) fn legal(text: String) -> String {
    if text.contains(is_illegal) { text.replace(is_illegal, "\u{fffd}") } else { text }
}

fn is_illegal(c: char) -> bool {
    c.is_control() && !matches!(c, '\t' | '\n' | '\r') || matches!(c, '\u{fffe}' | '\u{ffff}')
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_xml_does_not_have_is_replaced() {
        assert_eq!(legal("a\tb\r\n\u{e9}\u{1f600}".to_owned()), "a\tb\r\n\u{e9}\u{1f600}");
        assert_eq!(
            legal("\0a\u{1b}[2Jb\u{7f}\u{9b}\u{fffe}\u{ffff}".to_owned()),
            "\u{fffd}a\u{fffd}[2Jb\u{fffd}\u{fffd}\u{fffd}\u{fffd}"
        );
    }
}
