//! Chromium without a window, steered by its DevTools protocol (<https://github.com/ChromeDevTools/devtools-protocol>).

use std::net::TcpStream;
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

use serde_json::{Value, json};
use tempfile::TempDir;
use tungstenite::{Message, WebSocket};

/// Set where a missing browser is a failure.
const REQUIRED: &str = "SUMO_MFC_BROWSER";
/// The names under which it is installed.
const NAMES: [&str; 4] = ["chromium", "chromium-browser", "google-chrome", "chrome"];
/// Nothing here takes this long unless something hangs.
const LIMIT: Duration = Duration::from_secs(60);

/// A browser with one page.
pub struct Browser {
    process: Child,
    socket: WebSocket<TcpStream>,
    session: Option<String>,
    last: u64,
    /// What it told without being asked, since the page was opened.
    events: Vec<Value>,
    _profile: TempDir,
}

impl Browser {
    /// Starts it. `None`, and a line that says so, where there is none and none is required.
    pub fn start() -> Option<Self> {
        let found = NAMES.iter().find(|name| {
            let version = Command::new(name).arg("--version").stdout(Stdio::null()).stderr(Stdio::null()).status();
            version.is_ok_and(|status| status.success())
        });
        let Some(name) = found else {
            assert!(std::env::var_os(REQUIRED).is_none(), "no Chromium: on Debian, apt-get install chromium");
            println!("skipped: no Chromium (on Debian: apt-get install chromium)");
            return None;
        };
        let profile = tempfile::tempdir().unwrap();
        let process = Command::new(name)
            .args(["--headless=new", "--no-sandbox", "--disable-gpu", "--disable-dev-shm-usage", "--no-first-run"])
            .arg("--remote-debugging-port=0")
            .arg(format!("--user-data-dir={}", profile.path().display()))
            .arg("about:blank")
            .stdout(Stdio::null())
            .stderr(Stdio::null())
            .spawn()
            .unwrap();
        let address = address(profile.path());
        let stream = TcpStream::connect(address.trim_start_matches("ws://").split('/').next().unwrap()).unwrap();
        stream.set_read_timeout(Some(LIMIT)).unwrap();
        let (socket, _) = tungstenite::client(address.as_str(), stream).unwrap();
        let mut browser = Self { process, socket, session: None, last: 0, events: Vec::new(), _profile: profile };
        let target = browser.call("Target.createTarget", json!({ "url": "about:blank" }))["targetId"].clone();
        let session = browser.call("Target.attachToTarget", json!({ "targetId": target, "flatten": true }));
        browser.session = session["sessionId"].as_str().map(str::to_owned);
        for domain in ["Page", "Runtime", "Log", "Network"] {
            browser.call(&format!("{domain}.enable"), json!({}));
        }
        Some(browser)
    }

    /// Asks for something, and returns the answer.
    fn call(&mut self, method: &str, params: Value) -> Value {
        self.last += 1;
        let mut message = json!({ "id": self.last, "method": method, "params": params });
        if let Some(session) = &self.session {
            message["sessionId"] = json!(session);
        }
        self.socket.send(Message::text(message.to_string())).unwrap();
        loop {
            let told = self.told();
            if told["id"] == self.last {
                assert!(told["error"].is_null(), "{method}: {}", told["error"]);
                return told["result"].clone();
            }
            self.events.push(told);
        }
    }

    fn told(&mut self) -> Value {
        let message = self.socket.read().unwrap();
        serde_json::from_str(message.to_text().unwrap()).unwrap()
    }

    /// Opens a page and waits until it is loaded. Returns how long that took.
    pub fn open(&mut self, page: &Path, hash: &str) -> Duration {
        // From a page to a place on itself nothing would be loaded.
        self.call("Page.navigate", json!({ "url": "about:blank" }));
        self.wait_for("Page.loadEventFired");
        self.events.clear();
        let start = Instant::now();
        self.call("Page.navigate", json!({ "url": format!("file://{}{hash}", page.display()) }));
        self.wait_for("Page.loadEventFired");
        // Answered when the page is free again, which is when it can be used.
        self.js("document.readyState");
        start.elapsed()
    }

    fn wait_for(&mut self, event: &str) {
        let deadline = Instant::now() + LIMIT;
        while !self.events.iter().any(|told| told["method"] == event) {
            assert!(Instant::now() < deadline, "{event} never came");
            let told = self.told();
            self.events.push(told);
        }
        self.events.retain(|told| told["method"] != event);
    }

    /// The value of an expression, on the page.
    pub fn js(&mut self, expression: &str) -> Value {
        let arguments = json!({ "expression": expression, "returnByValue": true, "awaitPromise": true });
        let answer = self.call("Runtime.evaluate", arguments);
        assert!(answer["exceptionDetails"].is_null(), "{expression}: {}", answer["exceptionDetails"]);
        answer["result"]["value"].clone()
    }

    /// Moves the pointer to the middle of the first element that a selector finds, and clicks.
    pub fn click(&mut self, selector: &str) {
        let place = self.js(&format!(
            "(() => {{ const e = document.querySelector({selector:?}); e.scrollIntoView({{ block: 'center', inline: 'center' }});
             const b = e.getBoundingClientRect(); return [b.left + b.width / 2, b.top + b.height / 2]; }})()"
        ));
        for kind in ["mousePressed", "mouseReleased"] {
            let event = json!({ "type": kind, "x": place[0], "y": place[1], "button": "left", "clickCount": 1 });
            self.call("Input.dispatchMouseEvent", event);
        }
    }

    /// Writes into an input, as by keys, and waits until the page has heard it.
    pub fn write(&mut self, selector: &str, text: &str) {
        self.js(&format!("(() => {{ const e = document.querySelector({selector:?}); e.focus(); e.select(); }})()"));
        self.call("Input.insertText", json!({ "text": text }));
        self.js("new Promise((done) => setTimeout(done, 250))");
    }

    /// Size of the window, and whether its colours are dark.
    pub fn emulate(&mut self, [width, height]: [u32; 2], dark: bool) {
        let screen = json!({ "width": width, "height": height, "deviceScaleFactor": 1, "mobile": width < 500 });
        self.call("Emulation.setDeviceMetricsOverride", screen);
        let scheme = if dark { "dark" } else { "light" };
        let media = json!({ "media": "", "features": [{ "name": "prefers-color-scheme", "value": scheme }] });
        self.call("Emulation.setEmulatedMedia", media);
    }

    /// Shows the page as a printer would have it, until [`Self::emulate`].
    pub fn emulate_print(&mut self) {
        self.call("Emulation.setEmulatedMedia", json!({ "media": "print" }));
    }

    /// The page printed, PDF in base64.
    pub fn printed(&mut self) -> String {
        self.call("Page.printToPDF", json!({ "printBackground": true }))["data"].as_str().unwrap().to_owned()
    }

    /// What went wrong on the page, and every address that it asked the network for.
    pub fn complaints(&mut self) -> Vec<String> {
        self.js("new Promise((done) => setTimeout(done, 50))");
        let complaint = |told: &Value| match told["method"].as_str()? {
            "Runtime.exceptionThrown" | "Log.entryAdded" | "Runtime.consoleAPICalled" => {
                Some(told["params"].to_string())
            }
            "Page.javascriptDialogOpening" => Some(told["params"].to_string()),
            "Network.requestWillBeSent" => {
                let url = told["params"]["request"]["url"].as_str()?;
                let local = ["file:", "data:", "blob:", "about:"].iter().any(|scheme| url.starts_with(scheme));
                (!local).then(|| url.to_owned())
            }
            _ => None,
        };
        self.events.iter().filter_map(complaint).collect()
    }
}

impl Drop for Browser {
    fn drop(&mut self) {
        let _ = self.process.kill();
        let _ = self.process.wait();
    }
}

/// Where the browser listens: it writes that into its profile.
fn address(profile: &Path) -> String {
    let deadline = Instant::now() + LIMIT;
    loop {
        let text = std::fs::read_to_string(profile.join("DevToolsActivePort")).unwrap_or_default();
        if let Some((port, path)) = text.split_once('\n').filter(|(_, path)| !path.is_empty()) {
            return format!("ws://127.0.0.1:{port}{path}");
        }
        assert!(Instant::now() < deadline, "Chromium does not start");
        std::thread::sleep(Duration::from_millis(20));
    }
}
