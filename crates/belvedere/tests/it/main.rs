//! Tests of the library as its users see it: its examples, and the names of its types.

mod bands;
mod by_property;
mod escapes;
mod exact;
mod examples;
mod export;
mod films;
mod framed;
mod letters;
mod memory;
mod moving_pictures;
mod names;
mod over_ground;
mod parts;
mod see_through;
mod sessions;
mod steep_ground;
mod sweeps;
mod tiles;
mod typed_warnings;
mod vector_order;
mod vectors;
mod walls;
mod warnings;
mod written_lakes;
mod written_rivers;
