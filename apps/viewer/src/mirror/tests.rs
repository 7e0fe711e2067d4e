use super::*;
use eframe::egui::{Slider, Ui};
use std::sync::{Arc, Mutex};

/// A window with two controls, and what the page was told.
struct Page {
    ctx: Context,
    told: Arc<Mutex<Vec<Value>>>,
    rests: Arc<Mutex<f64>>,
    pressed: u32,
    angle: f64,
}

impl Page {
    fn new() -> Self {
        let (ctx, told) = (Context::default(), Arc::new(Mutex::new(Vec::new())));
        let outbox = told.clone();
        ctx.enable_accesskit();
        let rests = Arc::new(Mutex::new(0.0));
        let rest = rests.clone();
        ctx.add_plugin(Mirror::new(
            move |text| outbox.lock().expect("lock").push(serde_json::from_str(text).expect("JSON")),
            move |time| *rest.lock().expect("lock") = time,
        ));
        Self { ctx, told, rests, pressed: 0, angle: 40.0 }
    }

    /// One frame; what was told in it.
    fn frame(&mut self, has_button: bool) -> Vec<Value> {
        let mut output = self.ctx.clone().run_ui(RawInput::default(), |ui: &mut Ui| {
            if has_button && ui.button("Press").clicked() {
                self.pressed += 1;
            }
            ui.add(Slider::new(&mut self.angle, 5.0..=120.0).text("angle"));
        });
        // Nothing is painted here.
        output.textures_delta.clear();
        std::mem::take(&mut *self.told.lock().expect("lock"))
    }

    /// Frames until nothing changes any more; all that was told.
    fn rest(&mut self, has_button: bool) -> Vec<Value> {
        let mut all = Vec::new();
        for _ in 0..20 {
            let told = self.frame(has_button);
            if told.is_empty() && !all.is_empty() && *self.rests.lock().expect("lock") > 1e3 {
                return all;
            }
            all.extend(told);
        }
        panic!("it never rests: {all:?}")
    }
}

fn find(told: &[Value], role: &str) -> Value {
    let nodes = told.iter().rev().flat_map(|update| update["nodes"].as_array().expect("nodes"));
    nodes.into_iter().find(|node| node["role"] == role).unwrap_or_else(|| panic!("no {role} in {told:?}")).clone()
}

#[test]
fn controls_are_told_once_and_what_is_done_to_their_elements_is_done_to_them() {
    let mut page = Page::new();
    let told = page.rest(true);
    let (button, slider) = (find(&told, "button"), find(&told, "slider"));
    assert_eq!((&button["name"], &slider["number"], &slider["max"]), (&"Press".into(), &40.0.into(), &120.0.into()));
    assert!(button["place"][2].as_f64() > Some(10.0), "{button}");
    let name = told
        .iter()
        .flat_map(|update| update["nodes"].as_array().expect("nodes"))
        .find(|node| slider["named_by"].as_array().is_some_and(|ids| ids.contains(&node["id"])));
    assert_eq!(name.expect("a name")["value"], "angle");
    let id = |node: &Value| node["id"].as_str().expect("an id").to_owned();
    assert!(ask(&id(&button), "click", None, None).is_some());
    page.frame(true);
    assert_eq!(page.pressed, 1);
    assert!(ask(&id(&slider), "number", None, Some(55.5)).is_some());
    let told = page.rest(true);
    assert_eq!((page.angle, &find(&told, "slider")["number"]), (55.5, &55.5.into()));
    assert!(ask(&id(&button), "dance", None, None).is_none() && ask("x", "click", None, None).is_none());
    let told = page.rest(false);
    assert!(told.iter().any(|update| update["gone"].as_array().is_some_and(|gone| gone.contains(&button["id"]))));
}
