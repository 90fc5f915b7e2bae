//! Files named by a user: pipes and devices are rejected at once, and messages do not quote files
//! that are not tables.

use crate::harness::{Place, case};
use rustix::fs::{CWD, FileType, Mode, mknodat};
use std::fs;

/// A pipe that waits for a writer, or a device that never ends, is rejected by name.
#[test]
fn pipes_and_devices_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let pipe = folder.path().join("pipe");
    mknodat(CWD, &pipe, FileType::Fifo, Mode::from(0o600), 0).unwrap();
    let case = case("wheel-rail.toml");
    for path in [pipe.display().to_string(), "/dev/zero".to_owned()] {
        let history = format!("motion.speed={{file={path:?},column=\"v\"}}");
        let profile = format!("bodies.rail.profile={path}");
        for command in [
            &["sweep", &case, "--table", &path][..],
            &["ask", &path, "load.normal_force=1e5"],
            &["inspect", &path],
            &["check", &case, "--set", "time.mode=sequence", "--set", &history],
            &["check", &case, "--set", &profile],
        ] {
            let ended = Place::new().start(command).wait();
            assert_ne!(ended.code, Some(0), "{command:?}");
            let told = ["where a regular file is expected", "there is no file"];
            assert!(
                told.iter().any(|text| ended.stderr.contains(text)),
                "{command:?} {}",
                ended.stderr
            );
        }
    }
}

/// A password or key file named in place of a table is not quoted.
#[test]
fn contents_of_other_files_are_not_told() {
    let folder = tempfile::tempdir().unwrap();
    let case = case("wheel-rail.toml");
    for (name, text) in [
        ("shadow", "root:*:20228:0:99999:7:::\ndaemon:*:20228:0:99999:7:::\nuser:hash:1:::\n"),
        ("key", "5ec2e75ec2e75ec2e75ec2e75ec2e75ec2e75ec2e75ec2e75ec2e75ec2e75ec2\n"),
        ("environ", "HOME=/root secret\0TOKEN=5ec2e7\0"),
    ] {
        let file = folder.path().join(name);
        fs::write(&file, text).unwrap();
        let path = file.display().to_string();
        let history = format!("motion.speed={{file={path:?},column=\"v\"}}");
        let [profile, table] = ["bodies.rail.profile", "effects.temperature_friction.table"]
            .map(|key| format!("{key}={path}"));
        for command in [
            &["check", &case, "--set", "time.mode=sequence", "--set", &history][..],
            &["check", "--no-start", &case, "--set", "time.mode=sequence", "--set", &history],
            &["check", &case, "--set", &profile],
            &["check", &case, "--set", &table],
            &["sweep", &case, "--table", &path],
        ] {
            let ended = Place::new().start(command).wait();
            // Speed is known as a key only if the programs are started.
            assert_eq!(ended.code == Some(0), command.contains(&"--no-start"), "{command:?}");
            for word in ["root:", "daemon", "20228", "hash", "5ec2e7", "HOME", "secret"] {
                let told = format!("{}{}", ended.stdout, ended.stderr);
                assert!(!told.contains(word), "{command:?} {told}");
            }
        }
    }
}
