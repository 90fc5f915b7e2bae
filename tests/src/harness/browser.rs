//! Headless Chromium: screenshots and layout of a page, and its network requests.
//!
//! Starting the browser takes longer than showing a page: one start shows the page in all widths of
//! a colour scheme.

use serde_json::Value;
use std::collections::{BTreeSet, HashMap};
use std::fs::{self, File};
use std::io::BufReader;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};
use std::sync::OnceLock;
use tempfile::TempDir;

/// Preferred colour scheme.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Scheme {
    /// Dark on light.
    Light,
    /// Light on dark.
    Dark,
}

/// Viewport and colour scheme.
#[derive(Clone, Copy, Debug)]
pub struct View {
    /// Width of the viewport [px].
    pub width: u32,
    /// Preferred colour scheme.
    pub scheme: Scheme,
}

/// Desktop, light scheme.
pub const DESK: View = View { width: 1280, scheme: Scheme::Light };
/// Phone, dark scheme.
pub const PHONE: View = View { width: 375, scheme: Scheme::Dark };

/// Page as rendered by the browser.
#[derive(Debug)]
pub struct Look {
    /// Width of the page [px]; larger than the viewport if the page scrolls sideways.
    pub scroll_width: u32,
    /// Left, top, width and height of every plot [px].
    pub plots: Vec<[u32; 4]>,
    /// Reading the page shows for the middle of every plot with values.
    pub read: Vec<String>,
    /// Addresses fetched by the page.
    pub fetched: Vec<String>,
    columns: u32,
    /// Red, green and blue of every pixel.
    pixels: Vec<[u8; 3]>,
}

impl Look {
    /// Combines the layout from the probe with the screenshot.
    fn new(layout: &Value, columns: u32, pixels: Vec<[u8; 3]>) -> Self {
        let plots = layout["plots"].as_array().unwrap().iter();
        let texts = |name: &str| {
            let all = layout[name].as_array().unwrap().iter();
            all.map(|text| text.as_str().unwrap().to_owned()).collect()
        };
        Self {
            scroll_width: numbers(&layout["size"])[0],
            plots: plots.map(|plot| numbers(plot).try_into().unwrap()).collect(),
            read: texts("read"),
            fetched: texts("fetched"),
            columns,
            pixels,
        }
    }

    fn pixel(&self, x: u32, y: u32) -> [u8; 3] {
        self.pixels[(y * self.columns + x) as usize]
    }

    /// Colour in the corner of the page.
    pub fn paper(&self) -> [u8; 3] {
        self.pixel(2, 2)
    }

    /// True if more than 1 % of the pixels of a plot clearly differ from its background. A blank
    /// plot has none.
    pub fn is_drawn(&self, plot: usize) -> bool {
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

/// Path of the browser.
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

/// Runs the browser on a page until it exits.
fn browse(place: &TempDir, more: &[String], address: &str) -> Output {
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
        .args([
            "--host-resolver-rules=MAP * 127.0.0.1:9, EXCLUDE 127.0.0.1",
            "--force-device-scale-factor=1",
        ])
        .args(["--allow-file-access-from-files", "--virtual-time-budget=5000", "--timeout=60000"])
        .arg(format!("--user-data-dir={}", profile.display()))
        .args(more)
        .arg(address)
        .stdin(Stdio::null())
        .output()
        .unwrap();
    assert!(ended.status.success(), "{}", String::from_utf8_lossy(&ended.stderr));
    ended
}

/// Script in the page that reports the layout to the enclosing page.
const PROBE: &str = r#"<script>addEventListener("load", () => setTimeout(() => {
  const plots = [...document.querySelectorAll("svg.plot")].map(plot => {
    const r = plot.getBoundingClientRect();
    return [r.left, r.top, r.width, r.height].map(Math.floor);
  });
  // Reading for the middle of every plot with values.
  const read = [...document.querySelectorAll("svg.plot[data-x]")].map(plot => {
    const r = plot.getBoundingClientRect();
    const [clientX, clientY] = [r.left + r.width / 2, r.top + r.height / 2];
    plot.dispatchEvent(new PointerEvent("pointermove", { clientX, clientY }));
    const reading = document.querySelector(".reading").textContent;
    plot.dispatchEvent(new PointerEvent("pointerleave"));
    return reading;
  });
  const fetched = performance.getEntriesByType("resource").map(entry => entry.name);
  const root = document.documentElement;
  const size = [root.scrollWidth, root.scrollHeight];
  parent.postMessage({ plots, read, fetched, size }, "*");
}, 100));</script>"#;

/// Page with frames of these widths side by side, because a window cannot be as narrow as a phone.
/// Each frame becomes as high as its content. The title holds the reports of the frames.
fn framed(widths: &[u32]) -> String {
    let frame = |width: &u32| {
        format!(
            "<iframe src=\"page.html\" style=\"border:0;flex:none\" width=\"{width}\" \
             height=\"800\"></iframe>"
        )
    };
    format!(
        "<!DOCTYPE html><title></title>\
         <body style=\"margin:0;display:flex;align-items:flex-start\"><script>\
         const told = []; onmessage = event => {{\
         const frames = [...document.querySelectorAll('iframe')];\
         const at = frames.findIndex(frame => frame.contentWindow === event.source);\
         told[at] = event.data; frames[at].height = event.data.size[1];\
         document.title = JSON.stringify(told) }}</script>{}</body>",
        widths.iter().map(frame).collect::<String>()
    )
}

/// Renders a page in every view. Also returns its network requests.
pub fn look(page: &Path, views: &[View]) -> (Vec<Look>, Vec<String>) {
    let place = tempfile::tempdir().unwrap();
    let text = fs::read_to_string(page).unwrap();
    let probe = text.replace("</body>", &format!("{PROBE}</body>"));
    fs::write(place.path().join("page.html"), probe).unwrap();
    let mut looks: Vec<Option<Look>> = views.iter().map(|_| None).collect();
    let mut requests = BTreeSet::new();
    for scheme in [Scheme::Light, Scheme::Dark] {
        let of: Vec<usize> = (0..views.len()).filter(|&k| views[k].scheme == scheme).collect();
        let widths: Vec<u32> = of.iter().map(|&k| views[k].width).collect();
        if !widths.is_empty() {
            let (seen, asked) = see(&place, scheme, &widths);
            of.into_iter().zip(seen).for_each(|(k, look)| looks[k] = Some(look));
            requests.extend(asked);
        }
    }
    let looks = looks.into_iter().map(|look| look.expect("each view has a scheme"));
    (looks.collect(), requests.into_iter().collect())
}

/// Renders a page in every width, in one colour scheme. Also returns its network requests.
fn see(place: &TempDir, scheme: Scheme, widths: &[u32]) -> (Vec<Look>, Vec<String>) {
    let at = |name: &str| place.path().join(name);
    fs::write(at("frames.html"), framed(widths)).unwrap();
    let prefers = u8::from(scheme == Scheme::Light);
    let width = widths.iter().sum::<u32>().max(600);
    // High enough for most pages; a higher one is rendered again.
    let mut height = 10_000;
    let layouts = loop {
        let more = [
            format!("--blink-settings=preferredColorScheme={prefers}"),
            format!("--log-net-log={}", at("net.json").display()),
            format!("--window-size={width},{height}"),
            format!("--screenshot={}", at("shot.png").display()),
            "--dump-dom".to_owned(),
        ];
        let address = format!("file://{}", at("frames.html").display());
        let ended = browse(place, &more, &address);
        let layouts: Vec<Value> = probed(&String::from_utf8_lossy(&ended.stdout));
        assert_eq!(layouts.len(), widths.len(), "a frame has told nothing");
        let highest = layouts.iter().map(|layout| numbers(&layout["size"])[1]).max().unwrap();
        if highest <= height {
            break layouts;
        }
        height = highest;
    };
    let (columns, pixels) = decode(&at("shot.png"));
    let mut left = 0;
    let looks = layouts.iter().zip(widths).map(|(layout, width)| {
        let rows = pixels.chunks_exact(columns as usize);
        let rows = rows.take(numbers(&layout["size"])[1] as usize);
        let own = left..left + *width as usize;
        left = own.end;
        Look::new(layout, *width, rows.flat_map(|row| &row[own.clone()]).copied().collect())
    });
    (looks.collect(), requests(&at("net.json"), &at("page.html")))
}

/// Network requests of a page, from the log of the browser. Requests of the browser itself and of
/// the frames are ignored: those of the page have the page as initiator.
fn requests(log: &Path, page: &Path) -> Vec<String> {
    let log: Value = serde_json::from_str(&fs::read_to_string(log).unwrap()).unwrap();
    let events = log["events"].as_array().expect("the log has events");
    assert!(!events.is_empty());
    let of_page = |event: &&Value| {
        let initiator = event["params"]["initiator"].as_str();
        initiator.is_some_and(|initiator| initiator != "not an origin")
    };
    let urls = events.iter().filter(of_page).filter_map(|event| event["params"]["url"].as_str());
    let own = format!("file://{}", page.display());
    urls.filter(|url| !url.starts_with("data:") && *url != own).map(str::to_owned).collect()
}

/// Opens a page, runs a script in it, and returns the list that the script writes as JSON into the
/// title.
pub fn act(page: &Path, script: &str) -> Vec<Value> {
    let place = tempfile::tempdir().unwrap();
    let text = fs::read_to_string(page).unwrap();
    let script = format!("<script>{script}</script></body>");
    let path = place.path().join("page.html");
    fs::write(&path, text.replace("</body>", &script)).unwrap();
    let address = format!("file://{}", path.display());
    let ended = browse(&place, &["--dump-dom".to_owned()], &address);
    probed(&String::from_utf8_lossy(&ended.stdout))
}

/// Opens an address on this machine and returns the page after its scripts have run for a while.
pub fn opened(address: &str) -> String {
    let place = tempfile::tempdir().unwrap();
    let ended = browse(&place, &["--dump-dom".to_owned()], address);
    String::from_utf8_lossy(&ended.stdout).into_owned()
}

fn probed(dom: &str) -> Vec<Value> {
    let title = dom.split_once("<title>").and_then(|(_, rest)| rest.split_once("</title>"));
    let (title, _) = title.unwrap_or_else(|| panic!("no title in {dom:.400}"));
    serde_json::from_str(&title.replace("&amp;", "&"))
        .unwrap_or_else(|error| panic!("{error}: the page has not told its layout: {dom:.400}"))
}

fn numbers(list: &Value) -> Vec<u32> {
    list.as_array().unwrap().iter().map(|n| n.as_u64().unwrap() as u32).collect()
}

/// Asserts that the page fits every view, shows at least `plots` plots, all of them drawn, and
/// makes no network requests.
///
/// # Panics
/// Panics if one of these conditions fails.
pub fn assert_shown(page: &Path, views: &[View], plots: usize) {
    let (looks, requests) = look(page, views);
    assert_eq!(requests, Vec::<String>::new(), "{}", page.display());
    for (look, view) in looks.iter().zip(views) {
        assert!(look.plots.len() >= plots, "{view:?}: {} plots", look.plots.len());
        let width = look.scroll_width;
        assert!(width <= view.width, "{view:?}: the page is {width} wide");
        assert_eq!(look.fetched, Vec::<String>::new(), "{view:?}");
        for text in &look.read {
            let is_read = !text.is_empty() && !text.contains("NaN") && !text.contains("undefined");
            assert!(is_read, "{view:?}: a plot says `{text}` of its middle");
        }
        let light = look.paper().iter().map(|c| u32::from(*c)).sum::<u32>() > 3 * 128;
        assert_eq!(light, view.scheme == Scheme::Light, "{view:?}: {:?}", look.paper());
        for plot in 0..look.plots.len() {
            assert!(look.is_drawn(plot), "{view:?}: plot {plot} is blank");
        }
    }
}

/// Returns width and pixels of a picture.
fn decode(path: &Path) -> (u32, Vec<[u8; 3]>) {
    let file = BufReader::new(File::open(path).expect("the browser has taken a picture"));
    let mut reader = png::Decoder::new(file).read_info().unwrap();
    let mut bytes = vec![0; reader.output_buffer_size().unwrap()];
    let frame = reader.next_frame(&mut bytes).unwrap();
    assert_eq!(frame.bit_depth, png::BitDepth::Eight);
    let pixels = bytes[..frame.buffer_size()].chunks_exact(frame.color_type.samples());
    (frame.width, pixels.map(|pixel| [pixel[0], pixel[1], pixel[2]]).collect())
}
