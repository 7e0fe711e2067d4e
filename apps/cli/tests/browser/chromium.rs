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
    /// Whether the page may be left when it asks, and how often it asked.
    pub(super) may_leave: bool,
    pub(super) asked: u32,
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
        let (session, complaints) = (String::new(), Vec::new());
        let mut page = Self { browser, to, from, session, calls: 0, complaints, may_leave: true, asked: 0 };
        let target = page.call("Target.createTarget", json!({ "url": "about:blank" }))["targetId"].clone();
        let attached = page.call("Target.attachToTarget", json!({ "targetId": target, "flatten": true }));
        page.session = attached["sessionId"].as_str().expect("session").to_owned();
        for domain in ["Runtime", "Log", "Page", "DOM", "Accessibility", "Performance"] {
            // Times are those of the page's thread, whatever else the machine does.
            let params = if domain == "Performance" { json!({ "timeDomain": "threadTicks" }) } else { json!({}) };
            page.call(&format!("{domain}.enable"), params);
        }
        let size = json!({ "width": PAGE[0], "height": PAGE[1], "deviceScaleFactor": 1, "mobile": false });
        page.call("Emulation.setDeviceMetricsOverride", size);
        Some(page)
    }

    /// Calls a method of the protocol and waits for its result.
    pub(super) fn call(&mut self, method: &str, params: Value) -> Value {
        let call = self.send(method, params);
        loop {
            let answer = self.from.recv_timeout(PATIENCE).expect("the browser answers");
            if answer["id"] == call {
                // A page that is being loaded again has no value for the moment, and no elements.
                let ends = answer["error"]["code"] == -32000;
                assert!(ends || answer["error"].is_null(), "{method}: {}", answer["error"]);
                return answer["result"].clone();
            }
            self.listen(&answer);
        }
    }

    /// Sends a call; answers its number.
    fn send(&mut self, method: &str, params: Value) -> u64 {
        self.calls += 1;
        let mut message = json!({ "id": self.calls, "method": method, "params": params });
        if !self.session.is_empty() {
            message["sessionId"] = self.session.as_str().into();
        }
        write!(self.to, "{message}\0").and_then(|()| self.to.flush()).expect("the browser listens");
        self.calls
    }

    /// Errors of the console, of scripts and of what was loaded; the question whether the page may be left.
    fn listen(&mut self, event: &Value) {
        let params = &event["params"];
        if event["method"] == "Page.javascriptDialogOpening" {
            assert_eq!(params["type"], "beforeunload", "{params}");
            self.asked += 1;
            self.send("Page.handleJavaScriptDialog", json!({ "accept": self.may_leave }));
        }
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

    /// Loads the page again. A page that nobody has pressed since it was loaded may not ask.
    ///
    /// * `asks`: whether it asks before it is left.
    pub(super) fn reload(&mut self, asks: bool) {
        let asked = self.asked + u32::from(asks);
        self.value("window.stays = true");
        self.call("Page.reload", json!({}));
        if self.may_leave || !asks {
            self.wait("window.stays ?? null", Value::is_null);
        } else {
            // The question comes some time after the answer.
            let began = Instant::now();
            while self.asked < asked && began.elapsed() < PATIENCE {
                self.value("window.stays");
            }
            assert_eq!(self.value("window.stays"), true, "it is loaded although it may not be left");
        }
        assert_eq!(self.asked, asked, "how often it asked");
    }

    /// Waits until a script has a value that passes.
    pub(super) fn wait(&mut self, script: &str, passes: impl Fn(&Value) -> bool) -> Value {
        let began = Instant::now();
        loop {
            let value = self.value(script);
            if passes(&value) {
                return value;
            }
            let text = self.value("document.body?.innerText ?? ''");
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

    /// A key is pressed.
    ///
    /// * `modifiers`: 0, or 2 for Ctrl, 8 for Shift.
    pub(super) fn key(&mut self, key: &str, code: &str, number: u32, modifiers: u32) {
        for kind in ["rawKeyDown", "keyUp"] {
            let params = json!({ "type": kind, "modifiers": modifiers, "key": key, "code": code, "windowsVirtualKeyCode": number });
            self.call("Input.dispatchKeyEvent", params);
        }
    }

    /// Files are dropped on the middle of the page.
    pub(super) fn drop_files(&mut self, files: &[&Path]) {
        for step in ["dragEnter", "dragOver", "drop"] {
            let data = json!({ "items": [], "files": files, "dragOperationsMask": 1 });
            let params = json!({ "type": step, "x": PAGE[0] / 2, "y": PAGE[1] / 2, "data": data });
            self.call("Input.dispatchDragEvent", params);
        }
    }

    /// Roles and names in the browser's tree of accessibility, and its numbers of the elements.
    pub(super) fn accessible(&mut self) -> Vec<(String, String, Value)> {
        let tree = self.call("Accessibility.getFullAXTree", json!({}));
        let text = |node: &Value, key: &str| node[key]["value"].as_str().unwrap_or_default().to_owned();
        let nodes = tree["nodes"].as_array().into_iter().flatten().filter(|node| node["ignored"] == false);
        nodes.map(|node| (text(node, "role"), text(node, "name"), node["backendDOMNodeId"].clone())).collect()
    }

    /// Waits for the element of a role and a name, as a screen reader finds it, and calls a function of the page with it.
    pub(super) fn with(&mut self, role: &str, name: &str, function: &str) {
        let began = Instant::now();
        loop {
            let nodes = self.accessible();
            if let Some((_, _, node)) = nodes.iter().find(|(r, n, _)| r == role && n == name) {
                let found = self.call("DOM.resolveNode", json!({ "backendNodeId": node }));
                if let Some(object) = found["object"]["objectId"].as_str() {
                    let params = json!({ "objectId": object, "functionDeclaration": function, "userGesture": true });
                    self.call("Runtime.callFunctionOn", params);
                    return;
                }
            }
            let there: Vec<String> = nodes.into_iter().map(|(role, name, _)| format!("{role} {name}")).collect();
            assert!(began.elapsed() < PATIENCE, "there is no {role} {name}, but {there:?}; {:?}", self.complaints);
            std::thread::sleep(Duration::from_millis(50));
        }
    }

    /// Presses a button as a screen reader does.
    pub(super) fn press(&mut self, name: &str) {
        self.with("button", name, "function () { this.click(); }");
    }

    /// Share of a core that the page's thread works while nobody does anything.
    pub(super) fn load_at_rest(&mut self, time: Duration) -> f64 {
        let mut metric = || {
            let metrics = self.call("Performance.getMetrics", json!({}));
            let value = |name: &str| {
                let metrics = metrics["metrics"].as_array().into_iter().flatten();
                metrics.filter(|metric| metric["name"] == name).find_map(|metric| metric["value"].as_f64())
            };
            [value("TaskDuration"), value("Timestamp")].map(|value| value.expect("a metric"))
        };
        let before = metric();
        std::thread::sleep(time);
        let after = metric();
        (after[0] - before[0]) / (after[1] - before[1])
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
