//! A small driver of Chromium by its DevTools protocol: messages of JSON over two pipes, each ended by a zero byte.

use base64::Engine;
use base64::prelude::BASE64_STANDARD;
use serde_json::{Value, json};
use std::ffi::OsString;
use std::fs::File;
use std::io::{BufRead, BufReader, Cursor, Write};
use std::path::{Path, PathBuf};
use std::process::{Child, ChildStdin, Command, Stdio};
use std::sync::mpsc::{Receiver, RecvTimeoutError, channel};
use std::time::{Duration, Instant};
use tempfile::TempDir;

/// The time limit of any step, on a slow and busy machine.
const PATIENCE: Duration = Duration::from_secs(30);
/// Interval at which conditions are polled.
const BETWEEN: Duration = Duration::from_millis(25);

/// The names of browser programs, unless `LOCALSHAPE_BROWSER` names one.
const NAMES: [&str; 4] = ["chromium", "chromium-browser", "google-chrome", "chrome"];

/// A browser with one page.
pub(crate) struct Browser {
    process: Child,
    /// `None` when it is to end.
    orders: Option<ChildStdin>,
    answers: Receiver<Value>,
    last_order: u64,
    session: Option<String>,
    events: Vec<Value>,
    folder: TempDir,
}

/// Keys with special codes; all others are letters and signs.
const NAMED_KEYS: [(&str, u32, &str); 9] = [
    ("ArrowLeft", 37, ""),
    ("ArrowUp", 38, ""),
    ("ArrowRight", 39, ""),
    ("ArrowDown", 40, ""),
    ("Home", 36, ""),
    ("End", 35, ""),
    ("Tab", 9, ""),
    ("Escape", 27, ""),
    ("Enter", 13, "\r"),
];

impl Browser {
    /// A browser. Without one, `None` with a line on standard error, or a failure if one is required.
    pub(crate) fn start() -> Option<Self> {
        let Some(program) = program() else {
            let missing = "there is no Chromium: `apt install chromium`, or name one in LOCALSHAPE_BROWSER";
            assert!(std::env::var_os("LOCALSHAPE_REQUIRE_BROWSER").is_none_or(|value| value != "1"), "{missing}");
            localshape::internals::skipped(missing);
            return None;
        };
        let folder = tempfile::tempdir().expect("a folder for the browser");
        let log = File::create(folder.path().join("log")).expect("a file for what the browser says");
        // Chromium reads from file 3 and writes to file 4; the shell puts our pipes there.
        let mut process = Command::new("sh")
            .args(["-c", "exec \"$0\" \"$@\" 3<&0 4>&1 1>&2"])
            .arg(program)
            .args(["--headless", "--no-sandbox", "--disable-gpu", "--disable-quic", "--no-first-run"])
            .args(["--disable-background-networking", "--disable-component-update", "--disable-sync"])
            .args(["--disable-dev-shm-usage", "--disable-extensions", "--no-default-browser-check"])
            .args(["--force-color-profile=srgb", "--hide-scrollbars", "--remote-debugging-pipe"])
            .arg(format!("--user-data-dir={}", folder.path().join("profile").display()))
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .stderr(log)
            .spawn()
            .expect("a shell");
        let (orders, output) = (process.stdin.take(), process.stdout.take().expect("a pipe"));
        let (sender, answers) = channel();
        std::thread::spawn(move || {
            let mut output = BufReader::new(output);
            loop {
                let mut message = Vec::new();
                if output.read_until(0, &mut message).is_err() || message.pop() != Some(0) {
                    return; // The browser is gone.
                }
                if sender.send(serde_json::from_slice(&message).expect("a message of JSON")).is_err() {
                    return;
                }
            }
        });
        let mut browser = Self { process, orders, answers, last_order: 0, session: None, events: vec![], folder };
        let target = browser.order("Target.createTarget", json!({ "url": "about:blank" }))["targetId"].clone();
        let attached = browser.order("Target.attachToTarget", json!({ "targetId": target, "flatten": true }));
        browser.session = Some(attached["sessionId"].as_str().expect("a session").to_owned());
        for part in ["Page", "Runtime", "Network", "Log"] {
            browser.order(&format!("{part}.enable"), json!({}));
        }
        browser.resize([1280, 900]);
        Some(browser)
    }

    /// The browser's answer to a command.
    pub(crate) fn order(&mut self, method: &str, parameters: Value) -> Value {
        self.last_order += 1;
        let mut message = json!({ "id": self.last_order, "method": method, "params": parameters });
        if let Some(session) = &self.session {
            message["sessionId"] = json!(session);
        }
        let bytes = format!("{message}\0");
        let sent = self.orders.as_mut().expect("a browser that runs").write_all(bytes.as_bytes());
        if let Err(error) = sent {
            panic!("{method}: the browser does not listen ({error}): {}", self.log());
        }
        let start = Instant::now();
        loop {
            match self.answers.recv_timeout(PATIENCE.saturating_sub(start.elapsed())) {
                Ok(answer) if answer["id"] == self.last_order => {
                    assert!(answer.get("error").is_none(), "{method}: {}", answer["error"]);
                    return answer["result"].clone();
                }
                Ok(event) => self.events.push(event),
                Err(RecvTimeoutError::Timeout) => panic!("{method}: no answer within {PATIENCE:?}: {}", self.log()),
                Err(RecvTimeoutError::Disconnected) => panic!("{method}: the browser has ended: {}", self.log()),
            }
        }
    }

    /// The browser's output on standard error.
    fn log(&self) -> String {
        std::fs::read_to_string(self.folder.path().join("log")).unwrap_or_default()
    }

    /// Writes a page to a new file, opens it, and returns its address.
    pub(crate) fn open(&mut self, page: &str) -> String {
        let path = self.folder.path().join("report.html");
        std::fs::write(&path, page).expect("a file for the page");
        let address = format!("file://{}", path.display());
        self.order("Page.navigate", json!({ "url": "about:blank" }));
        self.until("an empty page", "location.href === 'about:blank'");
        self.events.clear();
        let opened = self.order("Page.navigate", json!({ "url": address }));
        assert!(opened.get("errorText").is_none(), "{address}: {opened}");
        self.until("the page", "location.protocol === 'file:' && document.readyState === 'complete'");
        address
    }

    /// The width and height of the window (px).
    pub(crate) fn resize(&mut self, [width, height]: [u32; 2]) {
        let metrics = json!({ "width": width, "height": height, "deviceScaleFactor": 1, "mobile": false });
        self.order("Emulation.setDeviceMetricsOverride", metrics);
    }

    /// The value of an expression in the page.
    pub(crate) fn value(&mut self, expression: &str) -> Value {
        let call = json!({ "expression": expression, "returnByValue": true, "awaitPromise": true });
        let answer = self.order("Runtime.evaluate", call);
        assert!(answer.get("exceptionDetails").is_none(), "{expression}: {}", answer["exceptionDetails"]);
        answer["result"]["value"].clone()
    }

    /// The text of an expression in the page.
    pub(crate) fn text(&mut self, expression: &str) -> String {
        let value = self.value(expression);
        value.as_str().unwrap_or_else(|| panic!("{expression} is {value}")).to_owned()
    }

    /// The numeric value of an expression in the page.
    pub(crate) fn number(&mut self, expression: &str) -> f64 {
        let value = self.value(expression);
        value.as_f64().unwrap_or_else(|| panic!("{expression} is {value}"))
    }

    /// Waits until a condition holds in the page.
    pub(crate) fn until(&mut self, what: &str, condition: &str) {
        let start = Instant::now();
        while self.value(condition) != true {
            assert!(start.elapsed() < PATIENCE, "waited {PATIENCE:?} for {what}: {condition}");
            std::thread::sleep(BETWEEN);
        }
    }

    /// Presses and releases a key: a sign such as `b`, or a name such as `ArrowLeft`.
    pub(crate) fn press(&mut self, key: &str) {
        let named = NAMED_KEYS.iter().find(|(name, ..)| *name == key);
        let letter = key.chars().next().unwrap_or_default().to_ascii_uppercase();
        let (code, text) = named.map_or((letter as u32, key), |&(_, code, text)| (code, text));
        let code = if named.is_none() && !letter.is_ascii_alphanumeric() && letter != ' ' { 0 } else { code };
        let mut event = json!({ "type": "keyDown", "key": key, "windowsVirtualKeyCode": code });
        if text.is_empty() {
            event["type"] = json!("rawKeyDown");
        } else {
            event["text"] = json!(text);
        }
        self.order("Input.dispatchKeyEvent", event.clone());
        event["type"] = json!("keyUp");
        self.order("Input.dispatchKeyEvent", event);
    }

    fn mouse(&mut self, kind: &str, [x, y]: [f64; 2], buttons: u32) {
        let button = if buttons > 0 || kind == "mouseReleased" { "left" } else { "none" };
        let event = json!({ "type": kind, "x": x, "y": y, "button": button, "buttons": buttons, "clickCount": 1 });
        self.order("Input.dispatchMouseEvent", event);
    }

    /// Moves the mouse pointer.
    pub(crate) fn point(&mut self, at: [f64; 2]) {
        self.mouse("mouseMoved", at, 0);
    }

    /// Presses the left button at one place, moves to another one and releases it there.
    pub(crate) fn drag(&mut self, from: [f64; 2], to: [f64; 2]) {
        self.point(from);
        self.mouse("mousePressed", from, 1);
        if from != to {
            let middle = [(from[0] + to[0]) / 2.0, (from[1] + to[1]) / 2.0];
            self.mouse("mouseMoved", middle, 1);
            self.mouse("mouseMoved", to, 1);
        }
        self.mouse("mouseReleased", to, 0);
    }

    /// Left, top, width and height of the element of a selector, after scrolling to it (px in the window).
    pub(crate) fn place(&mut self, selector: &str) -> [f64; 4] {
        let found = self.value(&format!(
            "(() => {{ const found = document.querySelector({}); found.scrollIntoView({{ block: 'center' }}); \
             const box = found.getBoundingClientRect(); return [box.left, box.top, box.width, box.height]; }})()",
            json!(selector)
        ));
        std::array::from_fn(|at| found[at].as_f64().unwrap_or_else(|| panic!("{selector} is nowhere")))
    }

    /// The colours at the middles of some places in the window, as on the screen.
    pub(crate) fn colours<const COUNT: usize>(&mut self, places: [[f64; 2]; COUNT]) -> [[u8; 3]; COUNT] {
        let (width, pixels) = self.pixels();
        places.map(|[x, y]| pixels[y as usize * width + x as usize])
    }

    /// The width of the window (px), and the colours of its pixels as they are on the screen, in rows from the top left.
    pub(crate) fn pixels(&mut self) -> (usize, Vec<[u8; 3]>) {
        let shot = self.order("Page.captureScreenshot", json!({ "format": "png" }));
        let file = BASE64_STANDARD.decode(shot["data"].as_str().expect("a picture")).expect("base64");
        let mut reader = png::Decoder::new(Cursor::new(file)).read_info().expect("a PNG picture");
        let mut bytes = vec![0; reader.output_buffer_size().expect("a size")];
        let info = reader.next_frame(&mut bytes).expect("a whole picture");
        let pixels = bytes.chunks_exact(info.color_type.samples());
        (info.width as usize, pixels.map(|pixel| [pixel[0], pixel[1], pixel[2]]).collect())
    }

    /// All requests since the page was opened.
    pub(crate) fn requests(&mut self) -> Vec<String> {
        self.value("1"); // Earlier events have arrived before this answer.
        let requests = self.events.iter().filter(|event| event["method"] == "Network.requestWillBeSent");
        requests.map(|event| event["params"]["request"]["url"].as_str().unwrap_or_default().to_owned()).collect()
    }

    /// Errors in the page since it was opened: exceptions, and errors reported by it or the browser.
    pub(crate) fn complaints(&mut self) -> Vec<String> {
        self.value("1");
        let is_complaint = |event: &&Value| match event["method"].as_str() {
            Some("Runtime.exceptionThrown") => true,
            Some("Runtime.consoleAPICalled") => event["params"]["type"] == "error",
            Some("Log.entryAdded") => event["params"]["entry"]["level"] == "error",
            _ => false,
        };
        self.events.iter().filter(is_complaint).map(Value::to_string).collect()
    }
}

impl Drop for Browser {
    fn drop(&mut self) {
        // Without a listener the browser ends by itself, with all its processes; the test does not wait for it.
        self.orders = None;
        let start = Instant::now();
        while start.elapsed() < Duration::from_secs(3) {
            if !matches!(self.process.try_wait(), Ok(None)) {
                return;
            }
            std::thread::sleep(BETWEEN);
        }
        let _ = self.process.kill();
        let _ = self.process.wait();
    }
}

/// The browser's program.
fn program() -> Option<OsString> {
    if let Some(named) = std::env::var_os("LOCALSHAPE_BROWSER").filter(|named| !named.is_empty()) {
        return Some(named);
    }
    let folders: Vec<PathBuf> = std::env::split_paths(&std::env::var_os("PATH")?).collect();
    let found = NAMES.iter().flat_map(|name| folders.iter().map(move |folder| folder.join(name)));
    found.into_iter().find(|path| Path::is_file(path)).map(PathBuf::into_os_string)
}
