//! The library as a program meets it: its examples, and the names of everything it hands out.

mod examples;
mod names;
mod sessions;
mod sweeps;
mod walls;
mod warnings;
mod written_lakes;
mod written_rivers;
