//! Headless Chromium: pictures of a page, its layout, and what it asked the network for.

use serde_json::Value;
use std::collections::{BTreeSet, HashMap};
use std::fs::{self, File};
use std::io::BufReader;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};
use std::sync::OnceLock;
use tempfile::TempDir;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Scheme {
    Light,
    Dark,
}

/// How a page is looked at.
#[derive(Clone, Copy, Debug)]
pub(super) struct View {
    /// Width of the viewport [px].
    pub(super) width: u32,
    /// What the user prefers.
    pub(super) scheme: Scheme,
}

/// What a browser has made of a page.
pub(super) struct Look {
    /// Width that the page takes, more than the viewport's where it has to be scrolled [px].
    pub(super) scroll_width: u32,
    /// Left, top, width and height of every plot [px].
    pub(super) plots: Vec<[u32; 4]>,
    /// Addresses that the page has asked for.
    pub(super) fetched: Vec<String>,
    columns: u32,
    /// Red, green and blue of every pixel.
    pixels: Vec<[u8; 3]>,
}

impl Look {
    fn pixel(&self, x: u32, y: u32) -> [u8; 3] {
        self.pixels[(y * self.columns + x) as usize]
    }

    /// The colour of the page's corner.
    pub(super) fn paper(&self) -> [u8; 3] {
        self.pixel(2, 2)
    }

    /// More than one pixel in a hundred of a plot is clearly not its background; of a blank one, none.
    pub(super) fn is_drawn(&self, plot: usize) -> bool {
        let [left, top, width, height] = self.plots[plot];
        let places = (top..top + height).flat_map(|y| (left..left + width).map(move |x| (x, y)));
        let colours: Vec<[u8; 3]> = places.map(|(x, y)| self.pixel(x, y)).collect();
        let mut counts: HashMap<[u8; 3], usize> = HashMap::new();
        colours.iter().for_each(|colour| *counts.entry(*colour).or_default() += 1);
        let (background, _) = counts.iter().max_by_key(|(_, count)| **count).unwrap();
        let apart =
            |colour: &&[u8; 3]| colour.iter().zip(background).any(|(a, b)| a.abs_diff(*b) > 40);
        100 * colours.iter().filter(apart).count() > colours.len()
    }
}

/// The browser's program.
fn chromium() -> &'static Path {
    static PROGRAM: OnceLock<PathBuf> = OnceLock::new();
    PROGRAM.get_or_init(|| {
        let folders = std::env::var_os("PATH").unwrap_or_default();
        let names = ["chromium", "chromium-browser", "google-chrome"];
        let all = std::env::split_paths(&folders).flat_map(|f| names.map(|name| f.join(name)));
        let found = std::env::var_os("COSIM_CHROMIUM").map(PathBuf::from);
        found.or_else(|| all.into_iter().find(|path| path.is_file())).expect(
            "Chromium is needed to test how reports look: apt-get install chromium, or name its \
             program in COSIM_CHROMIUM",
        )
    })
}

/// Runs the browser on a file until it is done.
fn browse(place: &TempDir, more: &[String], file: &Path) -> Output {
    let profile = place.path().join("profile");
    let ended = Command::new(chromium())
        .args([
            "--headless",
            "--no-sandbox",
            "--disable-gpu",
            "--hide-scrollbars",
            "--no-first-run",
        ])
        .args(["--disable-dev-shm-usage", "--disable-background-networking", "--disable-sync"])
        .args(["--disable-component-update", "--disable-extensions", "--disable-default-apps"])
        .args(["--host-resolver-rules=MAP * 127.0.0.1:9", "--force-device-scale-factor=1"])
        .args(["--allow-file-access-from-files", "--virtual-time-budget=5000", "--timeout=60000"])
        .arg(format!("--user-data-dir={}", profile.display()))
        .args(more)
        .arg(format!("file://{}", file.display()))
        .stdin(Stdio::null())
        .output()
        .unwrap();
    assert!(ended.status.success(), "{}", String::from_utf8_lossy(&ended.stderr));
    ended
}

/// Tells the page around it how a copy of the page is laid out.
const PROBE: &str = r#"<script>addEventListener("load", () => setTimeout(() => {
  const plots = [...document.querySelectorAll("svg.plot")].map(plot => {
    const r = plot.getBoundingClientRect();
    return [r.left, r.top, r.width, r.height].map(Math.floor);
  });
  const fetched = performance.getEntriesByType("resource").map(entry => entry.name);
  const root = document.documentElement;
  const size = [root.scrollWidth, root.scrollHeight];
  parent.postMessage(JSON.stringify({ plots, fetched, size }), "*");
}, 100));</script>"#;

/// A page that shows another one in a frame of a size: windows cannot be as narrow as a phone.
fn framed(width: u32, height: u32) -> String {
    format!(
        "<!DOCTYPE html><title></title><body style=\"margin:0\">\
         <script>onmessage = event => document.title = event.data</script>\
         <iframe src=\"page.html\" style=\"border:0;display:block\" width=\"{width}\" \
         height=\"{height}\"></iframe></body>"
    )
}

/// Looks at a page.
pub(super) fn look(page: &Path, view: View) -> Look {
    let place = tempfile::tempdir().unwrap();
    let at = |name: &str| place.path().join(name);
    let text = fs::read_to_string(page).unwrap();
    fs::write(at("page.html"), text.replace("</body>", &format!("{PROBE}</body>"))).unwrap();
    let prefers = u8::from(view.scheme == Scheme::Light);
    let mut more = vec![format!("--blink-settings=preferredColorScheme={prefers}")];
    fs::write(at("frame.html"), framed(view.width, 800)).unwrap();
    more.push("--dump-dom".to_owned());
    let ended = browse(&place, &more, &at("frame.html"));
    let probed = probed(&String::from_utf8_lossy(&ended.stdout));
    let size: Vec<u32> = numbers(&probed["size"]);
    fs::write(at("frame.html"), framed(view.width, size[1])).unwrap();
    more.pop();
    more.push(format!("--window-size={},{}", view.width.max(600), size[1]));
    more.push(format!("--screenshot={}", at("shot.png").display()));
    browse(&place, &more, &at("frame.html"));
    let (columns, pixels) = decode(&at("shot.png"));
    let plots = probed["plots"].as_array().unwrap().iter();
    let strings = probed["fetched"].as_array().unwrap().iter();
    Look {
        scroll_width: size[0],
        plots: plots.map(|plot| numbers(plot).try_into().unwrap()).collect(),
        fetched: strings.map(|name| name.as_str().unwrap().to_owned()).collect(),
        columns,
        pixels,
    }
}

fn probed(dom: &str) -> Value {
    let title = dom.split_once("<title>").and_then(|(_, rest)| rest.split_once("</title>"));
    let (title, _) = title.unwrap_or_else(|| panic!("no title in {dom:.400}"));
    serde_json::from_str(&title.replace("&amp;", "&"))
        .unwrap_or_else(|error| panic!("{error}: the page has not told its layout: {dom:.400}"))
}

fn numbers(list: &Value) -> Vec<u32> {
    list.as_array().unwrap().iter().map(|n| n.as_u64().unwrap() as u32).collect()
}

/// Width and pixels of a picture.
fn decode(path: &Path) -> (u32, Vec<[u8; 3]>) {
    let file = BufReader::new(File::open(path).expect("the browser has taken a picture"));
    let mut reader = png::Decoder::new(file).read_info().unwrap();
    let mut bytes = vec![0; reader.output_buffer_size().unwrap()];
    let frame = reader.next_frame(&mut bytes).unwrap();
    assert_eq!(frame.bit_depth, png::BitDepth::Eight);
    let pixels = bytes[..frame.buffer_size()].chunks_exact(frame.color_type.samples());
    (frame.width, pixels.map(|pixel| [pixel[0], pixel[1], pixel[2]]).collect())
}

/// What a page asks the network for, by the browser's own log. The browser asks for things of its
/// own; what a page asks for has the page as its initiator.
pub(super) fn requests(page: &Path) -> Vec<String> {
    let place = tempfile::tempdir().unwrap();
    let log = place.path().join("net.json");
    let more = [format!("--log-net-log={}", log.display()), "--dump-dom".to_owned()];
    browse(&place, &more, page);
    let log: Value = serde_json::from_str(&fs::read_to_string(&log).unwrap()).unwrap();
    let events = log["events"].as_array().expect("the log has events");
    assert!(!events.is_empty());
    let of_page = |event: &&Value| {
        let initiator = event["params"]["initiator"].as_str();
        initiator.is_some_and(|initiator| initiator != "not an origin")
    };
    let urls = events.iter().filter(of_page).filter_map(|event| event["params"]["url"].as_str());
    let urls: BTreeSet<&str> = urls.filter(|url| !url.starts_with("data:")).collect();
    urls.into_iter().map(str::to_owned).collect()
}
