//! What holds of the repository itself: its layers, its pages, what its benchmarks say.

mod benchmark_copies;
mod benchmark_history;
mod benchmark_scenes;
mod benchmark_verdict;
mod docs;
mod layers;
mod models;
mod package;
