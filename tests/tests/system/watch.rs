//! `coordinator watch`: a real server and real runs, asked over HTTP and shown by a browser.

use crate::harness::browser::{DESK, PHONE, act, assert_shown, opened};
use crate::harness::{Place, Running, case, sets, wait_until};
use rustix::process::Signal;
use serde_json::Value;
use std::io::{Read as _, Write as _};
use std::net::TcpStream;
use std::path::Path;
use std::time::Duration;

/// A watching coordinator and its address.
struct Server<'a> {
    running: Running<'a>,
    /// Host and port.
    host: String,
    token: String,
}

impl<'a> Server<'a> {
    fn of(place: &'a Place, path: &Path, more: &[&str]) -> Self {
        let path = path.display().to_string();
        let arguments: Vec<&str> =
            ["watch", &path].into_iter().chain(more.iter().copied()).collect();
        let mut running = place.start(&arguments);
        let address = running.first_line();
        let rest = address.strip_prefix("http://").unwrap_or_else(|| panic!("`{address}`"));
        let (host, token) = rest.trim_end_matches('/').split_once('/').unwrap();
        assert!(host.starts_with("127.0.0.1:") && token.len() == 32, "{address}");
        Self { running, host: host.to_owned(), token: token.to_owned() }
    }

    /// Sends a request and returns status and body.
    fn send(&self, method: &str, path: &str, host: &str) -> (u16, String) {
        let mut stream = TcpStream::connect(&self.host).unwrap();
        stream.set_read_timeout(Some(Duration::from_secs(60))).unwrap();
        let head = format!("{method} {path} HTTP/1.1\r\nHost: {host}\r\nConnection: close\r\n\r\n");
        stream.write_all(head.as_bytes()).unwrap();
        let mut answer = Vec::new();
        stream.read_to_end(&mut answer).unwrap();
        let answer = String::from_utf8_lossy(&answer);
        let (head, body) = answer.split_once("\r\n\r\n").unwrap();
        (head.split(' ').nth(1).unwrap().parse().unwrap(), body.to_owned())
    }

    fn get(&self, path: &str) -> String {
        let (status, body) = self.send("GET", &format!("/{}/{path}", self.token), &self.host);
        assert_eq!(status, 200, "{path}: {body}");
        body
    }

    fn json(&self, path: &str) -> Value {
        serde_json::from_str(&self.get(path)).unwrap()
    }

    /// Waits until the whole recording has been read.
    fn read(&self) -> Value {
        wait_until("the index of the recording", || self.json("state")["read"] == 1.0);
        self.json("state")
    }

    /// Returns the number of the series with this name.
    fn series(&self, name: &str) -> u64 {
        let state = self.read();
        let mut fields = state["fields"].as_array().unwrap().iter();
        let found = fields.find(|field| field[1] == name);
        found.unwrap_or_else(|| panic!("no {name} in {state}"))[0].as_u64().unwrap()
    }
}

#[test]
fn a_run_is_shown_step_by_step() {
    let place = Place::new();
    place.summary(&case("falling-friction.toml"), &["--record"]);
    let server = Server::of(&place, &place.out(), &[]);
    let state = server.read();
    let iterations = place.read_summary()["coupling"]["iterations"].as_u64().unwrap();
    assert_eq!(state["steps"].as_u64(), Some(iterations));
    assert_eq!((&state["live"], &state["remark"]), (&Value::Bool(false), &Value::Null));
    let series = server.series("rail temperature (thermal)");
    let view = server.json(&format!("view?series={series}&step=3&go=next&against=iteration"));
    assert_eq!(view["step"], 4);
    let caption = view["caption"].as_str().unwrap();
    assert!(caption.starts_with("window 0, iteration 5 · residual "), "{caption}");
    let html = view["html"].as_str().unwrap();
    for title in ["rail temperature", "rail temperature minus that of the iteration before"] {
        assert!(
            html.contains(&format!("<figcaption>{title}</figcaption>")),
            "{title}: {html:.900}"
        );
    }
    // The last step shows the result of the run.
    let last = server.json(&format!("view?series={series}&go=last"));
    let rise = place.read_summary()["temperature"]["rail"]["max_rise_k"].as_f64().unwrap();
    let largest = format!("Largest {:.1}", rise);
    assert!(last["html"].as_str().unwrap().contains(&largest), "{largest}");
    assert!(server.get("").contains("falling-friction · converged"));
    // The report of the run stands below.
    assert!(server.get("report").contains("energy audit"));
    let page = opened(&format!("http://{}/{}/#{series},4,iteration", server.host, server.token));
    assert!(page.contains("window 0, iteration 5 · residual "), "{page:.400}");
    assert!(page.contains("rail temperature minus that of the iteration before"));
}

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

/// The page as a file: all that it needs is in it, at any width; keys and buttons move it.
#[test]
fn the_page_is_written_as_a_file() {
    let place = Place::new();
    place.summary(&case("falling-friction.toml"), &["--record"]);
    let (out, file) = (place.out().display().to_string(), place.out().join("steps.html"));
    let shown = file.display().to_string();
    let ended = place.start(&["watch", &out, "--page", &shown]).wait();
    assert_eq!(ended.code, Some(0), "{}", ended.stderr);
    assert!(ended.stdout.starts_with(&format!("{shown}: 12 steps, ")), "{}", ended.stdout);
    assert_shown(&file, &[DESK, PHONE], 10);
    let script = r##"
      const told = [];
      const caption = () => document.querySelector("#caption").textContent.split(" · ")[0];
      const rest = () => new Promise(done => setTimeout(done, 300));
      const press = key => document.body.dispatchEvent(new KeyboardEvent("keydown", { key, bubbles: true }));
      const titles = () => [...document.querySelectorAll("#view figcaption")]
        .map(node => node.firstChild.textContent);
      addEventListener("load", async () => {
        await rest(); told.push(caption());
        press("ArrowLeft"); await rest(); told.push(caption());
        press("Home"); await rest(); told.push(caption());
        document.querySelector("[data-go=next]").click(); await rest(); told.push(caption());
        press("ArrowDown"); await rest(); told.push(caption());
        press("ArrowUp"); await rest(); told.push(caption());
        press("d"); await rest(); told.push(titles()[1]);
        press("f"); await rest(); told.push(titles()[0]);
        document.title = JSON.stringify(told);
      });"##;
    let told: Vec<String> =
        act(&file, script).iter().map(|text| text.as_str().unwrap().to_owned()).collect();
    let steps: Vec<String> =
        [12, 11, 1, 2, 1, 12].map(|n| format!("window 0, iteration {n}")).into();
    assert_eq!(told[..6], steps[..]);
    assert!(told[6].ends_with("minus that of the iteration before"), "{told:?}");
    assert_ne!(told[7], told[6], "another field is shown");
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
