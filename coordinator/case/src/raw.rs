//! The case as written: TOML with places, before anything is known about its keys.

use super::diagnostics::{Place, Problem, Problems, Source};
use super::tree::{Convert, Node, Origin, Table, TooDeep, Value};
use super::{schema, text};
use contract::text::is_hidden;
use std::io::Read as _;
use std::path::{Path, PathBuf};
use std::sync::{Arc, OnceLock};
use toml::de::DeTable;

/// Largest case file \[byte\].
const LARGEST: u64 = 1 << 20;
/// More errors of syntax than this say only that the file is no case.
const MOST_SYNTAX_ERRORS: usize = 20;

/// A case that has been read, and perhaps changed by options, but not validated.
#[derive(Clone, Debug)]
pub struct RawCase {
    pub(super) source: Arc<Source>,
    pub(super) tree: Table,
    /// The options that changed it, in full.
    pub(super) arguments: Vec<String>,
    folder: PathBuf,
}

/// A section of the case that names a participant; what is of the wrong type counts as absent
/// here and is reported by validation.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct RawParticipant {
    /// Name of the section.
    pub role: String,
    /// Name of the model.
    pub model: Option<String>,
    /// Program and arguments that start it.
    pub command: Option<Vec<String>>,
    /// It is started by hand, and waited for.
    pub attach: bool,
    /// Where its command stands; its section, if there is none.
    pub place: Place,
}

/// What stands for standard input in the place of a file.
const STANDARD_INPUT: &str = "-";

/// All of standard input: it can be read once, and a study reads its case for every run.
fn standard_input() -> &'static Result<Vec<u8>, String> {
    static READ: OnceLock<Result<Vec<u8>, String>> = OnceLock::new();
    READ.get_or_init(|| {
        let mut bytes = Vec::new();
        let read = std::io::stdin().take(LARGEST + 1).read_to_end(&mut bytes);
        read.map(|_| bytes).map_err(|error| error.to_string())
    })
}

impl RawCase {
    /// Reads a case file; `-` is standard input, whose relative paths are meant from the current folder.
    ///
    /// # Errors
    /// The file cannot be read, is not UTF-8 or is not TOML; all errors of syntax at once.
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

    /// Reads a case from text; `name` stands for the file in errors.
    ///
    /// # Errors
    /// All errors of syntax at once.
    pub fn parse(name: &str, text: &str) -> Result<Self, Problems> {
        Self::parse_bytes(name, text.as_bytes())
    }

    /// Reads a case from bytes that may be anything; `name` stands for the file in errors.
    ///
    /// # Errors
    /// The bytes are not UTF-8, or not TOML; all errors of syntax at once.
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

    /// The name of the case file, as the user gave it.
    #[must_use]
    pub fn name(&self) -> &str {
        &self.source.name
    }

    /// The key or table is in the case.
    #[must_use]
    pub fn has(&self, key: &str) -> bool {
        self.tree.find(key).is_some()
    }

    /// The folder from which relative file names are meant: that of the case file.
    #[must_use]
    pub fn folder(&self) -> &Path {
        &self.folder
    }

    /// The same case, with relative file names meant from another folder: that of the file of which
    /// this one is a copy.
    #[must_use]
    pub fn with_folder(self, folder: PathBuf) -> Self {
        Self { folder, ..self }
    }

    /// The case as TOML: the file's own text, or the case as the options have changed it.
    #[must_use]
    pub fn text(&self) -> String {
        if self.arguments.is_empty() {
            return self.source.text.clone();
        }
        let mut out = format!("# {}, changed by\n", one_line(&self.source.name));
        for argument in &self.arguments {
            out += &format!("#   {}\n", one_line(argument));
        }
        out + "\n" + &text::write_case(&self.tree)
    }

    /// The sections that may name participants: those of the well-known roles, and every other
    /// with a `command`, `attach` or `model` that is not the coordinator's own. A section with
    /// only a `model` may turn out to be a table of values that some participant reads.
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

    /// An error at a dotted key: at its value, or at the nearest section that holds it.
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

    /// Errors of this case, to be shown with its source lines; `None` if there are none.
    #[must_use]
    pub fn report(&self, problems: Vec<Problem>) -> Option<Problems> {
        let some = !problems.is_empty();
        some.then(|| Problems::new(Arc::clone(&self.source), problems))
    }

    /// The place of a key's name.
    pub(super) fn key_place(&self, node: &Node) -> Place {
        match &node.origin {
            // The header of a section is its key and its place.
            Origin::File { key, value } if is_header(node, key, value) => {
                self.source.place(value.clone())
            }
            Origin::File { key, .. } => self.source.place(key.clone()),
            Origin::Argument(number) => self.argument_place(*number),
        }
    }

    /// The place of a value.
    pub(super) fn value_place(&self, node: &Node) -> Place {
        match &node.origin {
            Origin::File { value, .. } => self.source.place(value.clone()),
            Origin::Argument(number) => self.argument_place(*number),
        }
    }

    /// The place of a section, or of the nearest that would hold it.
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
    // The text is unchanged up to the first invalid byte, which became one character.
    let place = source.place(valid..valid + 1);
    let reason = format!("byte {valid} (0x{:02x}) is not UTF-8", bytes[valid]);
    Problems::new(source, vec![Problem::new(place, "", reason, "save the file as UTF-8 text")])
}

/// Errors of syntax, one a line: a slip often makes the parser complain about what follows it.
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

/// What to write where a number has a comma in the place of its point.
fn decimal_comma(text: &str, at: usize) -> Option<String> {
    let (before, after) = (text.get(..at)?, text.get(at..)?.strip_prefix(',')?);
    let digits = |c: char| c.is_ascii_digit();
    let whole = &before[before.trim_end_matches(digits).len()..];
    let decimals = after.split(|c| !digits(c)).next().unwrap_or_default();
    let both = !whole.is_empty() && !decimals.is_empty();
    both.then(|| format!("write {whole}.{decimals}, with a point"))
}

/// An error of the TOML parser; `empty` if there is nothing at its place.
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
