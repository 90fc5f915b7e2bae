//! Server of the page, for this machine only.
//!
//! It listens on 127.0.0.1 and answers only requests whose path begins with a random token, and
//! whose header `Host` names this address. Other pages in the same browser can therefore neither
//! guess an address nor reach the server under a name of their own. It reads nothing from a request
//! but its path and query, and changes nothing.

use crate::steps::Move;
use crate::view::{Against, Request as ViewRequest};
use crate::watched::Watched;
use http_body_util::Full;
use hyper::body::{Bytes, Incoming};
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
    connections: RefCell<usize>,
    looked: RefCell<Instant>,
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
            connections: RefCell::new(0),
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
                if *shared.connections.borrow() >= CONNECTIONS {
                    continue;
                }
                *shared.connections.borrow_mut() += 1;
                let of_connection = Rc::clone(&shared);
                tokio::task::spawn_local(async move {
                    let answer = service_fn(|request| {
                        let answer = of_connection.answer(&request);
                        std::future::ready(Ok::<_, Infallible>(answer))
                    });
                    let connection = http1::Builder::new()
                        .timer(TokioTimer::new())
                        .header_read_timeout(PATIENCE)
                        .serve_connection(TokioIo::new(stream), answer);
                    // Nobody is left to hear of an error of the connection.
                    let _ = connection.await;
                    *of_connection.connections.borrow_mut() -= 1;
                });
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
            // Errors stand on the page.
            true => shared.watched.borrow_mut().advance().unwrap_or(false),
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
    fn answer(&self, request: &Request<Incoming>) -> Answer {
        let host = request.headers().get(header::HOST).and_then(|host| host.to_str().ok());
        let local = host.is_some_and(|host| {
            host == self.host || Some(host) == self.host.replace("127.0.0.1", "localhost").get(..)
        });
        let path = request.uri().path().strip_prefix('/').unwrap_or_default();
        let (token, path) = path.split_once('/').unwrap_or_default();
        if !local || token != self.token || request.method() != Method::GET {
            return plain(StatusCode::NOT_FOUND, "text/plain", "not found\n".to_owned());
        }
        *self.looked.borrow_mut() = Instant::now();
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
