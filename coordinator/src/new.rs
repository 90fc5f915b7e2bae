//! `coordinator new`: writes a case that runs, with a line on every key.

use clap::Args;
use console::command::{Command, Context, Group};
use console::keys::about;
use console::scenes::{self, FIRST, SCENES};
use run::error::{RunError, file_failure};
use run::fleet::installed;
use run::format::counted;
use std::fs::File;
use std::io::{ErrorKind, Write as _};
use std::path::PathBuf;

/// Longest line of a comment.
const WIDTH: usize = 100;

/// Options of `coordinator new`.
#[derive(Debug, Args)]
pub(crate) struct NewCommand {
    /// Name of the case; the file is NAME.toml.
    #[arg(required_unless_present = "list", value_parser = name)]
    name: Option<String>,
    /// Scene to copy.
    #[arg(long, value_name = "SCENE", default_value = FIRST)]
    scene: String,
    /// Show the scenes.
    #[arg(long)]
    list: bool,
}

/// Checks the name of a case, which is also the name of its file.
fn name(text: &str) -> Result<String, String> {
    let allowed = |c: char| c.is_ascii_alphanumeric() || c == '-' || c == '_';
    match !text.is_empty() && text.chars().all(allowed) {
        true => Ok(text.to_owned()),
        false => Err("a name has letters, digits, - and _".to_owned()),
    }
}

impl Command for NewCommand {
    const NAME: &'static str = "new";
    const GROUP: Group = Group::Run;
    const ABOUT: &'static str = "Write a case to begin from, every key explained";
    const EXAMPLES: &'static [&'static str] =
        &["coordinator new --list", "coordinator new mine --scene curving"];

    fn run(&self, context: &Context<'_>) -> Result<(), RunError> {
        let Some(name) = self.name.as_ref().filter(|_| !self.list) else {
            let line = |(name, text): &(&str, &str)| format!("  {name:26} {}\n", title(text));
            let list: String = SCENES.iter().map(line).collect();
            return context.print(&list);
        };
        let scene = scenes::text(&self.scene).ok_or_else(|| {
            let fix = "coordinator new --list shows those that there are";
            RunError::Usage(format!("--scene {}: there is no such scene; {fix}", self.scene))
        })?;
        let chosen: toml::Table = toml::from_str(scene).unwrap_or_default();
        let text = commented(name, (&self.scene, scene), about(&installed()?, &chosen));
        let path = PathBuf::from(format!("{name}.toml"));
        // An existing file is never replaced.
        let mut file = File::options().write(true).create_new(true).open(&path).map_err(
            |error| match error.kind() {
                ErrorKind::AlreadyExists => {
                    let what = "is there already; choose another name, or move it away";
                    RunError::Usage(format!("{} {what}", path.display()))
                }
                _ => file_failure(&path, &error),
            },
        )?;
        file.write_all(text.as_bytes()).map_err(|error| file_failure(&path, &error))?;
        let lines = counted(text.lines().count() as u64, "line");
        let path = path.display();
        context.print(&format!("{path} ({lines}); run it: coordinator run {path}\n"))
    }
}

/// Returns the title of a case.
fn title(text: &str) -> String {
    let case: toml::Table = toml::from_str(text).unwrap_or_default();
    let title = case.get("case").and_then(|case| case.get("title"));
    title.and_then(|title| title.as_str()).unwrap_or_default().to_owned()
}

/// Returns the case under its new name, with a line on each key above it.
fn commented(
    name: &str,
    (scene, text): (&str, &str),
    about: impl Fn(&str) -> Option<String>,
) -> String {
    let mut out = format!(
        "# {name}: a case to begin from, made from the scene `{scene}`.\n\
         #\n\
         #   coordinator check {name}.toml     every error at once\n\
         #   coordinator plan {name}.toml      what will run, and why\n\
         #   coordinator run {name}.toml --report\n\
         #   coordinator keys WORD     every other key that there is\n\
         #\n\
         # Numbers are in SI units; a text may have another one: \"134 kN\", \"0.6 mm\", \"140 km/h\".\n\n"
    );
    let mut table = String::new();
    let mut told: Vec<String> = Vec::new();
    for line in text.lines() {
        let bare = line.trim();
        if let Some(head) = bare.strip_prefix('[').and_then(|rest| rest.split(']').next()) {
            table = head.trim().to_owned();
        }
        let key = bare.split_once('=').map(|(key, _)| key.trim());
        let key = key.filter(|key| !key.starts_with('#') && !key.contains([' ', '"', '[']));
        let path = key.map(|key| format!("{table}.{key}"));
        if path.as_deref() == Some("case.name") {
            out += &format!("name = \"{name}\"\n");
            continue;
        }
        // Explain a key once, not for each body.
        let said = path.as_deref().and_then(&about).filter(|said| !told.contains(said));
        if let Some(said) = said {
            out += &comment(&said);
            told.push(said);
        }
        out += line;
        out.push('\n');
    }
    out
}

/// Returns a text as comments.
fn comment(text: &str) -> String {
    let mut lines = vec![String::from("#")];
    for word in text.split_whitespace() {
        let full = |line: &String| line.chars().count() + 1 + word.chars().count() > WIDTH;
        if lines.last().is_none_or(full) {
            lines.push(String::from("#  "));
        }
        if let Some(line) = lines.last_mut() {
            line.push(' ');
            line.push_str(word);
        }
    }
    lines.join("\n") + "\n"
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_key_has_a_line_above_it() {
        let text = "[case]\nname = \"x\"\n[a.b]\nc = 1 # one\n[a.d]\nc = 2\n";
        let about = |path: &str| path.ends_with(".c").then(|| "what it is [m]".to_owned());
        let made = commented("mine", ("x", text), about);
        let end = "[case]\nname = \"mine\"\n[a.b]\n# what it is [m]\nc = 1 # one\n[a.d]\nc = 2\n";
        assert!(made.ends_with(end), "{made}");
        assert!(comment(&"word ".repeat(40)).lines().all(|line| line.len() <= WIDTH));
    }

    #[test]
    fn a_name_is_one_of_a_file() {
        assert!(name("my-case_2").is_ok());
        for wrong in ["", "a/b", "..", "a b"] {
            assert!(name(wrong).is_err(), "{wrong}");
        }
    }
}
