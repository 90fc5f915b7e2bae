//! Source text as tokens, without comments, attributes and code compiled for tests only; its `use`
//! declarations and paths.

use proc_macro2::{Delimiter, Group, TokenStream, TokenTree};
use std::iter::Peekable;
use std::path::{Path, PathBuf};

/// Leaf of the tree of a `use` declaration.
pub(super) struct Use {
    pub(super) path: Vec<String>,
    /// Name of the item in this file; `*` for all items of a module.
    pub(super) alias: String,
    pub(super) public: bool,
}

/// References in a piece of code.
#[derive(Default)]
pub(super) struct References {
    pub(super) uses: Vec<Use>,
    /// Paths and single words outside `use` declarations.
    pub(super) paths: Vec<Vec<String>>,
    /// String literals.
    pub(super) texts: Vec<String>,
}

/// Reads the tokens of a source file.
pub(super) fn read(path: &Path) -> Vec<TokenTree> {
    let text = std::fs::read_to_string(path).unwrap();
    clean(text.parse().unwrap_or_else(|error| panic!("{}: {error}", path.display())))
}

/// Rust files under a folder, without tests.
pub(super) fn files(folder: &Path) -> Vec<PathBuf> {
    let entries = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
    let (folders, files): (Vec<_>, Vec<_>) = entries.partition(|path| path.is_dir());
    let tests = |path: &PathBuf| path.file_stem().unwrap() == "tests";
    let inner = folders.into_iter().filter(|path| !tests(path)).flat_map(|path| self::files(&path));
    let rust = |path: &PathBuf| path.extension().is_some_and(|ending| ending == "rs");
    files.into_iter().filter(|path| rust(path) && !tests(path)).chain(inner).collect()
}

/// Collects the references in a piece of code.
pub(super) fn references(tokens: &[TokenTree]) -> References {
    let mut found = References::default();
    collect(tokens, &mut found);
    found
}

/// True if the token is this punctuation mark.
pub(super) fn is(token: &TokenTree, mark: char) -> bool {
    matches!(token, TokenTree::Punct(punct) if punct.as_char() == mark)
}

/// Returns the identifier if the token is one.
pub(super) fn word(token: &TokenTree) -> Option<String> {
    match token {
        TokenTree::Ident(ident) => Some(ident.to_string()),
        _ => None,
    }
}

fn clean(stream: TokenStream) -> Vec<TokenTree> {
    let (mut kept, mut tokens) = (Vec::new(), stream.into_iter().peekable());
    while let Some(token) = tokens.next() {
        match token {
            TokenTree::Punct(_) if is(&token, '#') => {
                let _ = tokens.next_if(|token| is(token, '!'));
                let Some(attribute) = tokens.next() else { break };
                if is_for_tests(&attribute) {
                    skip_item(&mut tokens);
                }
            }
            TokenTree::Group(group) => {
                let inner = clean(group.stream()).into_iter().collect();
                kept.push(Group::new(group.delimiter(), inner).into());
            }
            other => kept.push(other),
        }
    }
    kept
}

fn is_for_tests(attribute: &TokenTree) -> bool {
    let text = attribute.to_string().replace(' ', "");
    text.starts_with("[cfg(test)") || text.starts_with("[cfg(all(test,")
}

/// Skips an item, up to its semicolon or its braces.
fn skip_item(tokens: &mut Peekable<impl Iterator<Item = TokenTree>>) {
    let mut braces_end = true;
    for token in tokens {
        match &token {
            TokenTree::Ident(ident) => match ident.to_string().as_str() {
                "use" | "const" | "static" | "type" => braces_end = false,
                "fn" => braces_end = true,
                _ => {}
            },
            TokenTree::Group(group) if braces_end && group.delimiter() == Delimiter::Brace => break,
            token if is(token, ';') => break,
            _ => {}
        }
    }
}

fn collect(tokens: &[TokenTree], found: &mut References) {
    let mut at = 0;
    while let Some(token) = tokens.get(at) {
        at += 1;
        match token {
            TokenTree::Group(group) => {
                let inner: Vec<TokenTree> = group.stream().into_iter().collect();
                collect(&inner, found);
            }
            TokenTree::Literal(literal) if literal.to_string().contains('"') => {
                found.texts.push(literal.to_string());
            }
            TokenTree::Ident(ident) if ident == "use" => {
                let end = tokens[at..].iter().position(|token| is(token, ';'));
                let end = at + end.unwrap_or(tokens.len() - at);
                let public = is_public(&tokens[..at - 1]);
                leaves(&tokens[at..end], &[], public, &mut found.uses);
                at = end;
            }
            TokenTree::Ident(ident) => {
                let mut path = vec![ident.to_string()];
                while let [first, second, TokenTree::Ident(next), ..] = &tokens[at..]
                    && is(first, ':')
                    && is(second, ':')
                {
                    path.push(next.to_string());
                    at += 3;
                }
                found.paths.push(path);
            }
            _ => {}
        }
    }
}

/// True if the tokens before a declaration make it public.
fn is_public(before: &[TokenTree]) -> bool {
    let before = match before {
        [rest @ .., TokenTree::Group(group)] if group.delimiter() == Delimiter::Parenthesis => rest,
        all => all,
    };
    before.last().and_then(word).is_some_and(|word| word == "pub")
}

/// Collects the leaves of a `use` tree.
fn leaves(tree: &[TokenTree], before: &[String], public: bool, into: &mut Vec<Use>) {
    for branch in tree.split(|token| is(token, ',')).filter(|branch| !branch.is_empty()) {
        let mut path = before.to_vec();
        if let [stem @ .., TokenTree::Group(group)] = branch {
            path.extend(stem.iter().filter_map(word));
            let inner: Vec<TokenTree> = group.stream().into_iter().collect();
            leaves(&inner, &path, public, into);
            continue;
        }
        let mut words: Vec<String> = branch.iter().filter_map(word).collect();
        words.extend(branch.last().filter(|token| is(token, '*')).map(|_| "*".to_owned()));
        let renamed = match &words[..] {
            [.., keyword, alias] if keyword == "as" => Some(alias.clone()),
            _ => None,
        };
        words.truncate(words.len() - 2 * usize::from(renamed.is_some()));
        if !before.is_empty() && words == ["self"] {
            words.clear();
        }
        path.extend(words);
        let alias = renamed.unwrap_or_else(|| path.last().unwrap().clone());
        into.push(Use { path, alias, public });
    }
}
