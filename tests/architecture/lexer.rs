//! Rust text as the few tokens that paths are made of. Comments, literals and lifetimes are left out, and so is what is
//! compiled for tests only.

/// A token.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Token {
    /// A keyword or a name, `r#` left out.
    Word(String),
    /// `::`.
    Separator,
    /// Any other character that is not white space.
    Mark(char),
}

impl Token {
    /// Whether this is the word.
    pub fn is_word(&self, word: &str) -> bool {
        matches!(self, Self::Word(own) if own == word)
    }

    /// The word, if this is one.
    pub fn word(&self) -> Option<&str> {
        match self {
            Self::Word(word) => Some(word),
            _ => None,
        }
    }
}

/// The tokens of a text.
pub fn tokens(text: &str) -> Vec<Token> {
    let mut rest = text;
    let mut found = Vec::new();
    while let Some(c) = rest.chars().next() {
        let length = match c {
            _ if rest.starts_with("//") => rest.find('\n').unwrap_or(rest.len()),
            _ if rest.starts_with("/*") => block_comment(rest),
            _ if raw_string(rest).is_some() => raw_string(rest).unwrap_or(rest.len()),
            '"' => quoted(rest, '"'),
            '\'' => character_or_lifetime(rest),
            _ if rest.starts_with("b\"") || rest.starts_with("c\"") => 1 + quoted(&rest[1..], '"'),
            _ if rest.starts_with("b'") => 1 + quoted(&rest[1..], '\''),
            _ if rest.starts_with("::") => {
                found.push(Token::Separator);
                2
            }
            _ if c.is_alphanumeric() || c == '_' => {
                let text = rest.strip_prefix("r#").unwrap_or(rest);
                let word: String = text.chars().take_while(|c| c.is_alphanumeric() || *c == '_').collect();
                let length = rest.len() - text.len() + word.len();
                if !c.is_ascii_digit() {
                    found.push(Token::Word(word));
                }
                length
            }
            _ => {
                if !c.is_whitespace() {
                    found.push(Token::Mark(c));
                }
                c.len_utf8()
            }
        };
        rest = &rest[length..];
    }
    found
}

/// The length of a block comment; they may be nested.
fn block_comment(text: &str) -> usize {
    let (mut depth, mut at) = (0, 0);
    while at < text.len() {
        let rest = &text[at..];
        if rest.starts_with("/*") {
            (depth, at) = (depth + 1, at + 2);
        } else if rest.starts_with("*/") {
            (depth, at) = (depth - 1, at + 2);
            if depth == 0 {
                return at;
            }
        } else {
            at += rest.chars().next().map_or(1, char::len_utf8);
        }
    }
    text.len()
}

/// The length of a raw string, such as `r#"..."#`; `None` where none begins.
fn raw_string(text: &str) -> Option<usize> {
    let after = text.strip_prefix("br").or_else(|| text.strip_prefix('r'))?;
    let hashes = after.len() - after.trim_start_matches('#').len();
    let body = after[hashes..].strip_prefix('"')?;
    let end = format!("\"{}", "#".repeat(hashes));
    let start = text.len() - body.len();
    Some(body.find(&end).map_or(text.len(), |at| start + at + end.len()))
}

/// The length of a literal between two quotes, the first of which begins the text.
fn quoted(text: &str, quote: char) -> usize {
    let mut escaped = false;
    for (at, c) in text.char_indices().skip(1) {
        match c {
            _ if escaped => escaped = false,
            '\\' => escaped = true,
            _ if c == quote => return at + 1,
            _ => {}
        }
    }
    text.len()
}

/// The length of `'a'`, or of the mark of a lifetime `'a`.
fn character_or_lifetime(text: &str) -> usize {
    let mut characters = text.chars().skip(1);
    let (first, second) = (characters.next(), characters.next());
    if first == Some('\\') || second == Some('\'') {
        return quoted(text, '\'');
    }
    let name = text[1..].chars().take_while(|c| c.is_alphanumeric() || *c == '_');
    1 + name.map(char::len_utf8).sum::<usize>()
}

/// The tokens of what a release build compiles, and the names of the modules that only tests have, `mod tests;`.
pub fn without_tests(tokens: &[Token]) -> (Vec<Token>, Vec<String>) {
    let (mut kept, mut test_modules) = (Vec::with_capacity(tokens.len()), Vec::new());
    let mut at = 0;
    while at < tokens.len() {
        match test_attribute(&tokens[at..]) {
            Some(length) => {
                let item = &tokens[at + length..];
                let end = item_length(item);
                test_modules.extend(module_name(&item[..end]));
                at += length + end;
            }
            None => {
                kept.push(tokens[at].clone());
                at += 1;
            }
        }
    }
    (kept, test_modules)
}

/// The length of `#[cfg(test)]`, and of a `cfg` that asks for tests among other things.
fn test_attribute(tokens: &[Token]) -> Option<usize> {
    let opens = [Token::Mark('#'), Token::Mark('['), Token::Word("cfg".into()), Token::Mark('(')];
    if !tokens.starts_with(&opens) {
        return None;
    }
    let end = tokens.iter().position(|token| *token == Token::Mark(']'))?;
    let has = |word: &str| tokens[..end].iter().any(|token| token.is_word(word));
    (has("test") && !has("not")).then_some(end + 1)
}

/// The length of an item: to its closing brace, or to the semicolon of one without a body.
fn item_length(tokens: &[Token]) -> usize {
    let mut depth = 0;
    for (at, token) in tokens.iter().enumerate() {
        match token {
            Token::Mark('(' | '[' | '{') => depth += 1,
            Token::Mark(')' | ']') => depth -= 1,
            Token::Mark('}') => {
                depth -= 1;
                if depth == 0 {
                    return at + 1;
                }
            }
            Token::Mark(';') if depth == 0 => return at + 1,
            _ => {}
        }
    }
    tokens.len()
}

/// The name in `mod name;`.
fn module_name(item: &[Token]) -> Option<String> {
    let at = item.iter().position(|token| token.is_word("mod"))?;
    match &item[at + 1..] {
        [Token::Word(name), Token::Mark(';'), ..] => Some(name.clone()),
        _ => None,
    }
}

#[cfg(test)]
mod rules {
    use super::*;

    fn words(text: &str) -> Vec<String> {
        tokens(text).iter().filter_map(|token| token.word().map(str::to_owned)).collect()
    }

    #[test]
    fn comments_and_literals_are_left_out() {
        let text = "a // b\n /* c /* d */ e */ f \"g \\\" h\" 'i' '\\'' b'j' r#\"k \" l\"# m 1.5e3 r#type &'static n";
        assert_eq!(words(text), ["a", "f", "m", "type", "n"]);
        assert_eq!(tokens("a::b"), [Token::Word("a".into()), Token::Separator, Token::Word("b".into())]);
    }

    #[test]
    fn what_tests_alone_have_is_left_out() {
        let text =
            "fn a() {} #[cfg(test)] mod tests { use b::c; } #[cfg(test)] mod testing; #[cfg(not(test))] fn d() {}";
        let (kept, modules) = without_tests(&tokens(text));
        assert!(kept.iter().any(|token| token.is_word("d")) && !kept.iter().any(|token| token.is_word("b")));
        assert_eq!(modules, ["testing"]);
    }
}
