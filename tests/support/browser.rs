//! Chromium without a screen, driven by the DevTools protocol: JSON messages that end with a zero byte, over two pipes.
//! Protocol: <https://chromedevtools.github.io/devtools-protocol/>.

use std::io::{BufRead, BufReader, Write};
use std::path::Path;
use std::process::{Child, ChildStdin, ChildStdout, Command, Stdio};
use std::time::{Duration, Instant};

use serde_json::{Value, json};
use tempfile::TempDir;

/// A page open in a browser of its own.
pub struct Browser {
    child: Child,
    to: ChildStdin,
    from: BufReader<ChildStdout>,
    session: String,
    n_sent: u64,
    /// What the browser has told unasked.
    events: Vec<Value>,
    _profile: TempDir,
}

/// The shell gives the pipes the numbers that Chromium wants; software stands in for a graphics card.
const START: &str = "exec chromium --headless=new --no-sandbox --disable-dev-shm-usage --disable-gpu-compositing --use-angle=swiftshader \
     --enable-unsafe-swiftshader --disable-background-networking --remote-debugging-pipe --user-data-dir=\"$0\" about:blank \
     3<&0 4>&1 1>&2";

/// What takes longer does not come.
const PATIENCE: Duration = Duration::from_secs(60);

impl Browser {
    /// Opens a file.
    pub fn open(page: &Path, [width, height]: [u32; 2]) -> Browser {
        let profile = tempfile::tempdir().unwrap();
        let mut command = Command::new("sh");
        command
            .args(["-c", START])
            .arg(profile.path())
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .stderr(Stdio::null());
        let mut child = command.spawn().expect("a shell starts");
        let (to, from) = (child.stdin.take().unwrap(), BufReader::new(child.stdout.take().unwrap()));
        let mut browser =
            Browser { child, to, from, session: String::new(), n_sent: 0, events: Vec::new(), _profile: profile };
        let target = browser.send("Target.createTarget", json!({"url": "about:blank"}));
        let attached = json!({"targetId": target["targetId"], "flatten": true});
        browser.session = browser.send("Target.attachToTarget", attached)["sessionId"].as_str().unwrap().to_owned();
        for domain in ["Runtime", "Log", "Network", "Page"] {
            browser.send(&format!("{domain}.enable"), json!({}));
        }
        browser.resize([width, height]);
        browser.send("Page.navigate", json!({"url": format!("file://{}", page.display())}));
        browser.wait_for("document.readyState === 'complete'");
        browser
    }

    /// Sends a command and gives its result.
    pub fn send(&mut self, method: &str, params: Value) -> Value {
        self.n_sent += 1;
        let mut message = json!({"id": self.n_sent, "method": method, "params": params});
        if !self.session.is_empty() {
            message["sessionId"] = json!(self.session);
        }
        self.to.write_all(format!("{message}\0").as_bytes()).expect("is Debian's package chromium installed?");
        loop {
            let mut bytes = Vec::new();
            self.from.read_until(0, &mut bytes).unwrap();
            assert!(bytes.pop() == Some(0), "the browser has gone: is Debian's package chromium installed?");
            let mut answer: Value = serde_json::from_slice(&bytes).unwrap();
            if answer["id"] != json!(self.n_sent) {
                self.events.push(answer);
                continue;
            }
            assert!(answer["error"].is_null(), "{method}: {answer}");
            return answer["result"].take();
        }
    }

    /// The value of an expression in the page.
    #[track_caller]
    pub fn value(&mut self, expression: &str) -> Value {
        let asked = json!({"expression": expression, "returnByValue": true, "awaitPromise": true});
        let mut answer = self.send("Runtime.evaluate", asked);
        assert!(answer["exceptionDetails"].is_null(), "{expression}: {answer}");
        answer["result"]["value"].take()
    }

    /// A text in the page.
    #[track_caller]
    pub fn text(&mut self, expression: &str) -> String {
        self.value(expression).as_str().unwrap_or_else(|| panic!("{expression} is no text")).to_owned()
    }

    /// A number in the page.
    #[track_caller]
    pub fn number(&mut self, expression: &str) -> f64 {
        self.value(expression).as_f64().unwrap_or_else(|| panic!("{expression} is no number"))
    }

    /// Waits until a condition holds.
    #[track_caller]
    pub fn wait_for(&mut self, condition: &str) {
        let start = Instant::now();
        while self.value(condition) != json!(true) {
            assert!(start.elapsed() < PATIENCE, "{condition} does not come");
            std::thread::sleep(Duration::from_millis(50));
        }
    }

    /// Presses a key, e.g. `ArrowLeft`.
    pub fn press(&mut self, key: &str) {
        let text = if key.chars().count() == 1 { key } else { "" };
        for kind in ["keyDown", "keyUp"] {
            self.send("Input.dispatchKeyEvent", json!({"type": kind, "key": key, "text": text}));
        }
    }

    /// Sets the size of the window.
    pub fn resize(&mut self, [width, height]: [u32; 2]) {
        let size = json!({"width": width, "height": height, "deviceScaleFactor": 1, "mobile": false});
        self.send("Emulation.setDeviceMetricsOverride", size);
    }

    /// What the page has complained of, and the addresses that it has asked for beyond its own.
    pub fn complaints(&mut self) -> Vec<String> {
        self.value("1");
        // A test that looks at a picture makes the driver wait, and the driver parts so.
        let is_own = |event: &Value| event.to_string().contains("GPU stall due to ReadPixels");
        let complaint = |event: &Value| match event["method"].as_str() {
            Some("Log.entryAdded") if is_own(event) => None,
            Some("Runtime.exceptionThrown" | "Log.entryAdded") => Some(event["params"].to_string()),
            Some("Runtime.consoleAPICalled") => Some(event["params"]["args"].to_string()),
            Some("Network.requestWillBeSent") => {
                let address = event["params"]["request"]["url"].as_str().unwrap();
                (!address.starts_with("file:") && !address.starts_with("data:")).then(|| address.to_owned())
            }
            _ => None,
        };
        self.events.iter().filter_map(complaint).collect()
    }
}

impl Drop for Browser {
    fn drop(&mut self) {
        // Best effort: the test has its answer.
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}
