//! Server of the page, for this machine only.
//!
//! It listens on 127.0.0.1 and answers only requests whose path begins with a random token, and
//! whose header `Host` names this address. Other pages in the same browser can therefore neither
//! guess an address nor reach the server under a name of their own. It reads nothing from a request
//! but its path and query. It changes nothing but the time of the file by which a run knows that
//! somebody looks.
//!
//! If there are too many connections, the one is dropped that has shown the token least recently,
//! or never. Silent connections of other programs can therefore keep no reader out.

use crate::steps::Move;
use crate::view::{Against, Request as ViewRequest};
use crate::watched::Watched;
use http_body_util::Full;
use hyper::body::{Body as _, Bytes, Incoming};
use hyper::header::{self, HeaderValue};
use hyper::server::conn::http1;
use hyper::service::service_fn;
use hyper::{Method, Request, Response, StatusCode};
use hyper_util::rt::{TokioIo, TokioTimer};
use pages::page::Addition;
use run::error::RunError;
use serde::Serialize;
use std::cell::RefCell;
use std::convert::Infallible;
use std::fmt::Write as _;
use std::net::{Ipv4Addr, SocketAddr};
use std::rc::Rc;
use std::time::{Duration, Instant};
use tokio::net::TcpListener;
use tokio::task::AbortHandle;

/// Longest wait for the header of a request.
const PATIENCE: Duration = Duration::from_secs(10);
/// Maximum number of connections at a time.
const CONNECTIONS: usize = 32;
/// Time after the last request from which nobody looks any more.
const AWAY: Duration = Duration::from_secs(3);
/// Pause between two readings of a run that goes on.
const PAUSE: Duration = Duration::from_millis(100);

/// Style sheet of the page, in addition to that of a report.
pub(crate) const STYLE: &str = include_str!("watch.css");
/// Script of the page.
pub(crate) const SCRIPT: &str = include_str!("watch.js");
/// Controls above the report.
pub(crate) const CONTROLS: &str = include_str!("controls.html");

/// A server that listens.
pub(crate) struct Server {
    listener: TcpListener,
    address: SocketAddr,
    token: String,
}

/// State shared by all connections.
struct Shared {
    watched: RefCell<Watched>,
    host: String,
    token: String,
    connections: RefCell<Connections>,
    looked: RefCell<Instant>,
}

/// Open connections, oldest first.
#[derive(Default)]
struct Connections {
    open: Vec<Connection>,
    count: u64,
}

struct Connection {
    number: u64,
    /// Time of the last request with the token.
    admitted: Option<Instant>,
    task: AbortHandle,
}

impl Connections {
    fn next_number(&mut self) -> u64 {
        self.count += 1;
        self.count
    }

    /// Adds a connection; if there are too many, another one is dropped.
    fn add(&mut self, number: u64, task: AbortHandle) {
        if self.open.len() >= CONNECTIONS
            && let Some(least) = self.open.iter().min_by_key(|one| (one.admitted, one.number))
        {
            least.task.abort();
            let least = least.number;
            self.remove(least);
        }
        self.open.push(Connection { number, admitted: None, task });
    }

    fn admit(&mut self, number: u64) {
        let known = self.open.iter_mut().find(|one| one.number == number);
        known.into_iter().for_each(|one| one.admitted = Some(Instant::now()));
    }

    fn remove(&mut self, number: u64) {
        self.open.retain(|one| one.number != number);
    }
}

type Answer = Response<Full<Bytes>>;

impl Server {
    /// Listens on a port; 0 stands for any free one.
    ///
    /// # Errors
    /// The port is in use, or no random number is available.
    pub(crate) async fn listen(port: u16) -> Result<Self, RunError> {
        let wrong = |what: String| RunError::Usage(what);
        let mut random = [0_u8; 16];
        getrandom::fill(&mut random)
            .map_err(|error| wrong(format!("no random number for the address: {error}")))?;
        let mut token = String::new();
        random.iter().for_each(|byte| {
            let _ = write!(token, "{byte:02x}");
        });
        let listener = TcpListener::bind((Ipv4Addr::LOCALHOST, port)).await;
        let listener = listener.map_err(|error| {
            wrong(format!("port {port} cannot be used: {error}; give another one with --port"))
        })?;
        let address = listener.local_addr().map_err(|error| wrong(error.to_string()))?;
        Ok(Self { listener, address, token })
    }

    /// Returns the address of the page.
    pub(crate) fn address(&self) -> String {
        format!("http://{}/{}/", self.address, self.token)
    }

    /// Answers requests, and reads on while somebody looks, until the returned future is dropped.
    pub(crate) async fn serve(self, watched: Watched) {
        let shared = Rc::new(Shared {
            watched: RefCell::new(watched),
            host: self.address.to_string(),
            token: self.token,
            connections: RefCell::default(),
            looked: RefCell::new(Instant::now()),
        });
        let reading = read_on(&shared);
        let accepting = async {
            loop {
                // A failure concerns a connection that has already gone, or all of them for a
                // while.
                let Ok((stream, _)) = self.listener.accept().await else {
                    tokio::time::sleep(PAUSE).await;
                    continue;
                };
                let number = shared.connections.borrow_mut().next_number();
                let of_connection = Rc::clone(&shared);
                let task = tokio::task::spawn_local(async move {
                    let answer = service_fn(|request| {
                        let answer = of_connection.answer(number, &request);
                        std::future::ready(Ok::<_, Infallible>(answer))
                    });
                    let connection = http1::Builder::new()
                        .timer(TokioTimer::new())
                        .header_read_timeout(PATIENCE)
                        .serve_connection(TokioIo::new(stream), answer);
                    // Nobody is left to hear of an error of the connection.
                    let _ = connection.await;
                    of_connection.connections.borrow_mut().remove(number);
                });
                shared.connections.borrow_mut().add(number, task.abort_handle());
            }
        };
        tokio::join!(reading, accepting);
    }
}

/// Reads what the run has written since, in short pieces between the requests.
async fn read_on(shared: &Shared) {
    let mut first = true;
    loop {
        let looks = shared.looked.borrow().elapsed() < AWAY;
        let more = match first || looks {
            true => shared.watched.borrow_mut().advance(),
            false => false,
        };
        first &= more;
        if looks {
            shared.watched.borrow().look();
        }
        match more {
            true => tokio::task::yield_now().await,
            false => tokio::time::sleep(PAUSE).await,
        }
    }
}

impl Shared {
    fn answer(&self, connection: u64, request: &Request<Incoming>) -> Answer {
        let mut hosts = request.headers().get_all(header::HOST).iter();
        let host = hosts.next().filter(|_| hosts.next().is_none());
        let local = host.and_then(|host| host.to_str().ok()).is_some_and(|host| {
            host == self.host || Some(host) == self.host.replace("127.0.0.1", "localhost").get(..)
        });
        let plain_get = request.method() == Method::GET && request.body().is_end_stream();
        let path = request.uri().path().strip_prefix('/').unwrap_or_default();
        let (token, path) = path.split_once('/').unwrap_or_default();
        if !local || !plain_get || !is_equal(token, &self.token) {
            return plain(StatusCode::NOT_FOUND, "text/plain", "not found\n".to_owned());
        }
        *self.looked.borrow_mut() = Instant::now();
        self.connections.borrow_mut().admit(connection);
        match path {
            "" => html(self.page()),
            "state" => json(&self.watched.borrow().state()),
            "report" => html(report(&self.watched.borrow())),
            "view" => match self.watched.borrow_mut().view(read_query(request.uri().query())) {
                Ok(view) => json(&view),
                Err(error) => {
                    let text = format!("{error}\n");
                    plain(StatusCode::INTERNAL_SERVER_ERROR, "text/plain", text)
                }
            },
            _ => plain(StatusCode::NOT_FOUND, "text/plain", "not found\n".to_owned()),
        }
    }

    fn page(&self) -> String {
        let watched = self.watched.borrow();
        let body = format!("{CONTROLS}<div id=\"report\">{}</div>\n", sections(&watched));
        let addition = Addition { body: &body, style: STYLE, script: SCRIPT, requests: true };
        let mut page = watched.page().clone();
        page.sections.clear();
        page.with(&addition)
    }
}

/// Compares two texts in a time that does not tell how many of their first letters agree.
fn is_equal(given: &str, token: &str) -> bool {
    let differ = given.bytes().zip(token.bytes()).fold(0, |all, (a, b)| all | (a ^ b));
    given.len() == token.len() && differ == 0
}

fn sections(watched: &Watched) -> String {
    watched.page().sections.iter().map(pages::page::Section::html).collect()
}

/// Head and sections of the report, for a page that is already open.
fn report(watched: &Watched) -> String {
    let head = watched.page().head();
    format!("{head}<div id=\"report\">{}</div>\n", sections(watched))
}

/// Reads the request of a view; what is missing or wrong has its default.
fn read_query(query: Option<&str>) -> ViewRequest {
    let pairs = query.unwrap_or_default().split('&').filter_map(|pair| pair.split_once('='));
    let mut request = ViewRequest::default();
    for (key, value) in pairs {
        match key {
            "series" => request.series = value.parse().unwrap_or_default(),
            "step" => request.step = value.parse().unwrap_or_default(),
            "go" => request.go = Move::from_word(value).unwrap_or_default(),
            "against" => request.against = Against::from_word(value).unwrap_or_default(),
            _ => {}
        }
    }
    request
}

fn html(text: String) -> Answer {
    plain(StatusCode::OK, "text/html; charset=utf-8", text)
}

fn json(of: &impl Serialize) -> Answer {
    match serde_json::to_string(of) {
        Ok(text) => plain(StatusCode::OK, "application/json", text),
        Err(error) => plain(StatusCode::INTERNAL_SERVER_ERROR, "text/plain", error.to_string()),
    }
}

fn plain(status: StatusCode, kind: &'static str, text: String) -> Answer {
    let mut answer = Response::new(Full::new(Bytes::from(text)));
    *answer.status_mut() = status;
    let fixed = [
        (header::CONTENT_TYPE, kind),
        (header::CACHE_CONTROL, "no-store"),
        (header::X_CONTENT_TYPE_OPTIONS, "nosniff"),
        (header::REFERRER_POLICY, "no-referrer"),
        (header::X_FRAME_OPTIONS, "DENY"),
    ];
    for (name, value) in fixed {
        answer.headers_mut().insert(name, HeaderValue::from_static(value));
    }
    answer
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::io::{Read, Write};
    use std::net::TcpStream;
    use std::sync::mpsc;

    /// Serves a folder without a recording on a thread of its own, for the life of the process.
    fn served() -> (SocketAddr, String) {
        let (sender, receiver) = mpsc::channel();
        std::thread::spawn(move || {
            let folder = tempfile::tempdir().unwrap();
            std::fs::write(folder.path().join("log.jsonl"), "").unwrap();
            let watched = Watched::open(folder.path(), None).unwrap();
            let runtime = tokio::runtime::Builder::new_current_thread().enable_all().build();
            tokio::task::LocalSet::new().block_on(&runtime.unwrap(), async {
                let server = Server::listen(0).await.unwrap();
                sender.send((server.address, server.token.clone())).unwrap();
                server.serve(watched).await;
            });
        });
        receiver.recv().unwrap()
    }

    /// Sends a request, and returns the status of the answer.
    fn asked(address: SocketAddr, request: &str) -> String {
        let mut stream = TcpStream::connect(address).unwrap();
        stream.write_all(request.as_bytes()).unwrap();
        let mut answer = String::new();
        stream.read_to_string(&mut answer).unwrap();
        answer.split(' ').nth(1).unwrap_or_default().to_owned()
    }

    #[test]
    fn silent_connections_keep_nobody_out() {
        let (address, token) = served();
        let _silent: Vec<TcpStream> =
            (0..2 * CONNECTIONS).map(|_| TcpStream::connect(address).unwrap()).collect();
        let close = "connection: close\r\n\r\n";
        let state = format!("GET /{token}/state HTTP/1.1\r\nhost: {address}\r\n");
        assert_eq!(asked(address, &format!("{state}{close}")), "200");
        let refused = [
            format!("{state}host: {address}\r\n{close}"),
            format!("{state}content-length: 1\r\n{close}x"),
            format!("GET /{token}x/state HTTP/1.1\r\nhost: {address}\r\n{close}"),
            format!("GET /{token}/state HTTP/1.1\r\nhost: example.org\r\n{close}"),
        ];
        for request in refused {
            assert_eq!(asked(address, &request), "404", "{request}");
        }
    }

    #[test]
    fn a_query_is_read_and_nonsense_is_the_default() {
        let request = read_query(Some("series=2&step=7&go=next-window&against=window"));
        let expected =
            ViewRequest { series: 2, step: 7, go: Move::NextWindow, against: Against::Window };
        assert_eq!(request, expected);
        let nonsense = read_query(Some("series=-1&step=x&go=<script>&against&&=&a=b"));
        assert_eq!(nonsense, ViewRequest::default());
        assert_eq!(read_query(None), ViewRequest::default());
    }
}
