//! A software screen: the triangles that the application would draw on a graphics card, with the same result on all machines.

use eframe::egui::{Color32, Context, FullOutput, ImageData, Mesh, Rect, TextureId, TexturesDelta, epaint::Primitive};
use egui_kittest::TestRenderer;
use image::{Rgba, RgbaImage};
use std::collections::HashMap;

/// The textures of the application.
#[derive(Default)]
pub(crate) struct Screen(HashMap<TextureId, Texture>);

struct Texture {
    size: [usize; 2],
    pixels: Vec<Color32>,
}

impl TestRenderer for Screen {
    fn handle_delta(&mut self, delta: &mut TexturesDelta) {
        for (id, change) in
            delta.set.drain().flat_map(|(id, changes)| changes.into_iter().map(move |change| (id, change)))
        {
            let ImageData::Color(image) = &change.image;
            match change.pos {
                None => drop(self.0.insert(id, Texture { size: image.size, pixels: image.pixels.clone() })),
                Some([x, y]) => {
                    let texture = self.0.get_mut(&id).expect("a texture that is there");
                    for (row, pixels) in image.pixels.chunks(image.size[0]).enumerate() {
                        let at = (y + row) * texture.size[0] + x;
                        texture.pixels[at..at + pixels.len()].copy_from_slice(pixels);
                    }
                }
            }
        }
        delta.free.drain().for_each(|id| drop(self.0.remove(&id)));
    }

    fn render(&mut self, ctx: &Context, output: &FullOutput) -> Result<RgbaImage, String> {
        let scale = output.pixels_per_point;
        let size = ctx.content_rect().size() * scale;
        let mut image = RgbaImage::from_pixel(size.x as u32, size.y as u32, Rgba([0, 0, 0, 255]));
        for clipped in ctx.tessellate(output.shapes.clone(), scale) {
            let Primitive::Mesh(mesh) = clipped.primitive else { continue };
            let texture = self.0.get(&mesh.texture_id).ok_or("a texture is missing")?;
            draw(&mut image, &mesh, texture, clipped.clip_rect, scale);
        }
        Ok(image)
    }
}

/// Draws the triangles of a mesh: their colours times those of the texture, blended over the image.
fn draw(image: &mut RgbaImage, mesh: &Mesh, texture: &Texture, clip: Rect, scale: f32) {
    let edge = |at: f32, end: u32| (at * scale).round().clamp(0.0, end as f32) as u32;
    let (x_end, y_end) = (edge(clip.max.x, image.width()), edge(clip.max.y, image.height()));
    let (x_begin, y_begin) = (edge(clip.min.x, x_end), edge(clip.min.y, y_end));
    for triangle in mesh.indices.chunks_exact(3) {
        let corners = [0, 1, 2].map(|k| &mesh.vertices[triangle[k] as usize]);
        let [a, b, c] = corners.map(|corner| corner.pos * scale);
        let area = (b - a).x * (c - a).y - (b - a).y * (c - a).x;
        if area == 0.0 {
            continue;
        }
        let lowest = a.min(b).min(c);
        let highest = a.max(b).max(c);
        let rows = (lowest.y.floor().max(0.0) as u32).max(y_begin)..(highest.y.ceil() as u32).min(y_end);
        for y in rows {
            for x in (lowest.x.floor().max(0.0) as u32).max(x_begin)..(highest.x.ceil() as u32).min(x_end) {
                let at = eframe::egui::pos2(x as f32 + 0.5, y as f32 + 0.5);
                let side = |p: eframe::egui::Pos2, q: eframe::egui::Pos2| {
                    ((q - p).x * (at - p).y - (q - p).y * (at - p).x) / area
                };
                let shares = [side(b, c), side(c, a), side(a, b)];
                // A pixel whose middle lies on an edge belongs to one of the two triangles that share it.
                let owns = |share: f32, p: eframe::egui::Pos2, q: eframe::egui::Pos2| {
                    let d = (q - p) * area.signum();
                    share > 0.0 || (share == 0.0 && (d.y < 0.0 || (d.y == 0.0 && d.x > 0.0)))
                };
                if !(owns(shares[0], b, c) && owns(shares[1], c, a) && owns(shares[2], a, b)) {
                    continue;
                }
                let mix = |value: &dyn Fn(usize) -> f32| (0..3).map(|k| shares[k] * value(k)).sum::<f32>();
                let uv = [mix(&|k| corners[k].uv.x), mix(&|k| corners[k].uv.y)];
                let sampled = sample(texture, uv);
                let over: [f32; 4] =
                    std::array::from_fn(|i| mix(&|k| f32::from(corners[k].color[i])) / 255.0 * sampled[i]);
                let pixel = image.get_pixel_mut(x, y);
                for i in 0..4 {
                    pixel[i] = (over[i] + f32::from(pixel[i]) * (1.0 - over[3] / 255.0)).round() as u8;
                }
            }
        }
    }
}

/// Bilinear sample of a texture.
fn sample(texture: &Texture, [u, v]: [f32; 2]) -> [f32; 4] {
    let [width, height] = texture.size;
    let place = |at: f32, size: usize| {
        let at = (at * size as f32 - 0.5).clamp(0.0, (size - 1) as f32);
        (at as usize, (at as usize + 1).min(size - 1), at.fract())
    };
    let ((x0, x1, fx), (y0, y1, fy)) = (place(u, width), place(v, height));
    let pixel = |x: usize, y: usize, i: usize| f32::from(texture.pixels[y * width + x][i]);
    std::array::from_fn(|i| {
        let row = |y: usize| pixel(x0, y, i) * (1.0 - fx) + pixel(x1, y, i) * fx;
        row(y0) * (1.0 - fy) + row(y1) * fy
    })
}
