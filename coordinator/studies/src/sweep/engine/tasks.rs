//! Tasks of a sweep: its parts, and the script that runs a part.

use super::super::design::Part;
use super::super::study::Study;
use crate::study::folder::StudyFolder;
use run::error::{RunError, file_failure};
use run::results::write::replace;
use std::collections::BTreeSet;
use std::ffi::{OsStr, OsString};
use std::fs;
use std::path::{Path, PathBuf};

/// Folder of the parts, in the folder of the sweep.
pub(in super::super) const PARTS: &str = "parts";
/// Name of the script.
const SCRIPT: &str = "tasks.sh";
/// Prefix of the environment variables that a task needs.
const VARIABLES: &str = "COSIM_";
/// Target duration of a task \[s\], long compared with the seconds that a task takes to start.
const TASK: f64 = 60.0;
/// Maximum number of parts unless given by the user: the default limit of Slurm for an array.
const MOST: usize = 1000;

/// The parts of a sweep, one task each.
#[derive(Debug)]
pub(in super::super) struct Tasks {
    /// Number of parts.
    pub parts: usize,
    /// Absolute path of the folder of the sweep.
    folder: PathBuf,
    /// Arguments of `coordinator sweep`, without the part and the folder.
    options: Vec<String>,
    /// Number of points at a time in a task, if given by the user.
    jobs: Option<u16>,
}

impl Tasks {
    /// Prepares the tasks of a sweep.
    ///
    /// # Errors
    /// The working directory cannot be determined.
    pub(in super::super) fn new(
        folder: &StudyFolder,
        parts: usize,
        options: Vec<String>,
        jobs: Option<u16>,
    ) -> Result<Self, RunError> {
        let path = folder.path();
        let folder = std::path::absolute(path).map_err(|error| file_failure(path, &error))?;
        Ok(Self { parts, folder, options, jobs })
    }

    /// Number of parts that gives tasks of about a minute, from the expected time of a point \[s\].
    pub(in super::super) fn parts_for(points: usize, seconds: f64) -> usize {
        let a_task = (TASK / seconds.max(1e-3)).ceil().max(1.0) as usize;
        points.div_ceil(a_task).clamp(1, MOST)
    }

    /// Folder of a part.
    pub(in super::super) fn folder(&self, part: usize) -> PathBuf {
        self.folder.join(PARTS).join(Part { one: part, of: self.parts }.name())
    }

    /// Path of the script, which takes the number of a part as argument.
    pub(super) fn script(&self) -> PathBuf {
        self.folder.join(SCRIPT)
    }

    /// Log file of a task. `number` may be the scheduler's placeholder for the number of the part.
    pub(super) fn log(&self, number: &str) -> PathBuf {
        self.folder.join(PARTS).join(format!("{number}-of-{}.log", self.parts))
    }

    /// Pattern that matches all log files.
    pub(super) fn logs(&self) -> String {
        self.log("*").display().to_string()
    }

    /// Name of the array.
    pub(super) fn title(&self) -> String {
        let name = self.folder.file_name().unwrap_or(OsStr::new("sweep"));
        format!("cosim-{}", name.to_string_lossy())
    }

    /// Part that contains a point.
    pub(super) fn part_of(&self, number: usize) -> usize {
        Part::with(number, self.parts)
    }

    /// Parts with missing points.
    pub(super) fn missing(&self, study: &Study) -> Vec<usize> {
        let parts: BTreeSet<usize> = study.missing().into_iter().map(|n| self.part_of(n)).collect();
        parts.into_iter().collect()
    }

    /// Shell command that runs a part.
    pub(super) fn command(&self, part: usize) -> String {
        format!("sh {} {part}", quoted(self.script().as_os_str()))
    }

    /// Writes the script and creates the folder of the parts.
    pub(super) fn write(&self) -> Result<(), RunError> {
        let parts = self.folder.join(PARTS);
        fs::create_dir_all(&parts).map_err(|error| file_failure(&parts, &error))?;
        let place = |what: &Path, error| file_failure(what, &error);
        let here = std::env::current_dir().map_err(|error| place(Path::new("."), error))?;
        let program =
            std::env::current_exe().map_err(|error| place(Path::new("coordinator"), error))?;
        replace(&self.script(), self.text(&here, &program, std::env::vars_os()).as_bytes())
    }

    fn text(
        &self,
        here: &Path,
        program: &Path,
        environment: impl Iterator<Item = (OsString, OsString)>,
    ) -> String {
        // The shell accepts only such names, and a name cannot be quoted.
        let is_letter = |c: char| c.is_ascii_uppercase() || c.is_ascii_digit() || c == '_';
        let is_ours = |name: &OsString| {
            name.to_str()
                .is_some_and(|name| name.starts_with(VARIABLES) && name.chars().all(is_letter))
        };
        let mut ours: Vec<_> = environment.filter(|(name, _)| is_ours(name)).collect();
        ours.sort();
        let export = |(name, value): &(OsString, OsString)| {
            format!("export {}={}\n", name.to_string_lossy(), quoted(value))
        };
        let exports: String = ours.iter().map(export).collect();
        let options: Vec<String> = self.options.iter().map(|one| quoted(OsStr::new(one))).collect();
        let jobs =
            self.jobs.map_or("\"${SLURM_CPUS_PER_TASK:-1}\"".to_owned(), |jobs| jobs.to_string());
        let (of, parts) = (self.parts, quoted(self.folder.join(PARTS).as_os_str()));
        format!(
            "#!/bin/sh\n\
             # Runs one part of a sweep: the first argument, or the number of the task.\n\
             part=${{1:-${{SLURM_ARRAY_TASK_ID:-$HQ_TASK_ID}}}}\n\
             cd {} || exit\n\
             {exports}\
             exec {} sweep {} \\\n  --part \"$part/{of}\" --out {parts}/\"$part-of-{of}\" --jobs {jobs}\n",
            quoted(here.as_os_str()),
            quoted(program.as_os_str()),
            options.join(" "),
        )
    }
}

/// Quotes a word for a shell.
fn quoted(word: &OsStr) -> String {
    let word = word.to_string_lossy();
    shlex::try_quote(&word).map_or_else(|_| word.to_string(), |quoted| quoted.into_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn tasks() -> Tasks {
        let options =
            ["a case.toml", "--vary", "motion.speed=10..20/3"].map(str::to_owned).to_vec();
        Tasks { parts: 20, folder: PathBuf::from("/data/my sweep"), options, jobs: None }
    }

    #[test]
    fn the_script_says_what_a_task_does() {
        // The name of a variable may be any text without `=`.
        let variables = [
            ("PATH", "/bin"),
            ("COSIM_X;touch Y", "1"),
            ("COSIM_$(touch Y)", "1"),
            ("COSIM_RUNTIME_DIR", "/dev/shm/x y"),
        ];
        let variables =
            variables.map(|(name, value)| (OsString::from(name), OsString::from(value)));
        let text = tasks().text(
            Path::new("/home/me"),
            Path::new("/opt/coordinator"),
            variables.into_iter(),
        );
        assert_eq!(
            text,
            "#!/bin/sh\n\
             # Runs one part of a sweep: the first argument, or the number of the task.\n\
             part=${1:-${SLURM_ARRAY_TASK_ID:-$HQ_TASK_ID}}\n\
             cd /home/me || exit\n\
             export COSIM_RUNTIME_DIR='/dev/shm/x y'\n\
             exec /opt/coordinator sweep 'a case.toml' --vary 'motion.speed=10..20/3' \\\n  \
             --part \"$part/20\" --out '/data/my sweep/parts'/\"$part-of-20\" \
             --jobs \"${SLURM_CPUS_PER_TASK:-1}\"\n"
        );
        assert_eq!(tasks().command(3), "sh '/data/my sweep/tasks.sh' 3");
    }

    #[test]
    fn a_task_is_a_minute_long() {
        assert_eq!(Tasks::parts_for(1000, 0.1), 2);
        assert_eq!(Tasks::parts_for(1000, 600.0), 1000);
        assert_eq!(Tasks::parts_for(1, 0.0), 1);
        assert_eq!(Tasks::parts_for(1_000_000, 60.0), MOST);
    }
}
