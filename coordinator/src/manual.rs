//! `coordinator completions` and `coordinator man`: files for shells and for `man`, from the list
//! of commands.

use clap::{ArgAction, Args};
use console::command::{Command, Context, Group};
use console::output::print;
use run::error::{RunError, file_failure};
use run::results::write::replace;
use std::path::PathBuf;

/// Options of `coordinator completions`.
#[derive(Debug, Args)]
pub(crate) struct CompletionsCommand {
    /// The shell.
    shell: clap_complete::Shell,
}

impl Command for CompletionsCommand {
    const NAME: &'static str = "completions";
    const GROUP: Group = Group::Reference;
    const ABOUT: &'static str = "Print the completion script of a shell";
    const EXAMPLES: &'static [&'static str] = &["coordinator completions bash"];

    fn run(&self, context: &Context<'_>) -> Result<(), RunError> {
        let mut command = (context.whole)();
        let name = command.get_name().to_owned();
        let mut script = Vec::new();
        clap_complete::generate(self.shell, &mut command, name, &mut script);
        print(&String::from_utf8_lossy(&script))
    }
}

/// Options of `coordinator man`.
#[derive(Debug, Args)]
pub(crate) struct ManCommand {
    /// Folder for a page of each command.
    #[arg(value_name = "DIR")]
    folder: PathBuf,
}

impl Command for ManCommand {
    const NAME: &'static str = "man";
    const GROUP: Group = Group::Reference;
    const ABOUT: &'static str = "Write manual pages";
    const EXAMPLES: &'static [&'static str] = &["coordinator man man1"];

    fn run(&self, context: &Context<'_>) -> Result<(), RunError> {
        let mut command = (context.whole)();
        command.build();
        let folder = &self.folder;
        std::fs::create_dir_all(folder).map_err(|error| file_failure(folder, &error))?;
        let mut written = 0u64;
        let subcommands = command.get_subcommands().filter(|one| one.get_name() != "help");
        for one in std::iter::once(&command).chain(subcommands) {
            // The display name of a built command is the name of its page: coordinator-run.
            let name = one.get_display_name().unwrap_or(one.get_name()).to_owned();
            let mut page = Vec::new();
            let path = folder.join(format!("{name}.1"));
            let page_of = one.clone().override_usage(synopsis(one));
            let rendered = clap_mangen::Man::new(page_of).render(&mut page);
            rendered.map_err(|error| file_failure(&path, &error))?;
            replace(&path, &page)?;
            written += 1;
        }
        let pages = run::format::counted(written, "page");
        context.print(&format!("{pages} -> {}\n", folder.display()))
    }
}

/// Returns the synopsis of a command, with the values of its options: clap's page leaves them out.
fn synopsis(command: &clap::Command) -> String {
    let name = command.get_bin_name().unwrap_or(command.get_name());
    let shown = command.get_arguments().filter(|argument| !argument.is_hide_set());
    let (places, options): (Vec<_>, Vec<_>) = shown.partition(|argument| argument.is_positional());
    let mut words = vec![name.to_owned()];
    words.extend(options.into_iter().chain(places).map(|argument| {
        // Positional arguments have their own brackets.
        let text = match argument.is_required_set() || argument.is_positional() {
            true => argument.to_string(),
            false => format!("[{argument}]"),
        };
        let again = matches!(argument.get_action(), ArgAction::Append | ArgAction::Count);
        if again && !text.contains("...") { text + "..." } else { text }
    }));
    if command.has_subcommands() {
        words.push("<COMMAND>".to_owned());
    }
    words.join(" ")
}
