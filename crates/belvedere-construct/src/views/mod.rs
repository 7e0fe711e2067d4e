//! Views of a part of a model or of a city, and the frame of a picture whose bend is known.

mod city;
mod land;
mod models;
mod refit;

pub use city::{around_in_city, city_region};
pub use land::{LandView, over_land};
pub use models::{MANY, around_model, core_of_town, outline};
pub use refit::{Content, Refit, RefitRecord, refit};
