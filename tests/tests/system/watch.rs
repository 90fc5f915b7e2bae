//! `coordinator watch`: a real server and real runs, asked over HTTP.

use crate::harness::watched::Server;
use crate::harness::{Place, case, sets, wait_until};
use rustix::process::Signal;
use serde_json::Value;
use std::net::TcpStream;

/// Only this machine is answered, and only who knows the address; nothing can be changed.
#[test]
fn strangers_are_not_answered() {
    let place = Place::new();
    place.summary(&case("linear.toml"), &["--record"]);
    let server = Server::of(&place, &place.out(), &[]);
    let path = format!("/{}/state", server.token);
    let port = server.host.split_once(':').unwrap().1;
    assert_eq!(server.send("GET", &path, &server.host).0, 200);
    assert_eq!(server.send("GET", &path, &format!("localhost:{port}")).0, 200);
    for (method, path, host) in [
        ("GET", "/state", server.host.as_str()),
        ("GET", &format!("/{}/state", "0".repeat(32)), &server.host),
        ("GET", &path, &format!("example.org:{port}")),
        ("GET", &path, "127.0.0.1"),
        ("POST", &path, &server.host),
        ("GET", &format!("/{}/../../etc/passwd", server.token), &server.host),
    ] {
        let (status, body) = server.send(method, path, host);
        assert_eq!((status, body.as_str()), (404, "not found\n"), "{method} {path} {host}");
    }
    assert!(TcpStream::connect(format!("127.0.0.2:{port}")).is_err(), "another address listens");
    server.running.signal(Signal::INT);
    assert_eq!(server.running.wait().code, Some(130));
}

/// A run writes its newest fields while somebody looks, and only then.
#[test]
fn a_run_that_goes_on_is_followed() {
    let place = Place::new();
    let settings = ["time.end=1000", "time.window=20 us", "output.every=100000000"];
    let more = ["mech.resolution=10", "coupling.solve_deadline=600"];
    let settings: Vec<&str> = settings.into_iter().chain(more).collect();
    let run = place.start_run(&case("cold-start.toml"), &sets(&settings));
    let (marker, fields) = (place.out().join(".watched"), place.out().join("fields/last.bin"));
    wait_until("rows of the run", || {
        let rows = std::fs::read_to_string(place.out().join("iterations.csv"));
        rows.is_ok_and(|rows| rows.lines().count() > 2)
    });
    assert!(!marker.exists() && !fields.exists(), "nobody has looked yet");
    let server = Server::of(&place, &place.out(), &[]);
    assert_eq!(server.json("state")["live"], true);
    wait_until("a map in the report", || {
        server.json("state");
        server.get("report").contains("<figcaption>pressure</figcaption>")
    });
    assert!(server.get("report").contains("<b>running</b>"));
    run.signal(Signal::KILL);
    run.wait();
    wait_until("the end of the run", || server.json("state")["live"] == false);
    wait_until("a report of the end", || server.get("report").contains("<b>no end</b>"));
    // The recording of the next run is shown.
    let coarse = sets(&["mech.resolution=10"]);
    place.summary(&case("cold-start.toml"), &[vec!["--record"], coarse.clone()].concat());
    wait_until("the steps of the next run", || server.json("state")["steps"] == 51);
    // A run removes what looks have left.
    drop(server);
    place.summary(&case("cold-start.toml"), &coarse);
    assert!(!marker.exists());
}

#[test]
fn two_recordings_lie_over_each_other() {
    let places = [Place::new(), Place::new()];
    let recordings = [0, 1].map(|n| {
        let set = format!("coupling.relaxation={}", ["0.5", "0.4"][n]);
        let more: Vec<&str> = ["--record"].into_iter().chain(["--set", &set]).collect();
        places[n].summary(&case("falling-friction.toml"), &more);
        places[n].out()
    });
    let against = recordings[0].display().to_string();
    let server = Server::of(&places[1], &recordings[1], &["--against", &against]);
    let state = server.read();
    // The relaxation acts first on the iterate after the first iteration.
    let [series, step] = [0, 1].map(|n| state["difference"][n].as_u64().unwrap());
    let field = state["fields"].as_array().unwrap().iter().find(|field| field[0] == series);
    let name = field.unwrap()[1].as_str().unwrap();
    assert!(name.ends_with("(iterate of the coupling)"), "{name} {state}");
    assert!(step <= 1, "{state}");
    let view = server.json(&format!("view?series={series}&step={step}&against=other"));
    assert!(view["html"].as_str().unwrap().contains("minus that of the other recording"));
    let same = Server::of(
        &places[1],
        &recordings[1],
        &["--against", &recordings[1].display().to_string()],
    );
    assert_eq!(same.read()["difference"], Value::Null);
}

#[test]
fn what_is_not_there_cannot_be_watched() {
    let place = Place::new();
    place.summary(&case("linear.toml"), &[]);
    let out = place.out().display().to_string();
    for (arguments, told) in [
        (vec!["watch", "no/such"], "there is neither a result directory nor a recording no/such"),
        (vec!["watch", &out, "--against", &out], "holds no recording to compare"),
        (vec!["watch", "cases"], "cases holds no results of a run"),
        (vec!["watch", "README.md"], "README.md"),
    ] {
        let ended = place.start(&arguments).wait();
        assert!(ended.stderr.contains(told), "{arguments:?}: {}", ended.stderr);
        assert!(ended.code.is_some_and(|code| code == 1 || code == 2), "{:?}", ended.code);
    }
}
