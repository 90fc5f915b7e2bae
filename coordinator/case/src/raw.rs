//! The case as written: TOML with places, without any knowledge of its keys, changed by `--set
//! key=value` and `--unset key`.

use super::diagnostics::{Place, Problem, Problems, Source};
use super::schema;
use super::tree::{Convert, Node, Origin, Table, TooDeep, Value, write_case};
use contract::suggest::nearest;
use contract::text::is_hidden;
use std::io::Read as _;
use std::path::{Path, PathBuf};
use std::sync::{Arc, OnceLock};
use toml::de::{DeTable, DeValue};

/// Largest case file \[byte\].
const LARGEST: u64 = 1 << 20;
/// Largest number of syntax errors to report; a file with more is hardly a case.
const MOST_SYNTAX_ERRORS: usize = 20;

/// Largest number of parts of a dotted key.
const MOST_PARTS: usize = 8;

/// A case that has been read, and perhaps changed by options, but not yet validated.
#[derive(Clone, Debug)]
pub struct RawCase {
    pub(super) source: Arc<Source>,
    pub(super) tree: Table,
    /// Options that have changed the case, in full.
    pub(super) arguments: Vec<String>,
    folder: PathBuf,
}

/// A section that names a participant. Values of the wrong type count as absent here; validation
/// reports them.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct RawParticipant {
    /// Name of the section.
    pub role: String,
    /// Name of the model.
    pub model: Option<String>,
    /// Program and arguments that start it.
    pub command: Option<Vec<String>>,
    /// Whether the user starts the participant by hand.
    pub attach: bool,
    /// Place of the command, or of the section without a command.
    pub place: Place,
}

/// File name that selects standard input.
const STANDARD_INPUT: &str = "-";

/// Returns all of standard input, read once because a study reads its case for every run.
fn standard_input() -> &'static Result<Vec<u8>, String> {
    static READ: OnceLock<Result<Vec<u8>, String>> = OnceLock::new();
    READ.get_or_init(|| {
        let mut bytes = Vec::new();
        let read = std::io::stdin().take(LARGEST + 1).read_to_end(&mut bytes);
        read.map(|_| bytes).map_err(|error| error.to_string())
    })
}

impl RawCase {
    /// Reads a case file. `-` selects standard input, with relative paths from the working
    /// directory.
    ///
    /// # Errors
    /// The file cannot be read, is too large, is not UTF-8 or is not TOML. All syntax errors are
    /// reported at once.
    pub fn read(path: &Path) -> Result<Self, Problems> {
        if path == Path::new(STANDARD_INPUT) {
            let bytes = standard_input();
            let bytes = bytes.as_ref().map_err(|error| {
                let reason = format!("cannot be read: {error}");
                whole_file("<stdin>", reason, "pipe a case into the command, or name a file")
            })?;
            return Self::parse_bytes("<stdin>", bytes);
        }
        let name = path.display().to_string();
        let mut bytes = Vec::new();
        let file = std::fs::File::open(path);
        if let Err(error) = file.and_then(|f| f.take(LARGEST + 1).read_to_end(&mut bytes)) {
            let fix = "check the path and its permissions";
            return Err(whole_file(&name, format!("cannot be read: {error}"), fix));
        }
        let folder = path.parent().map(Path::to_owned).unwrap_or_default();
        Ok(Self::parse_bytes(&name, &bytes)?.with_folder(folder))
    }

    /// Parses a case from text; `name` is the file name in messages.
    ///
    /// # Errors
    /// The text is too large or is not TOML. All syntax errors are reported at once.
    pub fn parse(name: &str, text: &str) -> Result<Self, Problems> {
        Self::parse_bytes(name, text.as_bytes())
    }

    /// Parses a case from arbitrary bytes; `name` is the file name in messages.
    ///
    /// # Errors
    /// The bytes are too many, not UTF-8, or not TOML. All syntax errors are reported at once.
    pub fn parse_bytes(name: &str, bytes: &[u8]) -> Result<Self, Problems> {
        if bytes.len() as u64 > LARGEST {
            let reason = format!("is larger than {} MiB", LARGEST >> 20);
            return Err(whole_file(name, reason, "name a case file"));
        }
        let text = match std::str::from_utf8(bytes) {
            Ok(text) => text.to_owned(),
            Err(error) => return Err(not_utf8(name, bytes, error.valid_up_to())),
        };
        let source = Arc::new(Source::new(name, text));
        let (document, errors) = DeTable::parse_recoverable(&source.text);
        if !errors.is_empty() {
            return Err(syntax(&source, &errors));
        }
        let convert = Convert { text: &source.text, argument: None };
        let tree = convert.table(document.get_ref(), 0).map_err(|TooDeep(span)| {
            let place = source.place(span);
            let problem = Problem::new(place, "", "nested too deeply", "use fewer levels");
            Problems::new(Arc::clone(&source), vec![problem])
        })?;
        let folder = Path::new(name).parent().map(Path::to_owned).unwrap_or_default();
        Ok(Self { source, tree, arguments: Vec::new(), folder })
    }

    /// Returns the name of the case file, as the user gave it.
    #[must_use]
    pub fn name(&self) -> &str {
        &self.source.name
    }

    /// Returns whether the case contains the key or table.
    #[must_use]
    pub fn has(&self, key: &str) -> bool {
        self.tree.find(key).is_some()
    }

    /// Returns the folder against which relative file names are resolved: that of the case file.
    #[must_use]
    pub fn folder(&self) -> &Path {
        &self.folder
    }

    /// Resolves relative file names against another folder: that of the original of a copied file.
    #[must_use]
    pub fn with_folder(self, folder: PathBuf) -> Self {
        Self { folder, ..self }
    }

    /// Returns the case as TOML: the file's own text, or the case as changed by the options.
    #[must_use]
    pub fn text(&self) -> String {
        if self.arguments.is_empty() {
            return self.source.text.clone();
        }
        let mut out = format!("# {}, changed by\n", one_line(&self.source.name));
        for argument in &self.arguments {
            out += &format!("#   {}\n", one_line(argument));
        }
        out + "\n" + &write_case(&self.tree)
    }

    /// Lists the sections that may name participants: the well-known roles, and every section other
    /// than the coordinator's with a `command`, `attach` or `model`. A section with only a `model`
    /// may be a table of values that a participant reads.
    #[must_use]
    pub fn participants(&self) -> Vec<RawParticipant> {
        let candidates = self.tree.entries.iter().filter_map(|(role, node)| {
            let table = node.table()?;
            let marks = ["command", "attach", "model"];
            let marked = marks.iter().any(|mark| table.get(mark).is_some());
            let known = schema::WELL_KNOWN_ROLES.contains(&role.as_str());
            let plain = !role.is_empty() && !role.contains('.');
            let own = schema::SECTIONS.contains(&role.as_str());
            (plain && !own && (known || marked)).then_some((role, node, table))
        });
        candidates.map(|(role, node, table)| self.participant(role, node, table)).collect()
    }

    fn participant(&self, role: &str, node: &Node, table: &Table) -> RawParticipant {
        let attach = table.get("attach").is_some_and(|n| matches!(n.value, Value::Flag(true)));
        RawParticipant {
            role: role.to_owned(),
            model: table.text("model").map(str::to_owned),
            command: table.get("command").and_then(Node::texts).filter(|c| !c.is_empty()),
            attach,
            place: table
                .get("command")
                .map_or_else(|| self.key_place(node), |c| self.value_place(c)),
        }
    }

    /// Creates an error at a dotted key: at its value, or at the nearest section above.
    pub fn problem_at(
        &self,
        key: &str,
        reason: impl Into<String>,
        fix: impl Into<String>,
    ) -> Problem {
        let place = match self.tree.find(key) {
            Some(node) if node.table().is_none() => self.value_place(node),
            _ => self.section_place(key),
        };
        Problem::new(place, key, reason, fix)
    }

    /// Collects errors of this case for display with their source lines; `None` without errors.
    #[must_use]
    pub fn report(&self, problems: Vec<Problem>) -> Option<Problems> {
        let some = !problems.is_empty();
        some.then(|| Problems::new(Arc::clone(&self.source), problems))
    }

    /// Returns the place of a key's name.
    pub(super) fn key_place(&self, node: &Node) -> Place {
        match &node.origin {
            // The header of a section serves as its key and its place.
            Origin::File { key, value } if is_header(node, key, value) => {
                self.source.place(value.clone())
            }
            Origin::File { key, .. } => self.source.place(key.clone()),
            Origin::Argument(number) => self.argument_place(*number),
        }
    }

    /// Returns the place of a value.
    pub(super) fn value_place(&self, node: &Node) -> Place {
        match &node.origin {
            Origin::File { value, .. } => self.source.place(value.clone()),
            Origin::Argument(number) => self.argument_place(*number),
        }
    }

    /// Returns the place of a section, or of the nearest section above.
    pub(super) fn section_place(&self, section: &str) -> Place {
        let mut key = section;
        loop {
            if let Some(node) = self.tree.find(key) {
                return self.key_place(node);
            }
            match key.rsplit_once('.') {
                Some((parent, _)) => key = parent,
                None => return Place::Case { path: Arc::clone(&self.source.name) },
            }
        }
    }

    fn argument_place(&self, number: usize) -> Place {
        Place::Argument { text: self.arguments.get(number).cloned().unwrap_or_default() }
    }
}

fn is_header(node: &Node, key: &std::ops::Range<usize>, value: &std::ops::Range<usize>) -> bool {
    node.table().is_some_and(|t| !t.inline) && value.start <= key.start && key.end <= value.end
}

fn one_line(text: &str) -> String {
    text.chars().map(|c| if is_hidden(c) { ' ' } else { c }).collect()
}

fn whole_file(name: &str, reason: String, fix: &str) -> Problems {
    let source = Arc::new(Source::new(name, String::new()));
    let place = Place::Case { path: Arc::clone(&source.name) };
    Problems::new(source, vec![Problem::new(place, "", reason, fix)])
}

fn not_utf8(name: &str, bytes: &[u8], valid: usize) -> Problems {
    let source = Arc::new(Source::new(name, String::from_utf8_lossy(bytes).into_owned()));
    // The text is unchanged up to the first invalid byte, which was replaced by one character.
    let place = source.place(valid..valid + 1);
    let reason = format!("byte {valid} (0x{:02x}) is not UTF-8", bytes[valid]);
    Problems::new(source, vec![Problem::new(place, "", reason, "save the file as UTF-8 text")])
}

/// Reports one syntax error a line, because a slip often causes further errors behind it.
fn syntax(source: &Arc<Source>, errors: &[toml::de::Error]) -> Problems {
    let mut problems: Vec<Problem> = Vec::new();
    for error in errors {
        let end = source.text.len();
        let place = source.place(error.span().unwrap_or(end..end));
        let line = |place: &Place| match place {
            Place::File { line, .. } => *line,
            _ => 0,
        };
        if problems.iter().any(|p| line(&p.place) == line(&place)) {
            continue;
        }
        if problems.len() == MOST_SYNTAX_ERRORS {
            break;
        }
        let empty = error
            .span()
            .and_then(|span| source.text.get(span))
            .is_some_and(|there| there.trim().is_empty());
        let comma = error.span().and_then(|span| decimal_comma(&source.text, span.start));
        problems.push(match comma {
            Some(fix) => Problem::new(place, "", "invalid TOML: a decimal comma", fix),
            None => syntax_problem(place, error.message(), empty),
        });
    }
    Problems::new(Arc::clone(source), problems)
}

/// Suggests a fix for a number with a decimal comma.
fn decimal_comma(text: &str, at: usize) -> Option<String> {
    let (before, after) = (text.get(..at)?, text.get(at..)?.strip_prefix(',')?);
    let digits = |c: char| c.is_ascii_digit();
    let whole = &before[before.trim_end_matches(digits).len()..];
    let decimals = after.split(|c| !digits(c)).next().unwrap_or_default();
    let both = !whole.is_empty() && !decimals.is_empty();
    both.then(|| format!("write {whole}.{decimals}, with a point"))
}

/// Translates an error of the TOML parser; `empty` if its place holds no text.
fn syntax_problem(place: Place, message: &str, empty: bool) -> Problem {
    let (reason, expected) = message.split_once(", expected ").unwrap_or((message, ""));
    let (reason, fix) = match (reason, expected) {
        ("duplicate key", _) => (reason, "keep one of the two".to_owned()),
        ("string values must be quoted", _) if empty => {
            ("no value after the `=`", "write a value".to_owned())
        }
        ("string values must be quoted", _) => (reason, "put the text in quotes".to_owned()),
        (_, "") => (reason, "write valid TOML".to_owned()),
        (_, "nothing") => (reason, "remove the surplus text".to_owned()),
        _ => (reason, format!("TOML expects {expected} here")),
    };
    Problem::new(place, "", format!("invalid TOML: {reason}"), fix)
}

impl RawCase {
    /// Applies `--set` and then `--unset` options.
    ///
    /// # Errors
    /// Lists every option that cannot be applied.
    pub fn apply<S: AsRef<str>>(&mut self, set: &[S], unset: &[S]) -> Result<(), Problems> {
        let mut problems = Vec::new();
        problems.extend(set.iter().filter_map(|option| self.set(option.as_ref()).err()));
        problems.extend(unset.iter().filter_map(|option| self.unset(option.as_ref()).err()));
        self.report(problems).map_or(Ok(()), Err)
    }

    /// Sets a key: `motion.speed=30`, `load.normal_force=100 kN`, `effects.partial_slip={}`. A
    /// value that is not TOML is a text. When the case is validated, an alternative set here
    /// replaces the alternatives of the file.
    ///
    /// # Errors
    /// The option has no `=`, no key or no value, the value is malformed TOML, or the key leads
    /// through a value that is not a table.
    pub fn set(&mut self, assignment: &str) -> Result<(), Problem> {
        let option = format!("--set {assignment}");
        let fail = |key: &str, reason: String, fix: String| {
            Problem::new(Place::Argument { text: option.clone() }, key, reason, fix)
        };
        let form = "write `--set key=value`, such as `--set motion.speed=30`";
        let (key, value) =
            split(assignment).ok_or_else(|| fail("", "has no `=`".to_owned(), form.to_owned()))?;
        let path = parse_key(key)
            .ok_or_else(|| fail("", format!("`{}` is not a key", key.trim()), form.to_owned()))?;
        let dotted = path.join(".");
        let value = self.parse_value(value).map_err(|fault| fail(&dotted, fault.0, fault.1))?;
        let node = Node { origin: Origin::Argument(self.arguments.len()), value };
        self.tree.insert(&path, node).map_err(|step| {
            fail(&dotted, format!("`{step}` is not a table"), format!("set `{step}` itself"))
        })?;
        self.arguments.push(option);
        Ok(())
    }

    /// Removes a key or a table.
    ///
    /// # Errors
    /// The case does not contain the key.
    pub fn unset(&mut self, key: &str) -> Result<(), Problem> {
        let option = format!("--unset {key}");
        if parse_key(key).and_then(|path| self.tree.remove(&path)).is_some() {
            self.arguments.push(option);
            return Ok(());
        }
        let mut keys = Vec::new();
        collect(&self.tree, "", &mut keys);
        let fix = match nearest(key, keys.iter().map(String::as_str)) {
            Some(near) => format!("write `--unset {near}`"),
            None => "leave the option out".to_owned(),
        };
        let place = Place::Argument { text: option };
        Err(Problem::new(place, key, "is not in the case", fix))
    }

    /// Parses the value of an option; an error has reason and fix.
    fn parse_value(&self, text: &str) -> Result<Value, (String, String)> {
        let text = text.trim();
        if text.is_empty() {
            let fix = "write a value, `\"\"` for an empty text, or use --unset";
            return Err(("has no value".to_owned(), fix.to_owned()));
        }
        let parsed = match DeValue::parse(text) {
            Ok(parsed) if !matches!(parsed.get_ref(), DeValue::Datetime(_)) => parsed,
            // Brackets and quotes start a TOML value; anything else is a bare text.
            Err(error) if text.starts_with(['{', '[', '"', '\'']) => {
                let fix = "the shell removes quotes; write --set 'key=\"value\"'";
                let reason = format!("the value is not TOML: {}", error.message());
                return Err((reason, fix.to_owned()));
            }
            _ => return Ok(Value::Text(text.to_owned())),
        };
        let convert = Convert { text, argument: Some(self.arguments.len()) };
        let node = convert.node(parsed.span(), &parsed, 0);
        node.map(|node| node.value).map_err(|TooDeep(_)| {
            ("the value is nested too deeply".to_owned(), "use fewer levels".to_owned())
        })
    }
}

/// Splits at the first `=` outside quotes.
fn split(assignment: &str) -> Option<(&str, &str)> {
    let mut quote = None;
    for (at, c) in assignment.char_indices() {
        match (quote, c) {
            (None, '=') => return Some((&assignment[..at], &assignment[at + 1..])),
            (None, '"' | '\'') => quote = Some(c),
            (Some(open), c) if c == open => quote = None,
            _ => {}
        }
    }
    None
}

/// Splits a dotted key into its parts, quoted or bare.
fn parse_key(key: &str) -> Option<Vec<String>> {
    let key = key.trim();
    if key.starts_with('[') || key.contains(['\n', '\r']) {
        return None;
    }
    // Apply TOML's own rules for keys: the key with a value is a document of nested tables.
    let document = format!("{key} = true");
    let parsed = DeTable::parse(&document).ok()?;
    let mut table = parsed.get_ref();
    let mut path = Vec::new();
    while path.len() < MOST_PARTS {
        let (name, value) = table.iter().next()?;
        path.push(name.get_ref().to_string());
        match value.get_ref() {
            DeValue::Table(next) => table = next,
            _ => return Some(path),
        }
    }
    None
}

/// Collects all dotted keys of a table.
fn collect(table: &Table, path: &str, keys: &mut Vec<String>) {
    for (name, node) in &table.entries {
        let key = if path.is_empty() { name.clone() } else { format!("{path}.{name}") };
        if let Some(inner) = node.table() {
            collect(inner, &key, keys);
        }
        keys.push(key);
    }
}
