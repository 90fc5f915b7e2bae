//! A server of `coordinator watch`, asked over HTTP.

use super::{Place, Running, wait_until};
use serde_json::Value;
use std::io::{Read as _, Write as _};
use std::net::TcpStream;
use std::path::Path;
use std::time::Duration;

/// A watching coordinator and its address.
#[derive(Debug)]
pub struct Server<'a> {
    /// The process of the server.
    pub running: Running<'a>,
    /// Host and port.
    pub host: String,
    /// First part of every path.
    pub token: String,
}

impl<'a> Server<'a> {
    /// Watches a folder or a file, with more arguments.
    pub fn of(place: &'a Place, path: &Path, more: &[&str]) -> Self {
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
    pub fn send(&self, method: &str, path: &str, host: &str) -> (u16, String) {
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

    /// Returns the body of a page.
    pub fn get(&self, path: &str) -> String {
        let (status, body) = self.send("GET", &format!("/{}/{path}", self.token), &self.host);
        assert_eq!(status, 200, "{path}: {body}");
        body
    }

    /// Returns an answer in JSON.
    pub fn json(&self, path: &str) -> Value {
        serde_json::from_str(&self.get(path)).unwrap()
    }

    /// Waits until the whole recording has been read.
    pub fn read(&self) -> Value {
        wait_until("the index of the recording", || self.json("state")["read"] == 1.0);
        self.json("state")
    }

    /// Returns the number of the series with this name.
    pub fn series(&self, name: &str) -> u64 {
        let state = self.read();
        let mut fields = state["fields"].as_array().unwrap().iter();
        let found = fields.find(|field| field[1] == name);
        found.unwrap_or_else(|| panic!("no {name} in {state}"))[0].as_u64().unwrap()
    }
}
