//! The sources as a graph: which file takes something from which.
//!
//! What is read are the paths of the code, `crate::…`, `super::…` and those of `use`, led through re-exports to the file that
//! holds what they name. Tests beside the code are left out, and so are methods, whose types are named anyway.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

/// A module by its path from the crate's root; the root's is empty.
pub(crate) type Module = Vec<String>;

/// The source files and what they take from each other.
pub(crate) struct House {
    files: BTreeMap<Module, PathBuf>,
    /// Names that a module hands on, and where from; `*` for all of another's.
    handed_on: BTreeMap<Module, Vec<(String, Vec<String>)>>,
    /// Every path that a file names, from the root.
    named: BTreeMap<Module, BTreeSet<Vec<String>>>,
}

pub(crate) fn files_below(folder: &Path) -> Vec<PathBuf> {
    let entries = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
    let mut files: Vec<PathBuf> =
        entries.flat_map(|path| if path.is_dir() { files_below(&path) } else { vec![path] }).collect();
    files.sort();
    files.retain(|path| path.extension().is_some_and(|extension| extension == "rs"));
    files
}

/// `text` without comments; what it says between quotes stays.
pub(crate) fn without_comments(text: &str) -> String {
    let code = |line: &str| line.split_once("//").map_or(line, |(code, _)| code).to_owned();
    text.lines().map(code).collect::<Vec<_>>().join("\n")
}

pub(crate) fn is_word(c: char) -> bool {
    c.is_alphanumeric() || c == '_'
}

/// `code` without the tests at its end.
fn without_tests(code: &str) -> &str {
    code.find("#[cfg(test)]\nmod ").map_or(code, |at| &code[..at])
}

/// The module of a file below `src`; `None` for the crate's roots and for tests.
fn module_of(path: &Path) -> Option<Module> {
    let path = path.strip_prefix("src").unwrap().with_extension("");
    let mut module: Module = path.iter().map(|part| part.to_string_lossy().into_owned()).collect();
    if module.last().is_some_and(|last| last == "mod") {
        module.pop();
    }
    let last = module.last().unwrap().as_str();
    let is_root = module.len() == 1 && ["lib", "main"].contains(&last);
    let is_tests = module.iter().any(|part| part == "tests");
    (!is_root && !is_tests).then_some(module)
}

/// The paths of a `use` tree, `a::{b, c::d as e}`, each with the name that it is known by.
fn branches(tree: &str, before: &[String]) -> Vec<(String, Vec<String>)> {
    let tree = tree.trim();
    if let Some(open) = tree.find('{') {
        let mut path = before.to_vec();
        path.extend(tree[..open].split("::").map(str::trim).filter(|part| !part.is_empty()).map(String::from));
        let inner = &tree[open + 1..tree.rfind('}').unwrap()];
        let (mut depth, mut start, mut found) = (0, 0, Vec::new());
        for (at, c) in inner.char_indices().chain([(inner.len(), ',')]) {
            match c {
                '{' => depth += 1,
                '}' => depth -= 1,
                ',' if depth == 0 => {
                    if !inner[start..at].trim().is_empty() {
                        found.extend(branches(&inner[start..at], &path));
                    }
                    start = at + 1;
                }
                _ => {}
            }
        }
        return found;
    }
    let (tree, alias) = tree.split_once(" as ").map_or((tree, None), |(tree, alias)| (tree, Some(alias.trim())));
    let mut path = before.to_vec();
    path.extend(tree.split("::").map(|part| part.trim().to_owned()).filter(|part| part != "self" && !part.is_empty()));
    let name = alias.map_or_else(|| path.last().cloned().unwrap_or_default(), String::from);
    vec![(name, path)]
}

impl House {
    pub(crate) fn read() -> Self {
        let mut house = Self { files: BTreeMap::new(), handed_on: BTreeMap::new(), named: BTreeMap::new() };
        let paths = files_below(Path::new("src"));
        house.files = paths.into_iter().filter_map(|path| Some((module_of(&path)?, path))).collect();
        for (module, path) in house.files.clone() {
            let text = without_comments(&std::fs::read_to_string(path).unwrap());
            house.enter(&module, without_tests(&text));
        }
        house
    }

    /// Enters what a module names and hands on.
    fn enter(&mut self, module: &Module, code: &str) {
        let (mut named, mut handed_on) = (BTreeSet::new(), Vec::new());
        let mut rest = String::new();
        for statement in code.split_inclusive(';') {
            let Some((before, visible, tree)) = use_of(statement) else {
                rest += statement;
                continue;
            };
            rest += before;
            for (name, path) in branches(tree, &[]) {
                let path = self.rooted(module, path);
                if visible {
                    handed_on.push((name, path));
                } else {
                    named.insert(path);
                }
            }
        }
        let children = self.files.keys().filter(|other| other.len() == module.len() + 1 && other.starts_with(module));
        let children: Vec<String> = children.filter_map(|child| child.last().cloned()).collect();
        for root in ["crate", "super", "self"].into_iter().chain(children.iter().map(String::as_str)) {
            for (at, _) in rest.match_indices(&format!("{root}::")) {
                if rest[..at].ends_with(|c| is_word(c) || c == ':' || c == '$') {
                    continue;
                }
                let end = rest[at..].find(|c| !is_word(c) && c != ':').map_or(rest.len(), |length| at + length);
                let path = rest[at..end].trim_end_matches(':').split("::").map(String::from).collect();
                named.insert(self.rooted(module, path));
            }
        }
        self.named.insert(module.clone(), named);
        self.handed_on.insert(module.clone(), handed_on);
    }

    /// A path as it stands in a module, from the root; what is of other crates keeps its name, which no module has.
    fn rooted(&self, module: &Module, path: Vec<String>) -> Vec<String> {
        let mut base = module.clone();
        let mut parts = path.into_iter().peekable();
        match parts.peek().map(String::as_str) {
            Some("crate") => {
                base.clear();
                parts.next();
            }
            Some("super") => {
                while parts.peek().is_some_and(|part| part == "super") {
                    base.pop();
                    parts.next();
                }
            }
            Some("self") => drop(parts.next()),
            Some(first) => {
                let mut child = base.clone();
                child.push(first.to_owned());
                if !self.files.contains_key(&child) {
                    base = vec!["(elsewhere)".into()];
                }
            }
            None => {}
        }
        base.extend(parts);
        base
    }

    /// The module whose file holds what a path names.
    fn home(&self, path: &[String], hops: usize) -> Option<Module> {
        let depth = (0..=path.len()).rev().find(|&depth| self.files.contains_key(&path[..depth]))?;
        let module = path[..depth].to_vec();
        let Some(name) = path.get(depth) else { return Some(module) };
        if hops > 0 {
            for (known, from) in self.handed_on.get(&module)? {
                let mut from = from.clone();
                if known == "*" {
                    from.pop();
                    from.push(name.clone());
                } else if known != name {
                    continue;
                }
                from.extend_from_slice(&path[depth + 1..]);
                let home = self.home(&from, hops - 1);
                if home.as_ref().is_some_and(|home| *home != module || known != "*") {
                    return home;
                }
            }
        }
        Some(module)
    }

    /// From each module to those whose files it takes something from. A room's own file, `mod.rs`, opens the room: what it takes
    /// from the files in it is no arrow.
    pub(crate) fn edges(&self) -> BTreeMap<Module, BTreeSet<Module>> {
        let of = |(module, paths): (&Module, &BTreeSet<Vec<String>>)| {
            let homes = paths.iter().filter_map(|path| self.home(path, 8)).filter(|home| !home.starts_with(module));
            (module.clone(), homes.collect())
        };
        self.named.iter().map(of).collect()
    }

    /// Files and rooms that are directly in a room.
    pub(crate) fn in_room(&self, room: &[String]) -> BTreeSet<String> {
        let below = self.files.keys().filter(|module| module.starts_with(room));
        below.filter_map(|module| module.get(room.len()).cloned()).collect()
    }
}

/// The `use` statement that ends `statement`: what is before it, whether it hands on, and its tree.
fn use_of(statement: &str) -> Option<(&str, bool, &str)> {
    let text = statement.strip_suffix(';')?;
    let line = |at: usize| text[..at].rfind('\n').map_or(0, |end| end + 1);
    let at = text.match_indices("use ").map(|(at, _)| at).find(|&at| {
        let visibility = text[line(at)..at].trim();
        visibility.is_empty() || visibility == "pub" || (visibility.starts_with("pub(") && visibility.ends_with(')'))
    })?;
    Some((&text[..line(at)], text[line(at)..at].contains("pub"), &text[at + "use ".len()..]))
}

/// Modules that are in a circle, or between two: what is left when those that take from none of the rest are taken away, and
/// those that none takes from.
pub(crate) fn in_circles(mut edges: BTreeMap<Module, BTreeSet<Module>>) -> Vec<String> {
    loop {
        let all: BTreeSet<Module> = edges.keys().cloned().collect();
        for targets in edges.values_mut() {
            targets.retain(|target| all.contains(target));
        }
        let taken: BTreeSet<Module> = edges.values().flatten().cloned().collect();
        let before = edges.len();
        edges.retain(|module, targets| !targets.is_empty() && taken.contains(module));
        if edges.len() == before {
            break;
        }
    }
    let arrow = |(module, targets): (Module, BTreeSet<Module>)| {
        let targets: Vec<String> = targets.iter().map(|target| target.join("::")).collect();
        format!("{} -> {}", module.join("::"), targets.join(", "))
    };
    edges.into_iter().map(arrow).collect()
}
