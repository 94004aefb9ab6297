//! Rust as its tokens, without what cannot move a number: comments, documentation, tests.

use std::fmt::Write;
use std::iter::Peekable;

use proc_macro2::{Delimiter, Group, LexError, TokenStream, TokenTree};

/// The tokens of a file.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Tokens {
    /// One after the other, each with a space after it.
    pub text: String,
    /// Names of modules in files of their own that are compiled for tests alone.
    pub test_modules: Vec<String>,
}

/// Words that begin an item; what else stands after an attribute ends at a comma too.
const ITEMS: [&str; 16] = [
    "async",
    "const",
    "enum",
    "extern",
    "fn",
    "impl",
    "let",
    "macro_rules",
    "mod",
    "static",
    "struct",
    "trait",
    "type",
    "union",
    "unsafe",
    "use",
];

/// The tokens of a file of Rust without comments, `doc` attributes, and items that are compiled under `cfg(test)` alone.
///
/// # Errors
/// A text that does not consist of tokens.
pub fn tokens(source: &str) -> Result<Tokens, LexError> {
    let stream: TokenStream = source.parse()?;
    let mut found = Tokens::default();
    write(stream, &mut found);
    Ok(found)
}

type Trees = Peekable<proc_macro2::token_stream::IntoIter>;

fn write(stream: TokenStream, found: &mut Tokens) {
    let mut trees = stream.into_iter().peekable();
    while let Some(tree) = trees.next() {
        match tree {
            TokenTree::Punct(punct) if punct.as_char() == '#' => {
                let inner = is_punct(trees.peek(), '!');
                if inner {
                    trees.next();
                }
                let Some(TokenTree::Group(group)) = trees.peek() else {
                    found.text.push_str(if inner { "# ! " } else { "# " });
                    continue;
                };
                match kind(group) {
                    Attribute::Doc => drop(trees.next()),
                    Attribute::Test if !inner => {
                        trees.next();
                        skip_item(&mut trees, found);
                    }
                    Attribute::Test | Attribute::Other => {
                        found.text.push_str(if inner { "# ! " } else { "# " });
                    }
                }
            }
            TokenTree::Group(group) => {
                let (open, close) = match group.delimiter() {
                    Delimiter::Parenthesis => ("( ", ") "),
                    Delimiter::Brace => ("{ ", "} "),
                    Delimiter::Bracket => ("[ ", "] "),
                    Delimiter::None => ("", ""),
                };
                found.text.push_str(open);
                write(group.stream(), found);
                found.text.push_str(close);
            }
            leaf => write!(found.text, "{leaf} ").expect("a text grows"),
        }
    }
}

enum Attribute {
    Doc,
    /// `cfg(test)`.
    Test,
    Other,
}

fn kind(group: &Group) -> Attribute {
    let text: String = group.stream().to_string().split_whitespace().collect();
    if text == "cfg(test)" {
        Attribute::Test
    } else if text.starts_with("doc=") || text.starts_with("doc(") {
        Attribute::Doc
    } else {
        Attribute::Other
    }
}

/// Passes by what an attribute belongs to; notes the name of a module in a file of its own.
fn skip_item(trees: &mut Trees, found: &mut Tokens) {
    while is_punct(trees.peek(), '#') {
        trees.next();
        trees.next();
    }
    if is_word(trees.peek(), "pub") {
        trees.next();
        if matches!(trees.peek(), Some(TokenTree::Group(group)) if group.delimiter() == Delimiter::Parenthesis)
        {
            trees.next();
        }
    }
    let item = ITEMS.iter().any(|word| is_word(trees.peek(), word));
    let module = is_word(trees.peek(), "mod");
    if module {
        trees.next();
        if let Some(TokenTree::Ident(name)) = trees.next()
            && is_punct(trees.peek(), ';')
        {
            found.test_modules.push(name.to_string());
        }
    }
    for tree in trees.by_ref() {
        match tree {
            TokenTree::Punct(punct) if punct.as_char() == ';' => return,
            TokenTree::Punct(punct) if punct.as_char() == ',' && !item => return,
            TokenTree::Group(group) if group.delimiter() == Delimiter::Brace => return,
            _ => {}
        }
    }
}

fn is_punct(tree: Option<&TokenTree>, character: char) -> bool {
    matches!(tree, Some(TokenTree::Punct(punct)) if punct.as_char() == character)
}

fn is_word(tree: Option<&TokenTree>, word: &str) -> bool {
    matches!(tree, Some(TokenTree::Ident(ident)) if ident == word)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn text(source: &str) -> String {
        tokens(source).unwrap().text
    }

    #[test]
    fn tests_documentation_and_comments_leave_no_token() {
        let bare = text("pub struct A { x: f64 }\nfn f() -> f64 { 1.0 }");
        let dressed = "//! A module.\n#![doc = \"more\"]\n/// A thing.\npub struct A {\n    /// Place \\[m\\].\n    x: f64\n}\n\
            #[cfg(test)]\nuse std::fs;\n#[cfg(test)]\n#[derive(Debug)]\npub(crate) struct B<T, U>(T, U);\n\
            fn f() -> f64 { /* half of two */ 1.0 }\n#[cfg(test)]\nmod tests { fn g() {} }";
        assert_eq!(text(dressed), bare);
        assert_eq!(text("A { #[cfg(test)] x: u8, y: u8 }"), text("A { y: u8 }"));
    }

    #[test]
    fn other_attributes_and_a_test_for_a_feature_stay() {
        assert_eq!(
            text("#[inline(always)] fn f() {}"),
            "# [ inline ( always ) ] fn f ( ) { } "
        );
        assert!(text("#[cfg(any(test, feature = \"a\"))] fn f() {}").contains("fn f"));
        assert!(text("#![forbid(unsafe_code)]").contains("forbid"));
    }

    #[test]
    fn modules_of_tests_are_named() {
        let found = tokens("mod a; #[cfg(test)] mod tests; #[cfg(test)] mod inner {}").unwrap();
        assert_eq!(found.test_modules, ["tests"]);
    }
}
