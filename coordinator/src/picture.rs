//! `coordinator picture`: the maps of a report as a file for papers and slides.

use clap::Args;
use console::command::{Command, Context, Group};
use pages::maps;
use pages::picture::Format;
use pages::sheet::{Ground, sheet};
use pages::source::Results;
use run::error::RunError;
use run::results::write::replace;
use run::signals;
use std::path::PathBuf;

/// Largest width of a picture \[px\].
const WIDEST: u32 = 20_000;

/// Options of `coordinator picture`.
#[derive(Debug, Args)]
pub(crate) struct PictureCommand {
    /// The result directory.
    #[arg(value_name = "DIR")]
    folder: PathBuf,
    /// Fields to draw, in this order [default: all].
    #[arg(long, value_name = "NAME", value_delimiter = ',')]
    field: Vec<String>,
    /// The file; its ending selects SVG, PNG or PDF (PNG and PDF need the feature pictures)
    /// [default: picture.png in DIR, else picture.svg].
    #[arg(long, short, value_name = "FILE")]
    out: Option<PathBuf>,
    /// Drawings per row [default: at most two].
    #[arg(long, value_name = "COUNT", value_parser = clap::value_parser!(u16).range(1..))]
    columns: Option<u16>,
    /// Width of a PNG.
    #[arg(long, value_name = "PIXELS", default_value_t = 1600,
          value_parser = clap::value_parser!(u32).range(64..=i64::from(WIDEST)))]
    width: u32,
    /// Draw light on dark.
    #[arg(long)]
    dark: bool,
}

impl Command for PictureCommand {
    const NAME: &'static str = "picture";
    const GROUP: Group = Group::Look;
    const ABOUT: &'static str = "Draw fields for papers and slides, as SVG, PNG or PDF";
    const EXAMPLES: &'static [&'static str] =
        &["coordinator picture results/latest --dark -o maps.svg"];

    fn run(&self, context: &Context<'_>) -> Result<(), RunError> {
        let _reading = signals::end_at_once();
        let path = self.out.clone().unwrap_or_else(|| self.folder.join(Format::default_file()));
        let format = Format::of(&path)?;
        let results = Results::read(&self.folder)?;
        let zero = maps::zero(&results);
        let maps = chosen(maps::named(&results), &self.field, &zero, &self.folder)?;
        let columns = self.columns.map_or_else(|| maps.len().clamp(1, 2), usize::from);
        let ground = if self.dark { Ground::Dark } else { Ground::Light };
        let svg = sheet(results.name(), &maps, columns, ground);
        replace(&path, &format.bytes(svg, self.width)?)?;
        context.print(&format!("{}\n", path.display()))
    }
}

/// Returns the maps of the named fields, or of all.
fn chosen<T>(
    all: Vec<(String, T)>,
    names: &[String],
    zero: &[&str],
    folder: &std::path::Path,
) -> Result<Vec<T>, RunError> {
    let shown = folder.display();
    if let Some(name) = names.iter().find(|name| zero.contains(&name.as_str())) {
        let why = "is zero everywhere: there is nothing to draw";
        return Err(RunError::Usage(format!("--field {name}: in {shown} it {why}")));
    }
    if all.is_empty() {
        let why = "no field on a regular grid that differs from zero";
        return Err(RunError::Usage(format!("{shown} has {why}: there is nothing to draw")));
    }
    if names.is_empty() {
        return Ok(all.into_iter().map(|(_, map)| map).collect());
    }
    let known: Vec<String> = all.iter().map(|(name, _)| name.clone()).collect();
    let mut all: Vec<(String, Option<T>)> =
        all.into_iter().map(|(n, map)| (n, Some(map))).collect();
    let mut find = |wanted: &String| {
        let found = all.iter_mut().find(|(name, map)| name == wanted && map.is_some());
        found.and_then(|(_, map)| map.take()).ok_or_else(|| {
            let known = known.join(", ");
            RunError::Usage(format!("--field {wanted}: {shown} has no such field; it has {known}"))
        })
    };
    names.iter().map(&mut find).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn fields_are_drawn_in_the_order_in_which_they_are_named() {
        let all = || vec![("a".to_owned(), 1), ("b".to_owned(), 2), ("c".to_owned(), 3)];
        let of = |names: &[&str]| {
            let names: Vec<String> = names.iter().map(|name| (*name).to_owned()).collect();
            chosen(all(), &names, &["e"], std::path::Path::new("r"))
        };
        assert_eq!(of(&[]).unwrap(), [1, 2, 3]);
        assert_eq!(of(&["c", "a"]).unwrap(), [3, 1]);
        let wrong = of(&["d"]).unwrap_err().to_string();
        assert!(wrong.contains("--field d: r has no such field; it has a, b, c"), "{wrong}");
        let zero = of(&["a", "e"]).unwrap_err().to_string();
        assert!(zero.contains("--field e: in r it is zero everywhere"), "{zero}");
        let none = chosen(Vec::<(String, i32)>::new(), &[], &[], std::path::Path::new("r"));
        assert!(none.unwrap_err().to_string().contains("nothing to draw"));
    }
}
