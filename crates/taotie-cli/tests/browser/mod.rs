//! A page opened from disk in a real browser, led by the DevTools protocol: what a hand does and an eye sees.
//!
//! ```no_run
//! let Some(mut tab) = browser::open(&path, [1200, 800]) else { return };
//! tab.drag([600.0, 300.0], [300.0, 300.0]);
//! assert_eq!(tab.screenshot().at(450, 300), [0, 0, 255]);
//! tab.assert_quiet();
//! ```
#![allow(dead_code, clippy::print_stdout, reason = "each test uses some of it; one that is skipped says why")]

mod process;
mod protocol;
pub mod server;

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use process::Process;
use protocol::Connection;
use serde_json::{Value, json};
use std::path::Path;
use std::thread::sleep;
use std::time::{Duration, Instant};
use taotie::image::Texels;

/// How long anything may take.
const PATIENCE: Duration = Duration::from_secs(60);

/// A tab of a browser of its own, which ends with it.
pub struct Tab {
    connection: Connection,
    session: String,
    process: Process,
}

/// Opens a page that lies on disk in a window of this size, once it has loaded. Where there is no browser the test
/// has to be skipped, which is a failure under `CI=true`.
pub fn open(path: &Path, size: [u32; 2]) -> Option<Tab> {
    let mut tab = Tab::new(Process::start(&["--disable-gpu"])?);
    tab.resize(size);
    tab.go(path);
    Some(tab)
}

/// Opens a page that a server gives out, in a browser that draws WebGL without a graphics card; else as [`open`].
pub fn open_webgl(address: &str, size: [u32; 2]) -> Option<Tab> {
    let mut tab = Tab::new(Process::start(&["--use-angle=swiftshader", "--enable-unsafe-swiftshader"])?);
    tab.resize(size);
    tab.call("Page.navigate", json!({ "url": address }));
    Some(tab)
}

impl Tab {
    fn new(process: Process) -> Self {
        let mut connection = Connection::new(process.address());
        let target = connection.call(None, "Target.createTarget", json!({ "url": "about:blank" }));
        let attach = json!({ "targetId": target["targetId"], "flatten": true });
        let session = connection.call(None, "Target.attachToTarget", attach)["sessionId"].clone();
        let session = session.as_str().expect("a session has a name").to_owned();
        let mut tab = Self { connection, session, process };
        for domain in ["Page", "Network", "Runtime", "Log"] {
            tab.call(&format!("{domain}.enable"), json!({}));
        }
        tab
    }

    /// A command of the protocol; its result.
    pub fn call(&mut self, method: &str, parameters: Value) -> Value {
        self.connection.call(Some(&self.session), method, parameters)
    }

    /// Loads a page from disk.
    pub fn go(&mut self, path: &Path) {
        let path = path.canonicalize().expect("the page is there");
        self.call("Page.navigate", json!({ "url": format!("file://{}", path.display()) }));
        self.until(
            "document.readyState === 'complete' && [...document.images].every((image) => image.complete)",
        );
    }

    /// The window's size in CSS pixels, each of which is one of the screen.
    pub fn resize(&mut self, [width, height]: [u32; 2]) {
        let size = json!({ "width": width, "height": height, "deviceScaleFactor": 1, "mobile": false });
        self.call("Emulation.setDeviceMetricsOverride", size);
    }

    /// Dark or light, as the system would ask for.
    pub fn prefer(&mut self, scheme: &str) {
        let feature = json!([{ "name": "prefers-color-scheme", "value": scheme }]);
        self.call("Emulation.setEmulatedMedia", json!({ "features": feature }));
    }

    /// The value of an expression in the page.
    pub fn value(&mut self, expression: &str) -> Value {
        let parameters = json!({ "expression": expression, "returnByValue": true, "awaitPromise": true });
        let result = self.call("Runtime.evaluate", parameters);
        assert!(result.get("exceptionDetails").is_none(), "{expression}: {result}");
        result["result"]["value"].clone()
    }

    /// Waits until an expression is true.
    pub fn until(&mut self, expression: &str) {
        let start = Instant::now();
        while self.value(expression) != Value::Bool(true) {
            assert!(start.elapsed() < PATIENCE, "never came true: {expression}");
            sleep(Duration::from_millis(20));
        }
    }

    /// Left, top, width and height of an element in the window, which is scrolled to it.
    pub fn place(&mut self, selector: &str) -> [f64; 4] {
        let find = format!("document.querySelector({})", json!(selector));
        self.value(&format!("{find}.scrollIntoView({{ block: 'center' }})"));
        self.settle();
        let found =
            self.value(&format!("(b => [b.x, b.y, b.width, b.height])({find}.getBoundingClientRect())"));
        serde_json::from_value(found).expect("an element has a place")
    }

    /// The middle of an element.
    pub fn middle(&mut self, selector: &str) -> [f64; 2] {
        let [x, y, width, height] = self.place(selector);
        [x + width / 2.0, y + height / 2.0]
    }

    /// Waits until the page has been drawn, and for a scroll of it to be over.
    pub fn settle(&mut self) {
        self.value("new Promise((done) => requestAnimationFrame(() => setTimeout(done, 250)))");
    }

    fn mouse(&mut self, kind: &str, [x, y]: [f64; 2], more: &[(&str, Value)]) {
        let mut event = json!({ "type": kind, "x": x, "y": y });
        for (name, value) in more {
            event[*name] = value.clone();
        }
        self.call("Input.dispatchMouseEvent", event);
    }

    fn press(&mut self, kind: &str, at: [f64; 2], count: u32) {
        let held = u32::from(kind == "mousePressed");
        self.mouse(
            kind,
            at,
            &[("button", json!("left")), ("buttons", json!(held)), ("clickCount", json!(count))],
        );
    }

    /// Presses the mouse at one point, moves it in steps to another and lets it go.
    pub fn drag(&mut self, from: [f64; 2], to: [f64; 2]) {
        self.mouse("mouseMoved", from, &[]);
        self.press("mousePressed", from, 1);
        for step in 1..=5 {
            let along = |i: usize| from[i] + (to[i] - from[i]) * f64::from(step) / 5.0;
            let held = [("button", json!("left")), ("buttons", json!(1))];
            self.mouse("mouseMoved", [along(0), along(1)], &held);
        }
        self.press("mouseReleased", to, 1);
        self.settle();
    }

    /// Clicks an element `count` times in a row.
    pub fn click(&mut self, selector: &str, count: u32) {
        let at = self.middle(selector);
        self.mouse("mouseMoved", at, &[]);
        for i in 1..=count {
            self.press("mousePressed", at, i);
            self.press("mouseReleased", at, i);
        }
        self.settle();
    }

    /// Moves the mouse without a button.
    pub fn hover(&mut self, at: [f64; 2]) {
        self.mouse("mouseMoved", at, &[]);
        self.settle();
    }

    /// Turns the wheel at a point; negative is away from the hand.
    pub fn wheel(&mut self, at: [f64; 2], delta: f64) {
        self.mouse("mouseWheel", at, &[("deltaX", json!(0)), ("deltaY", json!(delta))]);
        self.settle();
    }

    /// Presses and releases a key by its name, such as `ArrowLeft`.
    pub fn key(&mut self, name: &str) {
        for kind in ["keyDown", "keyUp"] {
            self.call("Input.dispatchKeyEvent", json!({ "type": kind, "key": name, "code": name }));
        }
        self.settle();
    }

    /// Fingers that touch the screen, move together in steps, and leave it: pairs of where from and where to.
    pub fn touch(&mut self, fingers: &[([f64; 2], [f64; 2])]) {
        let at = |step: f64| -> Value {
            let point = |(from, to): &([f64; 2], [f64; 2])| {
                let along = |i: usize| from[i] + (to[i] - from[i]) * step;
                json!({ "x": along(0), "y": along(1) })
            };
            fingers.iter().map(point).collect()
        };
        self.call("Emulation.setTouchEmulationEnabled", json!({ "enabled": true, "maxTouchPoints": 5 }));
        self.call("Input.dispatchTouchEvent", json!({ "type": "touchStart", "touchPoints": at(0.0) }));
        for step in 1..=8 {
            let points = at(f64::from(step) / 8.0);
            self.call("Input.dispatchTouchEvent", json!({ "type": "touchMove", "touchPoints": points }));
        }
        self.call("Input.dispatchTouchEvent", json!({ "type": "touchEnd", "touchPoints": [] }));
        self.settle();
    }

    /// What is seen in the window.
    pub fn screenshot(&mut self) -> Screenshot {
        self.settle();
        let png = self.call("Page.captureScreenshot", json!({ "format": "png" }));
        Screenshot::new(png["data"].as_str().expect("a screenshot is text"))
    }

    /// Writes the whole page as a picture, to be looked at.
    pub fn photograph(&mut self, path: &Path) {
        self.settle();
        let whole = json!({ "format": "png", "captureBeyondViewport": true });
        let png = self.call("Page.captureScreenshot", whole);
        let png = STANDARD.decode(png["data"].as_str().expect("a screenshot is text")).expect("it is base64");
        std::fs::write(path, png).expect("the folder is writable");
    }

    /// What was asked of the network or the disk since the tab was opened.
    pub fn requests(&mut self) -> Vec<String> {
        let urls = self.events("Network.requestWillBeSent");
        urls.iter().filter_map(|event| Some(event["request"]["url"].as_str()?.to_owned())).collect()
    }

    /// Exceptions and whatever else the browser complained about.
    pub fn complaints(&mut self) -> Vec<String> {
        let mut found = self.events("Runtime.exceptionThrown");
        found.extend(self.events("Log.entryAdded"));
        found.extend(self.events("Runtime.consoleAPICalled"));
        found.iter().map(Value::to_string).collect()
    }

    fn events(&mut self, method: &str) -> Vec<Value> {
        // Whatever was sent before the answer to this is there after it.
        self.value("0");
        self.connection
            .events
            .iter()
            .filter(|(name, _)| name == method)
            .map(|(_, event)| event.clone())
            .collect()
    }

    /// Fails where the page asked for anything but itself and what lies within it, or where the browser complained.
    pub fn assert_quiet(&mut self) {
        assert_eq!(self.complaints(), [""; 0]);
        let requests = self.requests();
        assert!(requests.iter().any(|url| url.starts_with("file:")), "nothing was watched");
        let other: Vec<&String> = requests.iter().filter(|url| !url.starts_with("data:")).collect();
        let pages = other.iter().filter(|url| url.starts_with("file:") && url.ends_with(".html"));
        assert_eq!(pages.count(), other.len(), "requests left the page: {other:?}");
    }
}

/// Pixels of a window.
pub struct Screenshot {
    width: usize,
    texels: Vec<[u8; 4]>,
}

impl Screenshot {
    fn new(base64: &str) -> Self {
        let png = STANDARD.decode(base64).expect("it is base64");
        let bitmap =
            taotie::io::decode_bitmap(&png, "screenshot", Path::new("screenshot")).expect("it is a PNG");
        let Texels::U8(texels) = bitmap.texels() else { panic!("a screenshot has 8 bits") };
        Self { width: bitmap.width() as usize, texels: texels.to_vec() }
    }

    /// The colour at a point of the window.
    pub fn at(&self, [x, y]: [f64; 2]) -> [u8; 3] {
        let [r, g, b, _] = self.texels[y as usize * self.width + x as usize];
        [r, g, b]
    }
}
