//! Memory that pictures may take beside what the process holds.

use belvedere::core::{DVec2, DVec3, Pinhole, Projection, View};
use belvedere::cpu::CpuRenderer;
use belvedere::io::budget;
use belvedere::scene::{Frame, Heightfield, RenderError, RenderJob, RenderOptions, Renderer, Scene};
use belvedere::{PictureOptions, Session};
use std::sync::atomic::{AtomicU64, Ordering::Relaxed};
use std::sync::{Arc, Mutex};

const MIB: u64 = 1 << 20;

/// Bytes that the process is said to hold.
static HELD: AtomicU64 = AtomicU64::new(0);

/// A renderer that keeps 300 MiB from its first picture on, and notes how much each may take.
#[derive(Default)]
struct Keeping {
    renderer: CpuRenderer,
    allowed: Mutex<Vec<u64>>,
}

impl Renderer for Keeping {
    fn name(&self) -> &'static str {
        "keeping"
    }

    fn render(&self, job: &RenderJob<'_>) -> Result<Frame, RenderError> {
        let mut allowed = self.allowed.lock().expect("free");
        if allowed.is_empty() {
            HELD.fetch_add(300 * MIB, Relaxed);
        }
        allowed.push(job.options.max_bytes);
        self.renderer.render(job)
    }
}

#[test]
fn caches_of_a_session_count_once_and_memory_of_others_always() {
    budget::count_by(|| HELD.load(Relaxed));
    HELD.store(100 * MIB, Relaxed);
    let ground =
        Heightfield::measured(DVec2::new(0.0, 90.0), DVec2::splat(10.0), 10, 10, vec![5.0; 100]).expect("ground");
    let lens = Projection::Perspective { fov_y: 0.8 };
    let eye = DVec3::new(50.0, -60.0, 60.0);
    let pinhole =
        Pinhole::look_at(eye, DVec3::new(50.0, 50.0, 0.0), DVec3::Z, lens, [32, 24], 1.0, None).expect("a camera");
    let renderer = Arc::new(Keeping::default());
    let session = Session::from_parts(Scene::default().with_terrain("ground", ground), View::straight(pinhole));
    let session = session.with_renderer(renderer.clone());
    let quality = RenderOptions { max_bytes: 1000 * MIB, ..PictureOptions::default().quality };
    let options = PictureOptions { quality, ..PictureOptions::default() };
    for frame in 0..4 {
        if frame == 3 {
            // Another session reads its data.
            HELD.fetch_add(200 * MIB, Relaxed);
        }
        session.clone().render(&options).expect("a picture");
    }
    HELD.store(0, Relaxed);
    let allowed: Vec<u64> = renderer.allowed.lock().expect("free").iter().map(|bytes| bytes.div_ceil(MIB)).collect();
    assert_eq!(allowed, [900, 900, 900, 700]);
}
