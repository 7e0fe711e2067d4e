//! A page in Chromium without a window, led through its debugging pipe.

use serde_json::{Value, json};
use std::io::{BufRead, BufReader, Write};
use std::path::Path;
use std::process::{Child, ChildStdin, Command, Stdio};
use std::sync::mpsc::{Receiver, channel};
use std::time::{Duration, Instant};

/// Longest that anything may take.
const PATIENCE: Duration = Duration::from_secs(120);
/// Size of the page, pixels.
pub(super) const PAGE: [u32; 2] = [1280, 720];

/// A browser with one page.
pub(super) struct Page {
    browser: Child,
    to: ChildStdin,
    from: Receiver<Value>,
    session: String,
    calls: u64,
    /// What the page complained about.
    pub(super) complaints: Vec<String>,
}

impl Page {
    /// `None` where there is no browser.
    ///
    /// * `profile`: a folder for what it writes.
    pub(super) fn open(profile: &Path) -> Option<Self> {
        let programs = ["chromium", "chromium-browser", "google-chrome"];
        let program = programs.into_iter().find(|name| Command::new(name).arg("--version").output().is_ok())?;
        // The pipe is on descriptors 3 and 4; pictures of WebGL are drawn by SwiftShader.
        let mut browser = Command::new("sh")
            .args(["-c", r#"exec "$@" 3<&0 4>&1 </dev/null >/dev/null 2>&1"#, "sh", program])
            .args(["--headless=new", "--no-sandbox", "--disable-dev-shm-usage", "--remote-debugging-pipe"])
            .args([
                "--use-gl=angle",
                "--use-angle=swiftshader",
                "--enable-unsafe-swiftshader",
                "--ignore-gpu-blocklist",
            ])
            .arg(format!("--user-data-dir={}", profile.display()))
            .arg("about:blank")
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .spawn()
            .ok()?;
        let to = browser.stdin.take().expect("input");
        let output = BufReader::new(browser.stdout.take().expect("output"));
        let (outbox, from) = channel();
        std::thread::spawn(move || {
            for message in output.split(0).map_while(Result::ok) {
                let heard = serde_json::from_slice(&message).is_ok_and(|value: Value| outbox.send(value).is_ok());
                if !heard {
                    return;
                }
            }
        });
        let mut page = Self { browser, to, from, session: String::new(), calls: 0, complaints: Vec::new() };
        let target = page.call("Target.createTarget", json!({ "url": "about:blank" }))["targetId"].clone();
        let attached = page.call("Target.attachToTarget", json!({ "targetId": target, "flatten": true }));
        page.session = attached["sessionId"].as_str().expect("session").to_owned();
        for domain in ["Runtime", "Log", "Page"] {
            page.call(&format!("{domain}.enable"), json!({}));
        }
        let size = json!({ "width": PAGE[0], "height": PAGE[1], "deviceScaleFactor": 1, "mobile": false });
        page.call("Emulation.setDeviceMetricsOverride", size);
        Some(page)
    }

    /// Calls a method of the protocol and waits for its result.
    pub(super) fn call(&mut self, method: &str, params: Value) -> Value {
        self.calls += 1;
        let mut message = json!({ "id": self.calls, "method": method, "params": params });
        if !self.session.is_empty() {
            message["sessionId"] = self.session.as_str().into();
        }
        write!(self.to, "{message}\0").and_then(|()| self.to.flush()).expect("the browser listens");
        loop {
            let answer = self.from.recv_timeout(PATIENCE).expect("the browser answers");
            if answer["id"] == self.calls {
                // A page that is being loaded again has no value for the moment.
                let ends = method == "Runtime.evaluate" && answer["error"]["code"] == -32000;
                assert!(ends || answer["error"].is_null(), "{method}: {}", answer["error"]);
                return answer["result"].clone();
            }
            self.listen(&answer);
        }
    }

    /// Errors of the console, of scripts and of what was loaded.
    fn listen(&mut self, event: &Value) {
        let params = &event["params"];
        let complains = match event["method"].as_str() {
            Some("Runtime.exceptionThrown") => true,
            Some("Runtime.consoleAPICalled") => params["type"] == "error",
            Some("Log.entryAdded") => params["entry"]["level"] == "error",
            _ => false,
        };
        if complains {
            self.complaints.push(params.to_string());
        }
    }

    /// Value of a script.
    pub(super) fn value(&mut self, script: &str) -> Value {
        let params = json!({ "expression": script, "returnByValue": true, "awaitPromise": true });
        let mut answer = self.call("Runtime.evaluate", params);
        assert!(answer["exceptionDetails"].is_null(), "{script}: {}", answer["exceptionDetails"]);
        answer["result"]["value"].take()
    }

    /// Waits until a script has a value that passes.
    pub(super) fn wait(&mut self, script: &str, passes: impl Fn(&Value) -> bool) -> Value {
        let began = Instant::now();
        loop {
            let value = self.value(script);
            if passes(&value) {
                return value;
            }
            let text = self.value("document.body.innerText");
            assert!(began.elapsed() < PATIENCE, "{script} is {value}; the page says {text}; {:?}", self.complaints);
            std::thread::sleep(Duration::from_millis(50));
        }
    }

    /// The pointer does something at a pixel.
    pub(super) fn pointer(&mut self, what: &str, [x, y]: [f64; 2]) {
        let pressed = i32::from(what != "mouseReleased");
        let params = json!({ "type": what, "x": x, "y": y, "button": "left", "buttons": pressed, "clickCount": 1 });
        self.call("Input.dispatchMouseEvent", params);
    }

    /// The page as a PNG, in base 64.
    pub(super) fn screenshot(&mut self) -> String {
        self.call("Page.captureScreenshot", json!({ "format": "png" }))["data"].as_str().expect("picture").to_owned()
    }
}

impl Drop for Page {
    fn drop(&mut self) {
        let _ = self.browser.kill();
        let _ = self.browser.wait();
    }
}
