//! Tests that no crate has circular references between its files.
//!
//! A reference is a `use` declaration or a path, followed through re-exports to the file with the
//! definition. Declarations and re-exports of submodules do not count as references.

use super::code::{self, References, is, word};
use super::manifests;
use proc_macro2::TokenTree;
use std::collections::{BTreeMap, BTreeSet, VecDeque};
use std::fs;
use std::path::{Path, PathBuf};
use tests::harness::root;

const ITEMS: [&str; 8] = ["fn", "struct", "enum", "trait", "type", "const", "static", "union"];

/// Longest chain of re-exports that is followed.
const LONGEST_CHAIN: usize = 12;

type Name = Vec<String>;

struct Module {
    file: PathBuf,
    items: BTreeSet<String>,
    children: BTreeSet<String>,
    refers: References,
}

/// Target of a path.
enum Target {
    Module(Name),
    /// Item in this module.
    Item(Name),
}

/// Modules of a crate.
struct Crate(BTreeMap<Name, Module>);

/// Names in the second file of each pair to which the first file refers.
type Edges = BTreeMap<PathBuf, BTreeMap<PathBuf, BTreeSet<String>>>;

impl Crate {
    fn read(folder: &Path) -> Self {
        let source = folder.join("src");
        let roots = ["lib.rs", "main.rs"].map(|file| source.join(file));
        let root = roots.into_iter().find(|path| path.is_file()).unwrap();
        let mut all = Self(BTreeMap::new());
        all.add(Name::new(), &root, &source, code::read(&root));
        all
    }

    /// Adds a module and its submodules, whose files are in `folder`.
    fn add(&mut self, name: Name, file: &Path, folder: &Path, tokens: Vec<TokenTree>) {
        let (mut items, mut children, mut own) = (BTreeSet::new(), BTreeSet::new(), Vec::new());
        let mut tokens = tokens.into_iter().peekable();
        while let Some(token) = tokens.next() {
            let keyword = word(&token).unwrap_or_default();
            let defined = tokens.peek().and_then(word).unwrap_or_default();
            if keyword == "mod" {
                tokens.next();
                let inner = [name.clone(), vec![defined.clone()]].concat();
                let folder = folder.join(&defined);
                match tokens.next() {
                    Some(TokenTree::Group(group)) => {
                        self.add(inner, file, &folder, group.stream().into_iter().collect());
                    }
                    _ => {
                        let file = [folder.with_extension("rs"), folder.join("mod.rs")];
                        let file = file.into_iter().find(|path| path.is_file()).unwrap();
                        self.add(inner, &file, &folder, code::read(&file));
                    }
                }
                children.insert(defined);
                continue;
            }
            if ITEMS.contains(&keyword.as_str()) {
                items.insert(defined);
            } else if keyword == "macro_rules" {
                let named = tokens.next().filter(|mark| is(mark, '!')).and_then(|_| tokens.next());
                items.extend(named.as_ref().and_then(word));
            }
            own.push(token);
        }
        let (file, refers) = (file.to_owned(), code::references(&own));
        self.0.insert(name, Module { file, items, children, refers });
    }

    /// Resolves a path in a module; `None` outside the crate.
    fn resolve(&self, from: &Name, path: &[String], chain: usize) -> Option<Target> {
        let above = path.iter().take_while(|word| *word == "super").count();
        match path.first()?.as_str() {
            "crate" => self.follow(Name::new(), &path[1..], chain),
            "self" => self.follow(from.clone(), &path[1..], chain),
            "super" => self.follow(from[..from.len() - above].to_vec(), &path[above..], chain),
            first if self.0[from].children.contains(first) => {
                self.follow(from.clone(), path, chain)
            }
            _ => None,
        }
    }

    fn follow(&self, mut at: Name, path: &[String], chain: usize) -> Option<Target> {
        for (depth, word) in path.iter().enumerate() {
            let module = &self.0[&at];
            if module.children.contains(word) {
                at.push(word.clone());
                continue;
            }
            let mut uses = module.refers.uses.iter();
            let passed_on = uses.find(|one| one.public && one.alias == *word && word != "*");
            return match passed_on {
                Some(one) if !module.items.contains(word) && chain < LONGEST_CHAIN => {
                    let whole = [&one.path[..], &path[depth + 1..]].concat();
                    self.resolve(&at, &whole, chain + 1)
                }
                _ => Some(Target::Item(at)),
            };
        }
        Some(Target::Module(at))
    }

    fn edges(&self) -> Edges {
        let mut edges = Edges::new();
        for (name, module) in &self.0 {
            let mut refer = |to: &Name, item: &str| {
                let to = &self.0[to].file;
                if *to != module.file {
                    let from = edges.entry(module.file.clone()).or_default();
                    from.entry(to.clone()).or_default().insert(item.to_owned());
                }
            };
            let mut modules = BTreeMap::new();
            let paths = &module.refers.paths;
            for one in &module.refers.uses {
                let used = || paths.iter().any(|path| path[0] == one.alias);
                match self.resolve(name, &one.path, 0) {
                    Some(Target::Module(target)) => _ = modules.insert(&one.alias, target),
                    Some(Target::Item(to)) if !one.public || used() => {
                        refer(&to, one.path.last().unwrap());
                    }
                    _ => {}
                }
            }
            for path in paths.iter().filter(|path| path.len() > 1) {
                let target = match modules.get(&path[0]) {
                    Some(module) => self.follow(module.clone(), &path[1..], 0),
                    None => self.resolve(name, path, 0),
                };
                if let Some(Target::Item(to)) = target {
                    refer(&to, path.last().unwrap());
                }
            }
        }
        edges
    }
}

/// Shortest path from a file back to itself.
fn around(edges: &Edges, start: &PathBuf) -> Option<Vec<PathBuf>> {
    let mut ways = VecDeque::from([vec![start.clone()]]);
    let mut seen = BTreeSet::new();
    while let Some(way) = ways.pop_front() {
        for next in edges.get(way.last()?).into_iter().flat_map(BTreeMap::keys) {
            let longer = [&way[..], std::slice::from_ref(next)].concat();
            if next == start {
                return Some(longer);
            }
            if seen.insert(next.clone()) {
                ways.push_back(longer);
            }
        }
    }
    None
}

/// Describes the shortest circle of files of a crate.
fn circle(folder: &Path) -> Option<String> {
    let edges = Crate::read(folder).edges();
    let circles = edges.keys().filter_map(|file| around(&edges, file));
    let shortest = circles.min_by_key(Vec::len)?;
    let shown = |path: &Path| path.strip_prefix(folder).unwrap().display().to_string();
    let line = |pair: &[PathBuf]| {
        let items: Vec<&str> = edges[&pair[0]][&pair[1]].iter().map(String::as_str).collect();
        format!("{} refers to {} of {}", shown(&pair[0]), items.join(", "), shown(&pair[1]))
    };
    Some(shortest.windows(2).map(line).collect::<Vec<_>>().join("\n"))
}

#[test]
fn no_circle_of_files() {
    for member in manifests::members() {
        if let Some(circle) = circle(&root().join(&member)) {
            panic!("files of {member} in a circle:\n{circle}");
        }
    }
}

/// A circle is found through `use` trees, re-exports, aliases and paths. Test code is ignored.
#[test]
fn a_circle_is_found() {
    let place = tempfile::tempdir().unwrap();
    let folder = place.path();
    let write = |name: &str, text: &str| fs::write(folder.join("src").join(name), text).unwrap();
    fs::create_dir_all(folder.join("src/b")).unwrap();
    write("lib.rs", "mod a;\npub mod b;\n");
    write("b.rs", "mod deep;\npub use deep::{Far, near as close};\n");
    write("b/deep.rs", "pub struct Far;\npub fn near() {}\n");
    write("a.rs", "use crate::b::{self, Far as Away};\npub fn go(_: Away) { b::close() }\n");
    assert_eq!(circle(folder), None);
    write("b/deep.rs", "#[cfg(test)]\nmod t { fn f() { crate::a::go() } }\npub struct Far;\n");
    assert_eq!(circle(folder), None);
    write("b/deep.rs", "pub struct Far;\npub fn near() { vec![crate::a::go(Far)]; }\n");
    let found = "src/a.rs refers to Far, close of src/b/deep.rs\n\
                 src/b/deep.rs refers to go of src/a.rs";
    assert_eq!(circle(folder).as_deref(), Some(found));
}
